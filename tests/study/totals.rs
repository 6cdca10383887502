//! Energy, contact measure and resultant: one formula for every scheme.

use unilateral::assemble::DataQuadrature;
use unilateral::element::P2;
use unilateral::mesh::TaggedFacet;
use unilateral::prelude::*;
use unilateral::scenes::{Scene, torsion_2d};
use unilateral::study::Row;

/// Schemes of every kind: conforming, nonconforming, symmetric and not, lifted, over-penalised.
fn schemes<const D: usize>() -> Vec<Box<dyn Scheme<D>>> {
    vec![
        Box::new(ConformingP1),
        Box::new(ConformingP2),
        Box::new(NonconformingP1),
        Box::new(Sipg::default()),
        Box::new(Nipg::default()),
        Box::new(Ldg::default()),
        Box::new(Wopsip::default()),
        Box::new(Sipg::default().on(P2)),
        Box::new(Wopsip::default().on(P2)),
    ]
}

fn rows<const D: usize>(scene: Scene<D>, levels: &[usize]) -> Vec<Row> {
    let study = Study::<D>::new(scene).levels(levels.iter().copied());
    let rows = schemes().into_iter().fold(study, Study::boxed_scheme).run().unwrap().rows;
    for row in &rows {
        assert!(row.converged(), "{} {} {}: {}", row.scene, row.label, row.level, row.status);
    }
    rows
}

/// The integral over a box by the midpoints of a fine grid.
fn integral<const D: usize>(
    (lower, upper): (Point<D>, Point<D>),
    f: impl Fn(&Point<D>) -> f64,
) -> f64 {
    let n: usize = [0, 100_000, 2000, 160][D];
    let step = (upper - lower) / n as f64;
    let mut sum = 0.0;
    for k in 0..n.pow(D as u32) {
        let index = Point::<D>::from_fn(|i, _| (k / n.pow(i as u32) % n) as f64 + 0.5);
        sum += f(&(lower + index.component_mul(&step)));
    }
    sum * step.product()
}

fn bounding_box<const D: usize>(scene: &Scene<D>) -> (Point<D>, Point<D>) {
    let domain = scene.domain.bounding_box();
    (domain.lower, domain.upper)
}

#[test]
fn the_energy_of_every_scheme_tends_to_the_exact_one_with_twice_the_order_in_h1() {
    let scene = scenes::radial::<2>(1.0);
    let exact = scene.problem.exact.clone().unwrap();
    let source = scene.problem.source.everywhere.clone().unwrap();
    let energy = integral(bounding_box(&scene), |x| {
        0.5 * (exact.gradient)(x).norm_squared() - source.at(x) * exact.value.at(x)
    });
    let levels = [16, 32, 64];
    let schemes = schemes().into_iter().filter(|s| s.layout().cell < 6);
    let study = Study::<2>::new(scene).levels(levels);
    let rows = schemes.fold(study, Study::boxed_scheme).run().unwrap().rows;
    for series in rows.chunks(levels.len()) {
        let gap = |row: &Row| (row.energy.unwrap() - energy).abs();
        let order = (gap(&series[1]) / gap(&series[2])).log2();
        let h1 = if series[0].label.contains("p2") { 1.5 } else { 1.0 };
        let gaps: Vec<f64> = series.iter().map(|r| r.energy.unwrap() - energy).collect();
        println!("{}: order {order:.2}, gaps {gaps:?}", series[0].label);
        assert!(order > 2.0 * h1 - 0.2, "{}: order {order}", series[0].label);
    }
}

