//! Violations of the laws.

use std::fmt;

use super::spectrum::SpectrumError;
use crate::element::Entity;
use crate::error::Error;
use crate::inequality::Outcome;
use crate::linear::FactorError;
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

/// A law that does not hold. Every message starts with the name of the law; `Debug` prints the
/// message.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum KitError {
    /// A quadrature rule is not exact for the degree asked for.
    #[error(
        "quadrature: the rule of family {family} for degree {degree} in dimension {dimension} gives {found:.16e} for the mean of the monomial with powers {powers:?} of barycentric coordinates, which is {expected:.16e}"
    )]
    RuleNotExact {
        /// Name of the family.
        family: String,
        /// Dimension of the simplex.
        dimension: usize,
        /// The degree asked for.
        degree: usize,
        /// The powers of barycentric coordinates in the monomial.
        powers: Vec<usize>,
        /// The mean by the rule.
        found: f64,
        /// The mean.
        expected: f64,
    },
    /// The layout owns more unknowns of a cell than there may be basis functions.
    #[error("element: the layout owns {functions} unknowns of a cell, at most {limit} are allowed")]
    TooManyFunctions {
        /// Unknowns of a cell by its layout.
        functions: usize,
        /// Largest number allowed.
        limit: usize,
    },
    /// A basis function for which the layout has an unknown is not a number, or was not written.
    #[error("element: basis function {function} is not a number at {at}")]
    NotANumber {
        /// The basis function.
        function: usize,
        /// The point, in barycentric coordinates.
        at: String,
    },
    /// A node is not dual to the basis.
    #[error("element: node {node} of basis function {function} is {found:.6}, not {expected}")]
    NotDual {
        /// The node.
        node: usize,
        /// The basis function.
        function: usize,
        /// The functional at the function.
        found: f64,
        /// One or zero.
        expected: f64,
    },
    /// A node is not tied to the vertex, edge or facet that owns its unknown.
    #[error("element: node {node} is tied to {entity:?}, its unknown belongs to {owner:?}")]
    NodeElsewhere {
        /// The node.
        node: usize,
        /// The entity of the node.
        entity: Entity,
        /// The owner by the layout.
        owner: Entity,
    },
    /// A basis function has a degree above the stated one.
    #[error(
        "element: a rule for basis functions of degree {stated} gives {found:.6e} for the mean of the square of function {function}, which is {expected:.6e}: state the degree of the basis as `basis_degree`"
    )]
    DegreeExceeded {
        /// The basis function.
        function: usize,
        /// The stated degree of the basis.
        stated: usize,
        /// The mean by the rule for that degree.
        found: f64,
        /// The mean.
        expected: f64,
    },
    /// The basis does not sum to one.
    #[error("element: at {at} the basis functions sum to {sum:.6}, not to one")]
    NotPartitionOfUnity {
        /// The point, barycentric.
        at: String,
        /// Their sum.
        sum: f64,
    },
    /// A polynomial of the element's degree is not in the span of its basis.
    #[error(
        "element: a polynomial of degree {degree} differs by {difference:.3e} from its interpolant at {at}, although the element is said to be of degree {stated}"
    )]
    PolynomialMissing {
        /// Degree of the polynomial.
        degree: usize,
        /// Degree of the element.
        stated: usize,
        /// The point, barycentric.
        at: String,
        /// Interpolant minus polynomial.
        difference: f64,
    },
    /// A derivative is not that of the values.
    #[error(
        "element: basis function {function} has derivative {stated:.6} at {at} from vertex {from} to vertex {to}, differences give {difference:.6}"
    )]
    WrongDerivative {
        /// The basis function.
        function: usize,
        /// The point, barycentric.
        at: String,
        /// The direction points away from this vertex of the cell.
        from: usize,
        /// The direction points to this vertex of the cell.
        to: usize,
        /// The stated derivative.
        stated: f64,
        /// That of the values.
        difference: f64,
    },
    /// The form is declared symmetric and is not.
    #[error(
        "symmetry: the form is declared symmetric, but the entry at ({row}, {column}) is {entry:.6e} and its mirror image {mirrored:.6e}; row: {row_place}; column: {column_place}"
    )]
    NotSymmetric {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        entry: f64,
        /// The entry with row and column exchanged.
        mirrored: f64,
        /// Support of the unknown of the row.
        row_place: String,
        /// Support of the unknown of the column.
        column_place: String,
    },
    /// The form is declared not symmetric and is.
    #[error(
        "symmetry: the form is declared not symmetric, but no entry differs from its mirror image by more than {difference:.1e} of its rows: declare it symmetric"
    )]
    SymmetricAfterAll {
        /// The largest relative difference.
        difference: f64,
    },
    /// The symmetric part is not positive definite.
    #[error(
        "coercivity: on {mesh} the form has {not_positive} of {unknowns} eigenvalues that are not positive, the smallest {smallest:.3e} (diagonal scaled to ones)"
    )]
    NotCoercive {
        /// The mesh.
        mesh: String,
        /// Number of eigenvalues that are not positive.
        not_positive: usize,
        /// Number of eigenvalues.
        unknowns: usize,
        /// The smallest.
        smallest: f64,
    },
    /// The smallest eigenvalue was not found.
    #[error("coercivity: no smallest eigenvalue on {mesh}: {why}")]
    NoEigenvalue {
        /// The mesh.
        mesh: String,
        /// The cause.
        #[source]
        why: SpectrumError,
    },
    /// Definiteness could not be decided.
    #[error("coercivity: the matrix could not be factored on {mesh}: {why}")]
    NotFactored {
        /// The mesh.
        mesh: String,
        /// The cause.
        #[source]
        why: FactorError,
    },
    /// Two unknowns of a cell have the same support, so that numberings cannot be compared.
    #[error("invariance: unknowns {first} and {second} live at the same place, {place}")]
    UnknownsNotTold {
        /// An unknown.
        first: usize,
        /// Another.
        second: usize,
        /// Their support.
        place: String,
    },
    /// An entry of the matrix depends on numbers of vertices or cells.
    #[error(
        "invariance: the entry at ({row}, {column}) changes from {before:.6e} to {after:.6e} when vertices and cells are renumbered; row: {row_place}; column: {column_place}"
    )]
    EntryDependsOnNumbering {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        before: f64,
        /// The entry in the other numbering.
        after: f64,
        /// Support of the unknown of the row.
        row_place: String,
        /// Support of the unknown of the column.
        column_place: String,
    },
    /// An entry of the load depends on numbers of vertices or cells.
    #[error(
        "invariance: the load of unknown {unknown} ({place}) changes from {before:.6e} to {after:.6e} when vertices and cells are renumbered"
    )]
    LoadDependsOnNumbering {
        /// The unknown.
        unknown: usize,
        /// Its support.
        place: String,
        /// Its load.
        before: f64,
        /// Its load in the other numbering.
        after: f64,
    },
    /// The solution depends on numbers of vertices or cells.
    #[error(
        "invariance: the solution at unknown {unknown} ({place}) changes from {before:.6e} to {after:.6e} when vertices and cells are renumbered"
    )]
    SolutionDependsOnNumbering {
        /// The unknown.
        unknown: usize,
        /// Its support.
        place: String,
        /// Its value.
        before: f64,
        /// Its value in the other numbering.
        after: f64,
    },
    /// The patch test fails.
    #[error(
        "consistency: on {mesh} the error against a polynomial of degree {degree} is {error:.3e}, rounding explains {tolerance:.1e}; worst in cell {cell}, near {at}"
    )]
    NotConsistent {
        /// The mesh.
        mesh: String,
        /// Degree of the polynomial.
        degree: usize,
        /// The relative error.
        error: f64,
        /// Bound on the effect of rounding errors.
        tolerance: f64,
        /// The cell with the largest error at a vertex.
        cell: usize,
        /// Barycentre of the cell.
        at: String,
    },
    /// The patch test succeeds for a scheme that is declared inconsistent.
    #[error(
        "consistency: the scheme is declared inconsistent, but on {mesh} it reproduces a polynomial of degree {degree} to {error:.3e}: declare it consistent"
    )]
    ConsistentAfterAll {
        /// The mesh.
        mesh: String,
        /// Degree of the polynomial.
        degree: usize,
        /// The relative error.
        error: f64,
    },
    /// The order of convergence is below the expected one.
    #[error(
        "orders: the {norm} error falls from {coarse:.3e} to {fine:.3e}, an order of {measured:.2} where {expected} is due"
    )]
    OrderMissed {
        /// "L2" or "H1".
        norm: &'static str,
        /// The order measured.
        measured: f64,
        /// The expected order.
        expected: f64,
        /// The error on the coarse mesh.
        coarse: f64,
        /// The error on the fine mesh.
        fine: f64,
    },
    /// A linear problem could not be solved.
    #[error("{law}: the linear problem on {mesh} ended as {outcome}")]
    NotSolved {
        /// The law that needs its solution.
        law: Law,
        /// The mesh.
        mesh: String,
        /// The outcome of the solver.
        outcome: Outcome,
    },
    /// Mesh, data or assembly failed.
    #[error("{law}: {why}")]
    NotAssembled {
        /// The law under test.
        law: Law,
        /// The cause.
        #[source]
        why: Error,
    },
}

