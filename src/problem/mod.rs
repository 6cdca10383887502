//! The data of a variational inequality, written once, independent of mesh and scheme.
//!
//! ```text
//! -div(alpha grad u) + c u = f + lambda      in the domain
//! u = u_D                                    on the Dirichlet boundary
//! alpha du/dn = q                            on the Neumann boundary
//! alpha du/dn + k (u - g) = 0                on Robin sides, which are parts of the Neumann boundary
//! |alpha du/dn| <= g, alpha du/dn u + g |u| = 0   on parts with friction, likewise
//! obstacle:   psi_lower <= u <= psi_upper    in the domain
//! Signorini:  u >= g, alpha du/dn >= 0, (u - g) alpha du/dn = 0   on the contact boundary
//! ```
//!
//! `n` is the outward unit normal. An absent datum is `None`, and no loop runs for it.
//!
//! A datum is a pure function of its arguments: it is called any number of times, in any order and
//! from several threads at once, and the discretisation is that of a problem only if it returns the
//! same number each time. A value that is not finite ends the assembly with
//! [`Error::DataNotFinite`](crate::error::Error::DataNotFinite), which names the datum and the point.

mod body_constants;
mod datum;
mod discrete_function;
mod exact;
mod given;
mod levels;
mod named;
mod on_mesh;
mod robin;
mod tensor;
mod unknown_name;
mod values;

pub(crate) use body_constants::BodyConstants;
#[cfg(feature = "problem-files")]
pub(crate) use datum::BoundaryField;
pub(crate) use datum::Field;
pub use datum::{BoundaryFlux, Datum, Shifted, Sum};
pub use discrete_function::DiscreteFunction;
pub use exact::{ContactSet, Exact, ReferenceEnergy};
pub use given::Given;
pub(crate) use on_mesh::{ByGroup, DataByGroup, DataOnMesh};
pub use robin::Robin;
pub use tensor::Tensor;
#[cfg(feature = "problem-files")]
pub(crate) use unknown_name::unknown_name;
pub(crate) use values::ROUNDING;
pub use values::ValueOf;

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use crate::constraint::{ConstraintSet, Nodes};
use crate::real::Point;
use given::ALL;

/// A variational inequality: data, the constraint set and, where known, its solution. A clone shares
/// the functions.
#[derive(Clone, Default)]
#[non_exhaustive]
pub struct Problem<const D: usize> {
    /// The load `f` per unit volume, the sum of those given for a name.
    pub source: Given<Datum<D>>,
    /// Dirichlet data `u_D`; zero where absent.
    pub dirichlet: Given<Datum<D>>,
    /// Neumann data `q = alpha du/dn`; zero where absent.
    pub neumann: Given<BoundaryFlux<D>>,
    /// Robin sides: groups of the Neumann boundary with data of their own.
    pub robin: Given<Robin<D>>,
    /// The diffusion coefficient; one where absent. Elements of degree one take its value at the barycentre
    /// of each cell, others its values at the points of rules in the cells in which it varies, see
    /// [`Problem::coefficient`].
    pub coefficient: Given<Datum<D>>,
    /// The threshold `g >= 0` of friction on parts of the Neumann boundary, see [`Problem::friction_on`].
    pub friction: Given<Datum<D>>,
    /// A tensor by which the diffusion coefficient is multiplied; one where absent. The energy norm has both.
    pub tensor: Given<Tensor<D>>,
    /// The reaction coefficient `c >= 0`.
    pub reaction: Given<Datum<D>>,
    /// Obstacle from below.
    pub lower: Given<Datum<D>>,
    /// Obstacle from above.
    pub upper: Given<Datum<D>>,
    /// Signorini gap `g` on the contact boundary.
    pub gap: Given<Datum<D>>,
    /// Where obstacles and gap bind; at the [`Nodes`] of the element where absent.
    pub constraint_set: Option<Arc<dyn ConstraintSet>>,
    /// The degree of the polynomials that all data given as functions are in each cell, where it is
    /// stated: see [`Problem::polynomial_data`].
    pub data_degree: Option<usize>,
    /// The exact solution.
    pub exact: Option<Exact<D>>,
    /// The minimum of the energy, where it is known and the solution is not.
    pub reference_energy: Option<ReferenceEnergy>,
    /// The numbers by name from which the data were made, for rows of reports: the constants of a problem file.
    pub constants: BTreeMap<String, f64>,
    /// Numbers of the solution by name, for rows of reports.
    pub values: Vec<(String, ValueOf<D>)>,
}

