//! The data of a variational inequality, written once, independent of mesh, scheme and scalar.
//!
//! ```text
//! -div(alpha grad u) + c u = f + lambda      in the domain
//! u = u_D                                    on the Dirichlet part
//! alpha du/dn = q                            on the Neumann part
//! obstacle:   psi_lower <= u <= psi_upper    in the domain
//! Signorini:  u >= g, alpha du/dn >= 0, (u - g) alpha du/dn = 0   on the contact part
//! ```
//!
//! `n` is the outward unit normal. An absent datum is `None`, and no loop runs for it.

use crate::real::Point;

/// A scalar function of space.
pub type Field<const D: usize> = Box<dyn Fn(&Point<f64, D>) -> f64 + Send + Sync>;
/// A vector function of space.
pub type VectorField<const D: usize> = Box<dyn Fn(&Point<f64, D>) -> Point<f64, D> + Send + Sync>;
/// A flux through the boundary: a function of the point and the outward unit normal.
pub type BoundaryFlux<const D: usize> =
    Box<dyn Fn(&Point<f64, D>, &Point<f64, D>) -> f64 + Send + Sync>;

/// A datum: a number, integrated exactly and without a quadrature loop, or a function.
pub enum Datum<const D: usize> {
    /// The same number everywhere.
    Constant(f64),
    /// A function of space, integrated by quadrature.
    Function(Field<D>),
}

impl<const D: usize> Datum<D> {
    /// The value at a point.
    pub fn at(&self, x: &Point<f64, D>) -> f64 {
        match self {
            Datum::Constant(c) => *c,
            Datum::Function(f) => f(x),
        }
    }
}

impl<const D: usize> From<f64> for Datum<D> {
    fn from(c: f64) -> Self {
        Datum::Constant(c)
    }
}

/// The exact solution, for error norms; also the source of Dirichlet and Neumann data where a
/// scene gives none.
pub struct Exact<const D: usize> {
    /// The solution.
    pub value: Field<D>,
    /// Its gradient.
    pub gradient: VectorField<D>,
    /// Density of the multiplier. With obstacles it is `lambda = -div(alpha grad u) + c u - f` per
    /// unit volume, everywhere in the domain; it is negative where an obstacle from above holds the
    /// solution. With the Signorini condition it is `sigma = alpha du/dn` per unit area of the
    /// contact part and means nothing elsewhere. None where it is not a function or not known.
    pub multiplier: Option<Field<D>>,
    /// The contact set; none where data and solution do not tell it.
    pub contact: Option<ContactSet<D>>,
}

/// The set where the exact solution is at a bound: a part of the domain with obstacles, a part of the
/// contact boundary with the Signorini condition.
pub struct ContactSet<const D: usize> {
    /// Positive inside the contact set, negative outside, zero on its free boundary.
    pub indicator: Field<D>,
    /// Points of the free boundary. In one dimension and for a Signorini condition in two these are
    /// all there are, otherwise a sample much denser than meshes are. Empty where there is none.
    pub free_boundary: Vec<Point<f64, D>>,
}

/// The least value of `J(v) = a(v, v)/2 - l(v)` on the domain of a scene, where no solution is known.
///
/// It was extrapolated from conforming linear elements on uniform meshes with up to 256 (or 512)
/// subdivisions, by an independent program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceEnergy {
    /// The energy.
    pub value: f64,
    /// By how much it may be wrong.
    pub uncertainty: f64,
}

impl<const D: usize> Exact<D> {
    /// A solution and its gradient, of which no more is known.
    pub fn new(
        value: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static,
        gradient: impl Fn(&Point<f64, D>) -> Point<f64, D> + Send + Sync + 'static,
    ) -> Self {
        Self {
            value: Box::new(value),
            gradient: Box::new(gradient),
            multiplier: None,
            contact: None,
        }
    }
    /// Sets the density of the multiplier.
    #[must_use]
    pub fn with_multiplier(
        mut self,
        lambda: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.multiplier = Some(Box::new(lambda));
        self
    }
    /// Sets the contact set: a function positive inside and negative outside, and points of the
    /// free boundary.
    #[must_use]
    pub fn with_contact(
        mut self,
        indicator: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static,
        free_boundary: Vec<Point<f64, D>>,
    ) -> Self {
        self.contact = Some(ContactSet { indicator: Box::new(indicator), free_boundary });
        self
    }
}

