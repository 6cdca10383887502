//! The laws of elements at more points than the kit looks at, and for single polynomials and coordinates.

use std::sync::Arc;

use proptest::prelude::*;
use unilateral::element::{Basis, Broken, CrouzeixRaviart, Element, Node, P1, P2};
use unilateral::kit::check_element;
use unilateral::quadrature::Rule;

/// Points inside, the vertices, and a point outside the reference simplex; their coordinates sum
/// to one.
fn points(dimension: usize) -> Vec<[f64; 4]> {
    let mut points = Rule::new(dimension, 7).points;
    points.extend((0..dimension + 1).map(|k| std::array::from_fn(|i| f64::from(i == k))));
    let mut outside = [1.75, -0.5, 0.25, -0.75];
    outside[dimension] = 1.0 - outside[..dimension].iter().sum::<f64>();
    points.push(outside);
    points.iter_mut().for_each(|p| p[dimension + 1..].fill(0.0));
    points
}

// not numbers at first, so that an entry left unwritten is no zero that happens to be right

fn values_at<const D: usize>(element: &dyn Element<D>, point: &[f64; 4]) -> Vec<f64> {
    let mut out = vec![f64::NAN; element.per_cell()];
    element.values(&point[..=D], &mut out);
    out
}

fn derivatives_at<const D: usize>(element: &dyn Element<D>, point: &[f64; 4]) -> Vec<[f64; 4]> {
    let mut out = vec![[0.0; 4]; element.per_cell()];
    out.iter_mut().for_each(|row| row[..=D].fill(f64::NAN));
    element.derivatives(&point[..=D], &mut out);
    out
}

/// The polynomials `1` and `p_a p_b^(degree - 1)`, and powers of a linear function up to the element's degree, are
/// reproduced.
fn check_polynomials<const D: usize>(element: &dyn Element<D>) {
    let facet_rule = Rule::new(D - 1, element.basis_degree());
    let terms: Vec<_> = element.nodes().iter().map(|node| node.terms(&facet_rule)).collect();
    let check = |f: &dyn Fn(&[f64; 4]) -> f64| {
        let at_nodes: Vec<f64> =
            terms.iter().map(|terms| terms.iter().map(|(p, w)| w * f(p)).sum()).collect();
        for point in points(D) {
            let values = values_at(element, &point);
            let found: f64 = values.iter().zip(&at_nodes).map(|(v, at_node)| v * at_node).sum();
            assert!((found - f(&point)).abs() < 1e-13, "{element:?} at {point:?}: {found}");
        }
    };
    let power = element.degree() as i32 - 1;
    for a in 0..=D {
        for b in 0..=D {
            check(&|p| if a == b { 1.0 } else { p[a] * p[b].powi(power) });
        }
    }
    for degree in 0..=element.degree() as i32 {
        check(&|[a, b, c, d]| (0.9 * a - 0.7 * b + 0.4 * c - 1.1 * d).powi(degree));
    }
}

/// Derivatives are those of the values in every barycentric coordinate, taken as independent.
/// Central differences are exact for quadratics up to rounding.
fn check_partial_derivatives<const D: usize>(element: &dyn Element<D>) {
    let step = 0.25;
    for point in points(D) {
        let stated = derivatives_at(element, &point);
        for k in 0..=D {
            let moved = |by: f64| {
                let mut moved = point;
                moved[k] += by;
                values_at(element, &moved)
            };
            let (after, before) = (moved(step), moved(-step));
            for (i, stated) in stated.iter().enumerate() {
                let found = (after[i] - before[i]) / (2.0 * step);
                let difference = (found - stated[k]).abs();
                assert!(difference < 1e-13, "function {i}, coordinate {k}: {difference}");
            }
        }
    }
}

fn check<const D: usize>(element: &dyn Element<D>) {
    let report = check_element(element).unwrap();
    let [duality, derivatives] =
        ["duality", "derivatives"].map(|name| report.figure(name).unwrap());
    assert!(duality < 1e-14 && derivatives < 1e-13, "{report:?}");
    check_polynomials(element);
    check_partial_derivatives(element);
}

fn check_all<const D: usize>() {
    let in_basis = |basis, is_broken| -> Arc<dyn Element<D>> {
        P2.in_basis(basis, is_broken).expect("quadratics have this basis")
    };
    check::<D>(&P1);
    check::<D>(&P2);
    check::<D>(&CrouzeixRaviart);
    check::<D>(&*in_basis(Basis::Bernstein, true));
    check::<D>(&*in_basis(Basis::Bernstein, false));
    check::<D>(&Broken(P1));
    check::<D>(&Broken(P2));
    check::<D>(&Broken(CrouzeixRaviart));
}

#[test]
fn elements_obey_the_laws() {
    check_all::<1>();
    check_all::<2>();
    check_all::<3>();
}

proptest! {
    #[test]
    fn points_of_a_facet_lie_on_it(local in 0_usize..4, b in prop::array::uniform3(0.0_f64..1.0)) {
        let s = b.iter().sum::<f64>().max(1e-9);
        let rule = Rule::from_points(2, vec![[b[0] / s, b[1] / s, b[2] / s, 0.0]], vec![1.0]).unwrap();
        for (x, _) in Node::facet_mean(local).terms(&rule) {
            prop_assert_eq!(x[local], 0.0);
            prop_assert!((x.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }
}
