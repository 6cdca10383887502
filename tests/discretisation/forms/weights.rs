//! The weights of forms on facets of meshes with known geometry.

use std::sync::{Arc, Mutex};

use crate::support::checks::Checks;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::facet::{FacetLifts, Side};
use unilateral::mesh::{BoundaryCondition, BoxDomain, Mesh, TaggedFacet};
use unilateral::prelude::*;

/// The unit square of two triangles: the diagonal from cell 0 to cell 1, and a side of cell 0.
fn diagonal_and_side(mesh: &Mesh<2>, alpha: [f64; 2]) -> [FacetView<'_, 2>; 2] {
    let root = 2_f64.sqrt();
    let side = |cell: usize, height: f64| Side {
        coefficient: alpha[cell],
        bound_coefficient: alpha[cell],
        volume: 0.5,
        surface: 2.0 + root,
        height,
    };
    // of the vertices 0, 1, 3 of cell 0 the middle one is opposite the diagonal
    let interior =
        FacetView::new(mesh, (0, 1), root, side(0, root / 2.0), Some(side(1, root / 2.0)));
    [interior, FacetView::new(mesh, (0, 0), 1.0, side(0, 1.0), None)]
}

fn unit_square() -> Mesh<2> {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Mesh::kuhn_box(&domain, [1, 1]).unwrap()
}

#[test]
fn penalties_on_two_triangles() {
    let mesh = unit_square();
    let root = 2_f64.sqrt();
    let mut checks = Checks::default();
    let mut close = |what: &str, form: &dyn FacetForm<2>, alpha, expected: [f64; 2]| {
        for (view, expected) in diagonal_and_side(&mesh, alpha).iter().zip(expected) {
            checks.close(
                &format!("{what}, {:?}", view.kind()),
                form.penalty(view),
                expected,
                1e-13,
            );
        }
    };
    // harmonic mean 3/2 of the coefficients 1 and 3, one half of the flux from each side
    let (ones, jumps) = ([1.0, 1.0], [1.0, 3.0]);
    let of = |scheme: &dyn Scheme<2>| scheme.form(&mesh);
    // boundary over volume of a cell, halved between cells, times three halves
    let ratio = (2.0 + root) / 0.5;
    close("sipg", &*of(&Sipg::default()), ones, [0.75 * ratio, 1.5 * ratio]);
    close("sipg", &*of(&Sipg::default()), jumps, [0.75 * 2.25 * ratio, 1.5 * ratio]);
    close("sipg-p2", &*of(&Sipg::default().on(P2)), ones, [2.25 * ratio, 4.5 * ratio]);
    close("iipg", &*of(&Iipg::default()), ones, [0.1875 * ratio, 0.375 * ratio]);
    close("nipg", &*of(&Nipg::default()), jumps, [1.5 / root, 1.0]);
    close("ldg", &*of(&Ldg::default()), jumps, [1.5 / root, 1.0]);
    // w^2 / alpha |F| / |K| of each side
    let lifts = [0.25 * root / 0.5 * 2.0, 1.0 / 0.5];
    let with_jumps = [0.5625 * (1.0 + 1.0 / 3.0) * root / 0.5, 2.0];
    close("br2", &*of(&Br2::default()), ones, lifts.map(|x| 4.5 * x));
    close("br2", &*of(&Br2::default()), jumps, with_jumps.map(|x| 4.5 * x));
    close("bmmpr", &*of(&Bmmpr::default()), ones, lifts);
    // the square of the diagonal of the domain is two, of quadratics its square four
    close("wopsip", &*of(&Wopsip::default()), ones, [2.0 / root.powi(3), 2.0]);
    close("wopsip-p2", &*of(&Wopsip::default().on(P2)), ones, [4.0 / root.powi(5), 4.0]);
    let anisotropic = Wopsip { weight: WeightRule::Anisotropic, ..Wopsip::default() };
    // h^2 = 2, l = (2 sqrt(sqrt(1/2)))^2 between the cells and 1 on the side
    close("anisotropic", &*of(&anisotropic), ones, [2.0 / (2.0 * 2.0 * root), 1.0]);
    checks.finish();
}