debug_by_display!(KitError);

impl KitError {
    /// The law that does not hold.
    pub fn law(&self) -> Law {
        match self {
            Self::RuleNotExact { .. } => Law::Quadrature,
            Self::TooManyFunctions { .. }
            | Self::NotANumber { .. }
            | Self::NotDual { .. }
            | Self::NodeElsewhere { .. }
            | Self::DegreeExceeded { .. }
            | Self::NotPartitionOfUnity { .. }
            | Self::PolynomialMissing { .. }
            | Self::WrongDerivative { .. } => Law::Element,
            Self::NotSymmetric { .. } | Self::SymmetricAfterAll { .. } => Law::Symmetry,
            Self::NotCoercive { .. } | Self::NoEigenvalue { .. } | Self::NotFactored { .. } => {
                Law::Coercivity
            }
            Self::UnknownsNotTold { .. }
            | Self::EntryDependsOnNumbering { .. }
            | Self::LoadDependsOnNumbering { .. }
            | Self::SolutionDependsOnNumbering { .. } => Law::Invariance,
            Self::NotConsistent { .. } | Self::ConsistentAfterAll { .. } => Law::Consistency,
            Self::OrderMissed { .. } => Law::Orders,
            Self::NotSolved { law, .. } | Self::NotAssembled { law, .. } => *law,
        }
    }
}
