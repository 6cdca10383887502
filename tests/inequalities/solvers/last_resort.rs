//! What the solver falls back on, forced: it agrees with slow solvers that are easy to believe.

use crate::problems::*;
use unilateral::algebra::{Bound, Inequality};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::constraint::constraint_set_by_name;
use unilateral::inequality::{
    ActiveSet, InequalitySolver, InteriorPoint, MonotoneMultigrid, Outcome, Stage, certify,
};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::scheme::{SCHEMES, SchemeOptions, scheme_by_name};
use unilateral::study::Row;

/// Every solver there is for symmetric matrices, by what forces it.
fn agree(what: &str, problem: &Inequality<f64>) {
    let direct = ActiveSet::default().linear(LinearMethod::Direct).solve(problem);
    let iterative = ActiveSet::default().linear(LinearMethod::Iterative).solve(problem);
    let scale = 1.0 + distance(&direct.values, &vec![0.0; problem.size()]);
    let others = [
        ("direct", direct.clone()),
        ("iterative", iterative),
        ("interior", InteriorPoint.solve(problem)),
        ("multigrid", MonotoneMultigrid::default().solve(problem)),
    ];
    for (name, solution) in others {
        assert_eq!(solution.outcome, Outcome::Converged, "{what}: {name}");
        let certificate = certify(problem, &solution.values);
        assert!(certificate.largest() < 1e-8, "{what}: {name}: {certificate:?}");
        let off = distance(&solution.values, &direct.values);
        assert!(off < 1e-8 * scale, "{what}: {name} is off by {off}");
    }
}

#[test]
fn all_agree_on_random_problems() {
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let n = 6 + seed as usize % 20;
        let matrix = random_definite(n, n / 2, 0.003, &mut random);
        let load: Vec<f64> = (0..n).map(|_| random.signed()).collect();
        let problem = inequality(sparse(&matrix), &load, random_bounds(n, &mut random));
        agree(&format!("seed {seed}"), &problem);
    }
}

/// The inequality of a scene at a level.
fn of<S: Scheme<2>>(scene: &Scene<2>, scheme: &S, level: usize) -> Inequality<f64> {
    let mesh = scene.domain.mesh(level).unwrap();
    let space =
        Discretisation::new(scheme, &scene.problem, &mesh, DataQuadrature::default()).unwrap();
    space.inequality().unwrap()
}

fn scenes_of_all_kinds() -> Vec<Scene<2>> {
    vec![
        scenes::ball_2d(),
        scenes::cone(),
        scenes::biactive_half_2d(),
        scenes::degenerate(2),
        scenes::signorini_shifted_2d(),
        scenes::signorini_irrational_2d(),
    ]
}

fn wopsip(eta: f64) -> Wopsip {
    Wopsip { eta: Eta::Absolute(eta), ..Wopsip::default() }
}

#[test]
fn all_agree_on_scenes() {
    for scene in scenes_of_all_kinds() {
        let name = &scene.name;
        agree(&format!("{name} p1"), &of(&scene, &ConformingP1, 6));
        agree(&format!("{name} cr"), &of(&scene, &NonconformingP1, 6));
        agree(&format!("{name} sipg"), &of(&scene, &Sipg::default(), 4));
        for eta in [1.0, 10.0, 100.0] {
            let scheme = wopsip(eta);
            agree(&format!("{name} wopsip {eta}"), &of(&scene, &scheme, 4));
            let mut on_means = scene.clone();
            on_means.problem = on_means.problem.on(FacetMeans);
            agree(&format!("{name} means {eta}"), &of(&on_means, &scheme, 4));
        }
    }
}

/// What a slow solver finds on the smallest of them.
#[test]
fn the_oracle_agrees() {
    for scene in scenes_of_all_kinds() {
        for problem in [of(&scene, &wopsip(1.0), 3), of(&scene, &Sipg::default(), 3)] {
            let expected = projected_gauss_seidel(&problem);
            let found = InteriorPoint.solve(&problem);
            let off = distance(&found.values, &expected);
            assert!(off < 1e-8, "{}: {off}", scene.name);
        }
    }
}

