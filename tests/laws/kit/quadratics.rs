//! Nothing in the kit assumes linear elements: quadratics on triangles in the basis of vertex
//! values and means over sides.

use unilateral::element::{Layout, Node};
use unilateral::facet::{InteriorPenalty, Symmetry};
use unilateral::kit::{KitError, check_consistency, check_scheme};
use unilateral::prelude::*;

/// `6 l_j l_k` has mean one over its side and vanishes on the others and at vertices;
/// `l_i - 3 l_i (l_j + l_k)` is one at its vertex and has mean zero over every side.
#[derive(Clone, Copy)]
struct SideMeans;

impl<T: Real> ReferenceElement<T, 2> for SideMeans {
    const N: usize = 6;
    const DEGREE: usize = 2;
    const LAYOUT: Layout = Layout { vertex: 1, edge: 0, facet: 1, cell: 0 };
    fn values(lambda: &[T], out: &mut [T]) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            out[i] = lambda[i] - T::lit(3.0) * lambda[i] * (lambda[j] + lambda[k]);
            out[3 + i] = T::lit(6.0) * lambda[j] * lambda[k];
        }
    }
    fn derivatives(lambda: &[T], out: &mut [[T; 4]]) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            [out[i], out[3 + i]] = [[T::lit(0.0); 4]; 2];
            out[i][i] = T::lit(1.0) - T::lit(3.0) * (lambda[j] + lambda[k]);
            out[i][j] = -T::lit(3.0) * lambda[i];
            out[i][k] = -T::lit(3.0) * lambda[i];
            out[3 + i][j] = T::lit(6.0) * lambda[k];
            out[3 + i][k] = T::lit(6.0) * lambda[j];
        }
    }
    fn node(i: usize) -> Node {
        if i < 3 { Node::vertex(i) } else { Node::facet_mean(i - 3) }
    }
}

struct Quadratic {
    symmetry: Symmetry,
    rule: PenaltyRule,
}

impl<T: Real> Scheme<T, 2> for Quadratic {
    type Element = Broken<SideMeans>;
    type Facet = InteriorPenalty;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;
    fn name(&self) -> &str {
        "quadratic"
    }
    fn facet(&self, _: &Mesh<T, 2>) -> InteriorPenalty {
        InteriorPenalty { symmetry: self.symmetry, rule: self.rule, degree: 2 }
    }
}

fn passes<T: Real>() {
    let symmetric = Quadratic { symmetry: Symmetry::Symmetric, rule: PenaltyRule::Proven(0.5) };
    let report = check_scheme::<T, 2, _>(&symmetric).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((report.element.degree, report.element.functions), (2, 6));
    assert_eq!((report.orders.h1_expected, report.orders.l2_expected), (2.0, Some(3.0)));
    // rounding in single precision outweighs the error in L2
    let precise = T::EPSILON < 1e-10;
    assert!(report.orders.h1 > 1.75 && (report.orders.l2 > 2.75 || !precise), "{report}");
    // without symmetry even degrees lose an order in L2, which nothing promised
    let without = Quadratic { symmetry: Symmetry::NonSymmetric, rule: PenaltyRule::Diameter(10.0) };
    let report = check_scheme::<T, 2, _>(&without).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(report.orders.l2_expected, None);
}

#[test]
fn quadratics_pass() {
    passes::<f64>();
    passes::<f32>();
}

/// Mean jumps control linears, not quadratics.
struct MeansOnly;

impl<T: Real> FacetForm<T, 2> for MeansOnly {
    fn uses_flux(&self) -> bool {
        true
    }
    fn moments(&self, _: usize) -> usize {
        0
    }
    fn penalty(&self, facet: &FacetView<T, 2>) -> T {
        T::lit(20.0) / facet.diameter()
    }
    fn integrand(&self, _: &FacetView<T, 2>, v: Trace<T>, u: Trace<T>, penalty: T) -> T {
        penalty * u.jump * v.jump - u.flux * v.jump - v.flux * u.jump
    }
}

struct UnderSampled;

impl<T: Real> Scheme<T, 2> for UnderSampled {
    type Element = Broken<SideMeans>;
    type Facet = MeansOnly;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;
    fn name(&self) -> &str {
        "under-sampled"
    }
    fn facet(&self, _: &Mesh<T, 2>) -> MeansOnly {
        MeansOnly
    }
}

#[test]
fn quadratics_with_terms_for_linears_are_not_consistent() {
    let error = check_consistency::<f64, 2, _>(&UnderSampled).unwrap_err();
    assert!(matches!(error, KitError::NotConsistent { degree: 2, .. }), "{error}");
}
