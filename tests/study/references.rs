//! Rows measured against a fine solution.

use unilateral::error::Error;
use unilateral::mesh::BoundaryCondition;
use unilateral::prelude::*;
use unilateral::scenes::{AnyScene, Parameters, Scene};
use unilateral::study::Row;

/// The H1 errors of linears against quadratics two refinements finer, over the true ones.
fn ratios<const D: usize>(scene: Scene<D>, levels: &[usize]) -> Vec<f64> {
    let finest = levels.iter().max().unwrap();
    let study = || {
        let study = Study::<D>::new(scene.clone()).levels(levels.iter().copied());
        study.scheme(ConformingP1).scheme(NonconformingP1).scheme(Wopsip::default())
    };
    let measured = study().reference(ConformingP2, 4 * finest).run().unwrap();
    let exact = study().run().unwrap();
    let name = format!("p2 at level {}", 4 * finest);
    let ratio = |(a, b): (&Row, &Row)| {
        assert!(a.converged() && b.converged());
        assert_eq!(a.against.as_deref(), Some(&name[..]));
        assert_eq!(b.against.as_deref(), Some("exact"));
        assert_eq!(a.error.energy, None);
        let (own, other) = (a.objective.unwrap(), b.objective.unwrap());
        assert!((own - other).abs() <= 1e-10 * other.abs(), "{own} {other}");
        // the exact solution is still known: the function of the bound is measured against it; the numbers of cells
        // differ, and with them the order in which the multipliers of the bound are exchanged
        let of_v = [a, b].map(|row| row.bound.effectivity_of_v);
        let agree = |x: f64, y: f64| (x - y).abs() <= 5e-2 * y;
        assert!(of_v[0].zip(of_v[1]).is_none_or(|(x, y)| agree(x, y)), "{of_v:?}");
        assert_eq!(of_v[0].is_some(), of_v[1].is_some());
        match b.error.h1 {
            // a row that is exact to rounding has no ratio
            Some(exact) if exact < 1e-12 => 1.0,
            exact => a.error.h1.unwrap() / exact.unwrap(),
        }
    };
    measured.rows.iter().zip(&exact.rows).map(ratio).collect()
}

#[track_caller]
fn within(ratios: Vec<f64>, tolerance: f64) {
    assert!(ratios.iter().all(|r| (r - 1.0).abs() < tolerance), "{ratios:?}");
}

#[test]
fn a_reference_stands_for_the_exact_solution() {
    within(ratios(scenes::radial::<1>(1.0), &[8, 16]), 0.08);
    within(ratios(scenes::radial::<2>(1.0), &[8, 16]), 0.08);
    within(ratios(scenes::radial::<3>(1.0), &[4]), 0.08);
    within(ratios(scenes::signorini_2d(), &[8, 16]), 0.08);
}

/// Solutions that are not in H2, or whose coefficient jumps inside cells.
#[test]
fn a_reference_stands_for_a_singular_solution() {
    for (name, levels) in [("lshape-2d", &[8, 16][..]), ("contrast-disc-2d", &[8, 16])] {
        let Some(AnyScene::Two(scene)) = made(name) else { panic!("{name}") };
        within(ratios(scene, levels), 0.2);
    }
}

fn made(name: &str) -> Option<AnyScene> {
    scenes::by_name(name)?.make(&Parameters::default()).ok()
}

/// Every scene of the catalogue whose solution is known, but those on a disc.
#[test]
#[ignore = "takes a minute"]
fn a_reference_stands_for_every_exact_solution() {
    let mut count = 0;
    for entry in scenes::catalogue().into_iter().filter(|e| e.name != "disc-2d") {
        let found = match entry.make(&Parameters::default()).unwrap() {
            AnyScene::One(s) if s.problem.exact.is_some() => ratios(s, &[16, 32]),
            AnyScene::Two(s) if s.problem.exact.is_some() => ratios(s, &[8, 16]),
            AnyScene::Three(s) if s.problem.exact.is_some() => ratios(s, &[4]),
            _ => continue,
        };
        let off = found.iter().map(|r| (r - 1.0).abs()).fold(0.0, f64::max);
        assert!(off < 0.08, "{}: {found:?}", entry.name);
        count += 1;
    }
    assert!(count > 40, "{count}");
}