/// A conforming function has the energy of conforming P1 in every space that contains it, and conforming
/// P1 has no other terms than those of the energy.
#[test]
fn one_function_has_one_energy() {
    fn check<const D: usize>(cells: usize) {
        let bent = |x: &Point<D>| 1.0 + x.norm_squared();
        let problem = Problem::new()
            .source(move |x| bent(x).sin())
            .coefficient(move |x| 2.0 + bent(x))
            .reaction(bent)
            .neumann(move |x, n| x[0] * n[0] - 1.0);
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let domain = domain.side(0, 1, BoundaryCondition::Neumann);
        let mesh = Mesh::<D>::kuhn_box(&domain, [cells; D]).unwrap();
        let space = |scheme: &dyn Scheme<D>| {
            scheme.discretise(&problem, &mesh, DataQuadrature::default()).unwrap()
        };
        let conforming = space(&ConformingP1);
        let u: Vec<f64> =
            mesh.vertices().iter().map(|x| (3.0 * x[0]).cos() + 2.0 * bent(x)).collect();
        let energy = conforming.energy(&u).unwrap();
        let objective = conforming.inequality().unwrap().objective(&u);
        assert!((energy / objective - 1.0).abs() < 1e-12, "{D}: {energy} and {objective}");
        let broken = conforming.vertex_values(&u);
        for scheme in [&Sipg::default() as &dyn Scheme<D>, &Wopsip::default()] {
            let other = space(scheme).energy(&broken).unwrap();
            assert!((other / energy - 1.0).abs() < 1e-12, "{D}, {}: {other}", scheme.name());
        }
    }
    check::<1>(9);
    check::<2>(5);
    check::<3>(3);
}

