//! Families of quadrature rules for data: the lumped reaction term, symmetric rules, a rule made
//! outside the crate.

use crate::runs::own_scene;
use crate::support::meshes::{Random, Raw};
use unilateral::algebra::Inequality;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::error::Error;
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome};
use unilateral::kit::{KitErrorKind, check_quadrature};
use unilateral::mesh::{BoxDomain, Mesh};
use unilateral::prelude::*;
use unilateral::quadrature::{FullySymmetric, Quadrature, QuadratureError, Rule, VertexRule};

fn unit_box<const D: usize>() -> BoxDomain<D> {
    BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
}

/// Triangles with equal sides, their inner vertices moved by up to a tenth of a side: no angle is
/// obtuse, so that the triangulation is that of Delaunay.
fn acute_mesh(n: usize) -> Mesh<2> {
    let mut raw = Raw::jittered(&unit_box(), n, 0.0, &mut Random(1));
    let is_inside = |x: &Point<2>| x.iter().all(|&x| x > 1e-9 && x < 1.0 - 1e-9);
    let place = |(k, x): (usize, &Point<2>)| {
        let shift = if is_inside(x) { 0.1 / n as f64 } else { 0.0 };
        let angle = 2.4 * k as f64;
        Point::from([
            x[0] - 0.5 * x[1] + shift * angle.cos(),
            0.75_f64.sqrt() * x[1] + shift * angle.sin(),
        ])
    };
    raw.vertices = raw.vertices.iter().enumerate().map(place).collect();
    raw.mesh()
}

/// `-Laplace u + c u = 0` with values from 0.2 to 1 on the boundary and a large reaction: the solution lies
/// between zero and one. No constant is taken off, which would be integrated by another rule than the reaction.
fn layer() -> Problem<2> {
    Problem::new().dirichlet(|x| 0.2 + 0.9 * x[1]).reaction(|x: &Point<2>| 2e4 * (1.0 + x[1]))
}

fn assembled(mesh: &Mesh<2>, quadrature: DataQuadrature) -> Inequality<f64> {
    let problem = layer();
    Discretisation::new(&ConformingP1, &problem, mesh, quadrature).unwrap().inequality().unwrap()
}

/// The largest entry off the diagonal over the largest on it, and the smallest value of the solution.
fn largest_and_smallest(inequality: &Inequality<f64>) -> (f64, f64) {
    let matrix = &inequality.matrix;
    let (mut off, mut on) = (f64::NEG_INFINITY, 0.0_f64);
    for row in 0..matrix.size() {
        let (columns, values) = matrix.row(row);
        for (&column, &value) in columns.iter().zip(values) {
            match column as usize == row {
                true => on = on.max(value),
                false => off = off.max(value),
            }
        }
    }
    let solution = ActiveSet::default().solve(inequality);
    assert_eq!(solution.outcome, Outcome::Converged);
    assert!(solution.values.iter().all(|&u| u < 1.0 + 1e-12));
    (off / on, solution.values.iter().copied().fold(f64::INFINITY, f64::min))
}

#[test]
fn a_lumped_reaction_keeps_the_m_matrix_and_the_sign_of_the_solution() {
    let mesh = acute_mesh(10);
    let lumped = assembled(&mesh, DataQuadrature::default().reaction(&VertexRule));
    let (off, smallest) = largest_and_smallest(&lumped);
    assert!(off < 0.0 && smallest > 0.0, "{off:e} {smallest:e}");
    let (off, smallest) = largest_and_smallest(&assembled(&mesh, DataQuadrature::default()));
    assert!(off > 0.05 && smallest < -0.01, "{off:e} {smallest:e}");
    // without a reaction only the stiffness is left off the diagonal
    let problem = Problem::new();
    let stiffness = Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default());
    let stiffness = stiffness.unwrap().matrix();
    for row in 0..stiffness.size() {
        let pairs = stiffness.row(row).1.iter().zip(lumped.matrix.row(row).1);
        let changed = pairs.filter(|(a, b)| a != b).count();
        assert_eq!(changed, 1, "row {row}: the diagonal alone changes");
    }
}

#[test]
fn a_lumped_reaction_keeps_the_orders_of_linears() {
    let value = |x: &Point<2>| (x[0] - 2.0 * x[1]).sin();
    let problem = Problem::new()
        .exact(value, |x| Point::from([1.0, -2.0]) * (x[0] - 2.0 * x[1]).cos())
        .reaction(3.0)
        .source(move |x| 8.0 * value(x));
    let study = Study::<2>::new(own_scene("reaction", unit_box(), problem))
        .scheme(ConformingP1)
        .scheme(Wopsip::default())
        .scheme(Sipg::default())
        .quadrature(DataQuadrature::default().reaction(&VertexRule))
        .levels([16, 32]);
    let report = study.run().unwrap();
    for row in report.rows.iter().filter(|row| row.level == 32) {
        let [l2, h1] = [row.order.l2, row.order.h1].map(Option::unwrap);
        let holds = (l2 - 2.0).abs() < 0.1 && (h1 - 1.0).abs() < 0.1;
        assert!(holds, "{}: L2 {l2:.3}, H1 {h1:.3}", row.scheme);
    }
}

