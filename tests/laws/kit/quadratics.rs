//! Nothing in the kit assumes linear elements: quadratics on triangles in the basis of vertex
//! values and means over sides.

use std::sync::Arc;

use unilateral::element::{Layout, Node};
use unilateral::facet::{InteriorPenalty, Symmetry};
use unilateral::kit::{KitErrorKind, Law, check_law, check_scheme};
use unilateral::prelude::*;

/// `6 l_j l_k` has mean one over its side and vanishes on the others and at vertices;
/// `l_i - 3 l_i (l_j + l_k)` is one at its vertex and has mean zero over every side.
#[derive(Clone, Copy, Debug)]
struct SideMeans;

impl Element<2> for SideMeans {
    fn degree(&self) -> usize {
        2
    }
    fn layout(&self) -> Layout {
        Layout { vertex: 1, edge: 0, facet: 1, cell: 0 }
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            out[i] = lambda[i] - 3.0 * lambda[i] * (lambda[j] + lambda[k]);
            out[3 + i] = 6.0 * lambda[j] * lambda[k];
        }
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            [out[i], out[3 + i]] = [[0.0; 4]; 2];
            out[i][i] = 1.0 - 3.0 * (lambda[j] + lambda[k]);
            out[i][j] = -3.0 * lambda[i];
            out[i][k] = -3.0 * lambda[i];
            out[3 + i][j] = 6.0 * lambda[k];
            out[3 + i][k] = 6.0 * lambda[j];
        }
    }
    fn node(&self, i: usize) -> Node {
        if i < 3 { Node::vertex(i) } else { Node::facet_mean(i - 3) }
    }
}

struct Quadratic {
    symmetry: Symmetry,
    rule: PenaltyRule,
}

impl Scheme<2> for Quadratic {
    fn name(&self) -> &str {
        "quadratic"
    }
    fn element(&self) -> Arc<dyn Element<2>> {
        Arc::new(Broken(SideMeans))
    }
    fn form(&self, _: &Mesh<2>) -> Box<dyn FacetForm<2>> {
        Box::new(InteriorPenalty { symmetry: self.symmetry, rule: self.rule, degree: 2 })
    }
}

#[test]
fn quadratics_pass() {
    let symmetric = Quadratic { symmetry: Symmetry::Symmetric, rule: PenaltyRule::Proven(0.5) };
    let report = check_scheme::<2>(&symmetric).unwrap_or_else(|e| panic!("{e}"));
    let figures = |law, names: [&str; 2]| names.map(|name| report.figure(law, name));
    assert_eq!(figures(Law::Element, ["degree", "functions"]), [Some(2.0), Some(6.0)]);
    assert_eq!(figures(Law::Orders, ["H1 due", "L2 due"]), [Some(2.0), Some(3.0)]);
    let [h1, l2] = figures(Law::Orders, ["H1", "L2"]);
    assert!(h1 > Some(1.75) && l2 > Some(2.75), "{report}");
    // without symmetry even degrees lose an order in L2, which nothing promised
    let without = Quadratic { symmetry: Symmetry::NonSymmetric, rule: PenaltyRule::Diameter(10.0) };
    let report = check_scheme::<2>(&without).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(report.figure(Law::Orders, "L2 due"), None);
}

/// Mean jumps control linears, not quadratics.
struct MeansOnly;

impl FacetForm<2> for MeansOnly {
    fn moments(&self, _: usize) -> usize {
        0
    }
    fn penalty(&self, facet: &FacetView<2>) -> f64 {
        20.0 / facet.diameter()
    }
    fn integrand(&self, _: &FacetView<2>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump - u.flux * v.jump - v.flux * u.jump
    }
}

struct UnderSampled;

impl Scheme<2> for UnderSampled {
    fn name(&self) -> &str {
        "under-sampled"
    }
    fn element(&self) -> Arc<dyn Element<2>> {
        Arc::new(Broken(SideMeans))
    }
    fn form(&self, _: &Mesh<2>) -> Box<dyn FacetForm<2>> {
        Box::new(MeansOnly)
    }
}

#[test]
fn quadratics_with_terms_for_linears_are_not_consistent() {
    let error = check_law::<2>(Law::Consistency, &UnderSampled).unwrap_err();
    assert_eq!(error.kind, KitErrorKind::NotConsistent, "{error}");
    assert!(error.to_string().contains("a polynomial of degree 2"), "{error}");
}
