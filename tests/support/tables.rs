//! Solutions and error norms by the rules of printed tables.

use unilateral::assemble::DataQuadrature;
use unilateral::inequality::{Certificate, Outcome};
use unilateral::measure::{Errors, Fields};
use unilateral::mesh::Mesh;
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::quadrature::Rule;
use unilateral::scenes::Scene;

/// The degree of the rules for data and norms in most tables of the independent implementation:
/// five points of Gauss in each direction.
pub const DEGREE_OF_TABLES: usize = 9;

/// The figures of a solution, without its mesh.
pub struct Figures {
    pub outcome: Outcome,
    pub certificate: Certificate,
    pub error: Errors,
    pub fields: Option<Fields>,
}

impl Figures {
    pub fn of<const D: usize>(solved: &Solved<'_, D>) -> Self {
        Self {
            outcome: solved.outcome(),
            certificate: solved.certificate(),
            error: solved.errors().unwrap(),
            fields: solved.fields(),
        }
    }
}

/// A scheme's solution on a level with the rules of those tables.
pub fn solve_as_tables<const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn Scheme<D>,
    level: usize,
) -> (Mesh<D>, Figures) {
    solve_by_rule(scene, scheme, level, DEGREE_OF_TABLES)
}

/// A scheme's solution on a level, with rules of this degree for data. The programs behind the
/// tables use their rules across jumps and kinks of the load too, as is done here for their sake; what
/// cells that are cut gain is tested by itself.
pub fn solve_by_rule<const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn Scheme<D>,
    level: usize,
    degree: usize,
) -> (Mesh<D>, Figures) {
    let meshes = Hierarchy::of_domain(&scene.domain, level).unwrap();
    let quadrature = DataQuadrature::default().cell(degree).facet(degree);
    let mut problem = scene.problem.clone();
    if let Some(Datum::Piecewise { value, .. }) = problem.source.everywhere {
        problem.source.everywhere = Some(Datum::Function(value));
    }
    let mut nested = NestedIteration::new(&problem, &meshes).quadrature(quadrature);
    let solved = nested.solve(scheme).unwrap();
    (meshes.finest().clone(), Figures::of(&solved))
}

/// L2 norm and H1 seminorm of the error by a rule of this degree, which collapses a square onto
/// each triangle, one side of it onto the triangle's first vertex. Where the error is not smooth in
/// a cell the last digits of a table are those of its rule.
pub fn norms_by_rule<const D: usize>(
    scene: &Scene<D>,
    mesh: &Mesh<D>,
    u: &[f64],
    degree: usize,
) -> [f64; 2] {
    let exact = scene.problem.exact.as_ref().unwrap();
    let rule = Rule::new(D, degree);
    let [mut l2, mut h1] = [0.0; 2];
    for (cell, values) in u.chunks(D + 1).enumerate() {
        let geometry = mesh.geometry(cell);
        let sum = |s: Point<D>, k: usize| s + geometry.gradient(k) * values[k];
        let gradient = (0..=D).fold(Point::zeros(), sum);
        for (point, weight) in rule.iter() {
            let point: Vec<f64> = (0..=D).map(|k| point[D - k]).collect();
            let x = mesh.point(cell, &point);
            let value: f64 = point.iter().zip(values).map(|(b, u)| b * u).sum();
            l2 += weight * geometry.volume * (value - exact.value.at(&x)).powi(2);
            h1 += weight * geometry.volume * (gradient - (exact.gradient)(&x)).norm_squared();
        }
    }
    [l2.sqrt(), h1.sqrt()]
}

/// The penalty part of WOPSIP's energy norm, where coefficient is one and there is no reaction.
pub fn jump_norm(energy: f64, h1: f64) -> f64 {
    (energy * energy - h1 * h1).sqrt()
}
