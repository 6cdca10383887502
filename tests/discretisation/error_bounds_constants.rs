//! The constants of Friedrichs' inequality with which bounds count what no flux balances.

use std::f64::consts::PI;

use unilateral::algebra::Contact;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::error_bound::{ErrorBound, Flux, Unproven};
use unilateral::inequality::{Outcome, Solution};
use unilateral::prelude::*;

const SIDES: [(usize, usize); 4] = [(0, 0), (0, 1), (1, 0), (1, 1)];

/// The bound of the function and the flux that vanish, under the load six, on a box whose sides are Dirichlet but for
/// some.
fn bound_of_zero(lengths: [f64; 2], others: &[((usize, usize), BoundaryCondition)]) -> ErrorBound {
    let mut domain = BoxDomain::<2>::dirichlet(Point::zeros(), Point::from(lengths));
    for &((axis, end), condition) in others {
        domain = domain.side(axis, end, condition);
    }
    let mesh = Mesh::kuhn_box(&domain, [3, 3]).unwrap();
    let problem = Problem::new().constant_source(6.0);
    let of = Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default());
    let of = of.unwrap();
    let zero = vec![0.0; of.unknowns()];
    let contact = vec![Contact::Inactive; zero.len()];
    let solution = Solution::new(zero.clone(), contact, Outcome::Converged);
    let mut pair = of.primal_dual_pair(&of.inequality().unwrap(), &solution).unwrap();
    pair.flux = Flux::zero(pair.flux.degree(), mesh.n_cells());
    of.error_bound(&pair, &zero).unwrap()
}

/// The squares of the reciprocals of axes that begin and end, or begin or end, on the Dirichlet boundary are added.
#[test]
fn constants_of_rectangles() {
    let constant = |lengths: [f64; 2], others: &[((usize, usize), BoundaryCondition)]| {
        let area: f64 = lengths.iter().product();
        bound_of_zero(lengths, others).total / 6.0 / area.sqrt() * PI
    };
    let neumann = |sides: &[(usize, usize)]| -> Vec<_> {
        sides.iter().map(|side| (*side, BoundaryCondition::Neumann)).collect()
    };
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    };
    near(constant([1.0, 1.0], &[]), 0.5_f64.sqrt());
    near(constant([2.0, 0.5], &[]), (0.25_f64 + 4.0).powf(-0.5));
    near(constant([1.0, 1.0], &[((1, 0), BoundaryCondition::Contact)]), 1.25_f64.powf(-0.5));
    for side in SIDES {
        near(constant([1.0, 1.0], &neumann(&[side])), 1.25_f64.powf(-0.5));
        // one side alone holds
        let others: Vec<_> = SIDES.into_iter().filter(|other| *other != side).collect();
        near(constant([1.0, 1.0], &neumann(&others)), 2.0);
    }
    // nothing holds the first axis
    near(constant([1.0, 3.0], &neumann(&[(0, 0), (0, 1)])), 3.0);
}

/// Without a Dirichlet boundary no constant is known, and what no flux balances is not in the bound.
#[test]
fn without_dirichlet_data_no_constant_is_known() {
    let all = SIDES.map(|side| (side, BoundaryCondition::Neumann));
    let bound = bound_of_zero([1.0, 1.0], &all);
    assert!(bound.unproven.contains(&Unproven::Algebra), "{:?}", bound.unproven);
    assert_eq!(bound.total, 0.0);
}
