//! Tests for authors of schemes: the laws that every scheme obeys, each of them by [`check_law`] and all by
//! [`check_scheme`]. [`Law`] says what each asks for and measures.
//!
//! | law | what it catches |
//! |---|---|
//! | [`Law::Element`] | a node not dual to its function, a wrong derivative, degree or layout |
//! | [`Law::Symmetry`] | a form that is not as symmetric as it declares |
//! | [`Law::Coercivity`] | a penalty that is too small |
//! | [`Law::Invariance`] | a form that depends on how cells and vertices are numbered |
//! | [`Law::Consistency`] | a wrong sign or factor of a term on facets |
//! | [`Law::Orders`] | a scheme that converges slower than its element allows |
//!
//! [`check_element`] tests an element, [`check_quadrature`] a family of quadrature rules.
//!
//! The meshes are small boxes, regular and with moved vertices, in the dimension of the call;
//! tolerances are multiples of machine epsilon. An error names the law, the place
//! and the size of the violation.
//!
//! ```
//! use unilateral::kit::{Law, check_scheme};
//! use unilateral::prelude::*;
//!
//! let report = check_scheme::<2>(&Sipg::default()).unwrap();
//! assert!(report.figure(Law::Coercivity, "smallest") > Some(0.0));
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
pub use report::{KitReport, LawReport};

use std::sync::Arc;

use crate::constraint::{ConstraintSet, Nodes};
use crate::instances::compiled;
use crate::scheme::Scheme;
use discrete::Tested;
use error::Fault;

/// The laws of schemes; those on solutions follow those on which the existence of solutions depends.
const LAWS: [Law; 6] =
    [Law::Element, Law::Symmetry, Law::Coercivity, Law::Invariance, Law::Consistency, Law::Orders];

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
    let tested = Tested { set: Arc::new(set), scheme };
    let laws = LAWS.iter().map(|&law| check(law, &tested)).collect::<Result<_, _>>()?;
    Ok(KitReport { scheme: scheme.name().to_owned(), dimension: D, laws })
}

/// Tests one law of a scheme.
///
/// # Errors
/// The law does not hold; [`KitErrorKind::NotOfSchemes`] for [`Law::Quadrature`].
pub fn check_law<const D: usize>(law: Law, scheme: &dyn Scheme<D>) -> Result<LawReport, KitError> {
    check(law, &Tested { set: Arc::new(Nodes), scheme })
}

fn check<const D: usize>(law: Law, tested: &Tested<'_, D>) -> Result<LawReport, KitError> {
    law.named(compiled!(const D: fn(Law, &Tested<'_, D>) -> Result<LawReport, Fault> = test)(
        law, tested,
    ))
}

fn test<const D: usize>(law: Law, tested: &Tested<'_, D>) -> Result<LawReport, Fault> {
    match law {
        Law::Quadrature => Err(Fault::new(
            KitErrorKind::NotOfSchemes,
            "this is a law of rules, not of schemes: call check_quadrature".to_owned(),
        )),
        Law::Element => element::check(&*tested.element()),
        Law::Symmetry => symmetry::check(tested),
        Law::Coercivity => coercivity::check(tested),
        Law::Invariance => invariance::check(tested),
        Law::Consistency => consistency::check(tested),
        Law::Orders => orders::check(tested),
    }
}
