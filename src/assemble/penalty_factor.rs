//! Penalty factors that make no penalty.

use super::discretisation::Discretisation;
use super::penalised_matrix::keeps_penalty_apart;
use super::space::Space;
use crate::error::Error;
use crate::facet::FacetForm;
use crate::real::Precision;

impl<const D: usize> Space<'_, D> {
    /// Refuses a factor that the form [states](crate::facet::FormTheory) and that is not positive and
    /// finite, or that makes a penalty too far from the stiffness beside it: beyond the reciprocal of
    /// the rounding unit a matrix holds no stiffness; the penalised form of a matrix keeps the two
    /// apart, so that the fourth power is the limit there, and below for every form.
    pub fn check_penalty_factor(&self, form: &dyn FacetForm<D>) -> Result<(), Error> {
        let Some((parameter, value, factor)) = form.theory().factor() else { return Ok(()) };
        let refuse = |allowed: String| Err(Error::parameter(parameter, value, allowed));
        if !(factor > 0.0 && factor.is_finite()) {
            return refuse(format!(
                "the penalty factor is {factor}, it must be positive and finite"
            ));
        }
        let Some(ratio) = self.penalty_over_stiffness(form) else { return Ok(()) };
        let least = f64::EPSILON.powi(4);
        let most = if keeps_penalty_apart(form) { 1.0 / least } else { 1.0 / f64::EPSILON };
        if ratio >= least && ratio <= most {
            return Ok(());
        }
        refuse(format!(
            "makes a penalty of {ratio:.1e} times the stiffness beside it, {least:.1e} to {most:.1e} have digits"
        ))
    }

    /// The penalty on the first facet that has one over the stiffness beside it; none without such a facet.
    fn penalty_over_stiffness(&self, form: &dyn FacetForm<D>) -> Option<f64> {
        let first = if form.couples() { self.form_facets().next() } else { None };
        let facet = self.facet_view(first?, None);
        let stiffness = facet.largest(|side| side.coefficient * side.surface / side.volume);
        Some(form.penalty(&facet) / stiffness)
    }
}

impl<const D: usize> Discretisation<'_, D> {
    /// The penalty over the stiffness beside it, where a matrix with both has no digit of the stiffness in a precision.
    pub(crate) fn penalty_beyond(&self, precision: Precision) -> Option<f64> {
        self.form().theory().factor()?;
        let ratio = self.space.penalty_over_stiffness(self.form())?;
        (!keeps_penalty_apart(self.form()) && ratio > 1.0 / precision.epsilon()).then_some(ratio)
    }
}
