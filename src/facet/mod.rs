//! Facet forms: the one formula of a scheme that lives between cells.
//!
//! # Conventions
//!
//! The two cells of an interior facet are *here*, the one with the lower number, and *there*. The
//! normal points from here to there, on the boundary outward. The jump is here minus there, on the
//! boundary the value. The flux is the mean of the normal derivatives times the harmonic mean of
//! the coefficients, on the boundary the one-sided flux. Only interior and Dirichlet facets carry a
//! form; on Neumann and contact facets the trace is free or bounded by the constraint.

mod none;
mod penalty;

pub use none::NoFacets;
pub use penalty::{InteriorPenalty, OverPenalty, PenaltyRule, WeightRule, proven_bound};

use crate::real::Real;
use crate::study::PenaltyParameters;

/// Jump and mean normal flux of a function at a point of a facet, or of one of its moments.
#[derive(Clone, Copy, Debug)]
pub struct Trace<T> {
    /// Here minus there.
    pub jump: T,
    /// The mean normal flux; not a number where the form says it does not use it.
    pub flux: T,
}

/// One cell as its facet sees it.
#[derive(Clone, Copy, Debug)]
pub struct Side<T> {
    /// The diffusion coefficient of the cell.
    pub coefficient: T,
    /// The volume of the cell.
    pub volume: T,
    /// The measure of the cell's whole boundary.
    pub surface: T,
    /// The height of the cell over the facet.
    pub height: T,
}

/// A facet and its cells: what a penalty may depend on.
#[derive(Clone, Copy, Debug)]
pub struct FacetView<T> {
    /// The measure of the facet; one in one dimension.
    pub measure: T,
    /// Its diameter `h_F`; in one dimension the mean length of the cells it joins.
    pub diameter: T,
    /// The cell here.
    pub here: Side<T>,
    /// The cell there; none on the boundary.
    pub there: Option<Side<T>>,
}

impl<T: Real> FacetView<T> {
    /// The harmonic mean of the coefficients, `2 a b / (a + b)`; on the boundary the coefficient.
    #[inline(always)]
    pub fn coefficient(&self) -> T {
        match &self.there {
            None => self.here.coefficient,
            Some(there) => {
                let (a, b) = (self.here.coefficient, there.coefficient);
                T::lit(2.0) * a * b / (a + b)
            }
        }
    }
    /// The larger of a quantity on the two sides.
    #[inline(always)]
    pub fn largest(&self, quantity: impl Fn(&Side<T>) -> T) -> T {
        let here = quantity(&self.here);
        match &self.there {
            Some(there) if quantity(there) > here => quantity(there),
            _ => here,
        }
    }
}

/// How a form looks at traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// At the points of a quadrature rule of this degree.
    Points(usize),
    /// Through their means over the facet.
    Means,
}

/// A facet term of a bilinear form, written as its integrand.
///
/// From the one formula come the matrix, the load of Dirichlet data (which enter as the trial trace
/// `{ jump: u_D, flux: 0 }`: wherever `[u]` stands on a Dirichlet facet, `[u] - u_D` is meant) and
/// the penalty part of the norm (the formula at traces without flux).
pub trait FacetForm<T: Real, const D: usize>: Send + Sync {
    /// Whether there is a form at all. Without one, facets are not even built.
    const COUPLES: bool = true;
    /// Whether the formula reads fluxes; if not, no normal derivative is computed.
    const USES_FLUX: bool;
    /// Whether `integrand(v, u)` equals `integrand(u, v)`.
    const SYMMETRIC: bool = true;
    /// How traces are sampled, for an element of this degree.
    fn sampling(degree: usize) -> Sampling {
        Sampling::Points(2 * degree)
    }
    /// The penalty weight of a facet, computed once for each.
    fn penalty(&self, facet: &FacetView<T>) -> T;
    /// The least weight with which the form is provably coercive; none if it always is, or if the
    /// weight is chosen by that very bound.
    fn least_penalty(&self, facet: &FacetView<T>) -> Option<T> {
        let _ = facet;
        None
    }
    /// The length of an edge below which rounding in the assembled matrix, with this rounding unit
    /// and on a domain of this diameter, may outweigh the discretisation error.
    ///
    /// By default for a condition number of `(h / length)^-2` against an error of
    /// `(h / length)^2`; the factor of one half is measured.
    fn rounding_limit(&self, epsilon: f64, length: f64) -> f64 {
        0.5 * length * epsilon.powf(0.25)
    }
    /// The factors in force, for reports.
    fn parameters(&self) -> PenaltyParameters {
        PenaltyParameters::default()
    }
    /// The formula, per unit measure of the facet.
    fn integrand(&self, v: Trace<T>, u: Trace<T>, penalty: T) -> T;
}
