//! The entropies of one and of two bounds: values between bounds as functions of a latent variable.

use crate::algebra::Bound;
use crate::real::Real;

/// The bounds of an unknown and its latent variable `psi`, of which the value `u` is an increasing function:
///
/// | bounds | entropy | `u` |
/// |---|---|---|
/// | lower `l` | Boltzmann, Shannon | `l + exp(psi)` |
/// | upper `U` | the same | `U - exp(-psi)` |
/// | both | Fermi, Dirac | `l + (U - l) / (1 + exp(-psi))` |
///
/// The latent variable is kept, not the value: in contact the difference of value and bound has no digits, and the gap
/// follows from the latent variable with all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Latent {
    /// Minus infinity without a lower bound.
    lower: f64,
    /// Infinity without an upper bound.
    upper: f64,
    pub psi: f64,
}

impl Latent {
    /// The latent variable zero of an unknown that is not fixed; `None` without bounds.
    pub fn of<T: Real>(bound: &Bound<T>) -> Option<Self> {
        let is_bounded = bound.is_inequality() && bound.fixed_value().is_none();
        let [lower, upper] = bound.interval();
        is_bounded.then_some(Self { lower, upper, psi: 0.0 })
    }

    fn width(&self) -> f64 {
        self.upper - self.lower
    }

    fn has_two_bounds(&self) -> bool {
        self.width().is_finite()
    }

    /// 1 if the lower bound is nearer, -1 if the upper one is: the direction away from the nearer bound.
    fn side(&self) -> f64 {
        let is_lower = if self.has_two_bounds() { self.psi <= 0.0 } else { self.lower.is_finite() };
        if is_lower { 1.0 } else { -1.0 }
    }

    /// The distance from the nearer bound.
    pub fn gap(&self) -> f64 {
        let towards = self.side() * self.psi;
        match self.has_two_bounds() {
            true => self.width() / (1.0 + (-towards).exp()),
            false => towards.exp(),
        }
    }

    pub fn value(&self) -> f64 {
        if self.side() > 0.0 { self.lower + self.gap() } else { self.upper - self.gap() }
    }

    /// The derivative of the value with respect to the latent variable.
    pub fn slope(&self) -> f64 {
        let gap = self.gap();
        if self.has_two_bounds() { gap * (1.0 - gap / self.width()) } else { gap }
    }

    /// The latent variable, times [`Latent::side`], with this gap; beyond the middle between two bounds its tangent
    /// there.
    fn of_gap(&self, gap: f64) -> f64 {
        let half = 0.5 * self.width();
        match self.has_two_bounds() {
            false => gap.ln(),
            true if gap <= half => (gap / (self.width() - gap)).ln(),
            true => 2.0 * (gap - half) / half,
        }
    }

    /// Sets the latent variable to that of a value, or of a value with the gap `least` if it is nearer to a bound.
    pub fn set_value(&mut self, value: f64, least: f64) {
        let (above, below) = (value - self.lower, self.upper - value);
        let side = if above <= below { 1.0 } else { -1.0 };
        let gap = above.min(below).max(least).min(0.5 * self.width());
        self.psi = side * self.of_gap(gap);
    }

    /// Changes the latent variable. Away from the nearer bound it goes at most to that with the gap `most`.
    pub fn advance(&mut self, change: f64, most: f64) {
        let side = self.side();
        let furthest = self.of_gap(most).max(side * self.psi);
        self.psi = side * (side * (self.psi + change)).min(furthest);
    }
}
