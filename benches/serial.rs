//! The serial share of each phase of a run: how much of its processor time one thread works alone.
//!
//! With two threads, `t` the processor time of all threads in a phase and `t_max` that of the busiest one, the
//! share is `s = 2 t_max / t - 1`: zero where both do half of the work, one where one thread does all of it. By Amdahl's
//! law `n` threads gain at most `1 / (s + (1 - s) / n)`. Processor times hardly depend on what else the machine
//! does; each run is a process of its own, and the least share of several rounds counts.
//!
//! `cargo bench --bench serial` prints the shares; `-- --rounds 5` sets the number of rounds, further words pick
//! the cases whose names contain one of them. The column `idle` is the processor time of two threads over that of one,
//! less one: threads that wait for work and spin would show in it.
//!
//! It reads `/proc/self/task`, so it runs on Linux.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::process::{Command, ExitCode};

use unilateral::nested::{Hierarchy, Phase};
use unilateral::prelude::*;

/// What one process tells another.
type Failure = Box<dyn std::error::Error>;

/// Schemes by their names in the program.
const SCHEMES: [&str; 4] = ["p1", "sipg", "wopsip", "wopsip:facet-means"];
/// Phases in the order in which they run.
const PHASES: [&str; 6] = ["mesh", "start", "assembly", "solve", "bound", "errors"];

/// Processor seconds of each thread of this process.
fn seconds_of_threads() -> Result<BTreeMap<String, f64>, Failure> {
    let mut seconds = BTreeMap::new();
    for thread in fs::read_dir("/proc/self/task")? {
        let thread = thread?;
        let times = fs::read_to_string(thread.path().join("schedstat"))?;
        let nanoseconds: f64 = times.split_whitespace().next().unwrap_or("0").parse()?;
        seconds.insert(thread.file_name().to_string_lossy().into_owned(), nanoseconds / 1e9);
    }
    Ok(seconds)
}

/// Times of threads at the ends of phases.
#[derive(Default)]
struct Clock {
    ends: Vec<(&'static str, BTreeMap<String, f64>)>,
}

impl Clock {
    /// A phase begins; the one before it ends.
    fn enter(&mut self, phase: &'static str) {
        let seconds = seconds_of_threads().expect("Linux tells the times of threads");
        self.ends.push((phase, seconds));
    }
    /// Prints for each phase the processor time of the busiest thread and of all threads.
    fn print(&self) {
        for pair in self.ends.windows(2) {
            let before = |thread: &String| pair[0].1.get(thread).copied().unwrap_or(0.0);
            let spent: Vec<f64> = pair[1].1.iter().map(|(t, now)| now - before(t)).collect();
            let busiest = spent.iter().copied().fold(0.0, f64::max);
            println!("{} {busiest} {}", pair[0].0, spent.iter().sum::<f64>());
        }
    }
}

fn run<const D: usize>(name: &str, level: usize) -> Result<(), Failure> {
    let scheme: Box<dyn Scheme<D>> = match name {
        "p1" => Box::new(ConformingP1),
        "sipg" => Box::new(Sipg::default()),
        "wopsip" | "wopsip:facet-means" => Box::new(Wopsip::default()),
        other => return Err(format!("no scheme {other}").into()),
    };
    let scene = scenes::radial::<D>(1.0);
    let problem = match name.ends_with("facet-means") {
        true => scene.problem.on(FacetMeans),
        false => scene.problem,
    };
    let clock = RefCell::new(Clock::default());
    clock.borrow_mut().enter("mesh");
    let meshes = Hierarchy::<D>::of_domain(&scene.domain, level)?;
    let enter = |phase| {
        clock.borrow_mut().enter(match phase {
            Phase::Start => "start",
            Phase::Assembly => "assembly",
            _ => "solve",
        })
    };
    let solved = NestedIteration::new(&problem, &meshes).observer(enter).solve(&*scheme)?;
    clock.borrow_mut().enter("bound");
    solved.bound()?;
    clock.borrow_mut().enter("errors");
    solved.errors()?;
    solved.contact_errors()?;
    clock.borrow_mut().enter("end");
    clock.borrow().print();
    Ok(())
}

/// Runs a case on a pool of its own, so that serial work is done by a thread that shares in the parallel work.
fn child(dimension: &str, scheme: &str, level: &str) -> Result<(), Failure> {
    let threads = rayon::current_num_threads();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let level = level.parse()?;
    pool.install(|| match dimension {
        "2d" => run::<2>(scheme, level).map_err(|e| e.to_string()),
        "3d" => run::<3>(scheme, level).map_err(|e| e.to_string()),
        other => Err(format!("no dimension {other}")),
    })?;
    Ok(())
}

/// For each phase the processor time of the busiest thread and of all threads, of one run.
fn measure(case: [&str; 3], threads: &str) -> Result<Vec<[f64; 2]>, Failure> {
    let output = Command::new(std::env::current_exe()?)
        .arg("--case")
        .args(case)
        .env("RAYON_NUM_THREADS", threads)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let text = String::from_utf8(output.stdout)?;
    let mut phases = vec![[0.0; 2]; PHASES.len()];
    for line in text.lines() {
        let mut words = line.split(' ');
        let name = words.next().unwrap_or_default();
        let k = PHASES.iter().position(|p| *p == name).ok_or("an unknown phase")?;
        for sum in &mut phases[k] {
            *sum += words.next().ok_or("two numbers a phase")?.parse::<f64>()?;
        }
    }
    Ok(phases)
}

fn all() -> Result<(), Failure> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let is_bench = words.iter().any(|w| w == "--bench");
    words.retain(|w| w != "--bench");
    if let [flag, dimension, scheme, level] = &words[..]
        && flag == "--case"
    {
        return child(dimension, scheme, level);
    }
    if !is_bench {
        println!("nothing is measured without `--bench`, which `cargo bench` adds");
        return Ok(());
    }
    let mut rounds = 3;
    if let Some(at) = words.iter().position(|w| w == "--rounds") {
        rounds = words.get(at + 1).ok_or("--rounds needs a number")?.parse()?;
        words.drain(at..at + 2);
    }
    println!(
        "{:<26}{:<10}{:>10}{:>10}{:>9}{:>8}",
        "case", "phase", "1 thread", "2 threads", "serial", "idle"
    );
    for (dimension, level) in [("2d", "512"), ("3d", "32")] {
        for scheme in SCHEMES {
            let name = format!("{dimension}-{scheme}-{level}");
            if !words.is_empty() && !words.iter().any(|w| name.contains(w.as_str())) {
                continue;
            }
            let case = [dimension, scheme, level];
            let mut one = vec![f64::INFINITY; PHASES.len()];
            let mut two = vec![[f64::INFINITY; 2]; PHASES.len()];
            for _ in 0..rounds {
                for (least, [_, all]) in one.iter_mut().zip(measure(case, "1")?) {
                    *least = least.min(all);
                }
                for (least, [busiest, all]) in two.iter_mut().zip(measure(case, "2")?) {
                    let share = (2.0 * busiest / all - 1.0).max(0.0);
                    *least = [least[0].min(share), least[1].min(all)];
                }
            }
            for ((phase, one), [share, all]) in PHASES.iter().zip(&one).zip(&two) {
                let idle = all / one - 1.0;
                println!("{name:<26}{phase:<10}{one:>10.3}{all:>10.3}{share:>9.3}{idle:>8.3}");
            }
        }
    }
    Ok(())
}

fn main() -> ExitCode {
    match all() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
