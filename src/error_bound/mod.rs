//! Guaranteed bounds on the error of a discrete solution, computed from the solution and the data alone.
//!
//! # The theorem
//!
//! Let `u` solve the inequality, let `v` satisfy its constraints and Dirichlet data, let `q` be a field with
//! a square-integrable divergence, and let `mu+`, `mu- >= 0` be functions and `s = q.n >= 0` on the contact
//! part. With `r = f - c v + div q + mu+ - mu-`, where `r` has the mean zero in each cell and `q.n` that of
//! the Neumann datum on each facet,
//!
//! ```text
//! |||u - v|||^2 <= sum_K (|alpha^-1/2 (alpha grad v - q)|_K + h_K / pi alpha_K^-1/2 |r|_K)^2
//!                  + 2 (mu+, v - psi) + 2 (mu-, Psi - v) + 2 int_C s (v - g)
//! ```
//!
//! with the energy norm `|||w|||^2 = int alpha |grad w|^2 + c w^2` and the least value `alpha_K` of the
//! coefficient in the cell. *Proof.* For `e = u - v` the inequality tested with `v` is
//! `|||e|||^2 <= (f, e) - (alpha grad v, grad e) - (c v, e) + int_N q_N e`. Integration by parts of `(q, grad e)`
//! makes this `(q - alpha grad v, grad e) + (r, e) - (mu+ - mu-, e) - int_C s e`; here
//! `-(mu+, e) <= (mu+, v - psi)`, likewise for the others, and `(r, e)_K <= h_K / pi |r|_K |grad e|_K`, the
//! inequality of Payne and Weinberger on a convex cell. With `S^2` the sum over cells and `G` the rest of
//! the right side `|||e|||^2 <= S |||e||| + G / 2`, hence `|||e|||^2 <= S^2 + G`.
//!
//! Where `r = 0` and `c = 0` half of the right side is *equal* to `1/2 |||u - v|||^2 + 1/2
//! |alpha^-1/2 (alpha grad u - q)|^2` plus the complementarity of `mu` with `u` and of the multiplier of `u`
//! with `v`: nothing is lost.
//!
//! Sources: S. Repin, J. Valdman, arXiv 1702.08689; D. Braess, Numer. Math. 101 (2005), 415-421; L. E. Payne,
//! H. F. Weinberger, Arch. Rational Mech. Anal. 5 (1960), 286-292.

mod algebra;
mod choice;
mod contact;
mod estimate;
mod exchange;
mod figures;
mod friedrichs;
mod function;
mod marking;
mod pair;
mod patches;
mod quadratic_patches;
mod quadratics;
mod shared_multipliers;
mod smooth_forces;
mod terms;

pub(crate) use algebra::CoarserCells;
pub use estimate::{BoundParts, ErrorBound, Unproven};
pub use figures::{BoundFigures, Guaranteed};
pub use pair::PrimalDualPair;

use crate::error::Error;
use crate::readable_debug::debug_by_display;

/// Why there is no bound.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum NoBound {
    /// The element is none of those for which a flux is known.
    #[error(
        "no flux is known for this element: the bound is for broken and conforming linears and quadratics, and for Crouzeix-Raviart elements"
    )]
    Element,
    /// The solve has no values.
    #[error("the solve has no values")]
    NoIterate,
    /// The reaction is negative at a point.
    #[error("the reaction is negative at a point, and the energy norm is none")]
    NegativeReaction,
    /// The flux of a pair through a contact facet has the sign of no contact force.
    #[error("the flux through a contact facet is negative in the mean: it is no contact force")]
    NegativeForce,
    /// A number that enters is not finite.
    #[error(
        "a datum is not finite, or a coefficient not positive, at a point of the bound's rules"
    )]
    NotFinite,
    /// A datum is not finite.
    #[error(transparent)]
    Data(#[from] Error),
}
debug_by_display!(NoBound);