/// A variational inequality: data and, where known, its solution.
#[derive(Default)]
pub struct Problem<const D: usize> {
    /// The load `f` per unit volume.
    pub source: Option<Datum<D>>,
    /// Dirichlet data `u_D`; zero where absent.
    pub dirichlet: Option<Field<D>>,
    /// Neumann data `q = alpha du/dn`; zero where absent.
    pub neumann: Option<BoundaryFlux<D>>,
    /// The diffusion coefficient, evaluated once per cell, at its barycentre; one where absent.
    pub coefficient: Option<Field<D>>,
    /// The reaction coefficient `c >= 0`.
    pub reaction: Option<Datum<D>>,
    /// Obstacle from below.
    pub lower: Option<Field<D>>,
    /// Obstacle from above.
    pub upper: Option<Field<D>>,
    /// Signorini gap `g` on the contact part.
    pub gap: Option<Field<D>>,
    /// The exact solution.
    pub exact: Option<Exact<D>>,
    /// The least energy, where it is known and the solution is not.
    pub reference_energy: Option<ReferenceEnergy>,
}

impl<const D: usize> Problem<D> {
    /// `-Laplace u = 0`, zero data, no constraint.
    pub fn new() -> Self {
        Self::default()
    }
    /// Sets a constant load.
    pub fn constant_source(mut self, f: f64) -> Self {
        self.source = Some(Datum::Constant(f));
        self
    }
    /// Sets a load that varies.
    pub fn source(mut self, f: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static) -> Self {
        self.source = Some(Datum::Function(Box::new(f)));
        self
    }
    /// Sets Dirichlet data.
    pub fn dirichlet(mut self, u: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static) -> Self {
        self.dirichlet = Some(Box::new(u));
        self
    }
    /// Sets Neumann data, a function of the point and the outward normal.
    pub fn neumann(
        mut self,
        q: impl Fn(&Point<f64, D>, &Point<f64, D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.neumann = Some(Box::new(q));
        self
    }
    /// Sets the diffusion coefficient.
    pub fn coefficient(
        mut self,
        alpha: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.coefficient = Some(Box::new(alpha));
        self
    }
    /// Sets the reaction coefficient.
    pub fn reaction(mut self, c: impl Into<Datum<D>>) -> Self {
        self.reaction = Some(c.into());
        self
    }
    /// Sets an obstacle from below.
    pub fn obstacle_below(
        mut self,
        psi: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.lower = Some(Box::new(psi));
        self
    }
    /// Sets an obstacle from above.
    pub fn obstacle_above(
        mut self,
        psi: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.upper = Some(Box::new(psi));
        self
    }
    /// Sets the Signorini condition `u >= g` on the contact part.
    pub fn signorini(
        mut self,
        gap: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.gap = Some(Box::new(gap));
        self
    }
    /// Sets the exact solution and its gradient, and makes it the Dirichlet datum and, times the
    /// coefficient, the Neumann datum, unless those are set.
    pub fn exact(
        self,
        value: impl Fn(&Point<f64, D>) -> f64 + Send + Sync + 'static,
        gradient: impl Fn(&Point<f64, D>) -> Point<f64, D> + Send + Sync + 'static,
    ) -> Self {
        self.solved_by(Exact::new(value, gradient))
    }
    /// The same with what else is known of the solution.
    pub fn solved_by(mut self, exact: Exact<D>) -> Self {
        self.exact = Some(exact);
        self
    }
    /// Sets the least energy and its uncertainty.
    pub fn reference_energy(mut self, value: f64, uncertainty: f64) -> Self {
        self.reference_energy = Some(ReferenceEnergy { value, uncertainty });
        self
    }
    /// The Dirichlet value at a point.
    pub fn dirichlet_at(&self, x: &Point<f64, D>) -> f64 {
        match (&self.dirichlet, &self.exact) {
            (Some(u), _) => u(x),
            (None, Some(exact)) => (exact.value)(x),
            (None, None) => 0.0,
        }
    }
    /// Whether an obstacle binds in the domain.
    pub fn has_obstacle(&self) -> bool {
        self.lower.is_some() || self.upper.is_some()
    }
    /// Whether any inequality binds.
    pub fn is_constrained(&self) -> bool {
        self.has_obstacle() || self.gap.is_some()
    }
    /// Whether Dirichlet data are other than zero by default.
    pub fn has_dirichlet_data(&self) -> bool {
        self.dirichlet.is_some() || self.exact.is_some()
    }
    /// Whether Neumann data are other than zero by default.
    pub fn has_neumann_data(&self) -> bool {
        self.neumann.is_some() || self.exact.is_some()
    }
}
