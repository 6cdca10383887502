//! From a Signorini problem to the contact force: a parabola pressed into a half plane, whose pressure is that of
//! Hertz, `sqrt(1/4 - x^2)` on the segment from -1/2 to 1/2, with the total force `pi / 8`.
//!
//! `cargo run --release --example contact_force` writes a picture and fields for ParaView to
//! `target/contact_force`.

use unilateral::plot::Picture;
use unilateral::prelude::*;

fn main() -> Result<(), Error> {
    let hertz = scenes::hertz_2d();
    println!(
        "exact: force {:.5}, largest pressure 0.500, contact length 1",
        std::f64::consts::PI / 8.0
    );
    let schemes: [Box<dyn Scheme<2>>; 3] =
        [Box::new(ConformingP1), Box::new(Sipg::default()), Box::new(ConformingP2)];
    for level in [8, 16, 32] {
        let meshes = Hierarchy::of_domain(&hertz.domain, level)?;
        let mut nested = NestedIteration::new(&hertz.problem, &meshes);
        for scheme in &schemes {
            let u = nested.solve(&**scheme)?;
            let (force, length) =
                (u.resultant().unwrap_or(0.0), u.contact_measure().unwrap_or(0.0));
            let Some(fields) = u.fields() else { continue };
            let largest = fields.pressure.iter().fold(0.0_f64, |a, &b| a.max(b));
            let gap = fields.gap.iter().fold(0.0_f64, |a, &b| a.max(b));
            print!(
                "{level:2} {:4}: force {force:.5}, largest pressure {largest:.3}, ",
                scheme.name()
            );
            println!("contact length {length:.3}, largest gap {gap:.3}");
            u.write_vtu(format!("target/contact_force/{}-{level}.vtu", scheme.name()))?;
            if (level, scheme.name()) == (8, "p1") {
                let title = "parabola pressed into a half plane, p1";
                let picture = Picture::of(title, &hertz.problem, u.mesh(), &fields)?;
                picture.write("target/contact_force".as_ref(), "hertz")?;
            }
        }
    }
    Ok(())
}
