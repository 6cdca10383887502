//! Constraint sets made outside the library, beside those of the library.

use crate::support::checks::Checks;
use crate::support::rows::label;
use unilateral::element::Basis;
use unilateral::prelude::*;
use unilateral::scheme::{Regularity, Setting, scheme_by_name};

/// The values at all vertices of a cell but its last one.
struct AllVerticesButOne;

impl ConstraintSet for AllVerticesButOne {
    fn name(&self) -> &str {
        "all-vertices-but-one"
    }
    fn in_domain(&self, node: &Node, dimension: usize) -> Option<BoundBy> {
        matches!(node.entity(), Entity::Vertex(k) if k < dimension).then_some(BoundBy::Value)
    }
}

/// All facet means, by the mean of the obstacle and not by its value at the barycentre.
struct ByMeans;

impl ConstraintSet for ByMeans {
    fn name(&self) -> &str {
        "by-means"
    }
    fn basis(&self) -> Option<Basis> {
        Some(Basis::FacetMeans)
    }
    fn in_domain(&self, node: &Node, _: usize) -> Option<BoundBy> {
        matches!(node.entity(), Entity::Facet(_)).then_some(BoundBy::Functional)
    }
}

/// One scheme stands five times in one report, each time with another set, and each has order one in
/// H1.
#[test]
fn own_sets_stand_beside_those_of_the_library() {
    let report = Study::<2>::new(scenes::radial(1.0))
        .scheme(Sipg::default())
        .scheme_on(Sipg::default(), FacetMeans)
        .scheme_on(Sipg::default(), AllVerticesButOne)
        .scheme_on(Sipg::default(), ByMeans)
        .scheme_on(NonconformingP1, FacetMeans)
        .levels([16, 32])
        .run()
        .unwrap();
    let fine: Vec<_> = report.rows.iter().filter(|row| row.level == 32).collect();
    let names: Vec<_> = fine.iter().map(|row| &row.constraint[..]).collect();
    let all = ["vertices", "facet-means", "all-vertices-but-one", "by-means", "facet-means"];
    assert_eq!(names, all);
    let mut checks = Checks::default();
    for row in &fine {
        checks.certified(row, 1e-9);
        // measured: 1.022, 1.004, 1.008, 1.004, 0.986
        let order = row.order.h1.unwrap();
        checks.that((0.95..1.05).contains(&order), || format!("{}: {order:.3}", label(row)));
    }
    checks.finish();
    // proven for all nodes; for others nothing is proven
    let promised: Vec<_> = fine.iter().map(|row| row.expected_order.h1.is_some()).collect();
    assert_eq!(promised, [true, false, false, false, true]);
    // the heading may be cut anywhere
    let table = report.details_to_text(100).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(table.contains("expected order H1 1 (sipg cr)"), "{table}");
    // fewer bounds leave a function that is nowhere above the one with more in energy
    let energy = |k: usize| fine[k].objective.unwrap();
    assert!(energy(2) < energy(0), "{} and {}", energy(2), energy(0));
}

/// The set of an entry replaces the set of the problem, and both are read by one discretisation.
#[test]
fn a_set_of_the_problem_is_that_of_an_entry() {
    let run = |study: Study<'static, 2>| study.levels([8]).run().unwrap().rows.remove(0);
    let mut scene = scenes::signorini_2d();
    scene.problem = scene.problem.on(FacetMeans);
    let by_problem = run(Study::new(scene.clone()).scheme(Wopsip::default()));
    let by_entry = run(Study::new(scenes::signorini_2d()).scheme_on(Wopsip::default(), FacetMeans));
    assert_eq!(by_problem.constraint, "facet-means");
    assert_eq!(by_problem.error, by_entry.error);
    let mesh = scene.domain.mesh(8).unwrap();
    let on_mesh = Study::new(scene.clone().domain(mesh)).scheme(Wopsip::default()).levels([0]);
    let on_mesh = on_mesh.run().unwrap().rows.remove(0).error.l2.unwrap();
    assert!((on_mesh / by_entry.error.l2.unwrap() - 1.0).abs() < 1e-10);
    let replaced = run(Study::new(scene).scheme_on(Wopsip::default(), Nodes));
    let plain = run(Study::new(scenes::signorini_2d()).scheme(Wopsip::default()));
    assert_eq!((&replaced.constraint[..], &replaced.error), ("vertices", &plain.error));
    assert_ne!(by_entry.error, plain.error);
}

