//! Violations of the laws.

use std::error::Error as StdError;
use std::fmt;

use crate::error::Error;
use crate::readable_debug::debug_by_display;

/// A law of the kit, with the figures that its [`LawReport`](super::LawReport) has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Law {
    /// A rule of quadrature is exact for polynomials of the degree asked for. Figures: the number of `points`, the
    /// `smallest weight`, the largest relative `error` of the mean of a monomial of the degree.
    Quadrature,
    /// Nodes are dual to basis functions and tied to the entities that own them, functions sum to one, polynomials of
    /// the element's degree are in their span, functions have the degree that the element states, derivatives are those
    /// of the values along the simplex. Figures: the number of `functions`, the `degree`, and the largest deviations:
    /// `duality` of nodes at functions from the unit matrix, `interpolation` of a polynomial from its interpolant,
    /// `derivatives` from differences.
    Element,
    /// The matrix is symmetric to rounding if the form declares it, and measurably not otherwise. Figure: the largest
    /// `difference` of an entry and its mirror image, relative to the size of their rows.
    Symmetry,
    /// The symmetric part of the matrix is positive definite on the free unknowns. Figure: the `smallest` eigenvalue of
    /// this part, scaled to a diagonal of ones, on all test meshes.
    Coercivity,
    /// Matrix, load and solution do not depend on the numbering of vertices and cells, nor on the order in which a cell
    /// lists its vertices. Figures: the largest changes of an entry of `matrix`, `load` and `solution`, relative to the
    /// size of what is compared.
    Invariance,
    /// The patch test: a polynomial of the element's degree is reproduced to rounding if the scheme declares itself
    /// consistent ([`Scheme::is_consistent`](crate::scheme::Scheme::is_consistent)), and measurably missed otherwise.
    /// Figure: the `error` against the polynomial, relative to it, the larger of that at nodes and of mesh size times
    /// that of the gradient: the largest of all meshes if the scheme is consistent, else the smallest.
    Consistency,
    /// Errors against a smooth solution fall with the order of the element: its degree in the broken H1 seminorm, one
    /// more in L2 where the scheme promises it
    /// ([`Scheme::expected_orders`](crate::scheme::Scheme::expected_orders) without inequalities) or where duality
    /// proves it, which is for consistent symmetric forms. Figures: the orders `L2` and `H1`, and what is due: `H1 due`
    /// and, where an order is proven, `L2 due`.
    ///
    /// The meshes are two coarse ones, of 4 and 8 subdivisions in the plane, and a quarter of an order may be missing.
    /// An error of lower order with a small factor, such as that of an over-penalty with too small a power of `h`, may
    /// pass and show the order of the element. A study over more levels shows the order that remains.
    Orders,
}

impl Law {
    /// The result of a test of this law, whose error names it.
    pub(super) fn named<T>(self, found: Result<T, Fault>) -> Result<T, KitError> {
        found.map_err(|Fault { kind, message, source }| KitError {
            law: self,
            kind,
            message,
            source,
        })
    }
}

impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
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

/// What is wrong, whatever the law.
pub(super) struct Fault {
    kind: KitErrorKind,
    message: String,
    source: Option<Box<dyn StdError + Send + Sync>>,
}

impl Fault {
    /// The fault of this kind with this sentence.
    pub fn new(kind: KitErrorKind, message: String) -> Self {
        Self { kind, message, source: None }
    }
    pub fn caused_by(self, source: impl StdError + Send + Sync + 'static) -> Self {
        Self { source: Some(Box::new(source)), ..self }
    }
}

/// The error of a mesh, of data or of the assembly, on which a law depends.
impl<E: Into<Error>> From<E> for Fault {
    fn from(why: E) -> Self {
        let why = why.into();
        Self::new(KitErrorKind::NotAssembled, why.to_string()).caused_by(why)
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
    /// The law is none of schemes, but of rules of quadrature.
    NotOfSchemes,
    /// Mesh, data or assembly failed: the source is an [`Error`].
    NotAssembled,
}