#[test]
fn multiplier_and_contact_set_are_measured_too() {
    let study = |reference: bool| {
        let study = Study::<2>::new(scenes::signorini_2d()).scheme(ConformingP1).levels([8, 16]);
        let study = if reference { study.reference(ConformingP2, 64) } else { study };
        study.run().unwrap().rows
    };
    for (row, exact) in study(true).iter().zip(study(false)) {
        let ratio = row.contact.multiplier_l2.unwrap() / exact.contact.multiplier_l2.unwrap();
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
        assert!(row.contact.contact_area_error.unwrap() <= 2.0 * row.mesh_size);
    }
    // cells, in the plane and in space, where the vertices of quadratics have no positive mean
    let plane = scenes::radial::<2>(1.0);
    let plane = Study::<2>::new(plane).scheme(ConformingP1).scheme(ConformingP2);
    let exact = plane.levels([8, 16]).run().unwrap().rows;
    let plane = Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).levels([8, 16]);
    let found = plane.reference(ConformingP2, 64).run().unwrap().rows;
    for (row, exact) in found.iter().zip(&exact) {
        let [found, exact] = [row, exact].map(|r| r.contact.contact_area_error.unwrap());
        assert!((found - exact).abs() < 0.25 * exact, "{found} {exact}");
    }
    // quadratics find the contact set, a disc of radius one, at least as well as linears
    let area = std::f64::consts::PI;
    for (linear, quadratic) in exact[..2].iter().zip(&exact[2..]) {
        let error = |row: &Row| row.contact.contact_area_error.unwrap();
        assert!(error(quadratic) <= error(linear), "{} {}", error(quadratic), error(linear));
        let measure = quadratic.contact_measure.unwrap();
        assert!((measure - area).abs() < 4.0 * quadratic.mesh_size, "{measure}");
    }
    // nothing differs from itself
    let scene = scenes::radial::<2>(1.0);
    let meshes = Hierarchy::<2>::of_domain(&scene.domain, 8).unwrap();
    let solved = solve(&scene.problem, &meshes, &Sipg::default()).unwrap();
    let none = solved.contact_difference(&solved).unwrap();
    assert_eq!(none.contact_area_error, Some(0.0));
    assert_eq!(none.multiplier_l1, Some(0.0));
}

/// A body that rests on a flat obstacle has the density of its load as multiplier on every mesh: tested with the hat
/// functions of a coarse mesh, that of a fine one is the coarse one. A difference is that from a finer solution.
#[test]
fn a_constant_multiplier_is_the_same_on_a_finer_mesh() {
    let free = [(0, 0), (0, 1), (1, 0), (1, 1)]
        .into_iter()
        .fold(BoxDomain::<2>::centred(1.0), |domain, (axis, end)| {
            domain.side(axis, end, BoundaryCondition::Neumann)
        });
    let mesh = Mesh::<2>::kuhn_box(&free, [2, 3]).unwrap();
    let meshes = Hierarchy::refine(&mesh, 2).unwrap();
    let problem = Problem::new().constant_source(-3.0).obstacle_below(|_| 0.5);
    let mut nested = NestedIteration::new(&problem, &meshes);
    for scheme in [&ConformingP1 as &dyn Scheme<2>, &NonconformingP1, &Sipg::default()] {
        let [coarse, _, fine] = [0, 1, 2].map(|k| nested.solve_on(k, scheme).unwrap());
        let found = coarse.contact_difference(&fine).unwrap();
        let name = scheme.name();
        assert_eq!(found.contact_area_error, Some(0.0), "{name}");
        let errors = [found.multiplier_l1, found.multiplier_l2].map(Option::unwrap);
        assert!(errors.iter().all(|error| *error < 1e-10), "{name}: {errors:?}");
        let refused = fine.contact_difference(&coarse);
        assert!(matches!(refused, Err(Error::NotNested)), "{name}: {refused:?}");
    }
}

