//! Runs of schemes on scenes and meshes, and figures compared with figures in print.

use std::path::{Path, PathBuf};
use unilateral::assemble::DataQuadrature;
use unilateral::inequality::ActiveSet;
use unilateral::mesh::BoxDomain;
use unilateral::mesh::{Mesh, gmsh};
use unilateral::nested::{Hierarchy, Solved, Task};
use unilateral::prelude::*;
use unilateral::quadrature::Rule;
use unilateral::scenes::Scene;
use unilateral::scheme::Regularity;
use unilateral::study::Row;

/// A scheme chosen at run time.
pub type Boxed<T, const D: usize> = Box<dyn AnyScheme<T, D>>;

/// Interior penalty with `sigma / h_F`.
pub fn sipg(sigma: f64) -> Sipg {
    Sipg { penalty: PenaltyRule::Diameter(sigma), ..Sipg::default() }
}

/// Over-penalty with `eta / h_F^3`.
pub fn wopsip(eta: f64) -> Wopsip {
    Wopsip { eta: Eta::Absolute(eta), ..Wopsip::default() }
}

/// The schemes that reproduce linear functions.
pub fn consistent_schemes<T: Real, const D: usize>() -> Vec<Boxed<T, D>> {
    vec![
        Box::new(ConformingP1),
        Box::new(NonconformingP1),
        Box::new(Sipg::default()),
        Box::new(FacetMeans(Sipg::default())),
    ]
}

/// Every scheme, and the discontinuous ones with both sets of constraints, with default penalties.
pub fn all_schemes<T: Real, const D: usize>() -> Vec<Boxed<T, D>> {
    let mut schemes = consistent_schemes();
    schemes.push(Box::new(Wopsip::default()));
    schemes.push(Box::new(FacetMeans(Wopsip::default())));
    schemes
}

/// Scheme, constraint, scene and level of a row, for messages.
pub fn label(row: &Row) -> String {
    format!("{} ({}) on {} at level {}", row.scheme, row.constraint, row.scene, row.level)
}

/// The rows of schemes on levels of a scene.
pub fn rows<T: Real, const D: usize>(
    scene: Scene<D>,
    schemes: Vec<Boxed<T, D>>,
    levels: impl IntoIterator<Item = usize>,
) -> Vec<Row> {
    run(Study::<T, D>::new(scene), schemes, levels)
}

/// The rows of schemes on a mesh and its refinements.
pub fn rows_on<T: Real, const D: usize>(
    mesh: Mesh<T, D>,
    scene: Scene<D>,
    schemes: Vec<Boxed<T, D>>,
    refinements: impl IntoIterator<Item = usize>,
) -> Vec<Row> {
    run(Study::<T, D>::new(scene).on_mesh(mesh), schemes, refinements)
}

fn run<T: Real, const D: usize>(
    study: Study<'_, T, D>,
    schemes: Vec<Boxed<T, D>>,
    levels: impl IntoIterator<Item = usize>,
) -> Vec<Row> {
    let study = schemes.into_iter().fold(study.levels(levels), Study::boxed_scheme);
    study.run().unwrap().rows
}

/// Solves on one mesh from a cold start.
pub fn solve<T: Real, const D: usize>(
    scheme: &dyn AnyScheme<T, D>,
    problem: &Problem<D>,
    mesh: &Mesh<T, D>,
) -> Solved {
    let solver = ActiveSet::default();
    let task = Task {
        problem,
        mesh,
        start: None,
        solver: &solver,
        quadrature: Default::default(),
        with_errors: true,
        repeat: 1,
        with_fields: true,
    };
    scheme.solve(&task).unwrap()
}

/// The degree of the rules for data and norms in most tables of the independent implementation:
/// five points of Gauss in each direction.
const DEGREE_OF_TABLES: usize = 9;

/// A scheme's solution on a level with the rules of those tables.
pub fn solve_as_tables<const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn AnyScheme<f64, D>,
    level: usize,
) -> (Mesh<f64, D>, Solved) {
    solve_by_rule(scene, scheme, level, DEGREE_OF_TABLES)
}

/// A scheme's solution on a level, started from that of conforming elements, with rules of this
/// degree for data.
pub fn solve_by_rule<const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn AnyScheme<f64, D>,
    level: usize,
    degree: usize,
) -> (Mesh<f64, D>, Solved) {
    let quadrature = DataQuadrature { cell: degree, facet: degree };
    let solver = ActiveSet::default();
    let mut levels = Hierarchy::new(&scene.problem, &scene.domain, None);
    levels.make(level).unwrap();
    let start = levels.contact(level, &solver, quadrature, 1).unwrap();
    let mesh = levels.mesh(level).unwrap().0.clone();
    let task = Task {
        problem: &scene.problem,
        mesh: &mesh,
        start: Some(&start),
        solver: &solver,
        quadrature,
        with_errors: true,
        repeat: 1,
        with_fields: true,
    };
    let solved = scheme.solve(&task).unwrap();
    (mesh, solved)
}

/// L2 norm and H1 seminorm of the error by the rule of those tables.
pub fn norms_as_tables<const D: usize>(
    scene: &Scene<D>,
    mesh: &Mesh<f64, D>,
    u: &[f64],
) -> [f64; 2] {
    norms_by_rule(scene, mesh, u, DEGREE_OF_TABLES)
}