/// The symmetric schemes there are, with every place of the bounds that fits.
#[test]
fn all_schemes_agree_with_the_oracle() {
    let mut compared = 0;
    for scene in [scenes::ball_2d(), scenes::signorini_shifted_2d()] {
        let mesh = scene.domain.mesh(2).unwrap();
        for &(name, _) in SCHEMES {
            for place in ["vertices", "facet-means", "nodes", "midpoints", "bernstein"] {
                let set = constraint_set_by_name(place).unwrap();
                let scheme = scheme_by_name::<2>(name, &SchemeOptions::default()).unwrap();
                // a scheme without such values keeps its nodes
                let constrained = match scheme.constraint_on(&set) {
                    Some(_) => scene.problem.clone().on(set),
                    None => scene.problem.clone(),
                };
                let quadrature = DataQuadrature::default();
                let Ok(problem) = scheme.inequality(&constrained, &mesh, quadrature) else {
                    continue;
                };
                if !problem.symmetric {
                    continue;
                }
                let what = format!("{} {name} {place}", scene.name);
                agree(&what, &problem);
                let found = ActiveSet::default().solve(&problem);
                let off = distance(&found.values, &projected_gauss_seidel(&problem));
                assert!(off < 1e-8, "{what}: {off}");
                compared += 1;
            }
        }
    }
    assert!(compared >= 40, "{compared}");
}

/// Converged, certified, and with at most so many steps.
fn converges<const D: usize>(scene: Scene<D>, scheme: Wopsip, level: usize, most: usize) {
    let eta = scheme.eta;
    let report = Study::<D>::new(scene).scheme(scheme).levels([level]).run().unwrap();
    let row = &report.rows[0];
    let what = format!("{} at level {level}, {:?}", row.scene, eta);
    assert!(row.converged(), "{what}");
    assert!(row.certificate.largest() < 1e-9, "{what}: {:?}", row.certificate);
    let outer = row.iterations.outer.unwrap();
    println!("{what}: {outer} steps, {:.2} s", row.seconds.solve);
    assert!(outer <= most, "{what}: {outer} steps");
}

/// Where contact is ragged the active set does not settle by itself.
#[test]
fn curved_and_kinked_obstacles_converge() {
    converges(scenes::ball_2d(), Wopsip::default(), 64, 25);
    converges(scenes::ball_2d(), wopsip(10.0), 64, 25);
    converges(scenes::cone::<2>(), wopsip(1.0), 32, 25);
    converges(scenes::cone::<2>(), wopsip(10.0), 32, 25);
    converges(scenes::pyramid_full_2d(), Wopsip::default(), 16, 30);
    for eta in [1.0, 10.0] {
        converges(scenes::oscillating_1d(), wopsip(eta), 128, 25);
    }
}

/// There contact shows in two scales: where values rest, and, by one over the penalty finer, how jumps
/// open. The active set must not be asked before the second.
#[test]
fn ragged_contact_is_found_under_every_penalty() {
    for eta in [1e4, 1e8] {
        converges(scenes::cone::<2>(), wopsip(eta), 16, 30);
        converges(scenes::torsion_2d(10.0), wopsip(eta), 16, 30);
        converges(scenes::disc_2d(), wopsip(eta), 16, 30);
    }
}

#[test]
#[ignore = "takes half a minute"]
fn curved_obstacles_converge_on_fine_meshes() {
    for level in [64, 128, 256] {
        converges(scenes::ball_2d(), wopsip(10.0), level, 25);
        converges(scenes::ball_2d(), Wopsip::default(), level, 25);
    }
}

/// The interior point method does not mind large penalties.
#[test]
fn no_penalty_is_too_large() {
    for eta in [1e-2, 1.0, 1e2, 1e4, 1e6, 1e8, 1e10] {
        let study = Study::<2>::new(scenes::ball_2d()).scheme(wopsip(eta));
        let row = study.solver(InteriorPoint).levels([8]).run().unwrap().rows.remove(0);
        assert!(row.converged(), "{eta:e}");
        assert!(row.certificate.largest() < 1e-9, "{eta:e}: {:?}", row.certificate);
        let outer = row.iterations.outer.unwrap();
        assert!(outer <= 40, "{eta:e}: {outer} steps");
    }
}