/// Zero beside the solution `1 + x`, with the coefficient four and the reaction three: the squares of the errors are the
/// integrals of `(1 + x)^2` and of one, and `4 + 3 7/3` in the broken energy norm.
#[test]
fn errors_in_the_energy_norm_contain_coefficient_and_reaction() {
    fn check<const D: usize>() {
        let slope = |_: &Point<D>| Point::from_fn(|k, _| f64::from(u8::from(k == 0)));
        let problem = Problem::new()
            .coefficient(|_| 4.0)
            .reaction(3.0)
            .exact(|x: &Point<D>| 1.0 + x[0], slope);
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let mesh = Mesh::<D>::kuhn_box(&domain, [2; D]).unwrap();
        for scheme in schemes() {
            let solved = solve(&problem, &mesh, &*scheme).unwrap();
            // the function zero, less the constant that is taken off
            let constants = solved.discretisation().constants();
            let zero: Vec<f64> = constants.iter().map(|constant| -constant).collect();
            let errors = solved.discretisation().errors(&zero).unwrap();
            let mut pair = solved.primal_dual_pair().unwrap();
            pair.function.fill(-constants[0]);
            let of_pair = solved.discretisation().error_of_pair(&pair);
            for (found, square) in [
                (errors.l2, 7.0 / 3.0),
                (errors.h1, 1.0),
                (errors.broken_energy, 11.0),
                (of_pair, 11.0),
            ] {
                let found = found.unwrap();
                let label = scheme.name();
                assert!((found * found / square - 1.0).abs() < 1e-12, "{D}, {label}: {found}");
            }
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

/// A body that contact alone holds, pressed down and to one side: the contact force is the load.
#[test]
fn the_resultant_of_a_body_on_its_foot_is_the_load() {
    fn check<const D: usize>(level: usize) {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let sides = (0..D).flat_map(|axis| [(axis, 0), (axis, 1)]);
        let free =
            sides.fold(domain, |d, (axis, end)| d.side(axis, end, BoundaryCondition::Neumann));
        let foot = free.clone().side(D - 1, 0, BoundaryCondition::Contact);
        let load = |x: &Point<D>| -1.0 - x[0];
        let problem = || Problem::new().source(load).neumann(|_, n| -0.25 * n[D - 1].powi(2));
        // on the foot there is no Neumann datum
        let on_foot = problem().signorini(|x| 0.1 * x[0]);
        let on_obstacle = problem().obstacle_below(|x| -0.1 * x[0]);
        for (problem, domain, total) in [(on_foot, foot, 1.75), (on_obstacle, free, 2.0)] {
            let mesh = Mesh::<D>::kuhn_box(&domain, [level; D]).unwrap();
            for scheme in schemes() {
                let found = solve(&problem, &mesh, &*scheme).unwrap();
                assert!(found.converged(), "{D} {total} {}: {}", scheme.name(), found.outcome());
                let gap = found.resultant().unwrap() / total - 1.0;
                println!("{D} {total} {}: {gap:.1e}", scheme.name());
                assert!(gap.abs() < 1e-8, "{D} {total} {}: {gap:e}", scheme.name());
            }
        }
    }
    check::<1>(8);
    check::<2>(8);
    check::<3>(4);
}

/// The whole body rests on an obstacle: all of it is in contact.
#[test]
fn a_flat_obstacle_carries_everything() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::<2>::new(2.0, 1.0));
    let sides = [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter();
    let free = sides.fold(domain, |d, (axis, end)| d.side(axis, end, BoundaryCondition::Neumann));
    let foot = free.clone().side(1, 0, BoundaryCondition::Contact);
    let body = |load| Problem::new().constant_source(load);
    for (problem, domain, force) in [
        (body(-3.0).obstacle_below(|_| 0.5), &free, 6.0),
        (body(3.0).obstacle_above(|_| 0.5), &free, -6.0),
        (body(-3.0).signorini(|_| 0.5), &foot, 6.0),
    ] {
        let mesh = Mesh::<2>::kuhn_box(domain, [8, 4]).unwrap();
        for scheme in schemes() {
            let found = solve(&problem, &mesh, &*scheme).unwrap();
            let totals = [found.resultant(), found.contact_measure()].map(Option::unwrap);
            let close = |x: f64, y: f64| (x / y - 1.0).abs() < 1e-9;
            println!("{} {totals:?}", scheme.name());
            assert!(
                close(totals[0], force) && close(totals[1], 2.0),
                "{} {totals:?}",
                scheme.name()
            );
        }
    }
}

/// Bodies that rest on flat obstacles and gaps with a constant density: it is that of every cell and facet, on meshes of
/// cells of different sizes and where two regions or groups meet too.
#[test]
fn a_constant_density_is_the_same_everywhere() {
    let near = |found: &[f64], density: f64, label: &str| {
        assert!(!found.is_empty(), "{label}");
        for found in found {
            assert!((found / density - 1.0).abs() < 1e-9, "{label}: {found} for {density}");
        }
    };
    // an interval of cells that grow, in two regions
    let vertices = [0.0, 0.1, 0.3, 0.6, 1.0].map(|x| Point::from([x])).to_vec();
    let end = |vertex| TaggedFacet { vertices: [vertex], condition: BoundaryCondition::Neumann };
    let line = Mesh::<1>::new(vertices, vec![0, 1, 1, 2, 2, 3, 3, 4], &[end(0), end(4)]);
    let names = ["left", "right"].map(|name| vec![name.to_owned()]).to_vec();
    let line = line.unwrap().with_regions(names, vec![0, 0, 1, 1]).unwrap();
    for (load, problem) in [
        (-3.0, Problem::new().obstacle_below_in("left", 0.5).obstacle_below_in("right", 0.5)),
        (3.0, Problem::new().obstacle_above_in("left", 0.5).obstacle_above_in("right", 0.5)),
    ] {
        let problem = problem.constant_source(load);
        for scheme in [&ConformingP1 as &dyn Scheme<1>, &Sipg::default()] {
            let solved = solve(&problem, &line, scheme).unwrap();
            near(&solved.fields().unwrap().multiplier, -load, scheme.name());
        }
    }
    // a column on its foot, pressed from above: the solution is linear
    fn column<const D: usize>(near: &dyn Fn(&[f64], f64, &str)) {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let sides = (0..D).flat_map(|axis| [(axis, 0), (axis, 1)]);
        let free =
            sides.fold(domain, |d, (axis, end)| d.side(axis, end, BoundaryCondition::Neumann));
        let foot = free.side(D - 1, 0, BoundaryCondition::Contact);
        let pressed = |_: &Point<D>, n: &Point<D>| -3.0 * n[D - 1].max(0.0);
        let problem = Problem::new().neumann(pressed).signorini(|_| 0.5);
        let mesh = Mesh::<D>::kuhn_box(&foot, [2; D]).unwrap();
        for scheme in [&ConformingP1 as &dyn Scheme<D>, &Sipg::default()] {
            let fields = solve(&problem, &mesh, scheme).unwrap().fields().unwrap();
            near(&fields.pressure, 3.0, scheme.name());
            assert!(fields.gap.iter().all(|gap| gap.abs() < 1e-9), "{:?}", fields.gap);
        }
    }
    column::<1>(&near);
    column::<2>(&near);
    column::<3>(&near);
}

/// A membrane that lies on the obstacle as its Dirichlet data do, far below another one, is in contact up to its boundary.
#[test]
fn contact_reaches_dirichlet_data_on_one_of_two_obstacles() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&domain, [4, 4]).unwrap();
    for sign in [1.0, -1.0] {
        let problem = Problem::new()
            .constant_source(-sign)
            .obstacle_below(move |_| if sign > 0.0 { 0.0 } else { -5.0 })
            .obstacle_above(move |_| if sign > 0.0 { 5.0 } else { 0.0 });
        for scheme in [&ConformingP1 as &dyn Scheme<2>, &NonconformingP1] {
            let found = solve(&problem, &mesh, scheme).unwrap();
            let measure = found.contact_measure().unwrap();
            assert!((measure - 1.0).abs() < 1e-12, "{}: {measure}", scheme.name());
            let forces = found.resultants().unwrap();
            let (pressing, other) =
                if sign > 0.0 { ("lower", "upper") } else { ("upper", "lower") };
            assert!(forces[pressing] * sign > 0.5 && forces[other] == 0.0, "{forces:?}");
        }
    }
}

