//! The orders that theory promises of a scheme, and the conditions of a promise.

/// Orders that theory promises.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
pub struct ExpectedOrders {
    /// In L2.
    pub l2: Option<f64>,
    /// In the broken H1 seminorm.
    pub h1: Option<f64>,
}

/// Regularity of the exact solution and of the coefficient, from which theory predicts orders.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Regularity {
    /// The solution lies in `H^s` for every `s` below this number.
    pub sobolev: f64,
    /// Gap and multiplier do not vanish together on a set of positive measure.
    pub strictly_complementary: bool,
    /// Up to which order the coefficient, where the problem has one, has bounded derivatives in every
    /// cell. One unless a problem states more: a function given by its values does not show its order.
    pub coefficient: f64,
}

impl Regularity {
    /// A solution in `H^s` for every `s` below `sobolev`, strictly complementary.
    pub const fn new(sobolev: f64) -> Self {
        Self { sobolev, strictly_complementary: true, coefficient: 1.0 }
    }
    /// A solution in every `H^s`, strictly complementary.
    pub const fn smooth() -> Self {
        Self::new(f64::INFINITY)
    }
    /// A solution in `H^1`, of which no more is known.
    pub const fn finite_energy() -> Self {
        Self::new(1.0).not_strictly_complementary()
    }
    /// A solution whose gap and multiplier may vanish together on a set of positive measure.
    #[must_use]
    pub const fn not_strictly_complementary(self) -> Self {
        Self { strictly_complementary: false, ..self }
    }
    /// States up to which order the coefficient has bounded derivatives in every cell.
    #[must_use]
    pub const fn with_coefficient(self, order: f64) -> Self {
        Self { coefficient: order, ..self }
    }
}

/// The conditions of a promise of orders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Dimension of space.
    pub dimension: usize,
    /// Whether an obstacle binds in the domain.
    pub obstacle: bool,
    /// Whether a Signorini condition binds on the boundary.
    pub contact: bool,
    /// Whether there is friction on the boundary.
    pub friction: bool,
    /// What is known of the solution.
    pub regularity: Regularity,
    /// Whether the problem has a coefficient that is a function of space.
    pub coefficient: bool,
    /// Whether the dual of the linear problem has solutions in `H^2`: with a coefficient that does
    /// not vary, on intervals and on convex domains with Dirichlet data on the whole boundary.
    pub regular_dual: bool,
}

impl Setting {
    /// The setting of a linear problem: dimension and regularity of the solution. The dual problem is
    /// not assumed to be regular.
    #[must_use]
    pub const fn new(dimension: usize, regularity: Regularity) -> Self {
        Self {
            dimension,
            obstacle: false,
            contact: false,
            friction: false,
            regularity,
            coefficient: false,
            regular_dual: false,
        }
    }
    /// Whether no inequality binds.
    pub fn is_linear(&self) -> bool {
        !self.obstacle && !self.contact && !self.friction
    }
}