/// Copies of one node are tied by the penalty and leave the bound within the contact set by as little as it
/// admits: torsion and the L-shape have a contact set that the penalty decides cell by cell.
#[test]
fn bounds_at_nodes_of_quadratics_are_solved_where_rounding_leaves_digits() {
    let of = |scene: &Scene<2>, eta: f64, level: usize| {
        let scheme: NamedScheme = format!("wopsip-p2@eta={eta:e}").parse().unwrap();
        let study = Study::<2>::new(scene.clone()).named_scheme(&scheme).levels([level]);
        study.run().unwrap().rows.remove(0)
    };
    for name in ["torsion-2d", "lshape-2d", "ball-2d", "disc-2d"] {
        let made = scenes::by_name(name).unwrap().make(&scenes::Parameters::default()).unwrap();
        let scenes::AnyScene::Two(scene) = made else { panic!("{name}") };
        let level = if name == "lshape-2d" { 8 } else { 16 };
        for eta in [1e-2, 1e4, 1e7] {
            let row = of(&scene, eta, level);
            assert!(row.converged(), "{name} {eta:e}: {}", row.status);
            // where the last active set does not settle, the values are those of the interior point method
            let certificate = row.certificate;
            let limit = if eta < 1.0 { 1e-14 } else { 1e-9 };
            assert!(certificate.largest() < limit, "{name} {eta:e}: {certificate:?}");
            let outer = row.iterations.outer.unwrap();
            assert!(outer <= 60, "{name} {eta:e}: {outer} systems");
            // products of the entries of the matrix, of size eta, would leave no digit of the objective; that of ball-2d
            // contains the penalty of its Dirichlet data, and rules differ on the load of lshape-2d; values of the
            // interior point method jump by more than the penalty admits with 1e7
            if eta >= 1e4 && ["torsion-2d", "disc-2d"].contains(&name) {
                let (objective, energy) = (row.objective.unwrap(), row.energy.unwrap());
                let difference = (objective / energy - 1.0).abs();
                let limit = if eta < 1e7 { 1e-4 / eta + 1e-12 } else { 1e-5 };
                assert!(difference < limit, "{name} {eta:e}: {objective} {energy}");
            }
        }
    }
}

/// Quadratics of whose assembled matrix a penalty leaves no digit are refused before the solve, and the row says why.
#[test]
fn quadratics_without_digits_are_refused() {
    let row = |name: &str, level: usize| {
        let scheme: NamedScheme = name.parse().unwrap();
        let study = Study::<2>::new(scenes::signorini_2d()).named_scheme(&scheme);
        study.levels([level]).run().unwrap().rows.remove(0)
    };
    let says = |row: &Row, text: &str| row.warnings.iter().any(|w| w.contains(text));
    let refused = row("wopsip-p2@eta=1e10", 16);
    assert_eq!(refused.status, Outcome::Singular);
    assert!(refused.iterations.stages.is_empty(), "{:?}", refused.iterations);
    assert!(
        says(&refused, "times the stiffness on 1024 cells leaves no digit in f64"),
        "{refused:?}"
    );
    for name in ["wopsip-p2", "wopsip-p2@eta=1e7", "wopsip@eta=1e10"] {
        let solved = row(name, 16);
        assert!(solved.converged() && !says(&solved, "digit"), "{name}: {solved:?}");
    }
}

/// Krylov methods with the assembled matrix of a huge penalty leave an active set whose jump multipliers exceed all loads
/// by it; the interior point method does not start from them.
#[test]
fn jump_multipliers_of_an_arbitrary_active_set_are_no_start() {
    let scheme: NamedScheme = "wopsip-p2@eta=1e4".parse().unwrap();
    let made = scenes::by_name("contrast-2d").unwrap().make(&scenes::Parameters::default());
    let scenes::AnyScene::Two(scene) = made.unwrap() else { panic!() };
    let study = Study::<2>::new(scene).named_scheme(&scheme).levels([32]);
    let row = study.run().unwrap().rows.remove(0);
    assert!(row.converged(), "{}", row.status);
    assert!(row.certificate.largest() < 1e-14, "{:?}", row.certificate);
    assert!(row.iterations.outer < Some(80), "{:?}", row.iterations);
}

