//! Guaranteed bounds on the error of a discrete solution, computed from the solution and the data alone.
//!
//! An admissible function `v` and a flux `q` are made from the solution ([`PrimalDualPair`]); what `q` leaves of the
//! load is the multiplier `mu` of an obstacle, and its normal component on the contact boundary a contact force `s`; where
//! the flux jumps on a facet, an obstacle presses there with a force `s_F` ([`FacetForce`]). The bound ([`ErrorBound`]) is,
//! but for the oscillation of data,
//!
//! ```text
//! |||u - v|||^2 <= |alpha^-1/2 (alpha grad v - q)|^2 + 2 (mu, distance of v from the obstacle) + 2 int_C s (v - g)
//!                  + 2 sum_F int_F s_F (distance of v from the obstacle)
//! ```
//!
//! The theorem with all terms, its proof, its sources and what is guaranteed stand in [`docs::bound`](crate::docs::bound).
//!
//! | file or folder | content |
//! |---|---|
//! | `primal_dual_pair` | function and flux of a discrete solution: where the files below meet |
//! | `admissible_function` | `v`: means of the values at nodes, moved into the constraints |
//! | `flux` | `q` by its numbers in cells |
//! | `patches` | the flux of conforming functions, around each vertex |
//! | `quadratics`, `shared_multipliers` | loads and multipliers of quadratics by cell, and the flux inside cells |
//! | `contact_forces` | the forces on contact facets |
//! | `facet_forces` | the forces of obstacles on other facets |
//! | `exchange` | multipliers exchanged for flux where obstacles bind |
//! | `integrals` | what each cell and the boundary add to the bound, and the sums |
//! | `friedrichs`, `eigenvalue` | the constant with which counts what the solver left |
//! | `guarantee` | which terms are proven |
//! | `estimate` | the bound from the sums |
//! | `marking`, `figures` | cells to refine; the figures of a report |

mod admissible_function;
mod contact_forces;
mod convex;
mod eigenvalue;
mod estimate;
mod exchange;
mod facet_forces;
mod figures;
mod flux;
mod friedrichs;
mod guarantee;
mod integrals;
mod marking;
mod patches;
mod primal_dual_pair;
mod quadratics;
mod shared_multipliers;

pub use eigenvalue::least_eigenvalue;
pub use estimate::{BoundTerms, ErrorBound, Unproven};
pub use facet_forces::FacetForce;
pub use figures::{BoundFigures, TrueErrors};
pub use flux::Flux;
pub use primal_dual_pair::PrimalDualPair;

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
    /// The mesh is a part of another one, and the pair one of quadratics or without the other parts.
    #[error("on parts of a mesh the bound is for linear functions, with all parts together")]
    Part,
    /// The solve has no values.
    #[error("the solve has no values")]
    NoIterate,
    /// The reaction is negative at a point.
    #[error("the reaction is negative at a point, and the energy norm is none")]
    NegativeReaction,
    /// A force on a facet has not one sign, or a contact force is negative in the mean.
    #[error(
        "the force on a facet has the wrong sign or exceeds the threshold of friction: no obstacle, gap or friction acts so"
    )]
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
