//! Numbers of twice the digits of `f64`, and symmetric systems in them.

use std::ops::{Add, Div, Mul, Sub};

/// The unevaluated sum of two numbers, the second below the rounding of the first (T. J. Dekker, Numer. Math.
/// 18 (1971) 224-242).
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Double {
    pub high: f64,
    low: f64,
}

impl Double {
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// The exact sum of two numbers.
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let part = high - a;
        Self { high, low: (a - (high - part)) + (b - part) }
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let sum = Self::sum(high.high, high.low + low.high);
        Self::sum(sum.high, sum.low + low.low)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self { high: -other.high, low: -other.low }
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let rest = self.high.mul_add(other.high, -product);
        Self::sum(product, rest + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = Self::from(self.high / other.high);
        let second = Self::from((self - first * other).high / other.high);
        let third = Self::from((self - first * other - second * other).high / other.high);
        first + second + third
    }
}

/// The lower triangle of a symmetric positive definite matrix by rows, each from its first entry on.
pub struct Envelope {
    firsts: Vec<usize>,
    rows: Vec<Vec<Double>>,
}

impl Envelope {
    /// The zero matrix whose rows begin in the given columns.
    pub fn new(firsts: Vec<usize>) -> Self {
        let row = |(i, &first): (usize, &usize)| vec![Double::ZERO; i + 1 - first];
        let rows = firsts.iter().enumerate().map(row).collect();
        Self { firsts, rows }
    }

    /// Adds to an entry of the lower triangle; one above the diagonal is left out.
    pub fn add(&mut self, i: usize, j: usize, value: Double) {
        if j <= i {
            let entry = &mut self.rows[i][j - self.firsts[i]];
            *entry = *entry + value;
        }
    }

    /// Replaces the matrix by its factors `L D L^T`, `D` on the diagonal of `L`.
    pub fn factor(&mut self) {
        for i in 0..self.rows.len() {
            let (above, row) = self.rows.split_at_mut(i);
            let (row, first) = (&mut row[0], self.firsts[i]);
            let mut pivot = row[i - first];
            // row becomes L D
            for j in first..i {
                let (other, start) = (&above[j], self.firsts[j]);
                let common = first.max(start);
                let mut entry = row[j - first];
                for k in common..j {
                    entry = entry - row[k - first] * other[k - start];
                }
                row[j - first] = entry;
            }
            for j in first..i {
                let scaled = row[j - first] / above[j][j - self.firsts[j]];
                pivot = pivot - scaled * row[j - first];
                row[j - first] = scaled;
            }
            assert!(pivot.high > 0.0, "pivot {i}: {pivot:?}");
            row[i - first] = pivot;
        }
    }

    /// Solves a system by the factors.
    pub fn solve(&self, x: &mut [Double]) {
        for i in 0..x.len() {
            let first = self.firsts[i];
            for j in first..i {
                x[i] = x[i] - self.rows[i][j - first] * x[j];
            }
        }
        for (x, row) in x.iter_mut().zip(&self.rows) {
            *x = *x / row[row.len() - 1];
        }
        for i in (0..x.len()).rev() {
            let first = self.firsts[i];
            for j in first..i {
                x[j] = x[j] - self.rows[i][j - first] * x[i];
            }
        }
    }
}
