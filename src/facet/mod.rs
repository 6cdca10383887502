//! Facet forms: the one formula of a scheme that lives between cells.
//!
//! # Conventions
//!
//! The two cells of an interior facet are *here*, the one with the lower number, and *there*. The
//! normal points from here to there, on the boundary outward. The jump is here minus there, on the
//! boundary the value. The flux is a mean of the normal derivatives times the harmonic mean of the
//! coefficients, on the boundary the one-sided flux. Only interior and Dirichlet facets carry a
//! form; on Neumann and contact facets the trace is free or bounded by the constraint.
//!
//! A form sees traces through their moments on the facet: their coefficients in orthonormal
//! polynomials up to a degree the form chooses. Up to the element's own degree nothing is lost,
//! and the sum over moments is the integral over the facet.
//!
//! The lift `r(v)` of a jump is the piecewise polynomial field, of degree one less than the element
//! unless the form asks for another, with `int r(v) . tau = - sum_F int_F [v] {tau . n}`, the mean with the average weights of the
//! flux; `r_F(v)` is the lift of one facet.

mod dirichlet;
mod facet_lifts;
mod form_theory;
mod interior_penalty;
mod local_fluxes;
mod none;
mod over_penalty;
mod parameters;
mod proven;
mod view;

pub use dirichlet::DirichletBy;
pub use facet_lifts::{FacetLifts, Lifts};
pub use form_theory::FormTheory;
pub use interior_penalty::{InteriorPenalty, PenaltyRule, Symmetry};
pub use local_fluxes::LocalFluxes;
pub use none::NoFacets;
pub use over_penalty::{Eta, OverPenalty, WeightRule};
pub use parameters::PenaltyParameters;
pub use proven::proven_bound;
pub use view::{FacetKind, FacetView, Side};

/// A moment of the jump and of the mean normal flux of a function on a facet.
#[derive(Clone, Copy, Debug)]
pub struct Trace {
    /// Here minus there.
    pub jump: f64,
    /// The mean normal flux; not a number where the form says it does not use it.
    pub flux: f64,
}

/// A facet term of a bilinear form, written as its integrand.
///
/// The trait is object-safe: the assembler holds a form as `&dyn FacetForm`. On broken elements it calls it
/// once a facet or less, never once a matrix entry.
///
/// From the one formula come the matrix, the load of Dirichlet data (which enter as the trial trace
/// `{ jump: u_D, flux: 0 }`: wherever `[u]` stands on a Dirichlet facet, `[u] - u_D` is meant) and
/// the penalty terms of the norm (the formula at traces without flux).
pub trait FacetForm<const D: usize>: Send + Sync {
    /// Whether there is a form at all, by default true.
    fn couples(&self) -> bool {
        true
    }
    /// Whether the formula reads fluxes; if not, no normal derivative is computed, and those it would
    /// read are not numbers. By default true.
    fn uses_flux(&self) -> bool {
        true
    }
    /// Whether `int alpha r(v) . r(u)` is added, which couples cells with the neighbours of their
    /// neighbours: with the consistency terms of a symmetric form it completes the square
    /// `|grad v + r(v)|^2`. Only broken elements of degree one or two carry such a form.
    ///
    /// Source: D. N. Arnold, F. Brezzi, B. Cockburn, L. D. Marini, SIAM J. Numer. Anal. 39 (2002),
    /// 1749-1779, section 3. By default false.
    fn is_lifted(&self) -> bool {
        false
    }
    /// The degree of lifts, at most that of the moments, for basis functions of this degree; by default one less.
    fn lift_degree(&self, degree: usize) -> usize {
        degree - 1
    }
    /// Whether `integrand(v, u)` equals `integrand(u, v)`, by default true.
    fn is_symmetric(&self) -> bool {
        true
    }
    /// Up to which degree the form sees moments of traces, for basis functions of this degree; by default up to that
    /// degree, which is all. Higher moments of jump and flux are dropped from the whole formula. The fluxes of linears
    /// are constant on a facet: a form on linears that needs the mean of the jump alone sees moment zero, which is
    /// cheaper.
    fn moments(&self, degree: usize) -> usize {
        degree
    }
    /// The weight of the cell here in the mean flux, by default one half; the weight of the cell there is what is left
    /// to one.
    fn average_weight(&self, facet: &FacetView<D>) -> f64 {
        let _ = facet;
        0.5
    }
    /// The penalty weight of a facet, computed once for each.
    fn penalty(&self, facet: &FacetView<D>) -> f64;
    /// By what the penalty weight is multiplied for the moments of degree `moment` of a trace, by default one. The
    /// integrand of such a moment has the product as its penalty; fluxes have no weight. For a penalty on the mean of
    /// the jump alone it is one for `moment = 0`, else zero.
    fn moment_weight(&self, moment: usize) -> f64 {
        let _ = moment;
        1.0
    }
    /// What is known of the form besides its formula; nothing of it enters matrix or load. A form may leave it out: its
    /// matrix is then tested for definiteness before an inequality is solved, and reports state no penalty factor. A form
    /// that theory proves coercive says so and saves the test, `FormTheory::default().with_coercivity(true)`; one whose
    /// penalty must exceed a bound gives the bound, `FormTheory::default().with_least_penalty(|facet| ..)`, and a warning
    /// says where it is not kept.
    fn theory(&self) -> FormTheory<'_, D> {
        FormTheory::default()
    }
    /// Whether the formula is the same on all interior facets and the same on all Dirichlet facets,
    /// but for the penalty weight; by default false. It is then read off once for each kind, not once for each facet,
    /// which is faster. A formula that does not look at its facet is uniform.
    fn is_uniform(&self) -> bool {
        false
    }
    /// The formula, per unit measure of the facet, for one moment of each trace, the same for every moment: moments do
    /// not mix, and moment zero is the mean over the facet. It is bilinear in the traces, and at most linear in the penalty weight. It may differ between facets, by their kind,
    /// normal, diameter or coefficient. The assembler reads it off at unit traces, with the weights
    /// zero and one.
    fn integrand(&self, facet: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64;
}
