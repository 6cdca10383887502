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

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> [Latent; 3] {
        [Bound::Lower(-1.0), Bound::Upper(2.0), Bound::Both(-1.0, 2.0)]
            .map(|bound: Bound<f64>| Latent::of(&bound).unwrap())
    }

    #[test]
    fn values_are_admissible_and_have_the_slope_of_their_difference_quotient() {
        for latent in all() {
            for psi in [-30.0, -3.0, -0.1, 0.0, 0.2, 5.0, 30.0] {
                let at = |psi| Latent { psi, ..latent };
                let (value, step) = (at(psi).value(), 1e-6);
                assert!(value >= latent.lower && value <= latent.upper, "{latent:?} {psi}");
                let quotient = (at(psi + step).value() - at(psi - step).value()) / (2.0 * step);
                let slope = at(psi).slope();
                let rounding = 1e-9 * (1.0 + value.abs());
                assert!((quotient - slope).abs() <= 1e-6 * slope + rounding, "{latent:?} {psi}");
            }
        }
    }

    #[test]
    fn a_value_gives_its_latent_variable_back() {
        for mut latent in all() {
            for value in [-0.999, -0.5, 0.4, 0.7, 1.9] {
                latent.set_value(value, 0.0);
                assert!((latent.value() - value).abs() < 1e-14, "{latent:?} {value}");
            }
            latent.set_value(latent.lower.max(-5.0), 1e-3);
            assert!(latent.gap() > 0.9e-3, "{latent:?}");
        }
        for bound in [Bound::Free, Bound::Fixed(1.0), Bound::Both(1.0, 1.0)] {
            assert!(Latent::of(&bound).is_none());
        }
    }

    /// From contact the gap grows to the given one, towards the bound there is no limit, and between two bounds a gap
    /// beyond the middle is one beyond the middle.
    #[test]
    fn a_change_away_from_the_bound_ends_at_the_largest_gap() {
        for latent in all() {
            for side in [1.0, -1.0] {
                let mut latent = Latent { psi: -20.0 * side, ..latent };
                if latent.side() != side {
                    continue;
                }
                latent.advance(1e4 * side, 0.25);
                assert!((latent.gap() - 0.25).abs() < 1e-15, "{latent:?}");
                latent.advance(-1e4 * side, 0.25);
                assert!(latent.gap() == 0.0 && latent.slope() == 0.0, "{latent:?}");
                latent.advance(2e4 * side, 1.6);
                let expected = if latent.has_two_bounds() { 1.4 } else { 1.6 };
                assert!((latent.gap() - expected).abs() < 0.01, "{latent:?}");
            }
        }
    }
}
