//! Conforming P1, SIPG and WOPSIP side by side on an obstacle problem and on a Signorini problem.
//!
//! `cargo run --release --example wopsip_vs_sipg` prints one table for each problem, and writes tables and plots to
//! `target/`.

use unilateral::prelude::*;

/// The schemes on one problem with a known solution.
fn compare(scene: scenes::Scene<2>) -> Result<Report, Error> {
    Study::<2>::new(scene)
        .scheme(ConformingP1)
        .scheme(Sipg::default())
        .scheme(Wopsip::default())
        .levels([8, 16, 32, 64])
        .run()
}

fn main() -> Result<(), Error> {
    // a membrane that is pressed onto an obstacle; the contact set is a disc
    let mut report = compare(scenes::radial(1.0))?;
    // a body that rests on one side
    report.rows.extend(compare(scenes::signorini_2d())?.rows);
    print!("{report}");
    for file in report.write("target/wopsip_vs_sipg")? {
        println!("{}", file.display());
    }
    Ok(())
}
