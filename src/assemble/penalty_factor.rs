//! Penalty factors that make no penalty.

use super::penalised;
use super::space::Space;
use crate::error::Error;
use crate::facet::FacetForm;

impl<const D: usize> Space<'_, D> {
    /// Refuses a factor that the form [states](crate::facet::FormTheory) and that is not positive and
    /// finite, or that makes a penalty too far from the stiffness beside it: beyond the reciprocal of
    /// the rounding unit a matrix holds no stiffness; the penalised form of a matrix keeps the two
    /// apart, so that the fourth power is the limit there, and below for every form.
    pub fn check_penalty_factor(&self, form: &dyn FacetForm<D>) -> Result<(), Error> {
        let Some((parameter, value, factor)) = form.theory().factor() else { return Ok(()) };
        let refuse =
            |allowed| Err(Error::Parameter { parameter, value: value.to_string(), allowed });
        if !(factor > 0.0 && factor.is_finite()) {
            return refuse(format!(
                "the penalty factor is {factor}, it must be positive and finite"
            ));
        }
        let Some(neighbours) = &self.neighbours else { return Ok(()) };
        let view = |k: usize| self.facet_view(neighbours, k / (D + 1), k % (D + 1));
        let mut views = (0..self.mesh.n_cells() * (D + 1)).filter_map(view);
        let Some(facet) = views.next() else { return Ok(()) };
        let stiffness = facet.largest(|side| side.coefficient * side.surface / side.volume);
        let ratio = form.penalty(&facet) / stiffness;
        let least = f64::EPSILON.powi(4);
        let most = if penalised::applies(form) { 1.0 / least } else { 1.0 / f64::EPSILON };
        if ratio >= least && ratio <= most {
            return Ok(());
        }
        refuse(format!(
            "makes a penalty of {ratio:.1e} times the stiffness beside it, {least:.1e} to {most:.1e} have digits",
        ))
    }
}
