//! Colours of numbers, and the numbers that are written beside them.

use crate::plot::pen::Colour;

/// Red, green and blue of the colours between which others are mixed, with evenly growing lightness.
const MIXED: [[f64; 3]; 3] = [[0.05, 0.1, 0.42], [0.15, 0.72, 0.55], [1.0, 0.95, 0.725]];

/// A colour for a number from 0 to 1: from dark blue over green to pale yellow. Its lightness grows evenly, so that the
/// picture reads the same in grey.
fn colour(share: f64) -> Colour {
    let from = usize::from(share >= 0.5);
    let part = 2.0 * share - from as f64;
    let channel = |k: usize| {
        let [low, high] = [MIXED[from][k], MIXED[from + 1][k]];
        (255.0 * (low + part * (high - low))).round() as u8
    };
    Colour(channel(0), channel(1), channel(2))
}

/// A scale of colours: bands between levels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    /// The ends of the bands, ascending.
    pub levels: Vec<f64>,
}

/// Fewest bands of a scale.
const BANDS: f64 = 10.0;

impl Scale {
    /// The scale over these numbers; none if there are none.
    pub fn over(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (low, high) = range(values)?;
        let step = round_step((high - low) / BANDS);
        let levels = if high - low <= 1e-12 * high.abs().max(low.abs()) {
            let half = 0.5 * high.abs().max(f64::MIN_POSITIVE);
            vec![low - half, high + half]
        } else {
            let first = (low / step + 1e-9).floor();
            let last = (high / step - 1e-9).ceil();
            (0..=(last - first) as i32).map(|k| (first + f64::from(k)) * step).collect()
        };
        Some(Scale { levels })
    }

    /// Number of bands.
    pub fn bands(&self) -> usize {
        self.levels.len() - 1
    }

    /// The band of a number; what is beyond the ends belongs to the last band before them.
    pub fn band(&self, value: f64) -> usize {
        self.levels[1..self.bands()].partition_point(|level| *level <= value)
    }

    /// The colour of a band.
    pub fn colour(&self, band: usize) -> Colour {
        colour((band as f64 + 0.5) / self.bands() as f64)
    }

    /// Position of a level on the bar: from 0 to 1.
    pub fn position(&self, level: f64) -> f64 {
        let (low, high) = (self.levels[0], self.levels[self.bands()]);
        (level - low) / (high - low)
    }
}

/// The smallest and the largest number.
fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let finite = values.filter(|v| v.is_finite());
    finite.fold(None, |known, v| match known {
        None => Some((v, v)),
        Some((low, high)) => Some((low.min(v), high.max(v))),
    })
}

/// The least length that is told from zero: powers of ten below it lose digits.
const LEAST: f64 = 1e-290;

/// The largest of 1, 2 and 5 times a power of ten that is not above a length; one for a length that is none.
pub(crate) fn round_step(length: f64) -> f64 {
    if !(length > LEAST && length.is_finite()) {
        return 1.0;
    }
    let power = 10.0_f64.powi(length.log10().floor() as i32);
    let digit = [5.0, 2.0].into_iter().find(|d| d * power <= length * (1.0 + 1e-9));
    digit.unwrap_or(1.0) * power
}

/// Numbers to be written on a linear axis: their places, their texts, and the power of ten by
/// which all are divided.
pub(crate) fn labels(low: f64, high: f64, most: usize) -> (Vec<(f64, String)>, i32) {
    let mut step = round_step((high - low) / most as f64);
    while (high / step).floor() - (low / step).ceil() + 1.0 > most as f64 {
        step = round_step(2.5 * step);
    }
    let largest = low.abs().max(high.abs());
    let magnitude = if largest > LEAST { largest.log10().floor() as i32 } else { 0 };
    let power = if (-2..4).contains(&magnitude) { 0 } else { magnitude };
    let unit = 10.0_f64.powi(power);
    let decimals = (-(step / unit).log10().floor()).max(0.0) as usize;
    let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    let text = |k: i64| {
        let value = k as f64 * step;
        (value, format!("{:.decimals$}", value / unit + 0.0).replace('-', "\u{2212}"))
    };
    ((first..=last).map(text).collect(), power)
}