/// The refusal names what the element of the scheme offers.
#[test]
fn refusals_name_what_the_element_offers() {
    fn refusal(scheme: &dyn Scheme<2>, problem: Problem<2>) -> String {
        let mesh = scenes::signorini_2d().domain.mesh(2).unwrap();
        let refused: Result<Discretisation<'_, 2>, Error> =
            Discretisation::new(scheme, &problem, &mesh, Default::default());
        refused.unwrap_err().to_string()
    }
    let obstacle = || Problem::new().obstacle_below(|_| 0.0);
    for (scheme, problem, offered) in [
        (&Sipg::default() as &dyn Scheme<2>, obstacle().on(Midpoints), "vertices or facet-means"),
        (&ConformingP1, obstacle().on(FacetMeans), "vertices"),
        (&NonconformingP1, obstacle().on(AllVerticesButOne), "facet-means"),
        (&Sipg::default().on(P2), obstacle().on(FacetMeans), "nodes or midpoints or bernstein"),
        (
            &Sipg::default().on(P2),
            Problem::new().signorini(|_| 0.0).on(FacetMeans),
            "nodes or midpoints or bernstein",
        ),
    ] {
        let message = refusal(scheme, problem);
        assert!(message.ends_with(&format!("choose {offered}")), "{message}");
    }
}

/// Under an inequality the proofs for broken schemes ask for solutions in `H^2`, those for quadratics leave out Signorini
/// conditions; of weakly over-penalised quadratics there is one for equations in the plane.
#[test]
fn promises_of_broken_schemes_are_those_that_are_proven() {
    fn h1<const D: usize>(name: &str, sobolev: f64, [obstacle, contact]: [bool; 2]) -> Option<f64> {
        let setting = Setting::new(D, Regularity::new(sobolev));
        let setting = Setting { obstacle, contact, ..setting };
        let scheme = scheme_by_name::<D>(name, &Default::default()).unwrap();
        scheme.expected_orders(&setting).h1
    }
    let (none, obstacle, contact) = ([false; 2], [true, false], [false, true]);
    for name in ["sipg", "nipg", "ldg", "wopsip"] {
        assert_eq!(h1::<2>(name, 1.75, none), Some(0.75), "{name}");
        assert_eq!(h1::<2>(name, 1.75, obstacle), None, "{name}");
        assert_eq!(h1::<2>(name, 1.75, contact), None, "{name}");
        assert_eq!(h1::<2>(name, 2.0, obstacle), Some(1.0), "{name}");
        assert_eq!(h1::<2>(name, 2.0, contact), Some(1.0), "{name}");
    }
    assert_eq!(h1::<2>("p1", 1.75, obstacle), Some(0.75));
    assert_eq!(h1::<2>("sipg-p2", 2.5, obstacle), Some(1.5));
    assert_eq!(h1::<2>("sipg-p2", 2.5, contact), None);
    assert_eq!(h1::<3>("sipg-p2", 3.0, none), Some(2.0));
    assert_eq!(h1::<3>("sipg-p2", 2.5, obstacle), None);
    assert_eq!(h1::<2>("wopsip-p2", 3.0, none), Some(2.0));
    assert_eq!(h1::<2>("wopsip-p2", 2.5, obstacle), None);
    assert_eq!(h1::<3>("wopsip-p2", 3.0, none), None);
}

/// On the elements that have them natively, sets keep the orders that nodes have.
#[test]
fn orders_remain_where_the_set_is_that_of_the_nodes() {
    let smooth = Setting { obstacle: true, ..Setting::new(2, Regularity::new(2.5)) };
    let orders = |scheme: &dyn Scheme<2>, set: &dyn ConstraintSet| {
        scheme.expected_orders_on(set, &smooth).h1
    };
    assert_eq!(orders(&NonconformingP1, &FacetMeans), Some(1.0));
    assert_eq!(orders(&Wopsip::default(), &FacetMeans), None);
    assert_eq!(orders(&ConformingP2, &Midpoints), Some(1.5));
    assert_eq!(orders(&ConformingP2, &Bernstein), None);
    assert_eq!(orders(&NonconformingP1, &ByMeans), None);
}