/// A rule of a user's crate: the midpoints of the edges of a triangle, exact for quadratics.
#[derive(Debug)]
struct EdgeMidpoints;

impl Quadrature for EdgeMidpoints {
    fn name(&self) -> &str {
        "edge-midpoints"
    }
    fn rule(&self, dimension: usize, degree: usize) -> Result<Rule, QuadratureError> {
        if dimension != 2 || degree > 2 {
            return Err(QuadratureError::no_rule(self.name(), dimension, degree, 2));
        }
        let points = vec![[0.5, 0.5, 0.0, 0.0], [0.5, 0.0, 0.5, 0.0], [0.0, 0.5, 0.5, 0.0]];
        Rule::from_points(2, points, vec![1.0 / 3.0; 3])
    }
}

#[test]
fn a_rule_made_outside_the_crate_integrates_data() {
    let report = check_quadrature(&EdgeMidpoints, 2, 2).unwrap();
    assert_eq!(report.figure("points"), Some(3.0));
    let mesh = acute_mesh(4);
    let problem = Problem::new().reaction(7.0);
    let matrix = |quadrature| {
        Discretisation::new(&ConformingP1, &problem, &mesh, quadrature).unwrap().matrix().values
    };
    let own = matrix(DataQuadrature::default().reaction(&EdgeMidpoints));
    for (own, built_in) in own.iter().zip(matrix(DataQuadrature::default())) {
        assert!((own - built_in).abs() < 1e-14, "{own} {built_in}");
    }
    // quadratics need a rule of degree four, boundary data one of degree fifteen on facets
    let reaction = DataQuadrature::default().reaction(&EdgeMidpoints);
    let error = Discretisation::new(&ConformingP2, &problem, &mesh, reaction).unwrap_err();
    assert!(matches!(&error, Error::Quadrature(_)), "{error}");
    assert!(error.to_string().contains("has no rule of degree 4 in dimension"), "{error}");
    let family = DataQuadrature::default().family(&EdgeMidpoints);
    let error = Discretisation::new(&ConformingP1, &problem, &mesh, family).unwrap_err();
    assert!(error.to_string().starts_with("quadrature family edge-midpoints has no rule"));
}

/// A family whose rules are none.
#[derive(Debug)]
struct Unweighted;

impl Quadrature for Unweighted {
    fn name(&self) -> &str {
        "unweighted"
    }
    fn rule(&self, dimension: usize, degree: usize) -> Result<Rule, QuadratureError> {
        let mut rule = Rule::new(dimension, degree);
        rule.weights.iter_mut().for_each(|w| *w *= 2.0);
        Ok(rule)
    }
}

#[test]
fn a_rule_whose_weights_do_not_sum_to_one_is_refused() {
    let mesh = acute_mesh(2);
    let problem = Problem::new().reaction(1.0);
    let quadrature = DataQuadrature::default().reaction(&Unweighted);
    let error = Discretisation::new(&ConformingP1, &problem, &mesh, quadrature).unwrap_err();
    assert!(matches!(error, Error::Quadrature(_)), "{error}");
    assert!(error.to_string().starts_with("the weights of a rule sum to 2"), "{error}");
    let error = check_quadrature(&VertexRule, 2, 2).unwrap_err();
    assert_eq!(error.kind, KitErrorKind::RuleNotExact, "{error}");
    assert!(error.to_string().contains("for degree 2 in"), "{error}");
}

/// Loads of polynomials of degree three are exact with linears by either family.
fn loads<const D: usize>() {
    let problem = Problem::<D>::new().source(|x| (x.sum() - 0.3).powi(3));
    let mesh = Mesh::<D>::kuhn_box(&unit_box(), [3; D]).unwrap();
    let load = |quadrature| {
        let space = Discretisation::new(&ConformingP1, &problem, &mesh, quadrature).unwrap();
        space.load().unwrap()
    };
    let conical = load(DataQuadrature::default());
    let symmetric = load(DataQuadrature::default().family(&FullySymmetric));
    let size = conical.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
    for (a, b) in conical.iter().zip(&symmetric) {
        assert!((a - b).abs() < 1e-13 * size, "{a} {b}");
    }
}

#[test]
fn symmetric_rules_give_the_same_loads() {
    loads::<1>();
    loads::<2>();
    loads::<3>();
}