/// Lists the data that are present.
impl<const D: usize> fmt::Debug for Problem<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = f.debug_struct("Problem");
        for (name, _, given) in self.data() {
            if let Some(datum) = given.everywhere() {
                out.field(name, datum);
            }
        }
        let names: Vec<&str> = self.names().map(|(name, _)| name).collect();
        if !names.is_empty() {
            out.field("named", &names);
        }
        if let Some(set) = &self.constraint_set {
            out.field("constraint_set", &set.name());
        }
        if let Some(degree) = &self.data_degree {
            out.field("data_degree", degree);
        }
        if let Some(exact) = &self.exact {
            out.field("exact", exact);
        }
        if let Some(energy) = &self.reference_energy {
            out.field("reference_energy", energy);
        }
        out.finish()
    }
}

impl<const D: usize> Problem<D> {
    /// `-Laplace u = 0`, zero data, no constraint.
    pub fn new() -> Self {
        Self::default()
    }
    /// Adds a constant load. Loads of one name, or without a name, add up; to have another in place of one, set
    /// [the field](field@Problem::source).
    #[must_use]
    pub fn constant_source(mut self, f: f64) -> Self {
        self.source.add(ALL, f);
        self
    }
    /// Adds a load that is a smooth function of space. Other [data](Datum), discrete functions among them, are given by
    /// name, `source_in("default", u)`: a datum for the name `default` is one without a name.
    #[must_use]
    pub fn source(mut self, f: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static) -> Self {
        self.source.add(ALL, f);
        self
    }
    /// Adds a load that may jump, or have a kink, where `level` changes its sign: a rule across a jump
    /// would leave an error that is larger than that of the scheme. Several interfaces are the zeros
    /// of a product.
    ///
    /// In one dimension the integral over a cut cell is divided at the zero. In the plane and in space
    /// it is divided along the zero set, exactly along planes; on a sphere what goes to the wrong side has a
    /// mean thickness of 1e-5 (plane) to 1e-3 (space) times `h^2`, below the error of every scheme.
    /// A cell counts as cut if the sign of `level` differs between its vertices, the middles of its edges
    /// and its barycentre; an interface that enters and leaves through one facet between these points
    /// escapes. A smooth one does so in few cells, with a piece of the cell of order `h`.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// // pressed down near the ends of (0, 1), lifted between
    /// let away = |x: &Point<1>| (x[0] - 0.5).abs() - 0.3;
    /// let load = move |x: &Point<1>| if away(x) > 0.0 { -16.0 } else { 8.0 };
    /// let problem = Problem::new().piecewise_source(load, away);
    /// # assert!(problem.source.is_given());
    /// ```
    #[must_use]
    pub fn piecewise_source(
        mut self,
        f: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
        level: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.source.add(ALL, Datum::piecewise(f, level));
        self
    }
    /// Sets Dirichlet data.
    #[must_use]
    pub fn dirichlet(mut self, u: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static) -> Self {
        self.dirichlet.give(ALL, u.into());
        self
    }
    /// Sets Neumann data, a function of the point and the outward normal.
    #[must_use]
    pub fn neumann(
        mut self,
        q: impl Fn(&Point<D>, &Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.neumann.give(ALL, BoundaryFlux::Function(Arc::new(q)));
        self
    }
    /// Sets the diffusion coefficient.
    ///
    /// Elements whose basis functions are linear take one value in each cell, at its barycentre. Those with
    /// basis functions of degree `b > 1` take its values at the points of a rule of degree `2 b`
    /// in each cell, and on each facet from inside the cell; where these agree with the value at the
    /// barycentre but for rounding, that one alone is used. The coefficient may jump between cells. Where it
    /// jumps within them no element reaches more than the order 1/2 in H1.
    #[must_use]
    pub fn coefficient(mut self, alpha: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static) -> Self {
        self.coefficient.give(ALL, alpha.into());
        self
    }
    /// Sets the reaction coefficient: a number, a closure whose argument is written with its
    /// type, `|x: &Point<2>| ..`, or [`Datum::piecewise`].
    #[must_use]
    pub fn reaction(mut self, c: impl Into<Datum<D>>) -> Self {
        self.reaction.give(ALL, c.into());
        self
    }
    /// Sets an obstacle from below.
    #[must_use]
    pub fn obstacle_below(
        mut self,
        psi: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.lower.give(ALL, psi.into());
        self
    }
    /// Sets an obstacle from above.
    #[must_use]
    pub fn obstacle_above(
        mut self,
        psi: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.upper.give(ALL, psi.into());
        self
    }
    /// Sets the Signorini condition `u >= g` on the contact boundary.
    #[must_use]
    pub fn signorini(mut self, gap: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static) -> Self {
        self.gap.give(ALL, gap.into());
        self
    }
    /// Sets the constraint set: where obstacles and gap bind. A [`Study`](crate::study::Study) may
    /// give each of its schemes another one.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), Error> {
    /// let scene = scenes::radial::<2>(1.0);
    /// let mesh = scene.domain.mesh(4)?;
    /// let problem = scene.problem.on(FacetMeans);
    /// let discretisation =
    ///     Discretisation::new(&Wopsip::default(), &problem, &mesh, Default::default())?;
    /// // the obstacle at the barycentres of facets, from each of their cells
    /// assert_eq!(discretisation.unknowns(), 3 * mesh.n_cells());
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn on(mut self, set: impl ConstraintSet + 'static) -> Self {
        self.constraint_set = Some(Arc::new(set));
        self
    }
    /// States that every datum given as a function is in each cell, and on each boundary facet, a
    /// polynomial of at most this degree; for a single one see [`Datum::polynomial`]. The discretisation does not
    /// depend on it: [error bounds](crate::error_bound) are guaranteed only for data of which it is stated, or
    /// constants.
    #[must_use]
    pub fn polynomial_data(mut self, degree: usize) -> Self {
        self.data_degree = Some(degree);
        self
    }
    /// States that obstacles and gap, as far as they are functions without a name so far, are in each cell polynomials
    /// of at most this degree.
    #[must_use]
    pub fn obstacles_of_degree(mut self, degree: usize) -> Self {
        let of_degree = |datum: Datum<D>| match datum {
            Datum::Function(value) => Datum::Polynomial { value, degree },
            other => other,
        };
        for datum in [&mut self.lower, &mut self.upper, &mut self.gap] {
            datum.everywhere = datum.everywhere.take().map(of_degree);
        }
        self
    }
    /// Sets the exact solution and its gradient, and makes it the Dirichlet datum and, times the
    /// coefficient, the Neumann datum, unless those are set.
    #[must_use]
    pub fn exact(
        self,
        value: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
        gradient: impl Fn(&Point<D>) -> Point<D> + Send + Sync + 'static,
    ) -> Self {
        self.solved_by(Exact::new(value, gradient))
    }
    /// Sets the exact solution as [`Problem::exact`] does, with its multiplier and contact set where
    /// those are known.
    #[must_use]
    pub fn solved_by(mut self, exact: Exact<D>) -> Self {
        self.exact = Some(exact);
        self
    }
    /// Sets the minimum of the energy and its uncertainty.
    #[must_use]
    pub fn reference_energy(mut self, value: f64, uncertainty: f64) -> Self {
        self.reference_energy = Some(ReferenceEnergy { value, uncertainty });
        self
    }
    /// The constraint set in force.
    pub fn constraint_set(&self) -> &dyn ConstraintSet {
        self.constraint_set.as_deref().unwrap_or(&Nodes)
    }
    /// The Dirichlet value at a point.
    pub fn dirichlet_at(&self, x: &Point<D>) -> f64 {
        let exact = self.exact.as_ref().map(|exact| &exact.value);
        self.dirichlet.everywhere.as_ref().or(exact).map_or(0.0, |u| u.at(x))
    }
    /// Whether the problem has an obstacle in the domain.
    pub fn has_obstacle(&self) -> bool {
        self.lower.is_given() || self.upper.is_given()
    }
    /// Whether the problem has a Signorini condition somewhere on the boundary.
    pub fn has_gap(&self) -> bool {
        self.gap.is_given()
    }
    /// Whether the problem is an inequality.
    pub fn is_constrained(&self) -> bool {
        self.has_obstacle() || self.acts_on_boundary()
    }
    /// Whether a Signorini condition or friction acts somewhere on the boundary.
    pub fn acts_on_boundary(&self) -> bool {
        self.has_gap() || self.friction.is_given()
    }
    /// Whether Dirichlet data are given, by themselves or by the exact solution.
    pub fn has_dirichlet_data(&self) -> bool {
        self.dirichlet.is_given() || self.exact.is_some()
    }
    /// Whether Neumann data are given, by themselves, by Robin sides or by the exact solution.
    pub fn has_neumann_data(&self) -> bool {
        self.neumann.is_given() || self.robin.is_given() || self.exact.is_some()
    }
}
