//! What is measured.

use std::hint::black_box;
use std::sync::OnceLock;

use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::mesh::BoxDomain;
use unilateral::mesh::{Edges, Neighbours};
use unilateral::prelude::*;
use unilateral::scheme::ConformingP2;

/// Work on one mesh, in several jobs.
pub struct Case<'c> {
    /// Dimension and what is done.
    pub name: String,
    /// Subdivisions of each side of the unit box.
    pub subdivisions: usize,
    /// By how many cells times are divided.
    pub cells: usize,
    /// What is done.
    pub jobs: Vec<Job<'c>>,
}

/// One thing to measure.
pub struct Job<'c> {
    pub name: &'static str,
    /// Bytes of the matrix that are written and of the mesh that are read; none where unknown.
    pub bytes: Option<usize>,
    pub work: Box<dyn FnMut() + Send + 'c>,
}

/// Runs work on a pool of so many threads.
pub fn on(threads: usize, work: &mut (dyn FnMut() + Send)) {
    static POOLS: [OnceLock<rayon::ThreadPool>; 2] = [OnceLock::new(), OnceLock::new()];
    let pool = POOLS[threads - 1].get_or_init(|| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads")
    });
    pool.install(work);
}

/// A Kuhn mesh of the unit box.
pub fn unit_box<const D: usize>(subdivisions: usize) -> Mesh<D> {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Mesh::kuhn_box(&domain, [subdivisions; D]).expect("a mesh of the unit box")
}

/// Bytes of cells and vertices.
fn mesh_bytes<const D: usize>(mesh: &Mesh<D>) -> usize {
    4 * mesh.cells().len() + 8 * D * mesh.vertices().len()
}

/// Assembly of a scheme, from nothing and into a known pattern.
fn assembly<const D: usize, S: Scheme<D>>(
    scheme: &S,
    subdivisions: usize,
    run: &mut dyn FnMut(&mut Case<'_>),
) {
    let mesh = unit_box::<D>(subdivisions);
    let problem = Problem::<D>::new();
    let discretise = || {
        Discretisation::new(scheme, &problem, &mesh, DataQuadrature::default()).expect("a space")
    };
    let space = discretise();
    let mut matrix = space.matrix();
    let values = 8 * matrix.nonzeros();
    let pattern = 4 * matrix.nonzeros() + 4 * (matrix.size() + 1);
    let read = mesh_bytes(&mesh);
    let jobs = vec![
        Job {
            name: "from nothing",
            bytes: Some(pattern + values + read),
            // facets and unknowns included, which a refill does not need again
            work: Box::new(|| drop(black_box(discretise().matrix()))),
        },
        Job {
            name: "refill",
            bytes: Some(values + read),
            work: Box::new(|| space.fill(black_box(&mut matrix))),
        },
    ];
    let name = format!("{D}d/{}", scheme.name());
    run(&mut Case { name, subdivisions, cells: mesh.n_cells(), jobs });
}

/// Facets, edges and refinement of a mesh.
fn topology<const D: usize>(subdivisions: usize, run: &mut dyn FnMut(&mut Case<'_>)) {
    let mesh = unit_box::<D>(subdivisions);
    let job = |name, work: Box<dyn FnMut() + Send>| Job { name, bytes: None, work };
    let jobs = vec![
        job("facets", Box::new(|| drop(black_box(Neighbours::new(&mesh))))),
        job("edges", Box::new(|| drop(black_box(Edges::with_cell_edges(&mesh))))),
    ];
    run(&mut Case { name: format!("{D}d/mesh"), subdivisions, cells: mesh.n_cells(), jobs });
    let coarse = unit_box::<D>(subdivisions / 2);
    let work = Box::new(|| drop(black_box(coarse.refine())));
    let jobs = vec![Job { name: "refinement", bytes: None, work }];
    let cells = coarse.n_cells() << D;
    let subdivisions = subdivisions / 2;
    run(&mut Case { name: format!("{D}d/refinement"), subdivisions, cells, jobs });
}

/// Every case whose name contains one of the filters, or every case if there are none.
pub fn each(filters: &[String], run: &mut dyn FnMut(&mut Case<'_>)) {
    let wanted = |name: &str| filters.is_empty() || filters.iter().any(|f| name.contains(&**f));
    macro_rules! cases {
        ($($name:literal: $case:expr;)*) => { $(if wanted($name) { $case })* };
    }
    cases! {
        "2d/p1": assembly::<2, _>(&ConformingP1, 1024, run);
        "2d/p2": assembly::<2, _>(&ConformingP2, 512, run);
        "2d/cr": assembly::<2, _>(&NonconformingP1, 512, run);
        "2d/sipg": assembly::<2, _>(&Sipg::default(), 512, run);
        "2d/wopsip": assembly::<2, _>(&Wopsip::default(), 512, run);
        "2d/sipg-p2": assembly::<2, _>(&Sipg::default().on(P2), 256, run);
        "2d/mesh": topology::<2>(1024, run);
        "3d/p1": assembly::<3, _>(&ConformingP1, 64, run);
        "3d/p2": assembly::<3, _>(&ConformingP2, 32, run);
        "3d/cr": assembly::<3, _>(&NonconformingP1, 32, run);
        "3d/sipg": assembly::<3, _>(&Sipg::default(), 32, run);
        "3d/wopsip": assembly::<3, _>(&Wopsip::default(), 32, run);
        "3d/sipg-p2": assembly::<3, _>(&Sipg::default().on(P2), 16, run);
        "3d/mesh": topology::<3>(64, run);
    }
}
