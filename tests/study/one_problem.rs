//! One problem solved by one call, and several solvers side by side.

use std::sync::Arc;

use std::path::Path;

use crate::support::scratch::Scratch;
use unilateral::algebra::Start;
use unilateral::inequality::{
    ActiveSet, InequalitySolver, MonotoneMultigrid, Outcome, SOLVERS, SinglePrecision,
    solver_by_name,
};
use unilateral::linear::LinearMethod;
use unilateral::mesh::gmsh;
use unilateral::prelude::*;
use unilateral::problem::Exact;
use unilateral::real::Precision;
use unilateral::scenes::Scene;

/// A membrane above an obstacle that stops at a part of its boundary too.
fn plate() -> (Mesh<2>, Problem<2>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/plate.msh");
    let problem = Problem::new()
        .constant_source(-2.0)
        .obstacle_below(|x| -0.1 - 0.2 * x[0] * x[0])
        .signorini(|_| -0.2);
    (gmsh::read(&path).unwrap().mesh, problem)
}

fn square(n: usize) -> Mesh<2> {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Mesh::kuhn_box(&domain, [n, n]).unwrap()
}

#[test]
fn one_call_and_a_study_give_the_same_bits() {
    let (mesh, problem) = plate();
    let (_, of_study) = plate();
    // the domain of the scene is not used
    let scene = Scene::new("plate", BoxDomain::above_contact(), of_study);
    let study = Study::<2>::new(scene.domain(mesh.clone())).levels([0, 3]);
    let study = study.scheme(ConformingP1).scheme(Sipg::default()).scheme(Wopsip::default());
    let rows = study.run().unwrap().rows;
    let meshes = Hierarchy::refine(&mesh, 3).unwrap();
    let schemes: [&dyn Scheme<2>; 3] = [&ConformingP1, &Sipg::default(), &Wopsip::default()];
    for (scheme, rows) in schemes.iter().zip(rows.chunks(2)) {
        let flat = solve(&problem, &mesh, *scheme).unwrap();
        let nested = solve(&problem, &meshes, *scheme).unwrap();
        for (solved, row) in [flat, nested].iter().zip(rows) {
            assert!(solved.converged() && solved.active() > Some(0), "{}", row.scheme);
            assert_eq!(solved.objective(), row.objective, "{}", row.scheme);
            assert_eq!(solved.certificate(), row.certificate, "{}", row.scheme);
            assert_eq!(solved.active(), row.active, "{}", row.scheme);
            assert_eq!(solved.outer(), row.iterations.outer, "{}", row.scheme);
        }
    }
}

#[test]
fn a_large_mesh_without_coarser_ones_needs_few_active_sets() {
    let mesh = square(128);
    let problem = Problem::new()
        .constant_source(-8.0)
        .obstacle_below(|x| -0.2 - 0.5 * (x - Point::from([0.4, 0.5])).norm_squared());
    for scheme in [&ConformingP1 as &dyn Scheme<2>, &Sipg::default()] {
        let u = solve(&problem, &mesh, scheme).unwrap();
        assert!(u.converged() && u.certificate().largest() < 1e-9, "{}", scheme.name());
        assert!(u.outer() <= Some(6), "{}: {:?} active sets", scheme.name(), u.outer());
    }
    let ours = solve(&problem, &mesh, &ConformingP1).unwrap();
    let mut inequality = ours.inequality().clone();
    inequality.start = Start::Cold;
    let cold = ActiveSet::default().solve(&inequality);
    assert!(2 * ours.outer().unwrap() <= cold.outer, "{}", cold.outer);
    assert_eq!(ours.contact(), cold.contact);
}

