//! Stability of schemes in hard cases: rounding, penalty factors, stretched and graded meshes,
//! contrast, coercivity, curved obstacles, biactive sets, units, contact ends, orders, slivers.
//!
//! ```text
//! cargo run --release --example stability -- --quick
//! ```
//!
//! ends within a minute, without `--quick` within fifteen. The report is written as rows are
//! finished; a run that is interrupted leaves the rows it has. Exit codes: 0; 1 if work ended in an
//! error, or with `--strict` if a criterion was missed; 2 if the request was wrong.

use std::fs;
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

#[path = "stability/options.rs"]
mod options;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use options::Options;
use unilateral::mesh::gmsh;
use unilateral::stability::{Effort, Stability, StabilityProgress, Verdict};

fn main() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            let _ = writeln!(std::io::stderr(), "error: {message}");
            ExitCode::from(2)
        }
    }
}

/// Prints; whoever closed the pipe wants no more.
fn print(text: &str) -> Result<(), String> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(format!("cannot print: {e}")),
        _ => Ok(()),
    }
}

/// The name of a file without its directory.
fn name_of(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// A path as it was given; of an absolute one, which says nothing elsewhere, its last part.
fn shown(path: &Path) -> String {
    if path.is_relative() { path.display().to_string() } else { name_of(path) }
}

/// Whether all went as asked.
fn run(options: &Options) -> Result<bool, String> {
    if let Some(threads) = options.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        pool.build_global().map_err(|e| format!("--threads {threads}: {e}"))?;
    }
    let bar = bar(options);
    let mut study = Stability::new(options.effort())
        .cases(options.cases.clone())
        .schemes(options.schemes.clone())
        .write_to(&options.out)
        .observer(|progress| match progress {
            StabilityProgress::Planned(n) => bar.set_length(n as u64),
            StabilityProgress::Started(case, label) => bar.set_message(format!("{case}: {label}")),
            StabilityProgress::Row(_) => {}
            StabilityProgress::Finished => bar.inc(1),
        });
    for path in &options.meshes {
        let mesh = gmsh::read::<f64, 3>(path).map_err(|e| format!("{}: {e}", path.display()))?;
        study = study.mesh(&name_of(path), mesh.mesh);
    }
    let report = study.run().map_err(|e| e.to_string())?;
    bar.finish_and_clear();
    if let Some(path) = &options.markdown {
        let named: Vec<String> = options.meshes.iter().map(|path| shown(path)).collect();
        let meshes = match named.is_empty() {
            true => String::new(),
            false => format!(" --mesh {}", named.join(",")),
        };
        let title = "# Stability\n";
        let quick = if options.effort() == Effort::Full { "" } else { " --quick" };
        let command =
            format!("cargo run --release --example stability --{quick} --markdown FILE{meshes}");
        let text =
            report.to_markdown().replacen(title, &format!("{title}\nMade by `{command}`.\n"), 1);
        fs::write(path, text).map_err(|e| format!("cannot write {}: {e}", path.display()))?;
    }
    if !options.quiet {
        print(&report.summary())?;
        print(&format!("\nReports are in {}\n", options.out.display()))?;
    }
    let is_missed = report.count(Verdict::Missed) > 0;
    Ok(report.failures.is_empty() && !(options.strict && is_missed))
}

/// A bar on a terminal, nothing elsewhere.
fn bar(options: &Options) -> ProgressBar {
    if options.quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let template = "{bar:24} {pos} of {len}, {elapsed}, {eta} to go: {msg}";
    let bar = ProgressBar::new(0);
    bar.enable_steady_tick(Duration::from_millis(200));
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