/// Contact set and multiplier in closed form: `radial` in one to three dimensions.
#[test]
fn contact_measure_and_resultant_tend_to_the_exact_ones() {
    fn check<const D: usize>(level: usize, [resultant_gap, measure_gap]: [f64; 2]) {
        let scene = scenes::radial::<D>(1.0);
        let exact = scene.problem.exact.clone().unwrap();
        let (multiplier, set) = (exact.multiplier.unwrap(), exact.contact.unwrap());
        let inside = |x: &Point<D>| (set.indicator)(x) > 0.0;
        let over_set = |f: &dyn Fn(&Point<D>) -> f64| {
            integral(bounding_box(&scene), |x| if inside(x) { f(x) } else { 0.0 })
        };
        let (force, measure) = (over_set(&|x| multiplier(x)), over_set(&|_| 1.0));
        let study = Study::<D>::new(scene).scheme_on(ConformingP2, Midpoints).levels([level]);
        let rows = schemes().into_iter().fold(study, Study::boxed_scheme).run().unwrap().rows;
        for row in &rows {
            assert!(row.converged(), "{D} {}: {}", row.label, row.status);
            let gap = |x: Option<f64>, y: f64| (x.unwrap() / y - 1.0).abs();
            let found = [gap(row.resultant, force), gap(row.contact_measure, measure)];
            println!("{D} {}: {found:.4?}", row.label);
            assert!(found[0] < resultant_gap, "{D} {}: {found:?}", row.label);
            // bounds at the vertices of quadratics do not tell contact: their basis functions have
            // integral zero in the plane
            let tells = D == 1 || !row.scheme.ends_with("p2") || row.constraint == "midpoints";
            assert!(!tells || found[1] < measure_gap, "{D} {}: {found:?}", row.label);
        }
    }
    check::<1>(64, [0.05, 0.05]);
    check::<2>(32, [0.1, 0.1]);
    check::<3>(8, [0.2, 0.5]);
}

