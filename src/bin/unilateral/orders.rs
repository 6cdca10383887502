//! Every scheme on every scene, with observed orders beside those that theory promises:
//!
//! ```text
//! cargo run --release -- orders target/orders.md --summary target/orders-summary.md
//! ```
//!
//! Without a file the table goes to standard output. A word after the file picks the scenes whose
//! names contain it; `--quick` halves the levels. Exit codes: 0, or 1 if the work ended in an error,
//! 2 if the request was wrong.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use unilateral::prelude::{Report, Study};
use unilateral::real::Real;
use unilateral::scenes::{AnyScene, Parameters, Scene, catalogue};
use unilateral::scheme::{SCHEMES, SchemeOptions, scheme_by_name};
use unilateral::study::{Program, Row, orders_summary, orders_table};

use crate::shared::{ORDER_TOLERANCE, Request, complain, print, write};

/// Sets observed orders beside those that theory promises, every scheme on every scene
#[derive(Args, Debug)]
pub struct Options {
    /// Where the table goes, in Markdown; standard output by default
    file: Option<PathBuf>,
    /// Only scenes whose names contain this
    #[arg(value_name = "WORD")]
    pattern: Option<String>,
    /// Also write how many promises each scheme keeps, and those that it misses
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,
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
    let program = Program::new("orders", f64::NAME, rayon::current_num_threads(), 1);
    let observed = Report::new(program, rows).observed_orders();
    let table = orders_table(&observed, ORDER_TOLERANCE);
    match &options.file {
        Some(file) => write(file, table)?,
        None => print(&table)?,
    }
    match &options.summary {
        Some(file) => Ok(write(file, orders_summary(&observed, ORDER_TOLERANCE))?),
        None => Ok(()),
    }
}

/// All schemes of a degree on a scene, on five levels, in space on four; quadratics on coarser ones,
/// since they have more unknowns.
fn study<const D: usize>(
    scene: Scene<D>,
    degree: usize,
    quick: bool,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let levels: &[usize] = match (D, degree) {
        (1, _) => &[16, 32, 64, 128, 256],
        (2, 1) => &[8, 16, 32, 64, 128],
        (2, _) => &[4, 8, 16, 32, 64],
        (_, 1) => &[2, 4, 8, 16],
        _ => &[2, 4, 6, 8],
    };
    let levels = levels.iter().map(|level| if quick { level / 2 } else { *level });
    let options = SchemeOptions::default();
    let names = SCHEMES.iter().filter(|(name, _)| name.ends_with("p2") == (degree == 2));
    let schemes = names.filter_map(|(name, _)| scheme_by_name::<f64, D>(name, &options));
    let study = Study::<f64, D>::new(scene).levels(levels);
    Ok(schemes.fold(study, Study::boxed_scheme).run()?.rows)
}
