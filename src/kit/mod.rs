//! Tests for authors of schemes: laws that every scheme obeys, each tested by one function, and all
//! of them by [`check_scheme`].
//!
//! | law | function | what it catches |
//! |---|---|---|
//! | element | [`check_element`] | a node not dual to its function, a wrong derivative, degree or layout |
//! | symmetry | [`check_symmetry`] | a form that is not as symmetric as it declares |
//! | coercivity | [`check_coercivity`] | a penalty that is too small |
//! | invariance | [`check_invariance`] | a form that depends on how cells and vertices are numbered |
//! | consistency | [`check_consistency`] | a wrong sign or factor of a term on facets |
//! | orders | [`check_orders`] | a scheme that converges slower than its element allows |
//!
//! [`check_quadrature`] tests a family of quadrature rules.
//!
//! The meshes are small boxes, regular and with moved vertices, in the dimension of the call;
//! tolerances are multiples of machine epsilon. An error names the law, the place
//! and the size of the violation.
//!
//! ```
//! use unilateral::kit::check_scheme;
//! use unilateral::prelude::*;
//!
//! let report = check_scheme::<2>(&Sipg::default()).unwrap();
//! assert!(report.coercivity.smallest > 0.0);
//!
//! let too_weak = Sipg { penalty: PenaltyRule::Diameter(1.0) };
//! let error = check_scheme::<2>(&too_weak).unwrap_err();
//! assert!(error.to_string().starts_with("coercivity: "));
//! ```
//!
//! In the tests of a crate with a scheme of its own, here the library's:
//!
//! ```no_run
//! use unilateral::kit::{KitError, check_scheme};
//! use unilateral::prelude::Sipg;
//!
//! #[test]
//! fn the_scheme_obeys_the_laws() -> Result<(), KitError> {
//!     check_scheme::<1>(&Sipg::default())?;
//!     check_scheme::<2>(&Sipg::default())?;
//!     check_scheme::<3>(&Sipg::default())?;
//!     Ok(())
//! }
//! ```

mod coercivity;
mod consistency;
mod discrete;
mod element;
mod error;
mod invariance;
mod matrix;
pub(crate) mod meshes;
mod orders;
mod problems;
mod quadrature;
mod report;
pub mod spectrum;
mod split_mix;
mod symmetry;

pub use element::check_element;
pub use error::{KitError, KitErrorKind, Law};
pub use quadrature::check_quadrature;
pub use report::{
    CoercivityReport, ConsistencyReport, ElementReport, InvarianceReport, KitReport, OrdersReport,
    QuadratureReport, SymmetryReport,
};

use std::sync::Arc;

use crate::constraint::{ConstraintSet, Nodes};
use crate::instances::compiled;
use crate::scheme::Scheme;
use discrete::Tested;

/// Tests all laws; those on solutions follow those on which the existence of solutions depends.
///
/// # Errors
/// The first law that does not hold.
pub fn check_scheme<const D: usize>(scheme: &dyn Scheme<D>) -> Result<KitReport, KitError> {
    check_scheme_on(scheme, Nodes)
}

/// Tests all laws in the basis that a constraint set needs.
///
/// # Errors
/// The first law that does not hold.
pub fn check_scheme_on<const D: usize>(
    scheme: &dyn Scheme<D>,
    set: impl ConstraintSet + 'static,
) -> Result<KitReport, KitError> {
    let tested = Tested { set: Arc::new(set), ..Tested::new(scheme) };
    compiled!(const D: fn(&Tested<'_, D>) -> Result<KitReport, KitError> = check_all)(&tested)
}

fn check_all<const D: usize>(tested: &Tested<'_, D>) -> Result<KitReport, KitError> {
    Ok(KitReport {
        scheme: tested.name().to_owned(),
        dimension: D,
        element: check_element(&*tested.element())?,
        symmetry: symmetry::check(tested)?,
        coercivity: coercivity::check(tested)?,
        invariance: invariance::check(tested)?,
        consistency: consistency::check(tested)?,
        orders: orders::check(tested)?,
    })
}

/// The matrix is symmetric to rounding if the form declares it, and measurably not otherwise.
///
/// # Errors
/// [`KitErrorKind::NotSymmetric`], [`KitErrorKind::SymmetricAfterAll`].
pub fn check_symmetry<const D: usize>(scheme: &dyn Scheme<D>) -> Result<SymmetryReport, KitError> {
    let tested = Tested::new(scheme);
    compiled!(const D: fn(&Tested<'_, D>) -> Result<SymmetryReport, KitError> = symmetry::check)(
        &tested,
    )
}

/// The symmetric part of the matrix is positive definite on the free unknowns.
///
/// # Errors
/// [`KitErrorKind::NotCoercive`].
pub fn check_coercivity<const D: usize>(
    scheme: &dyn Scheme<D>,
) -> Result<CoercivityReport, KitError> {
    let tested = Tested::new(scheme);
    compiled!(const D: fn(&Tested<'_, D>) -> Result<CoercivityReport, KitError> = coercivity::check)(
        &tested,
    )
}

/// Matrix, load and solution do not depend on the numbers of vertices and cells, nor on the order
/// in which a cell lists its vertices.
///
/// # Errors
/// [`KitErrorKind::EntryDependsOnNumbering`], [`KitErrorKind::LoadDependsOnNumbering`],
/// [`KitErrorKind::SolutionDependsOnNumbering`], [`KitErrorKind::UnknownsNotTold`].
pub fn check_invariance<const D: usize>(
    scheme: &dyn Scheme<D>,
) -> Result<InvarianceReport, KitError> {
    let tested = Tested::new(scheme);
    compiled!(const D: fn(&Tested<'_, D>) -> Result<InvarianceReport, KitError> = invariance::check)(
        &tested,
    )
}

/// The patch test: a polynomial of the element's degree is reproduced to rounding if the scheme
/// declares itself consistent ([`Scheme::is_consistent`]), and measurably missed otherwise.
///
/// # Errors
/// [`KitErrorKind::NotConsistent`], [`KitErrorKind::ConsistentAfterAll`].
pub fn check_consistency<const D: usize>(
    scheme: &dyn Scheme<D>,
) -> Result<ConsistencyReport, KitError> {
    let tested = Tested::new(scheme);
    compiled!(const D: fn(&Tested<'_, D>) -> Result<ConsistencyReport, KitError> = consistency::check)(
        &tested,
    )
}

/// Errors against a smooth solution fall with the order of the element: its degree in the broken
/// H1 seminorm, one more in L2 where the scheme promises it
/// ([`Scheme::expected_orders`] without inequalities) or where duality proves it, which is for
/// consistent symmetric forms.
///
/// The meshes are two coarse ones, of 4 and 8 subdivisions in the plane, and a quarter of an order may be missing. An
/// error of lower order with a small factor, such as that of an over-penalty with too small a power of `h`, may pass
/// and show the order of the element. A study over more levels shows the order that remains.
///
/// # Errors
/// [`KitErrorKind::OrderMissed`].
pub fn check_orders<const D: usize>(scheme: &dyn Scheme<D>) -> Result<OrdersReport, KitError> {
    let tested = Tested::new(scheme);
    compiled!(const D: fn(&Tested<'_, D>) -> Result<OrdersReport, KitError> = orders::check)(
        &tested,
    )
}
