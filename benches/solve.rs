//! Seconds from assembled inequalities to solutions: with factors and without, cold on one mesh, on
//! one and two threads.
//!
//! `cargo bench --bench solve`; a filter picks cases, e.g. `cargo bench --bench solve -- sipg`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use unilateral::algebra::{Bound, Inequality};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;

/// One scheme on one mesh: the linear system, without inequalities.
fn scheme<const D: usize, S: Scheme<D>>(c: &mut Criterion, scheme: &S, subdivisions: usize) {
    let scene = scenes::radial::<D>(1.0);
    let Ok(mesh) = scene.domain.mesh(subdivisions) else { return };
    let quadrature = DataQuadrature::default();
    let Ok(space) = Discretisation::new(scheme, &scene.problem, &mesh, quadrature) else { return };
    let Ok(mut inequality) = space.inequality() else { return };
    for bound in inequality.bounds.iter_mut().filter(|bound| bound.is_inequality()) {
        *bound = Bound::Free;
    }
    let name = format!("{D}d/{}", scheme.name());
    let mut group = c.benchmark_group(&name);
    group.throughput(Throughput::Elements(inequality.size() as u64)).sample_size(10);
    for (name, linear, threads) in [
        ("direct", LinearMethod::Direct, 1),
        ("iterative", LinearMethod::Iterative, 1),
        ("iterative", LinearMethod::Iterative, 2),
    ] {
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { return };
        group.bench_function(BenchmarkId::new(name, threads), |b| {
            b.iter(|| pool.install(|| solve(black_box(&inequality), linear)))
        });
    }
    group.finish();
}

fn solve(inequality: &Inequality<f64>, linear: LinearMethod) -> Outcome {
    ActiveSet::default().linear(linear).solve(inequality).outcome
}

fn solvers(c: &mut Criterion) {
    scheme::<2, _>(c, &ConformingP1, 256);
    scheme::<2, _>(c, &Sipg::default(), 128);
    scheme::<2, _>(c, &Wopsip::default(), 128);
    scheme::<3, _>(c, &ConformingP1, 32);
    scheme::<3, _>(c, &Sipg::default(), 8);
}

criterion_group!(benches, solvers);
criterion_main!(benches);
