//! Known properties of a form besides its formula, for warnings and reports.

use std::fmt;

use super::{FacetView, PenaltyParameters};

/// The least penalty weight of a facet with which a form is provably coercive.
pub type LeastPenalty<'f, const D: usize> = Box<dyn Fn(&FacetView<'_, D>) -> f64 + 'f>;

/// Properties of a form by theory and measurement: nothing of it enters matrix or load. By default there are no
/// parameters, no proof of coercivity and no least penalty.
#[derive(Default)]
#[non_exhaustive]
pub struct FormTheory<'f, const D: usize> {
    /// The factors in force, for reports.
    pub parameters: PenaltyParameters,
    /// Whether theory proves the form coercive, for a reaction that is not negative and with penalties of
    /// at least `least_penalty` where there is one. The matrix of a form without such a proof is tested
    /// before an inequality is solved: a solution does not show that its matrix is indefinite.
    pub is_coercive: bool,
    /// The least weight with which the form is provably coercive; none if its weights are positive and
    /// need no bound, or are chosen by that very bound.
    pub least_penalty: Option<LeastPenalty<'f, D>>,
    /// The margin over a proven bound, where the weight is chosen by that bound: 0.5 for a penalty of 1.5 times it.
    pub margin: Option<f64>,
}

impl<'f, const D: usize> FormTheory<'f, D> {
    /// States whether theory proves the form coercive with its own weights.
    #[must_use]
    pub fn with_coercivity(self, is_coercive: bool) -> Self {
        Self { is_coercive, ..self }
    }
    /// The parameter by which the penalty is chosen, its value, and the factor that it makes, which
    /// is linear in the penalty; none for a form that states no such parameter.
    pub(crate) fn factor(&self) -> Option<(&'static str, f64, f64)> {
        let PenaltyParameters { sigma, eta, .. } = self.parameters;
        let margin = self.margin.map(|margin| ("margin", margin, 1.0 + margin));
        let stated = sigma.map(|x| ("sigma", x, x)).or(eta.map(|x| ("eta", x, x)));
        margin.or(stated)
    }
    /// Sets the least weight of a facet with which the form is provably coercive.
    #[must_use]
    pub fn with_least_penalty(self, least: impl Fn(&FacetView<'_, D>) -> f64 + 'f) -> Self {
        Self { is_coercive: true, least_penalty: Some(Box::new(least)), ..self }
    }
    /// The length of an edge below which rounding, with this rounding unit and on a domain of this
    /// diameter, may outweigh the discretisation error of an element of this degree `k`: for a condition number of
    /// `(h / length)^-2` against an error of `(h / length)^(k + 1)`. A penalty does not enter: interior
    /// penalty has one of the size of the stiffness, an over-penalty is kept apart from it. The factor one half is
    /// measured for linears.
    pub fn rounding_limit(&self, epsilon: f64, length: f64, degree: usize) -> f64 {
        0.5 * length * epsilon.powf(((degree + 3) as f64).recip())
    }
}

impl<const D: usize> fmt::Debug for FormTheory<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FormTheory")
            .field("parameters", &self.parameters)
            .field("is_coercive", &self.is_coercive)
            .field("least_penalty", &self.least_penalty.is_some())
            .field("margin", &self.margin)
            .finish()
    }
}
