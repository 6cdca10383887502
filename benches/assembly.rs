//! Cells assembled per second: from nothing (pattern and values) and refilling a known pattern, on
//! one and two threads.
//!
//! `cargo bench --bench assembly`; a filter picks cases, e.g. `cargo bench --bench assembly -- 2d/sipg`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::prelude::*;
use unilateral::scenes::BoxDomain;

/// One scheme on one mesh, with and without its pattern.
fn scheme<const D: usize, S: Scheme<f64, D>>(c: &mut Criterion, scheme: &S, subdivisions: usize) {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let Ok(mesh) = Mesh::<f64, D>::kuhn_box(&domain, [subdivisions; D]) else { return };
    let problem = Problem::<D>::new();
    let name = format!("{D}d/{}", scheme.name());
    let mut group = c.benchmark_group(&name);
    group.throughput(Throughput::Elements(mesh.n_cells() as u64)).sample_size(10);
    for threads in [1, 2] {
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { return };
        let discretise = || Discretisation::new(scheme, &problem, &mesh, DataQuadrature::default());
        // from nothing includes facets and unknowns, which a refill does not need again
        group.bench_function(BenchmarkId::new("from nothing", threads), |b| {
            b.iter(|| pool.install(|| discretise().map(|space| black_box(space.matrix()))))
        });
        let Ok(space) = discretise() else { return };
        let mut matrix = space.matrix();
        group.bench_function(BenchmarkId::new("refill", threads), |b| {
            b.iter(|| pool.install(|| space.fill(black_box(&mut matrix))))
        });
    }
    group.finish();
}

fn assembly(c: &mut Criterion) {
    scheme::<2, _>(c, &ConformingP1, 512);
    scheme::<2, _>(c, &Sipg::default(), 256);
    scheme::<2, _>(c, &Wopsip::default(), 256);
    scheme::<3, _>(c, &ConformingP1, 32);
    scheme::<3, _>(c, &Sipg::default(), 16);
    scheme::<3, _>(c, &Wopsip::default(), 16);
}

criterion_group!(benches, assembly);
criterion_main!(benches);
