//! The program of the README: three schemes on an obstacle problem, with table and picture.

use unilateral::prelude::*;

fn main() -> Result<(), Error> {
    let report = Study::<f64, 2>::new(scenes::radial(1.0))
        .scheme(ConformingP1)
        .scheme(Sipg::default())
        .scheme(Wopsip::default())
        .levels([8, 16, 32, 64])
        .run()?;
    print!("{report}");
    report.write("target/obstacle")?;
    Ok(())
}