#[test]
fn values_at_points_are_those_of_the_function() {
    let linear = |x: &Point<2>| 1.0 + 2.0 * x[0] - 3.0 * x[1];
    let exact = || Exact::new(linear, |_: &Point<2>| Point::from([2.0, -3.0]));
    let problem = Problem::new().solved_by(exact());
    let mesh = square(5);
    for scheme in [&ConformingP1 as &dyn Scheme<2>, &ConformingP2, &Br2::default()] {
        let u = solve(&problem, &mesh, scheme).unwrap();
        for x in [[0.0, 0.0], [1.0, 1.0], [0.37, 0.81], [0.6, 0.4]] {
            let x = Point::from(x);
            let value = u.value_at(&x).unwrap();
            assert!((value - linear(&x)).abs() < 1e-12, "{}: {value} at {x}", scheme.name());
        }
        assert_eq!(u.value_at(&Point::from([1.1, 0.5])), None);
        assert_eq!(u.errors().unwrap(), u.errors_against(&exact()).unwrap());
        // twice the gradient and a constant: distances are known
        let other = Exact::new(move |x| linear(x) + 1.0, |_| Point::from([5.0, 1.0]));
        let errors = u.errors_against(&other).unwrap();
        let [l2, h1] = [errors.l2, errors.h1].map(Option::unwrap);
        assert!((l2 - 1.0).abs() < 1e-12 && (h1 - 5.0).abs() < 1e-11, "{l2} {h1}");
    }
}

#[test]
fn differences_on_nested_meshes_are_between_difference_and_sum_of_errors() {
    let scene = scenes::radial::<2>(1.0);
    let meshes = Hierarchy::<2>::of_domain(&scene.domain, 16).unwrap();
    let mut nested = NestedIteration::new(&scene.problem, &meshes);
    let coarse = nested.solve_on(0, &Sipg::default()).unwrap();
    let fine = nested.solve(&ConformingP2).unwrap();
    let [there, back] = [fine.difference(&coarse), coarse.difference(&fine)].map(Result::unwrap);
    assert_eq!(there, back);
    assert_eq!(there.energy, None);
    let [rough, exact] = [coarse.errors(), fine.errors()].map(Result::unwrap);
    for (of, [apart, a, b]) in
        [("L2", [there.l2, rough.l2, exact.l2]), ("H1", [there.h1, rough.h1, exact.h1])]
            .map(|(of, numbers)| (of, numbers.map(Option::unwrap)))
    {
        // the two rules differ: the error on the coarse mesh is not integrated on the fine one
        assert!(apart > 0.99 * (a - b) && apart < 1.01 * (a + b), "{of}: {apart}, {a}, {b}");
    }
    let itself = fine.difference(&fine).unwrap();
    assert!(itself.l2 < Some(1e-13) && itself.max < Some(1e-13), "{itself:?}");
    let elsewhere = Hierarchy::<2>::of_domain(&scene.domain, 8).unwrap();
    let other = solve(&scene.problem, &elsewhere, &ConformingP1).unwrap();
    assert!(matches!(fine.difference(&other), Err(Error::NotNested)));
    let message = nested.solve_on(3, &ConformingP1).unwrap_err().to_string();
    assert_eq!(message, "position = 3: there are 3 meshes, of which the coarsest has position 0");
}

#[test]
fn multipliers_balance_the_load() {
    let problem = Problem::new().constant_source(-8.0).obstacle_below(|_| -0.1);
    let mesh = square(8);
    let u = solve(&problem, &mesh, &ConformingP1).unwrap();
    let multiplier = u.multiplier().unwrap();
    assert!(u.active() > Some(0) && multiplier.iter().all(|&m| m >= -1e-12));
    // where all neighbours of a vertex are in contact its multiplier is minus its load
    let middle = mesh.vertices().iter().position(|&x| x == Point::from([0.5, 0.5])).unwrap();
    assert!((multiplier[middle] - 8.0 / 64.0).abs() < 1e-12, "{}", multiplier[middle]);
}

