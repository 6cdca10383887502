//! Contact forces of over-penalty: at nodes whose jumps cancel they follow from balances, whatever jump multipliers a
//! solver has.

use unilateral::algebra::Contact;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{Outcome, Solution};
use unilateral::prelude::*;

/// Jump multipliers moved by any numbers do not change forces, whose sum over the copies of a node is that of the
/// residual with any multipliers.
fn moved_multipliers<const D: usize>(problem: &Problem<D>) {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<D>::kuhn_box(&domain, [3; D]).unwrap();
    let of = Discretisation::new(&Wopsip::default(), problem, &mesh, DataQuadrature::default());
    let of = of.unwrap();
    let inequality = of.inequality().unwrap();
    let penalised = inequality.penalised.as_ref().unwrap();
    let (n, number) = (inequality.size(), |k: usize| ((7 * k * k + 3 * k) % 23) as f64 - 11.0);
    let values: Vec<f64> = (0..n).map(number).collect();
    let multipliers = penalised.jump_multipliers(|i| values[i]);
    let moved: Vec<f64> =
        (0..penalised.n_jumps()).map(|k| multipliers[k] + 1e3 * number(k + 1)).collect();
    let state = |i: usize| if i.is_multiple_of(3) { Contact::Lower } else { Contact::Inactive };
    let contact: Vec<Contact> = (0..n).map(state).collect();
    let solution = Solution::new(values.clone(), contact.clone(), Outcome::Converged);
    let forces = |multipliers: &[f64]| {
        let solution = solution.clone().jump_multipliers(multipliers.to_vec());
        of.multipliers(&inequality, &solution).unwrap()
    };
    let (one, other) = (forces(&multipliers), forces(&moved));
    assert_eq!(one, other);
    assert!(one.iter().filter(|force| **force != 0.0).count() > 1);
    let mut residual = vec![0.0; n];
    let load = &inequality.load;
    penalised.residual_with_jump_multipliers(load, |i| values[i], |k| moved[k], &mut residual);
    let (locations, mut n_nodes) = (&inequality.locations, 0);
    for node in 0..n {
        let copies = || (0..n).filter(|&i| locations[i].vertices() == locations[node].vertices());
        if copies().any(|i| one[i] != 0.0) {
            let force: f64 = copies().map(|i| one[i]).sum();
            let sum: f64 = copies().map(|i| residual[i]).sum();
            assert!((force + sum).abs() <= 1e-9, "{node}: {force} {sum}");
            // copies in contact have equal shares, others have none
            for i in copies() {
                let share = if contact[i] == Contact::Lower { one[node] } else { 0.0 };
                let is_own = contact[node] == Contact::Lower;
                assert!(!is_own || one[i] == share, "{node} {i}: {} {share}", one[i]);
            }
            n_nodes += 1;
        }
    }
    assert!(n_nodes > 0);
}

#[test]
fn forces_at_nodes_do_not_depend_on_jump_multipliers() {
    let above = |_: &Point<2>| -0.1;
    let problem = Problem::new().constant_source(-1.0).obstacle_below(above);
    moved_multipliers::<2>(&problem.clone().on(Nodes));
    moved_multipliers::<2>(&problem.on(FacetMeans));
    let above = |_: &Point<3>| -0.1;
    moved_multipliers::<3>(&Problem::new().constant_source(-1.0).obstacle_below(above).on(Nodes));
}
