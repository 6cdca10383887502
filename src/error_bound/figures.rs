//! The figures of an error bound in a row of a report.

use std::fmt::Display;

use super::estimate::Unproven;
use super::{BoundTerms, ErrorBound};
use crate::measure::Rounding;

/// Effectivities that differ from one by less are one but for rounding.
const ROUNDING: f64 = 1e-8;

/// A true error that is smaller than this share of the energy norm of the solution is rounding, and its ratio to a bound
/// says nothing.
const ERROR_ROUNDING: f64 = 1e-8;

/// Effectivities of which a row says nothing, but for rounding: others have a warning.
const USUAL: std::ops::RangeInclusive<f64> = 1.0 - ROUNDING..=3.0;

/// How far the rules that integrate errors may be from them, as a share: no bound is said to be wrong by less.
const OF_RULES: f64 = 1e-4;

/// The bound in figures; without a bound all are absent but the reason.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BoundFigures {
    /// Bound on the energy norm of `u - v`: [`ErrorBound::total`].
    pub total: Option<f64>,
    /// Distance of `v` from the discrete solution in the broken energy norm.
    pub distance: Option<f64>,
    /// Bound on the error of the discrete solution in the broken energy norm: [`ErrorBound::discrete`].
    pub discrete: Option<f64>,
    /// Whether all terms are proven.
    pub guaranteed: Option<bool>,
    /// The terms that are computed, or neglected, without proof.
    pub unproven: Option<Vec<Unproven>>,
    /// The share of the square of `total` that `alpha grad v` less the flux has; the next four are the other shares.
    pub mismatch: Option<f64>,
    /// Complementarity of the obstacles.
    pub obstacle: Option<f64>,
    /// Complementarity of contact.
    pub contact: Option<f64>,
    /// Data oscillation.
    pub oscillation: Option<f64>,
    /// The residual that the solver left.
    pub algebra: Option<f64>,
    /// `discrete` over the error of the discrete solution in the broken energy norm, where it is known and more than
    /// rounding.
    pub effectivity: Option<f64>,
    /// `total` over the energy norm of `u - v`, likewise.
    pub effectivity_of_v: Option<f64>,
    /// Whether `discrete` exceeds the energy norm of the discrete solution: such a bound says nothing.
    pub exceeds_norm: Option<bool>,
    /// Why there is no bound.
    pub reason: Option<String>,
}

impl BoundFigures {
    /// The figures of a bound, and the true errors of the discrete solution and of `v` where they are known and more
    /// than rounding.
    #[must_use]
    pub fn new<E: Display>(bound: Result<&ErrorBound, E>, errors: TrueErrors) -> Self {
        let bound = match bound {
            Ok(bound) => bound,
            Err(reason) => return Self { reason: Some(reason.to_string()), ..Self::default() },
        };
        let BoundTerms { mismatch, obstacle, contact, oscillation, algebra } = bound.terms;
        Self {
            total: Some(bound.total),
            distance: Some(bound.distance),
            discrete: Some(bound.discrete),
            guaranteed: Some(bound.is_guaranteed()),
            unproven: Some(bound.unproven.clone()),
            mismatch: Some(mismatch),
            obstacle: Some(obstacle),
            contact: Some(contact),
            oscillation: Some(oscillation),
            algebra: Some(algebra),
            effectivity: errors.of_solution.map(|error| bound.discrete / error),
            effectivity_of_v: errors.of_v.map(|error| bound.total / error),
            exceeds_norm: None,
            reason: None,
        }
    }

    /// The figures of a bound and, unless they are rounding, of the true errors for a solution with this energy norm
    /// and these rounding errors.
    pub(crate) fn of_solution<E: Display>(
        bound: Result<&ErrorBound, E>,
        TrueErrors { of_solution, of_v }: TrueErrors,
        (energy_norm, rounding): (f64, Option<Rounding>),
    ) -> Self {
        let rounding = rounding.and_then(|rounding| rounding.error.broken_energy).unwrap_or(0.0);
        let least = rounding.max(ERROR_ROUNDING * energy_norm);
        let known = |error: Option<f64>| error.filter(|error| *error > least);
        let errors = TrueErrors { of_solution: known(of_solution), of_v: known(of_v) };
        let figures = Self::new(bound, errors);
        let exceeds_norm = figures.discrete.map(|bound| bound > energy_norm);
        Self { exceeds_norm, ..figures }
    }

    /// The names of the terms that are not proven.
    pub(crate) fn unproven_words(&self) -> String {
        let terms = self.unproven.as_deref().unwrap_or_default();
        let words: Vec<String> =
            terms.iter().map(|term| format!("{term:?}").to_lowercase()).collect();
        words.join(", ")
    }

    /// Why the bound on the discrete solution is below its error against `against` or above three times that, where
    /// it is.
    pub(crate) fn remark(&self, against: Option<&str>) -> Option<String> {
        let effectivity = self.effectivity.filter(|e| !USUAL.contains(e))?;
        if effectivity < *USUAL.start() {
            return match (self.guaranteed, against) {
                (Some(true), _) if effectivity > 1.0 - OF_RULES => None,
                (Some(true), Some("exact")) => Some(format!(
                    "the stated solution does not solve this problem: its distance from the discrete solution is {:.2} times a guaranteed bound on the error",
                    1.0 / effectivity
                )),
                (Some(true), _) => Some(format!(
                    "the distance from the reference is {:.2} times a guaranteed bound on the error: the reference is less accurate",
                    1.0 / effectivity
                )),
                _ => Some(format!(
                    "the bound is {effectivity:.2} times the error; not proven: {}",
                    self.unproven_words()
                )),
            };
        }
        let start = format!("the bound is {effectivity:.1} times the error");
        if self.distance > self.total {
            return Some(format!("{start}: the admissible function is far from the solution"));
        }
        let (share, term) = [
            (self.mismatch, "the flux, further from the solution than the function"),
            (self.obstacle, "the multiplier where the function is off the obstacle"),
            (self.contact, "the contact force where the function is off the gap"),
            (self.oscillation, "the oscillation of data and multiplier in cells"),
            (self.algebra, "what the solver left"),
        ]
        .into_iter()
        .filter_map(|(share, term)| Some((share?, term)))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(format!("{start}: {:.0} % of the square of `total` is {term}", 100.0 * share))
    }
}

/// True errors beside a bound, where they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrueErrors {
    /// That of the discrete solution in the broken energy norm.
    pub of_solution: Option<f64>,
    /// That of the admissible function `v` in the energy norm.
    pub of_v: Option<f64>,
}