#[test]
fn the_solution_writes_itself() {
    let (mesh, problem) = plate();
    let scratch = Scratch::new("one-problem");
    let u = solve(&problem, &mesh, &Wopsip::default()).unwrap();
    u.write_vtu(scratch.0.join("deep/plate.vtu")).unwrap();
    let bytes = std::fs::read(scratch.0.join("deep/plate.vtu")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    assert!(["u", "obstacle", "multiplier"].iter().all(|n| text.contains(&format!("\"{n}\""))));
}

#[test]
fn solvers_stand_side_by_side() {
    let study = Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).levels([8, 16]);
    let named =
        |name: &str| solver_by_name(name, LinearMethod::default(), Precision::default()).unwrap();
    let both = SOLVERS.iter().fold(study, |study, s| study.boxed_solver(named(s.0)));
    let report = both.run().unwrap();
    let solvers: Vec<&str> = report.rows.iter().map(|r| &r.solver[..]).collect();
    let [one, two, three, four] =
        ["active-set", "monotone-multigrid", "interior-point", "proximal"];
    assert_eq!(solvers, [one, one, two, two, three, three, four, four]);
    assert!(report.rows.iter().all(|r| r.converged()));
    // each series has its own orders
    let orders: Vec<bool> = report.rows.iter().map(|r| r.order.l2.is_some()).collect();
    assert_eq!(orders, [false, true].repeat(4));
    assert_eq!(report.observed_orders(0.1).len(), 2 * 4);
    let [a, others @ ..] = [1, 3, 5, 7].map(|k: usize| report.rows[k].error.h1.unwrap());
    assert!(others.iter().all(|b| (a - b).abs() < 1e-8 * a), "{a} {others:?}");
    let text = report.details_to_text(100);
    assert!(text.contains("\nscheme solver ") && text.contains(two), "{text}");
    assert!(solver_by_name("magic", LinearMethod::default(), Precision::default()).is_none());
    for (name, _) in SOLVERS {
        assert_eq!(named(name).name(), *name);
    }
    let only = Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).levels([8]);
    let rows = only.solver(MonotoneMultigrid::default()).run().unwrap().rows;
    assert_eq!((rows.len(), &rows[0].solver[..]), (1, two));
}

/// A scheme with a parameter that its name does not tell, as far as `tells` says so.
struct Mine {
    factor: f64,
    tells: bool,
}

impl<const D: usize> Scheme<D> for Mine {
    fn name(&self) -> &str {
        match self.factor {
            1.0 if self.tells => "mine-1",
            _ => "mine",
        }
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(P1))
    }
    fn form(&self, mesh: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let penalty = PenaltyRule::Diameter(self.factor);
        Nipg { penalty }.form(mesh)
    }
}

#[test]
fn two_series_of_one_name_are_refused_before_anything_runs() {
    let study = || Study::<2>::new(scenes::radial(1.0)).levels([4, 8]);
    let mine = |factor, tells| Mine { factor, tells };
    let refused = |study: Study<'_, 2>, wanted: &str| {
        let is_refused = |error: Error| match error {
            Error::EqualNames(why) => {
                let words = ["nothing would tell their rows apart", "give one of your own another"];
                why.starts_with(wanted) && words.iter().all(|words| why.contains(words))
            }
            other => panic!("{other}"),
        };
        assert!(study.check().is_err_and(is_refused) && study.run().is_err_and(is_refused));
    };
    refused(
        study().scheme(mine(1.0, false)).scheme(mine(18.0, false)),
        r#"two schemes of the study are named "mine", "#,
    );
    refused(
        study().scheme(Sipg::default()).scheme(Sipg::default()),
        r#"two schemes of the study are named "sipg", "#,
    );
    let solver = ActiveSet::default;
    refused(
        study().scheme(ConformingP1).solver(solver()).solver(solver()),
        r#"two solvers of the study are named "active-set", "#,
    );
    // names that tell them apart: each series has its own orders, that of the series alone
    let both = study().scheme(mine(1.0, true)).scheme(mine(18.0, true)).run().unwrap();
    for (factor, rows) in [1.0, 18.0].into_iter().zip(both.rows.chunks(2)) {
        let alone = study().scheme(mine(factor, true)).run().unwrap();
        assert_eq!(rows[0].order.l2, None);
        assert_eq!(rows[1].order, alone.rows[1].order);
        assert!(rows[1].order.h1 > Some(0.7), "{factor}: {:?}", rows[1].order);
    }
}

