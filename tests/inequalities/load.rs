//! The load of an inequality is one vector, which every solver and the certificate read.

use unilateral::algebra::Inequality;
use unilateral::assemble::DataQuadrature;
use unilateral::inequality::{
    ActiveSet, InequalitySolver, Outcome, SOLVERS, Solution, certify, solver_by_name,
};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;
use unilateral::real::Precision;

fn square(n: usize) -> Mesh<2> {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Mesh::kuhn_box(&domain, [n, n]).unwrap()
}

fn assemble(scheme: &str, problem: &Problem<2>, mesh: &Mesh<2>) -> Inequality<f64> {
    let scheme: NamedScheme = scheme.parse().unwrap();
    let mut problem = problem.clone();
    problem.constraint_set = scheme.constraint_set().or(problem.constraint_set);
    scheme.make().inequality(&problem, mesh, DataQuadrature::default()).unwrap()
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// All solvers of the library.
fn solvers() -> Vec<Box<dyn InequalitySolver<f64>>> {
    let by_name =
        |name| solver_by_name(name, LinearMethod::default(), Precision::default()).unwrap();
    let mut solvers: Vec<_> = SOLVERS.iter().map(|(name, _)| by_name(name)).collect();
    for linear in [LinearMethod::Direct, LinearMethod::Iterative] {
        solvers.push(Box::new(ActiveSet::default().linear(linear)));
    }
    solvers
}

#[test]
fn without_a_load_the_solution_is_zero() {
    let mesh = square(8);
    let problem = Problem::new().constant_source(-8.0).obstacle_below(|_| -0.1);
    for name in ["p1", "sipg", "wopsip", "wopsip:facet-means", "wopsip-p2", "ldg", "cr"] {
        let given = assemble(name, &problem, &mesh);
        let mut without = given.clone();
        without.load.fill(0.0);
        assert!(without.is_well_formed());
        for solver in solvers() {
            let what = format!("{name}, {}", solver.name());
            let solution = solver.solve(&given);
            assert!(largest(solution.values.clone()) >= 0.1, "{what}");
            let solution = solver.solve(&without);
            assert!(solution.outcome == Outcome::Converged, "{what}: {}", solution.outcome);
            assert!(largest(solution.values.clone()) == 0.0, "{what}");
            assert!(certify(&without, &solution.values).largest() == 0.0, "{what}");
            assert!(certify(&given, &solution.values).largest() > 0.1, "{what}");
        }
    }
}

/// A membrane that rises from rest: the values of each step are a part of the load of the next one.
#[test]
fn each_step_of_the_implicit_euler_method_hears_the_last_one() {
    let mesh = square(8);
    let problem = Problem::new().constant_source(1.0).obstacle_below(|_| 0.0).reaction(50.0);
    for name in ["p1", "sipg", "wopsip", "wopsip:facet-means", "cr"] {
        let mut q = assemble(name, &problem, &mesh);
        let load = q.load.clone();
        let mut heights = Vec::new();
        for _ in 0..4 {
            let solution = ActiveSet::default().solve(&q);
            assert!(solution.outcome == Outcome::Converged, "{name}: {}", solution.outcome);
            heights.push(largest(solution.values.clone()));
            // the load of a source of one is a lumped mass
            for (i, u) in solution.values.iter().enumerate() {
                q.load[i] = load[i] * (1.0 + 50.0 * u);
            }
        }
        assert!(heights.windows(2).all(|pair| pair[1] > 1.02 * pair[0]), "{name}: {heights:?}");
    }
}

/// The sum of the solutions for the source alone and for Dirichlet data alone. The load of the assembled matrix has
/// no digit of the source below a weight of 1e10.
#[test]
fn beside_a_large_weight_dirichlet_data_leave_the_load_its_digits() {
    let mesh = square(8);
    let (source, data) = (|x: &Point<2>| 3.0 * x[0] - 1.0, |x: &Point<2>| 2.0 - x[0] * x[1]);
    let both = Problem::new().source(source).dirichlet(data);
    let solve = |q: &Inequality<f64>| -> Solution<f64> {
        let solution = ActiveSet::default().solve(q);
        assert!(solution.outcome == Outcome::Converged, "{}", solution.outcome);
        solution
    };
    for name in ["wopsip", "wopsip:facet-means"] {
        let of = |problem: &Problem<2>, weight| {
            assemble(&format!("{name}@eta={weight}"), problem, &mesh)
        };
        let [q, moderate] = [of(&both, "1e10"), of(&both, "1")];
        assert_eq!(q.load, moderate.load, "{name}: the load of the data has the weight in it");
        assert_eq!(q.load, of(&Problem::new().source(source), "1e10").load);
        assert!(largest(q.assembled_load().to_vec()) > 1e9, "{name}");
        let together = solve(&q).values;
        let of_source = solve(&of(&Problem::new().source(source), "1e10")).values;
        let of_data = solve(&of(&Problem::new().dirichlet(data), "1e10")).values;
        let parts = of_source.iter().zip(&of_data).map(|(a, b)| a + b);
        let off = largest(together.iter().zip(parts).map(|(a, b)| a - b));
        assert!(off < 1e-14 * 2.0 * 8.0, "{name}: {off:e}");
        // the load of another source, added: every bit of the inequality of that source
        let mut twice = q.clone();
        twice.load.iter_mut().for_each(|b| *b *= 2.0);
        let twofold = Problem::new().source(move |x| 2.0 * source(x)).dirichlet(data);
        assert_eq!(solve(&twice).values, solve(&of(&twofold, "1e10")).values, "{name}");
    }
}

/// The load of the assembled matrix is that of the form.
#[test]
fn the_assembled_load_is_that_of_the_form() {
    let mesh = square(5);
    let problem = Problem::new().source(|x| x[0]).dirichlet(|x| 2.0 + x[0] * x[1]);
    for name in ["p1", "sipg", "ldg", "wopsip", "wopsip-p2", "wopsip:facet-means@eta=1e6"] {
        let scheme: NamedScheme = name.parse().unwrap();
        let mut problem = problem.clone();
        problem.constraint_set = scheme.constraint_set();
        let scheme = scheme.make();
        let form =
            Discretisation::new(&*scheme, &problem, &mesh, DataQuadrature::default()).unwrap();
        let (load, q) = (form.load().unwrap(), form.inequality().unwrap());
        let assembled = q.assembled_load();
        assert_eq!(*assembled == *q.load, q.penalised.is_none(), "{name}");
        let off = largest(load.iter().zip(&*assembled).map(|(a, b)| a - b));
        assert!(off <= 1e-14 * largest(load), "{name}: {off:e}");
    }
}
