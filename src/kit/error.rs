//! Violations of the laws.

use std::error::Error as StdError;
use std::fmt;

use crate::error::Error;
use crate::readable_debug::debug_by_display;

/// A law of the kit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Law {
    /// Exactness of quadrature rules.
    Quadrature,
    /// The nodes, values and derivatives of the reference element.
    Element,
    /// Equality of the matrix and its transpose.
    Symmetry,
    /// Positivity of the form.
    Coercivity,
    /// Independence of numberings.
    Invariance,
    /// Reproduction of polynomials.
    Consistency,
    /// Orders of convergence.
    Orders,
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Law::Quadrature => "quadrature",
            Law::Element => "element",
            Law::Symmetry => "symmetry",
            Law::Coercivity => "coercivity",
            Law::Invariance => "invariance",
            Law::Consistency => "consistency",
            Law::Orders => "orders",
        })
    }
}

/// A law that does not hold or cannot be tested. The message starts with the name of the law and says what is wrong,
/// where and by how much; `Debug` prints the message and its causes.
#[derive(thiserror::Error)]
#[error("{law}: {message}")]
#[non_exhaustive]
pub struct KitError {
    /// The law.
    pub law: Law,
    /// What is wrong.
    pub kind: KitErrorKind,
    message: String,
    /// The error of the assembly, of the factorisation or of the method of Lanczos.
    source: Option<Box<dyn StdError + Send + Sync>>,
}

debug_by_display!(KitError);

impl KitError {
    /// The error with this sentence.
    pub(super) fn new(law: Law, kind: KitErrorKind, message: String) -> Self {
        Self { law, kind, message, source: None }
    }
    pub(super) fn caused_by(self, source: impl StdError + Send + Sync + 'static) -> Self {
        Self { source: Some(Box::new(source)), ..self }
    }
    /// The error of a mesh, of data or of the assembly, on which a law depends.
    pub(super) fn not_assembled(law: Law, why: impl Into<Error>) -> Self {
        let why = why.into();
        Self::new(law, KitErrorKind::NotAssembled, why.to_string()).caused_by(why)
    }
}

/// A law that a scheme, an element or a quadrature rule breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum KitErrorKind {
    /// A quadrature rule is not exact for the degree asked for.
    RuleNotExact,
    /// The layout owns more unknowns of a cell than there may be basis functions.
    TooManyFunctions,
    /// A basis function for which the layout has an unknown is not a number, or was not written.
    NotANumber,
    /// A node is not dual to the basis.
    NotDual,
    /// A node is not tied to the vertex, edge or facet that owns its unknown.
    NodeElsewhere,
    /// A basis function has a degree above the stated one.
    DegreeExceeded,
    /// The basis does not sum to one.
    NotPartitionOfUnity,
    /// A polynomial of the element's degree is not in the span of its basis.
    PolynomialMissing,
    /// A derivative is not that of the values.
    WrongDerivative,
    /// The form is declared symmetric and is not.
    NotSymmetric,
    /// The form is declared not symmetric and is.
    SymmetricAfterAll,
    /// The symmetric part is not positive definite.
    NotCoercive,
    /// The smallest eigenvalue was not found: the source is a [`SpectrumError`](super::spectrum::SpectrumError).
    NoEigenvalue,
    /// Definiteness could not be decided: the source is a [`FactorError`](crate::linear::FactorError).
    NotFactored,
    /// Two unknowns of a cell have the same location, so that numberings cannot be compared.
    UnknownsNotTold,
    /// An entry of the matrix depends on numbers of vertices or cells.
    EntryDependsOnNumbering,
    /// An entry of the load depends on numbers of vertices or cells.
    LoadDependsOnNumbering,
    /// The solution depends on numbers of vertices or cells.
    SolutionDependsOnNumbering,
    /// The patch test fails.
    NotConsistent,
    /// The patch test succeeds for a scheme that is declared inconsistent.
    ConsistentAfterAll,
    /// The order of convergence is below the expected one.
    OrderMissed,
    /// A linear problem could not be solved.
    NotSolved,
    /// Mesh, data or assembly failed: the source is an [`Error`].
    NotAssembled,
}