#[test]
fn a_study_has_one_precision() {
    let study = Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).levels([4]);
    let single = SinglePrecision::new(MonotoneMultigrid::default());
    let error = study.solver(ActiveSet::default()).solver(single).run().unwrap_err();
    assert!(error.to_string().contains("one precision for all solvers"), "{error}");
}

/// What does not fit together is malformed in single precision too, and no panic.
#[test]
fn single_precision_says_what_is_malformed() {
    let (mesh, problem) = plate();
    let mut inequality = solve(&problem, &mesh, &ConformingP1).unwrap().inequality().clone();
    inequality.load.pop();
    let solution = SinglePrecision::new(ActiveSet::default()).solve(&inequality);
    assert_eq!(solution.outcome, Outcome::Malformed);
}

#[test]
fn values_that_are_not_finite_are_refused() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&domain, [2, 2]).unwrap();
    let problem = Problem::new().constant_source(1.0);
    let nested = NestedIteration::new(&problem, &mesh);
    let judged = |value: f64| nested.judge_on(0, &ConformingP1, &[value; 9]).map(|s| s.outcome());
    assert_eq!(judged(0.0).unwrap(), Outcome::NotASolution);
    for value in [f64::INFINITY, -f64::INFINITY, f64::NAN] {
        let error = judged(value).unwrap_err();
        let of_values = matches!(&error, Error::Parameter(why) if why.starts_with("values = "));
        assert!(of_values, "{value}: {error}");
    }
}

/// A solve that ends at a share of the error bound takes fewer iterations, but for those by which a matrix that is not
/// symmetric gets its bound, once a solve; its error differs by no more, and its bound is hardly larger.
#[test]
fn solves_end_at_a_share_of_the_error_bound() {
    const SHARE: f64 = 0.1;
    let scene = scenes::radial::<2>(1.0);
    let meshes = Hierarchy::<2>::of_domain(&scene.domain, 64).unwrap();
    for named in NamedScheme::list(["p1", "sipg", "nipg", "wopsip:facet-means"]).unwrap() {
        let scheme = named.make::<2>();
        let solve = |tolerance: Option<f64>| {
            let solver = ActiveSet::default().linear(LinearMethod::Iterative);
            let nested = NestedIteration::new(&scene.problem, &meshes).solver(solver);
            let mut nested = match tolerance {
                Some(share) => nested.tolerance(share),
                None => nested,
            };
            nested.solve(&*scheme).unwrap()
        };
        let [to_rounding, to_share] = [None, Some(SHARE)].map(solve);
        assert!(to_share.converged(), "{}: {}", scheme.name(), to_share.outcome());
        let [all, few] = [&to_rounding, &to_share].map(|solved| solved.solution().linear);
        let is_symmetric = to_share.inequality().symmetric;
        assert!(few < all || !is_symmetric, "{}: {few} of {all} iterations", scheme.name());
        let error = |solved: &Solved<'_, 2>| solved.errors().unwrap().broken_energy.unwrap();
        let difference = (error(&to_rounding) - error(&to_share)).abs();
        let bound = to_share.bound().unwrap().discrete;
        assert!(difference <= SHARE * bound, "{}: {difference:e}, {bound:e}", scheme.name());
        let whole = to_rounding.bound().unwrap().discrete;
        assert!(bound <= (1.0 + 2.0 * SHARE) * whole, "{}: {bound:e}, {whole:e}", scheme.name());
    }
}
