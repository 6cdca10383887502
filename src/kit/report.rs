//! Measurements of the laws that hold.

use std::fmt;

/// Measurements of the law of the element, in the units of the basis functions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ElementReport {
    /// Number of basis functions.
    pub functions: usize,
    /// Polynomial degree.
    pub degree: usize,
    /// Largest deviation of nodes at basis functions from the unit matrix.
    pub duality: f64,
    /// Largest deviation of a polynomial of the element's degree from its interpolant.
    pub interpolation: f64,
    /// Largest deviation of a derivative from differences.
    pub derivatives: f64,
}

/// Measurements of a quadrature rule.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct QuadratureReport {
    /// Number of points.
    pub points: usize,
    /// The smallest weight.
    pub smallest_weight: f64,
    /// Largest relative deviation from the mean of a monomial of the degree.
    pub error: f64,
}

/// Measurements of the law of symmetry.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SymmetryReport {
    /// Whether the form is declared symmetric.
    pub declared: bool,
    /// The largest difference of an entry and its mirror image, relative to the size of the rows
    /// they stand in.
    pub difference: f64,
}

/// Measurements of the law of coercivity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CoercivityReport {
    /// The smallest eigenvalue of the symmetric part of the matrix, scaled to a diagonal of ones,
    /// on all test meshes.
    pub smallest: f64,
}

/// Measurements of the law of invariance, relative to the size of what is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct InvarianceReport {
    /// Largest change of an entry of the matrix.
    pub matrix: f64,
    /// Largest change of an entry of the load.
    pub load: f64,
    /// Largest change of an unknown.
    pub solution: f64,
}

/// Measurements of the law of consistency.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ConsistencyReport {
    /// Whether the scheme is declared consistent.
    pub declared: bool,
    /// The error against a polynomial, the larger of that at nodes and of mesh size times that of
    /// the gradient, relative to the polynomial: the largest of all meshes if the scheme is
    /// consistent, else the smallest.
    pub error: f64,
}

/// Measurements of the law of orders.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct OrdersReport {
    /// Measured order in L2.
    pub l2: f64,
    /// Expected order in L2; none where no order is proven.
    pub l2_expected: Option<f64>,
    /// Measured order in the broken H1 seminorm.
    pub h1: f64,
    /// Expected order in the broken H1 seminorm.
    pub h1_expected: f64,
}

/// Measurements of all laws.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct KitReport {
    /// Name of the scheme.
    pub scheme: String,
    /// Dimension of space.
    pub dimension: usize,
    /// The element.
    pub element: ElementReport,
    /// Symmetry.
    pub symmetry: SymmetryReport,
    /// Coercivity.
    pub coercivity: CoercivityReport,
    /// Invariance.
    pub invariance: InvarianceReport,
    /// Consistency.
    pub consistency: ConsistencyReport,
    /// Orders.
    pub orders: OrdersReport,
}

impl fmt::Display for KitReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { element, symmetry, coercivity, invariance, consistency, orders, .. } = self;
        let declared = |holds: bool, word: &str| {
            if holds { word.to_owned() } else { format!("not {word}") }
        };
        writeln!(f, "{} in {} dimensions", self.scheme, self.dimension)?;
        writeln!(
            f,
            "  element      {} functions of degree {}, duality {:.1e}, interpolation {:.1e}, derivatives {:.1e}",
            element.functions,
            element.degree,
            element.duality,
            element.interpolation,
            element.derivatives
        )?;
        let word = declared(symmetry.declared, "symmetric");
        writeln!(f, "  symmetry     {word}, difference {:.1e}", symmetry.difference)?;
        writeln!(f, "  coercivity   smallest eigenvalue {:.3e}", coercivity.smallest)?;
        writeln!(
            f,
            "  invariance   matrix {:.1e}, load {:.1e}, solution {:.1e}",
            invariance.matrix, invariance.load, invariance.solution
        )?;
        let word = declared(consistency.declared, "consistent");
        writeln!(f, "  consistency  {word}, error {:.1e}", consistency.error)?;
        writeln!(f, "  orders       L2 {:.2}, H1 {:.2}", orders.l2, orders.h1)
    }
}
