//! The number of unknowns, which is known before an assembly.

use std::sync::{Arc, Mutex};

use crate::support::panics::message_of_panic;

use unilateral::algebra::Inequality;
use unilateral::inequality::{ActiveSet, InequalitySolver, Solution};
use unilateral::prelude::*;
use unilateral::scheme::scheme_by_name;

/// A solver that keeps the numbers of unknowns for which it is asked whether it uses coarse spaces.
#[derive(Default)]
struct Asked(Arc<Mutex<Vec<usize>>>);

impl InequalitySolver<f64> for Asked {
    fn name(&self) -> &'static str {
        "asked"
    }
    fn solve(&self, inequality: &Inequality<f64>) -> Solution<f64> {
        ActiveSet::default().solve(inequality)
    }
    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        self.0.lock().unwrap().push(unknowns);
        false
    }
}

fn check<const D: usize>() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<D>::kuhn_box(&domain, [2; D]).unwrap();
    let problem = Problem::new().constant_source(1.0);
    for name in ["p1", "p2", "cr", "sipg", "wopsip", "sipg-p2"] {
        let scheme = scheme_by_name::<D>(name, &Default::default()).unwrap();
        let solver = Asked::default();
        let asked = Arc::clone(&solver.0);
        let solved = NestedIteration::new(&problem, &mesh).solver(solver).solve(&*scheme).unwrap();
        assert_eq!(*asked.lock().unwrap(), [solved.inequality().size()], "{name} in {D}D");
    }
}

#[test]
fn the_number_of_unknowns_is_known_before_the_assembly() {
    check::<1>();
    check::<2>();
    check::<3>();
}

/// An error where the function returns one, else a panic that says what is wrong.
#[test]
fn vectors_of_another_length_are_refused() {
    let scene = scenes::radial::<2>(1.0);
    let mesh = scene.domain.mesh(4).unwrap();
    let of = Discretisation::new(&ConformingP1, &scene.problem, &mesh, Default::default()).unwrap();
    let inequality = of.inequality().unwrap();
    let exact = scene.problem.exact.as_ref().unwrap();
    let right = ActiveSet::default().solve(&inequality);
    let pair = of.primal_dual_pair(&inequality, &right).unwrap();
    for n in [0, 24, 26] {
        let u = &vec![0.0; n][..];
        let mut solution = right.clone();
        solution.values = u.to_vec();
        let said = format!("number of values = {n}: one for each of the 25 unknowns");
        for error in [
            of.energy(u).err(),
            of.penetration(u).err(),
            of.errors(u).err(),
            of.errors_against(exact, u).err(),
            of.squared_errors(exact, u, &|_| true).err(),
            of.contact_errors(&inequality, &solution).err(),
        ] {
            let error = error.expect("another length");
            assert!(matches!(error, Error::Parameter(_)) && error.to_string() == said, "{error}");
        }
        let calls: [&dyn Fn(); 10] = [
            &|| _ = of.function(u),
            &|| _ = of.vertex_values(u),
            &|| _ = of.value_at(u, &Point::zeros()),
            &|| _ = of.fields(&inequality, &solution),
            &|| _ = of.multipliers(&inequality, &solution),
            &|| _ = of.resultant(&inequality, &solution),
            &|| _ = of.resultants(&inequality, &solution),
            &|| _ = of.contact_measure(&inequality, &solution),
            &|| _ = of.primal_dual_pair(&inequality, &solution),
            &|| _ = of.error_bound(&pair, u),
        ];
        for call in calls {
            assert_eq!(message_of_panic(call), said);
        }
    }
    let meshes = Hierarchy::refine(&mesh, 1).unwrap();
    let adaptive = AdaptiveMeshes::new(mesh.clone());
    let calls: [(&dyn Fn(), usize); 3] = [
        (&|| _ = meshes.mesh(9).n_cells(), 2),
        (&|| _ = meshes.part(9), 2),
        (&|| _ = adaptive.mesh(9).n_cells(), 1),
    ];
    for (call, n) in calls {
        assert_eq!(message_of_panic(call), format!("there are {n} meshes, none at position 9"));
    }
}

/// A solver that leaves out the last value, or the last contact state.
struct Short {
    is_of_values: bool,
}

impl InequalitySolver<f64> for Short {
    fn name(&self) -> &'static str {
        "short"
    }
    fn solve(&self, inequality: &Inequality<f64>) -> Solution<f64> {
        let mut solution = ActiveSet::default().solve(inequality);
        match self.is_of_values {
            true => _ = solution.values.pop(),
            false => _ = solution.contact.pop(),
        }
        solution
    }
}

#[test]
fn a_solver_of_ones_own_that_returns_too_little_has_no_iterate() {
    let scene = scenes::radial::<2>(1.0);
    let mesh = scene.domain.mesh(4).unwrap();
    for is_of_values in [true, false] {
        let nested = NestedIteration::new(&scene.problem, &mesh).cold_start(true);
        let solved = nested.solver(Short { is_of_values }).solve(&Sipg::default()).unwrap();
        assert!(!solved.converged() && !solved.has_iterate(), "{}", solved.outcome());
        assert_eq!((solved.energy().unwrap(), solved.value_at(&Point::zeros())), (None, None));
        assert!(solved.fields().is_none() && solved.penetration().unwrap().is_none());
        assert!(solved.errors().unwrap().l2.is_none() && solved.bound().is_err());
    }
}
