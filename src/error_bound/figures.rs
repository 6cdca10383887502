//! The figures of an error bound in a row of a report.

use std::fmt::Display;

use super::estimate::Unproven;
use super::{BoundParts, ErrorBound};

/// Effectivities that differ from one by less are one but for rounding.
const ROUNDING: f64 = 1e-8;

/// A true error that is smaller than this share of the energy norm of the solution is rounding, and its ratio to a bound
/// says nothing.
const ERROR_ROUNDING: f64 = 1e-8;

/// Effectivities of which a row says nothing, but for rounding: others have a warning.
const USUAL: std::ops::RangeInclusive<f64> = 1.0 - ROUNDING..=3.0;

/// Whether a bound is proven.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(untagged))]
pub enum Guaranteed {
    /// Whether all terms are proven.
    All(bool),
    /// The terms that are computed, or neglected, without proof.
    Except(Vec<Unproven>),
}

impl From<&[Unproven]> for Guaranteed {
    fn from(unproven: &[Unproven]) -> Self {
        match unproven {
            [] => Self::All(true),
            some => Self::Except(some.to_vec()),
        }
    }
}

/// The bound in figures; without a bound all are absent but the reason.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BoundFigures {
    /// Bound on the energy norm of `u - v`: [`ErrorBound::total`].
    pub total: Option<f64>,
    /// Distance of `v` from the discrete solution in the broken energy norm.
    pub distance: Option<f64>,
    /// True, or the terms that are not proven.
    pub guaranteed: Option<Guaranteed>,
    /// Parts of `total` squared.
    pub mismatch: Option<f64>,
    /// Complementarity of the obstacles.
    pub obstacle: Option<f64>,
    /// Complementarity of contact.
    pub contact: Option<f64>,
    /// Data oscillation.
    pub oscillation: Option<f64>,
    /// What the solver left.
    pub algebra: Option<f64>,
    /// `total` over the energy norm of `u - v`, where the exact solution is known and `v` is not exact but for
    /// rounding.
    pub effectivity: Option<f64>,
    /// Why there is no bound.
    pub reason: Option<String>,
}

impl BoundFigures {
    /// The figures of a bound, and the true error where it is known and more than rounding.
    #[must_use]
    pub fn new<E: Display>(bound: Result<&ErrorBound, E>, error: Option<f64>) -> Self {
        let bound = match bound {
            Ok(bound) => bound,
            Err(reason) => return Self { reason: Some(reason.to_string()), ..Self::default() },
        };
        let BoundParts { mismatch, obstacle, contact, oscillation, algebra } = bound.parts;
        Self {
            total: Some(bound.total),
            distance: Some(bound.distance),
            guaranteed: Some(bound.unproven[..].into()),
            mismatch: Some(mismatch),
            obstacle: Some(obstacle),
            contact: Some(contact),
            oscillation: Some(oscillation),
            algebra: Some(algebra),
            effectivity: error.map(|error| bound.total / error),
            reason: None,
        }
    }

    /// The figures of a bound and, unless it is rounding, of the true error of a solution with this energy norm.
    pub(crate) fn of_solution<E: Display>(
        bound: Result<&ErrorBound, E>,
        error: Option<f64>,
        energy_norm: f64,
    ) -> Self {
        Self::new(bound, error.filter(|error| *error > ERROR_ROUNDING * energy_norm))
    }

    /// Why the bound is below the true error or above three times that, where it is.
    pub(crate) fn remark(&self) -> Option<String> {
        let effectivity = self.effectivity.filter(|e| !USUAL.contains(e))?;
        if effectivity < *USUAL.start() {
            let unproven = match &self.guaranteed {
                Some(Guaranteed::Except(some)) => some.as_slice(),
                _ => &[],
            };
            let words: Vec<String> =
                unproven.iter().map(|term| format!("{term:?}").to_lowercase()).collect();
            let words = words.join(", ");
            return Some(format!(
                "the bound is {effectivity:.2} times the error; not proven: {words}"
            ));
        }
        let (share, part) = [
            (self.mismatch, "the flux, further from the solution than the function"),
            (self.obstacle, "the multiplier where the function is off the obstacle"),
            (self.contact, "the contact force where the function is off the gap"),
            (self.oscillation, "the oscillation of data and multiplier in cells"),
            (self.algebra, "what the solver left"),
        ]
        .into_iter()
        .filter_map(|(share, part)| Some((share?, part)))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
        let percent = 100.0 * share;
        Some(format!(
            "the bound is {effectivity:.1} times the error: {percent:.0} % of its square is {part}"
        ))
    }

    /// The bound on the broken energy norm of the error of the discrete solution: `total` and `distance`.
    pub fn of_broken_energy(&self) -> Option<f64> {
        self.total.zip(self.distance).map(|(total, distance)| total + distance)
    }
}
