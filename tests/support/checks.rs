//! Checks that gather what disagrees.

/// What disagrees, gathered so that one run shows all of it.
#[derive(Default)]
pub struct Checks {
    done: usize,
    failed: Vec<String>,
}

impl Checks {
    /// Notes a condition that does not hold.
    pub fn that(&mut self, holds: bool, message: impl FnOnce() -> String) {
        self.done += 1;
        if !holds {
            self.failed.push(message());
        }
    }
    /// The figure is what is printed, to this many units of the last printed digit; half a unit is
    /// what rounding to that digit allows. Shows both with `--nocapture`.
    pub fn printed(&mut self, what: &str, ours: f64, printed: &str, units: f64) {
        println!("{what}: {ours:.6e}, in print {printed}");
        let (theirs, unit) = figure(printed);
        let off = (ours - theirs) / unit;
        self.that(off.abs() <= units * (1.0 + 1e-9), || {
            format!("{what}: {ours:.6e} against {printed}, {off:+.2} units of the last digit")
        });
    }
    /// Fails with everything that disagrees, or if nothing was checked at all.
    pub fn finish(self) {
        assert!(self.done > 0, "nothing was checked");
        let Self { done, failed } = self;
        assert!(
            failed.is_empty(),
            "{} of {done} do not hold:\n{}",
            failed.len(),
            failed.join("\n")
        );
    }
}

/// A printed figure and the unit of its last digit.
pub fn figure(printed: &str) -> (f64, f64) {
    let (mantissa, exponent) = printed.split_once('e').unwrap_or((printed, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len()) as i32;
    let exponent: i32 = exponent.parse().unwrap();
    (printed.parse().unwrap(), 10_f64.powi(exponent - decimals))
}
