//! Logarithmic axes and their ticks.

/// A logarithmic axis: exponents of ten at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LogAxis {
    pub low: f64,
    pub high: f64,
}

/// A tick: a digit times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tick {
    pub digit: u32,
    pub exponent: i32,
    /// Whether its value is written.
    pub labelled: bool,
}

impl Tick {
    /// The logarithm of the tick.
    pub fn log(self) -> f64 {
        f64::from(self.digit).log10() + f64::from(self.exponent)
    }

    /// The label: a plain number, or a digit and a power of ten as in `2e-7`.
    pub fn label(self, plain: bool) -> String {
        let (d, e) = (self.digit, self.exponent);
        let zeros = e.unsigned_abs() as usize;
        match plain {
            true if e >= 0 => format!("{d}{}", "0".repeat(zeros)),
            true => format!("{:.zeros$}", f64::from(d) * 10.0_f64.powi(e)),
            false => format!("{d}e{e}").replace('-', "\u{2212}"),
        }
    }
}

impl LogAxis {
    /// An axis that shows positive values with some room around them, over a decade at least.
    pub fn over(values: &[f64]) -> Self {
        let logs = values.iter().map(|v| v.log10());
        let (low, high) =
            logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return LogAxis { low: -1.0, high: 0.0 };
        }
        let room = (0.07 * (high - low)).max((1.0 - (high - low)) / 2.0);
        LogAxis { low: low - room, high: high + room }
    }

    /// Whether all labels are plain numbers; else all are powers of ten.
    pub fn is_plain(&self) -> bool {
        self.low > -3.5 && self.high < 4.0
    }

    /// Position of a logarithm on the axis: 0 at the low end, 1 at the high end.
    pub fn position(&self, log: f64) -> f64 {
        (log - self.low) / (self.high - self.low)
    }

    /// Ticks within the axis: powers of ten, labelled as far as `most` labels go; between them the
    /// digits, of which 2 and 5 are labelled where there are fewer than two powers.
    pub fn ticks(&self, most: usize) -> Vec<Tick> {
        let (first, last) = (self.low.ceil() as i32, self.high.floor() as i32);
        let powers = usize::try_from(last - first + 1).unwrap_or(0);
        let step = powers.div_ceil(most.max(1)).max(1) as i32;
        let mut ticks = Vec::new();
        for exponent in first - 1..=last {
            for digit in 1..=9 {
                let labelled = match digit {
                    1 => exponent.rem_euclid(step) == 0,
                    2 | 5 => powers < 2,
                    _ => false,
                };
                let tick = Tick { digit, exponent, labelled };
                let inside = (self.low..=self.high).contains(&tick.log());
                // digits between many powers would merge into a grey bar
                if inside && (digit == 1 || powers <= 6) {
                    ticks.push(tick);
                }
            }
        }
        ticks
    }
}
