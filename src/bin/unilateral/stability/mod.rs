//! Stability of schemes in hard cases: rounding, penalty factors, stretched and graded meshes,
//! contrast, coercivity, curved obstacles, biactive sets, units, contact ends, orders, slivers.
//!
//! ```text
//! cargo run --release -- stability --quick
//! ```
//!
//! ends within a minute, without `--quick` within fifteen. The report is written as rows are
//! finished; a run that is interrupted leaves the rows it has.

mod options;

pub use options::Options;

use crate::asked::command;
use crate::mesh_file::MeshFile;
use crate::one_run::take_directory;
use crate::shared::{Failure, bar, end_at_interrupt, print, tick, use_threads, warn};
use unilateral::stability::{Effort, Stability, Verdict};

/// Runs the study; false if a job ended in an error, or with `--strict` if a criterion was missed.
pub fn run(options: &Options) -> Result<bool, Failure> {
    use_threads(options.threads.map(usize::from))?;
    let bar = bar(options.quiet, "{spinner} {elapsed}: {msg}");
    tick(&bar);
    let mut study = Stability::new(if options.quick { Effort::Quick } else { Effort::Full })
        .cases(options.cases.clone())
        .schemes(options.schemes.clone())
        .command(command())
        .write_to(&options.out)
        .observer(|case, scheme| bar.set_message(format!("{case}, {scheme}")));
    let warn = |warning: String| {
        if !options.quiet {
            warn(&warning);
        }
    };
    for path in &options.meshes {
        let of = MeshFile { path: Some(path.clone()), boundary: options.boundary.clone() };
        let file = of.read()?.expect("a file with a path has contents");
        let mesh = of.mesh::<3>(&file, &warn)?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        study = study.mesh(&name.unwrap_or_default(), mesh);
    }
    study.check().map_err(|e| e.to_string())?;
    take_directory(&options.out)?;
    end_at_interrupt("the report has the rows so far and is not complete")?;
    let report = study.run().map_err(Failure::of_work)?;
    bar.finish_and_clear();
    if !options.quiet {
        print(&report.summary())?;
        print(&format!("\nReports are in {}\n", options.out.display()))?;
    }
    let is_missed = report.count(Verdict::Missed) > 0;
    Ok(report.failures.is_empty() && !(options.strict && is_missed))
}