/// L2 norm and H1 seminorm of the error by a rule of this degree, which collapses a square onto
/// each triangle, one side of it onto the triangle's first vertex. Where the error is not smooth in
/// a cell the last digits of a table are those of its rule.
pub fn norms_by_rule<const D: usize>(
    scene: &Scene<D>,
    mesh: &Mesh<f64, D>,
    u: &[f64],
    degree: usize,
) -> [f64; 2] {
    let exact = scene.problem.exact.as_ref().unwrap();
    let rule = Rule::new(D, degree);
    let [mut l2, mut h1] = [0.0; 2];
    for (cell, values) in u.chunks(D + 1).enumerate() {
        let geometry = mesh.geometry(cell);
        let sum = |s: Point<f64, D>, k: usize| s + geometry.gradient(k) * values[k];
        let gradient = (0..=D).fold(Point::zeros(), sum);
        for (point, weight) in rule.iter() {
            let point: Vec<f64> = (0..=D).map(|k| point[D - k]).collect();
            let x = mesh.point(cell, &point);
            let value: f64 = point.iter().zip(values).map(|(b, u)| b * u).sum();
            l2 += weight * geometry.volume * (value - (exact.value)(&x)).powi(2);
            h1 += weight * geometry.volume * (gradient - (exact.gradient)(&x)).norm_squared();
        }
    }
    [l2.sqrt(), h1.sqrt()]
}

/// A scene of a test's own.
pub fn own_scene<const D: usize>(
    name: &str,
    domain: BoxDomain<D>,
    problem: Problem<D>,
) -> Scene<D> {
    Scene::new(name, domain, problem).summary("of a test").regularity(Regularity::smooth())
}

/// The penalty part of WOPSIP's energy norm, where coefficient is one and there is no reaction.
pub fn jump_norm(energy: f64, h1: f64) -> f64 {
    (energy * energy - h1 * h1).sqrt()
}

/// A mesh of the folder of test data.
pub fn small_mesh<const D: usize>(name: &str) -> Mesh<f64, D> {
    read(&Path::new("tests/data").join(name))
}

/// A mesh of the folder beside the project; none, with a word on it, where there is no such folder.
pub fn shared_mesh<const D: usize>(name: &str) -> Option<Mesh<f64, D>> {
    // Tests run in the folder of the package.
    let path = PathBuf::from("../shared/meshes").join(name);
    if path.is_file() {
        return Some(read(&path));
    }
    eprintln!("skipped: there is no {}", path.display());
    None
}

fn read<const D: usize>(path: &Path) -> Mesh<f64, D> {
    gmsh::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).mesh
}

/// What disagrees, gathered so that one run shows all of it.
#[derive(Default)]
pub struct Checks {
    done: usize,
    failed: Vec<String>,
}

impl Checks {
    /// Notes a condition that does not hold.
    pub fn that(&mut self, holds: bool, message: impl FnOnce() -> String) {
        self.done += 1;
        if !holds {
            self.failed.push(message());
        }
    }
    /// The figure is what is printed, to this many units of the last printed digit; half a unit is
    /// what rounding to that digit allows. Shows both with `--nocapture`.
    pub fn printed(&mut self, what: &str, ours: f64, printed: &str, units: f64) {
        println!("{what}: {ours:.6e}, in print {printed}");
        let (theirs, unit) = figure(printed);
        let off = (ours - theirs) / unit;
        self.that(off.abs() <= units * (1.0 + 1e-9), || {
            format!("{what}: {ours:.6e} against {printed}, {off:+.2} units of the last digit")
        });
    }
    /// The figure is what is printed but for this much and half a unit of the last digit.
    pub fn printed_within(&mut self, what: &str, ours: f64, printed: &str, tolerance: f64) {
        println!("{what}: {ours:.6e}, in print {printed}");
        let (theirs, unit) = figure(printed);
        self.close(what, ours, theirs, tolerance + 0.5 * unit);
    }
    /// Ours and theirs differ by at most this.
    pub fn close(&mut self, what: &str, ours: f64, theirs: f64, tolerance: f64) {
        self.that((ours - theirs).abs() <= tolerance, || {
            format!("{what}: {ours:e} against {theirs:e}, off by {:.2e}", ours - theirs)
        });
    }
    /// The row converged, with a certificate that says so.
    pub fn certified(&mut self, row: &Row, largest: f64) {
        let (status, found) = (&row.status, row.certificate.largest());
        self.that(row.converged() && found < largest, || {
            format!("{}: {status}, certificate {found:e}", label(row))
        });
    }
    /// Fails with everything that disagrees, or if nothing was checked at all.
    pub fn finish(self) {
        assert!(self.done > 0, "nothing was checked");
        let Self { done, failed } = self;
        assert!(
            failed.is_empty(),
            "{} of {done} do not hold:\n{}",
            failed.len(),
            failed.join("\n")
        );
    }
}

/// A printed figure and the unit of its last digit.
fn figure(printed: &str) -> (f64, f64) {
    let (mantissa, exponent) = printed.split_once('e').unwrap_or((printed, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len()) as i32;
    let exponent: i32 = exponent.parse().unwrap();
    (printed.parse().unwrap(), 10_f64.powi(exponent - decimals))
}
