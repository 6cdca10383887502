//! What assembly, facet topology, edges and refinement cost per cell, against the bandwidth of memory.
//!
//! `cargo bench --bench assembly` prints the table of `docs/results/assembly.md` and then runs criterion;
//! after `--`
//!
//! * `--table` prints the table alone, for example of the cases `--table 2d/p1`;
//! * `--large` assembles meshes of up to 10^7 cells, each in a process of its own, and states peaks
//!   of memory;
//! * anything else goes to criterion, for example a filter like `2d/sipg`.

#[path = "assembly/cases.rs"]
mod cases;
#[path = "assembly/large.rs"]
mod large;
#[path = "assembly/table.rs"]
mod table;

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput};

use cases::Case;

/// The cases of the table in criterion's statistics.
fn criterion(filters: &[String]) {
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args();
    let mut run = |case: &mut Case<'_>| {
        let mut group = criterion.benchmark_group(&case.name);
        group.throughput(Throughput::Elements(case.cells as u64));
        for job in &mut case.jobs {
            for threads in [1, 2] {
                group.bench_function(BenchmarkId::new(job.name, threads), |b| {
                    b.iter(|| cases::on(threads, &mut *job.work))
                });
            }
        }
        group.finish();
    };
    cases::each(filters, &mut run);
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| arguments.iter().any(|a| a == flag);
    let names: Vec<String> = arguments.iter().filter(|a| !a.starts_with('-')).cloned().collect();
    if has("--one-large") {
        return large::one(&names);
    }
    if has("--large") {
        return large::all(&names);
    }
    if has("--table") {
        return table::print(&names);
    }
    // a run that only tests that benchmarks run, or lists them, is criterion's own
    if has("--bench") && arguments.len() == 1 {
        table::print(&[]);
    }
    criterion(&names);
}
