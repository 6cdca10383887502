//! The number of unknowns, which is known before an assembly.

use std::sync::{Arc, Mutex};

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