/// Of two different cells the one that asks for more counts.
#[test]
fn the_proven_bound_is_that_of_the_worse_cell() {
    let mesh = unit_square();
    let side = |volume: f64| Side {
        coefficient: 1.0,
        bound_coefficient: 1.0,
        volume,
        surface: 3.0,
        height: 1.0,
    };
    let penalty = |here: f64, there: f64| {
        let view = FacetView::new(&mesh, (0, 1), 1.0, side(here), Some(side(there)));
        Scheme::<2>::form(&Sipg::default(), &mesh).penalty(&view)
    };
    assert!((penalty(0.5, 0.1) / (0.75 * 3.0 / 0.1) - 1.0).abs() < 1e-14);
    assert_eq!(penalty(0.5, 0.1), penalty(0.1, 0.5));
}

/// The lifts of the facets of a triangle need a factor of three.
#[test]
fn the_bound_of_lifts_is_the_number_of_facets() {
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [3, 3]).unwrap();
    let problem = Problem::new();
    for (eta, is_below) in [(2.5, true), (2.99, true), (3.01, false), (4.5, false)] {
        let scheme = Br2 { factor: eta / 3.0, ..Br2::default() };
        let of = Discretisation::new(&scheme, &problem, &mesh, Default::default()).unwrap();
        assert_eq!(of.penalty_below_bound().is_some(), is_below, "eta = {eta}");
    }
}

/// The square of the lift of a moment of the jump of degree `m` into polynomials of degree `p - 1`:
/// the weights of [`FacetLifts`] against those integrated on one interval, triangle, tetrahedron in
/// their closed form, the first being `|F| / |K|` times one.
#[test]
fn moments_of_lifts() {
    fn of<const D: usize>(degree: usize, moment: usize) -> f64 {
        let form = FacetLifts { eta: 1.0, lift_degree: degree - 1, with_all_lifts: true };
        FacetForm::<D>::moment_weight(&form, moment)
    }
    // means into constants: the lift is constant, of energy |F|^2 / |K|
    assert_eq!([of::<1>(1, 0), of::<2>(1, 0), of::<3>(1, 0)], [1.0; 3]);
    // means into linears: on the unit interval s = 4 - 6 x has int s q = q(0), int s^2 = 4; on a
    // triangle and a tetrahedron 3 and 8/3 by the same for the height
    assert_eq!([of::<1>(2, 0), of::<2>(2, 0)], [4.0, 3.0]);
    assert!((of::<3>(2, 0) - 8.0 / 3.0).abs() < 1e-15);
    // first moments into linears
    assert_eq!(of::<2>(2, 1), 2.0);
    assert!((of::<3>(2, 1) - 5.0 / 3.0).abs() < 1e-15);
}

/// In one dimension the diameter of a vertex is the mean length of its two cells, at an end that of
/// its cell.
#[test]
fn the_diameter_of_a_vertex() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<1>::kuhn_box(&domain, [2]).unwrap();
    let side = |length: f64| Side {
        coefficient: 1.0,
        bound_coefficient: 1.0,
        volume: length,
        surface: 2.0,
        height: length,
    };
    let between = FacetView::new(&mesh, (0, 0), 1.0, side(0.2), Some(side(0.6)));
    let end = FacetView::new(&mesh, (0, 1), 1.0, side(0.2), None);
    assert_eq!((between.diameter(), end.diameter()), (0.4, 0.2));
    let over = Wopsip { eta: Eta::Absolute(1.0), ..Wopsip::default() };
    let form = Scheme::<1>::form(&over, &mesh);
    assert!((form.penalty(&between) - 0.4_f64.powi(-3)).abs() < 1e-12);
}