#[test]
fn a_reference_that_is_too_coarse_or_not_nested_is_refused() {
    let study = |levels: &[usize], reference: usize| {
        let study = Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1);
        study.levels(levels.iter().copied()).reference(ConformingP2, reference).check()
    };
    assert!(study(&[8, 16], 64).is_ok());
    for (levels, reference, words) in [
        (&[8, 16][..], 32, "at least 64"),
        (&[8, 12], 64, "power of two times every level, which 64 is not of 12"),
        (&[8], 40, "power of two"),
    ] {
        let error = study(levels, reference).unwrap_err();
        let said = "level of the reference = ";
        assert!(matches!(&error, Error::Parameter(why) if why.starts_with(said)), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
    let disc = Study::<2>::new(scenes::disc_2d()).scheme(ConformingP1).levels([4]);
    let error = disc.reference(ConformingP2, 16).check().unwrap_err();
    assert!(error.to_string().contains("not nested"), "{error}");
}

#[test]
fn a_problem_of_ones_own_needs_a_name_and_a_mesh() {
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [4, 4]).unwrap();
    let problem = Problem::new()
        .constant_source(-4.0)
        .signorini_on("bottom", -0.1)
        .neumann_on("left", |_, _| 0.0);
    let report = Study::new(Scene::of_problem("own", problem, mesh).unwrap())
        .scheme(ConformingP1)
        .scheme(Sipg::default())
        .levels([0, 1, 2])
        .reference(ConformingP2, 4)
        .run()
        .unwrap();
    assert!(report.details_to_text(100).contains("errors against p2 at level 4"));
    for row in &report.rows {
        assert!(row.converged());
        assert!(row.active > Some(0) && row.resultant > Some(0.0));
        assert!(row.level == 0 || (0.7..1.2).contains(&row.order.h1.unwrap()), "{:?}", row.order);
    }
    let first = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [4, 4]).unwrap();
    assert!(first.has_condition(BoundaryCondition::Dirichlet));
    let early = Study::new(Scene::new("own", first, Problem::new())).scheme(ConformingP1);
    let error = early.levels([0, 1]).reference(ConformingP2, 2).check().unwrap_err();
    assert!(error.to_string().contains("at least 3"), "{error}");
}

/// A solution that presses where there is a gap does not fulfil the contact condition, in whatever units: it measures
/// nothing. Dirichlet data that are not its own are refused.
#[test]
fn a_solution_that_breaks_the_contact_condition_has_no_errors() {
    let study_of = |[gap, fixed]: [f64; 2], unit: f64| {
        let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let mesh = Mesh::<2>::kuhn_box(&square.side(1, 0, BoundaryCondition::Contact), [2, 2]);
        let problem = Problem::new()
            .dirichlet(move |x| unit * (fixed - x[1]))
            .signorini(move |_| unit * gap)
            .exact(move |x| unit * (1.0 - x[1]), move |_| Point::from([0.0, -unit]));
        let scene = Scene::new("pressed", mesh.unwrap(), problem);
        Study::<2>::new(scene).scheme(ConformingP1).levels([1])
    };
    for unit in [1.0, 1e-9, 1e9] {
        let row_of = |gap: f64| study_of([gap, 1.0], unit).run().unwrap().rows.remove(0);
        let row = row_of(1.0);
        assert_eq!((row.against.as_deref(), &row.warnings[..]), (Some("exact"), &[][..]));
        // the flux presses by one, and the gap is open by a half
        let row = row_of(0.5);
        assert_eq!((row.against, row.error.l2), (None, None));
        let expected = "the exact solution breaks the contact condition of this mesh at (0.25";
        assert!(
            row.warnings.iter().any(|warning| warning.contains(expected)),
            "{:?}",
            row.warnings
        );
        let error = study_of([1.0, 1.01], unit).run().unwrap_err().to_string();
        assert!(error.contains("where its Dirichlet value is"), "{unit}: {error}");
    }
}
