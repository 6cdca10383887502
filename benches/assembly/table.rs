//! The table: the least time of interleaved runs, beside what memory allows.

use std::hint::black_box;
use std::time::{Duration, Instant};

use super::cases::{self, Case};

/// Runs of each job, and the time after which a case is given no more.
const RUNS: usize = 15;
const ENOUGH: Duration = Duration::from_secs(8);

/// Numbers of the arrays that are filled and copied: 256 MB each, beyond all caches.
const BIG: usize = 32 << 20;

/// Bytes per second of a plain fill and a plain copy, the most that was seen so far; a copy reads
/// and writes. Fresh memory is filled once after it was asked for: what it costs to get it from the
/// system is part of every assembly from nothing.
struct Bandwidth {
    from: Vec<f64>,
    to: Vec<f64>,
    fill: [f64; 2],
    copy: [f64; 2],
    fresh: [f64; 2],
}

impl Bandwidth {
    fn new() -> Self {
        let (from, to) = (vec![1.0; BIG], vec![2.0; BIG]);
        Self { from, to, fill: [0.0; 2], copy: [0.0; 2], fresh: [0.0; 2] }
    }
    fn measure(&mut self) {
        let Self { from, to, fill, copy, fresh } = self;
        for threads in [1, 2] {
            let share = BIG / threads;
            let mut fill_all = || {
                let parts = to.chunks_mut(share);
                rayon::scope(|s| parts.for_each(|part| s.spawn(|_| part.fill(black_box(3.0)))));
            };
            let seconds = seconds(threads, &mut fill_all);
            fill[threads - 1] = fill[threads - 1].max((8 * BIG) as f64 / seconds);
            let mut copy_all = || {
                let parts = to.chunks_mut(share).zip(from.chunks(share));
                rayon::scope(|s| {
                    parts.for_each(|(to, from)| s.spawn(|_| to.copy_from_slice(black_box(from))));
                });
            };
            let seconds = self::seconds(threads, &mut copy_all);
            copy[threads - 1] = copy[threads - 1].max((16 * BIG) as f64 / seconds);
            let mut fill_fresh = || {
                let one = |_: &rayon::Scope<'_>| drop(black_box(vec![black_box(1.0); share]));
                rayon::scope(|s| (0..threads).for_each(|_| s.spawn(one)));
            };
            let seconds = self::seconds(threads, &mut fill_fresh);
            fresh[threads - 1] = fresh[threads - 1].max((8 * BIG) as f64 / seconds);
        }
    }
}

/// Seconds that work takes on so many threads.
///
/// With `--processor` those of one thread are what it had of a processor, so that other programs do
/// not count; where the system does not tell, and for more threads, by the clock all the same.
pub fn seconds(threads: usize, work: &mut (dyn FnMut() + Send)) -> f64 {
    let start = Instant::now();
    if threads > 1 || !std::env::args().any(|a| a == "--processor") {
        cases::on(threads, work);
        return start.elapsed().as_secs_f64();
    }
    let mut spent = None;
    cases::on(1, &mut || {
        let before = processor_seconds();
        work();
        spent = before.zip(processor_seconds()).map(|(before, after)| after - before);
    });
    spent.unwrap_or_else(|| start.elapsed().as_secs_f64())
}

/// Seconds for which this thread has had a processor so far.
fn processor_seconds() -> Option<f64> {
    // the kernel counts to the last switch: without one the time at hand would be missing
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * text.split(' ').next()?.parse::<f64>().ok()?)
}

/// One line of the table.
struct Line {
    name: String,
    job: &'static str,
    subdivisions: usize,
    cells: usize,
    bytes: Option<usize>,
    /// On one thread and on two.
    least: [f64; 2],
}

fn measure(case: &mut Case<'_>, bandwidth: &mut Bandwidth) -> Vec<Line> {
    let mut least = vec![[f64::INFINITY; 2]; case.jobs.len()];
    let start = Instant::now();
    for run in 0..RUNS {
        if run > 2 && start.elapsed() > ENOUGH {
            break;
        }
        if run % 4 == 0 {
            bandwidth.measure();
        }
        for (job, least) in case.jobs.iter_mut().zip(&mut least) {
            for threads in [1, 2] {
                let time = seconds(threads, &mut *job.work);
                least[threads - 1] = least[threads - 1].min(time);
            }
        }
    }
    let line = |(job, least): (&cases::Job<'_>, &[f64; 2])| Line {
        name: case.name.clone(),
        job: job.name,
        subdivisions: case.subdivisions,
        cells: case.cells,
        bytes: job.bytes,
        least: *least,
    };
    case.jobs.iter().zip(&least).map(line).collect()
}

/// Prints the table of the cases that the filters name.
pub fn print(filters: &[String]) {
    let mut bandwidth = Bandwidth::new();
    let mut lines = Vec::new();
    cases::each(filters, &mut |case| {
        eprintln!("{} ...", case.name);
        lines.extend(measure(case, &mut bandwidth));
    });
    let Bandwidth { fill, copy, fresh, .. } = bandwidth;
    let [fill, copy, fresh] = [fill, copy, fresh].map(|b| b.map(|b| b / 1e9));
    println!(
        "\nPlain fill {:.1} GB/s on one thread and {:.1} on two, plain copy (read and written) {:.1} \
         and {:.1}, fill of fresh memory {:.1} and {:.1}.\n",
        fill[0], fill[1], copy[0], copy[1], fresh[0], fresh[1]
    );
    println!(
        "| case | n | what | threads | ns per cell | 10^6 cells per s | speed-up | GB/s | of fill | of copy |"
    );
    println!("|---|--:|---|--:|--:|--:|--:|--:|--:|--:|");
    for line in &lines {
        for threads in [1, 2] {
            let time = line.least[threads - 1];
            let per_cell = time / line.cells as f64;
            let rates = line.bytes.map_or("| | |".to_owned(), |bytes| {
                let rate = bytes as f64 / time / 1e9;
                let (fill, copy) = (rate / fill[threads - 1], rate / copy[threads - 1]);
                format!("{rate:.2} | {:.0} % | {:.0} % |", 100.0 * fill, 100.0 * copy)
            });
            println!(
                "| {} | {} | {} | {threads} | {:.1} | {:.1} | {:.2} | {rates}",
                line.name,
                line.subdivisions,
                line.job,
                1e9 * per_cell,
                1e-6 / per_cell,
                line.least[0] / time,
            );
        }
    }
}