/// The default factor of the over-penalty has no dimension: a penalty scales as the stiffness does.
#[test]
fn the_default_over_penalty_scales_with_the_domain() {
    fn check<const D: usize>(scheme: &dyn Scheme<D>, power: i32) {
        let factor = |scale: f64| {
            let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(scale));
            let mesh = Mesh::<D>::kuhn_box(&domain, [2; D]).unwrap();
            scheme.parameters(&mesh).eta.unwrap()
        };
        let expected = (D as f64).sqrt().powi(power);
        assert!((factor(1.0) / expected - 1.0).abs() < 1e-14, "{}", factor(1.0));
        assert!((factor(10.0) / factor(1.0) / 10_f64.powi(power) - 1.0).abs() < 1e-13);
    }
    check::<1>(&Wopsip::default(), 2);
    check::<2>(&Wopsip::default(), 2);
    check::<3>(&Wopsip::default(), 2);
    check::<2>(&Wopsip::default().on(P2), 4);
}

/// Rounding weighs `(length / h)^2`, a discretisation error `(h / length)^2`, of quadratics its cube: the mesh size at
/// which they are equal is a length, and grows with the fourth, the fifth root of the rounding unit.
#[test]
fn the_limit_of_rounding_is_a_length() {
    let mesh = unit_square();
    for scheme in [&ConformingP1 as &dyn Scheme<2>, &Sipg::default(), &Wopsip::default()] {
        let form = scheme.form(&mesh);
        let limit = |epsilon, length| form.theory().rounding_limit(epsilon, length, 1);
        let of_quadratics = |epsilon| form.theory().rounding_limit(epsilon, 1.0, 2);
        assert!((of_quadratics(32e-16) / of_quadratics(1e-16) - 2.0).abs() < 1e-14);
        for length in [1e-3, 1.0, 1e3] {
            let expected = length * limit(1e-16, 1.0);
            assert!((limit(1e-16, length) / expected - 1.0).abs() < 1e-14, "{}", scheme.name());
        }
        assert!((limit(16e-16, 1.0) / limit(1e-16, 1.0) - 2.0).abs() < 1e-14);
    }
}

/// A penalty that notes the measures of the facets that it sees.
#[derive(Clone, Default)]
struct Noting(Arc<Mutex<Vec<f64>>>);

impl FacetForm<2> for Noting {
    fn uses_flux(&self) -> bool {
        false
    }
    fn penalty(&self, facet: &FacetView<2>) -> f64 {
        self.0.lock().unwrap().push(facet.measure);
        1.0
    }
    fn integrand(&self, _: &FacetView<2>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump
    }
}

impl Scheme<2> for Noting {
    fn name(&self) -> &str {
        "noting"
    }
    fn element(&self) -> Arc<dyn Element<2>> {
        Arc::new(Broken(P1))
    }
    fn form(&self, _: &Mesh<2>) -> Box<dyn FacetForm<2>> {
        Box::new(self.clone())
    }
}

#[test]
fn the_shortest_facet_of_a_thin_cell_keeps_its_digits() {
    for short in [1e-3, 1e-6, 1e-9] {
        let vertices = [[0.0, 0.0], [1.0, 0.0], [1.0, short]].map(Point::<2>::from);
        let sides = [[0, 1], [0, 2], [1, 2]]
            .map(|vertices| TaggedFacet { vertices, condition: BoundaryCondition::Dirichlet });
        let mesh = Mesh::new(vertices.to_vec(), vec![0, 1, 2], &sides).expect("one cell");
        let (scheme, problem) = (Noting::default(), Problem::new());
        let assembled =
            Discretisation::new(&scheme, &problem, &mesh, DataQuadrature::default()).unwrap();
        assert_eq!(assembled.matrix().size(), 3);
        let measures = scheme.0.lock().unwrap();
        let exact = [short, (1.0 + short * short).sqrt(), 1.0];
        assert_eq!(measures.len(), exact.len());
        for (measure, exact) in measures.iter().zip(exact) {
            assert!((measure / exact - 1.0).abs() < 4.0 * f64::EPSILON, "{short}");
        }
    }
}