/// Rounding of a huge penalty makes a direction of a Krylov method look indefinite. The matrix is known to be
/// definite, so that factors with jump multipliers go on.
#[test]
fn rounding_in_a_krylov_method_is_not_an_indefinite_matrix() {
    let scheme: NamedScheme = "wopsip-p2@eta=1e6".parse().unwrap();
    let study = Study::<2>::new(scenes::radial(1.0)).named_scheme(&scheme).levels([32]);
    let row = study.run().unwrap().rows.remove(0);
    let stages: Vec<Stage> = row.iterations.stages.iter().map(|run| run.stage).collect();
    assert_eq!(stages[..2], [Stage::PreconditionedActiveSet, Stage::DirectActiveSet]);
    assert!(row.converged(), "{}", row.status);
    assert!(row.certificate.largest() < 1e-9);
    assert!((row.error.h1.unwrap() / 9.25e-3 - 1.0).abs() < 0.01, "{:?}", row.error.h1);
}

/// Factors aim at a certificate of rounding. Where a small penalty keeps them above it and below the limit of
/// the certificate, the solve has converged.
#[test]
fn a_certificate_within_its_limit_has_not_stalled() {
    for (scene, level) in [("polynomial-2d", 8), ("degenerate2-2d", 8)] {
        let made = scenes::by_name(scene).unwrap().make(&scenes::Parameters::default()).unwrap();
        let scenes::AnyScene::Two(scene) = made else { panic!("{scene}") };
        let study = Study::<2>::new(scene).scheme_on(wopsip(1e-2), FacetMeans);
        let row = study.levels([level]).run().unwrap().rows.remove(0);
        assert!(row.converged(), "{}", row.status);
        assert!(row.certificate.largest() > 2e-14 && row.certificate.largest() < 1e-9);
    }
}

/// A constant has no energy for rounding to be compared with.
#[test]
fn a_solution_without_energy_is_not_singular() {
    let study = Study::<3>::new(scenes::ball_3d()).scheme_on(wopsip(1e-2), FacetMeans);
    let study = study.levels([1]);
    let row = study.run().unwrap().rows.remove(0);
    assert!(row.converged());
}

/// Every solver names what is wrong, whatever it was asked to start with.
#[test]
fn what_has_no_solution_is_named() {
    let good = of(&scenes::ball_2d(), &Sipg::default(), 4);
    let mut wrong_number = good.clone();
    wrong_number.load[3] = f64::NAN;
    let mut no_room = good.clone();
    no_room.bounds[5] = Bound::Both(1.0, 0.0);
    let weak = Sipg { penalty: PenaltyRule::Diameter(0.5) };
    let indefinite = of(&scenes::ball_2d(), &weak, 4);
    let mut floating =
        inequality(sparse(&[vec![1.0, -1.0], vec![-1.0, 1.0]]), &[1.0, 1.0], vec![Bound::Free; 2]);
    let mut malformed = good.clone();
    malformed.bounds.pop();
    let mut solvers: Vec<Box<dyn InequalitySolver<f64>>> =
        vec![Box::new(MonotoneMultigrid::default()), Box::new(InteriorPoint)];
    for linear in [LinearMethod::Direct, LinearMethod::Iterative] {
        solvers.push(Box::new(ActiveSet::default().linear(linear)));
    }
    for (k, solver) in solvers.iter().enumerate() {
        let what = format!("{} {k}", solver.name());
        let outcome = |problem: &Inequality<f64>| solver.solve(problem).outcome;
        assert_eq!(outcome(&wrong_number), Outcome::NotFinite, "{what}");
        assert_eq!(outcome(&no_room), Outcome::Infeasible, "{what}");
        assert_eq!(outcome(&malformed), Outcome::Malformed, "{what}");
        assert_eq!(outcome(&indefinite), Outcome::NotCoercive, "{what}");
        floating.bounds = vec![Bound::Free; 2];
        assert_eq!(outcome(&floating), Outcome::Singular, "{what}");
        // a floor does not hold what is pulled upwards
        floating.bounds = vec![Bound::Lower(0.0); 2];
        let found = outcome(&floating);
        let fails = [Outcome::Singular, Outcome::NotCoercive, Outcome::IterationLimit];
        assert!(fails.contains(&found), "{what}: {found}");
    }
}
