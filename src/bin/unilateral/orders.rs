//! Every scheme on every scene, with observed orders beside those that theory promises:
//!
//! ```text
//! cargo run --release -- orders docs/orders.md
//! ```
//!
//! Without a file the table goes to standard output. A word after the file picks the scenes whose
//! names contain it; `--quick` halves the levels. Exit codes: 0, or 1 if the work ended in an error,
//! 2 if the request was wrong.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use unilateral::prelude::{Report, Study};
use unilateral::scenes::{AnyScene, Parameters, Scene, catalogue};
use unilateral::scheme::{SCHEMES, SchemeOptions, scheme_by_name};
use unilateral::study::orders_table;
use unilateral::study::{Program, Row};

use crate::shared::{ORDER_TOLERANCE, Request, complain, print, write};

/// Sets observed orders beside those that theory promises, every scheme on every scene
#[derive(Args, Debug)]
pub struct Options {
    /// Where the table goes, in Markdown; standard output by default
    file: Option<PathBuf>,
    /// Only scenes whose names contain this
    #[arg(value_name = "WORD")]
    pattern: Option<String>,
    /// Half the levels
    #[arg(long)]
    quick: bool,
}

/// Whether the work came to its end.
pub fn run(options: &Options) -> Request<bool> {
    match make(options) {
        Ok(()) => Ok(true),
        Err(error) => {
            complain(&error.to_string());
            Ok(false)
        }
    }
}

fn make(options: &Options) -> Result<(), Box<dyn Error>> {
    let quick = options.quick;
    let mut rows = Vec::new();
    for entry in catalogue() {
        if options.pattern.as_ref().is_some_and(|pattern| !entry.name.contains(pattern)) {
            continue;
        }
        eprintln!("{}", entry.name);
        for degree in [1, 2] {
            rows.extend(match entry.make(&Parameters::default())? {
                AnyScene::One(scene) => study(scene, degree, quick)?,
                AnyScene::Two(scene) => study(scene, degree, quick)?,
                AnyScene::Three(scene) => study(scene, degree, quick)?,
            });
        }
    }
    let program = Program::new("orders", "f64", rayon::current_num_threads(), 1);
    let report = Report::new(program, rows);
    let table = orders_table(&report.observed_orders(), ORDER_TOLERANCE);
    match &options.file {
        Some(file) => write(file, page(&table, &report))?,
        None => print(&table)?,
    }
    Ok(())
}

/// All schemes of a degree on a scene, quadratics on coarser levels: they have more unknowns.
fn study<const D: usize>(
    scene: Scene<D>,
    degree: usize,
    quick: bool,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let finest = match D {
        1 => 64,
        2 => 32 / degree,
        _ => 8 / degree,
    };
    let finest = if quick { finest / 2 } else { finest };
    let levels = [4, 2, 1].map(|part| finest / part).into_iter().filter(|&n| n > 0);
    let options = SchemeOptions::default();
    let names = SCHEMES.iter().filter(|(name, _)| name.ends_with("p2") == (degree == 2));
    let schemes = names.filter_map(|(name, _)| scheme_by_name::<f64, D>(name, &options));
    let study = Study::<f64, D>::new(scene).levels(levels);
    Ok(schemes.fold(study, Study::boxed_scheme).run()?.rows)
}

/// The table with what made it and what its words mean.
fn page(table: &str, report: &Report) -> String {
    format!(
        "# Observed and promised orders\n\n\
         Made by `cargo run --release -- orders docs/orders.md`, version {}, with the \
         default penalties and constraint sets. The orders of coarse levels are those of coarse \
         levels: a promise is for small mesh sizes, so `missed` here means not yet reached, or \
         missed, and finer levels tell which (`compare --scene S --scheme A --levels 32,64,128`).\n\n\
         Levels that end with another word than `converged` did so for a reason: \
         `iteration-limit`, the active set did not settle; `cycling`, it came back to where it was; \
         `stalled`, rounding keeps the certificate above its limit; `not-coercive`, the matrix is \
         not positive definite; `singular`, nothing holds the body, or rounding hides what does; `infeasible`, no function lies \
         between the bounds; `not-finite`, a number was not; \
         `malformed`, matrix and data do not fit; `out-of-memory`, the factors were too large. See `inequality::Outcome`.\n\n{table}",
        report.program.version
    )
}