#[test]
fn the_extrapolated_energy_is_the_reference() {
    let scene = torsion_2d(5.0);
    let reference = scene.problem.reference_energy.unwrap();
    let study = Study::<2>::new(scene).scheme(ConformingP1).scheme(Sipg::default());
    let report = study.levels([16, 32, 64]).run().unwrap();
    assert_eq!(report.extrapolated().len(), 2);
    for (series, rows) in report.extrapolated().iter().zip(report.rows.chunks(3)) {
        let limit = series.energy.unwrap();
        let gap = |x: f64| (x - reference.value).abs();
        let finest = gap(rows[2].energy.unwrap());
        println!("{}: {limit:?}, {:.2e} and {finest:.2e}", series.label, gap(limit.value));
        assert!(gap(limit.value) < 0.1 * finest, "{}: {limit:?}", series.label);
        assert!((limit.order.unwrap() - 2.0).abs() < 0.2, "{}: {limit:?}", series.label);
    }
    let text = report.details_to_text(100);
    assert!(text.contains("energy") && text.contains("extrapolated, p1: energy -4.18"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn without_an_inequality_there_is_no_contact() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let scene = Scene::new("free", domain, Problem::<2>::new().constant_source(1.0));
    for row in rows(scene, &[4]) {
        assert!(row.energy.unwrap() < 0.0, "{}", row.label);
        assert_eq!((row.contact_measure, row.resultant), (None, None), "{}", row.label);
    }
}

/// A row whose bound is far from the error says which part of it is, or what is not proven.
#[test]
fn bounds_far_from_the_error_say_why() {
    let at_level = |scene: Scene<2>, scheme: &str, level: usize| {
        let scheme: NamedScheme = scheme.parse().unwrap();
        let study = Study::<2>::new(scene).named_scheme(&scheme).levels([level]);
        study.run().unwrap().rows.remove(0)
    };
    let of_scene = |scene: Scene<2>, scheme: &str| at_level(scene, scheme, 4);
    let says = |row: &Row, text: &str| row.warnings.iter().any(|w| w.contains(text));
    // the bound on the admissible function is far from its error, that on the solution is not
    let row = of_scene(scenes::contrast::<2>(1e6), "wopsip-p2");
    assert!(row.bound.effectivity_of_v > Some(3.0), "{:?}", row.bound);
    assert!(row.bound.effectivity < Some(1.5), "{:?}", row.bound);
    assert!(!says(&row, "times the error"), "{:?}", row.warnings);
    let row = of_scene(scenes::biactive_ring_2d(), "p1");
    assert!(row.bound.effectivity > Some(3.0), "{:?}", row.bound);
    assert!(
        says(&row, "times the error: ") && says(&row, " % of the square of `total` is "),
        "{:?}",
        row.warnings
    );
    let row = at_level(scenes::contrast_disc_2d(1e6), "p1", 3);
    assert!(row.bound.effectivity < Some(1.0), "{:?}", row.bound);
    assert!(says(&row, "not proven: quadrature"), "{:?}", row.warnings);
    let row = of_scene(scenes::radial(1.0), "p1");
    assert!(!says(&row, "times the error"), "{:?}", row.warnings);
    // bound and error are equal but for rounding
    let study = Study::<1>::new(scenes::signorini_closed_1d()).scheme(ConformingP1).levels([4]);
    let row = study.run().unwrap().rows.remove(0);
    assert!((row.bound.effectivity.unwrap() - 1.0).abs() < 1e-12, "{:?}", row.bound);
    assert!(!says(&row, "times the error"), "{:?}", row.warnings);
}

/// The bound on the discrete solution is divided by its error, that on the admissible function by the error of that.
#[test]
fn each_effectivity_is_of_its_own_error() {
    use unilateral::error_bound::{BoundFigures, TrueErrors};
    let scene = scenes::contrast::<2>(1e6);
    let mesh = scene.domain.mesh(4).unwrap();
    let bound = solve(&scene.problem, &mesh, &Sipg::default()).unwrap().bound().unwrap();
    assert!(bound.total != bound.discrete, "{bound:?}");
    let errors = TrueErrors { of_solution: Some(2.0), of_v: Some(4.0) };
    let figures = BoundFigures::new(Ok::<_, String>(&bound), errors);
    assert_eq!(figures.effectivity, Some(bound.discrete / 2.0));
    assert_eq!(figures.effectivity_of_v, Some(bound.total / 4.0));
    assert_eq!([figures.total, figures.distance], [Some(bound.total), Some(bound.distance)]);
}
