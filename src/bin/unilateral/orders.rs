//! Every scheme on every scene, with observed orders beside those that theory promises:
//!
//! ```text
//! cargo run --release -- orders target/orders.md --summary target/orders-summary.md
//! ```
//!
//! Without a file the table goes to standard output. A word after the file picks the scenes whose
//! names contain it; `--quick` halves the levels.

use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use unilateral::in_its_dimension;
use unilateral::input::excerpt;
use unilateral::prelude::{Report, Study};
use unilateral::scenes::{Parameters, Scene, catalogue};
use unilateral::scheme::NamedScheme;
use unilateral::study::{ObservedOrders, Program, Row, orders_summary, orders_table};

use crate::asked::{MESHES, OUTPUT, PROBLEM, SCHEMES};
use crate::shared::{
    Failure, ORDER_TOLERANCE, Request, check_writable, end_at_interrupt, print, schemes, write,
};

const EXAMPLES: &str = "\
Examples:
  unilateral orders orders.md radial-2d --scheme p1,sipg,wopsip
  unilateral orders --quick orders.md --summary summary.md";

/// Sets observed orders beside those that theory promises, every scheme on every scene
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Where the table goes, in Markdown; standard output by default
    #[arg(help_heading = OUTPUT)]
    file: Option<PathBuf>,
    /// Only scenes whose names contain this
    #[arg(help_heading = PROBLEM, value_name = "WORD")]
    pattern: Option<String>,
    /// Schemes as NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]]; all by default
    #[arg(help_heading = SCHEMES, long = "scheme", value_delimiter = ',', value_name = "A[,B...]")]
    schemes: Vec<String>,
    /// Also write how many promises each scheme keeps, and those that it misses
    #[arg(help_heading = OUTPUT, long, value_name = "FILE")]
    summary: Option<PathBuf>,
    /// Half the levels
    #[arg(help_heading = MESHES, long)]
    quick: bool,
}

/// Whether the work came to its end.
pub fn run(options: &Options) -> Result<bool, Failure> {
    let schemes = schemes(&options.schemes, &["all"])?;
    let names: Vec<String> = catalogue().into_iter().map(|entry| entry.name).collect();
    if let Some(pattern) =
        options.pattern.as_ref().filter(|p| !names.iter().any(|n| n.contains(*p)))
    {
        let (pattern, names) = (excerpt(pattern), names.join(", "));
        return Err(format!("no scene has {pattern} in its name; there are: {names}").into());
    }
    check_writable(options.file.iter().chain(&options.summary))?;
    end_at_interrupt("the table has the scenes so far")?;
    make(options, &schemes).map_err(Failure::of_work)?;
    Ok(true)
}

fn make(options: &Options, schemes: &[NamedScheme]) -> Result<(), Box<dyn Error>> {
    let quick = options.quick;
    let program = Program::new("orders", "f64", rayon::current_num_threads(), 1);
    let mut report = Report::new(program, Vec::new());
    for entry in catalogue() {
        if options.pattern.as_ref().is_some_and(|pattern| !entry.name.contains(pattern)) {
            continue;
        }
        eprintln!("{}", entry.name);
        for degree in [1, 2] {
            let is_of_degree = |s: &&NamedScheme| s.name().ends_with("p2") == (degree == 2);
            let schemes: Vec<&NamedScheme> = schemes.iter().filter(is_of_degree).collect();
            if schemes.is_empty() {
                continue;
            }
            let scene = entry.make(&Parameters::default())?;
            let rows = in_its_dimension!(scene, |scene| study(scene, &schemes, degree, quick))?;
            report.rows.extend(rows);
        }
        save(options, &report.observed_orders())?;
    }
    if options.file.is_none() {
        print(&orders_table(&report.observed_orders(), ORDER_TOLERANCE))?;
    }
    Ok(())
}

/// Writes the files that are asked for.
fn save(options: &Options, observed: &[ObservedOrders]) -> Request<()> {
    if let Some(file) = &options.file {
        write(file, orders_table(observed, ORDER_TOLERANCE))?;
    }
    match &options.summary {
        Some(file) => write(file, orders_summary(observed, ORDER_TOLERANCE)),
        None => Ok(()),
    }
}

/// Schemes of a degree on a scene, on five levels, in space on four; quadratics on coarser ones,
/// since they have more unknowns.
fn study<const D: usize>(
    scene: Scene<D>,
    schemes: &[&NamedScheme],
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
    let study = Study::<D>::new(scene).levels(levels);
    let study = schemes.iter().fold(study, |study, scheme| study.named_scheme(scheme));
    study.check_memory()?;
    Ok(study.run()?.rows)
}
