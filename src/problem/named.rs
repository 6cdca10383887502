//! Data for named regions of cells and named groups of boundary facets.

use std::sync::Arc;

use super::datum::{BoundaryFlux, Datum};
use super::given::{ALL, AnyGiven};
use super::{Given, Problem, Robin, Tensor, ValueOf};
use crate::error::Error;
use crate::input::excerpt;
use crate::instances::compiled;
use crate::mesh::{BoundaryCondition, Mesh, MeshError};
use crate::real::Point;

/// Data for named regions and boundary groups.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), Error> {
/// // the square with its sides, its lower half of another material
/// let domain = BoxDomain::<2>::centred(1.0).side(1, 0, BoundaryCondition::Contact);
/// let mesh = Mesh::<2>::kuhn_box(&domain, [8, 8])?;
/// let is_below = |c| usize::from(mesh.barycentre(c)[1] < 0.0);
/// let of_cells = (0..mesh.n_cells()).map(|c| is_below(c) as u16).collect();
/// let names = vec![vec!["steel".to_owned()], vec!["rubber".to_owned()]];
/// let mesh = mesh.clone().with_regions(names, of_cells)?;
///
/// let problem = Problem::new()
///     .constant_source(-1.0)
///     .coefficient_in("rubber", 0.01)
///     .dirichlet_on("top", 0.0)
///     .neumann_on("left", |_, _| 0.0)
///     .neumann_on("right", |_, _| 0.0)
///     .signorini_on("bottom", -0.05);
/// let mesh = problem.bind_boundary(mesh)?;
/// let solved = solve(&problem, &mesh, &ConformingP1)?;
/// assert!(solved.converged() && solved.active() > Some(0));
/// # Ok(())
/// # }
/// ```
impl<const D: usize> Problem<D> {
    /// Asks for a number of the solution, which rows of reports have under this name.
    #[must_use]
    pub fn value(mut self, name: &str, of: ValueOf<D>) -> Self {
        self.values.push((name.to_owned(), of));
        self
    }
    /// Sets the diffusion coefficient in a region: a number, or a closure whose argument is written with
    /// its type, `|x: &Point<2>| ..`, or another [`Datum`]. It is one in regions for which none is given. Schemes
    /// evaluate one with a level at the points at which they evaluate one without; errors against an exact solution,
    /// whose gradient jumps on the zero set of the level, are integrated over cells divided along it.
    #[must_use]
    pub fn coefficient_in(mut self, region: &str, alpha: impl Into<Datum<D>>) -> Self {
        self.coefficient.give(region, alpha.into());
        self
    }
    /// Sets the tensor by which the diffusion coefficient is multiplied in a region: rows of numbers, or
    /// [`Tensor::function`]. It must be symmetric and positive definite. Linear elements take its value at the barycentre
    /// of each cell; on others only constants are possible.
    #[must_use]
    pub fn tensor_in(mut self, region: &str, tensor: impl Into<Tensor<D>>) -> Self {
        self.tensor.give(region, tensor.into());
        self
    }
    /// Adds a load in a region: a number or a closure, as for [`Problem::coefficient_in`].
    #[must_use]
    pub fn source_in(mut self, region: &str, f: impl Into<Datum<D>>) -> Self {
        self.source.add(region, f);
        self
    }
    /// Sets the reaction coefficient in a region.
    #[must_use]
    pub fn reaction_in(mut self, region: &str, c: impl Into<Datum<D>>) -> Self {
        self.reaction.give(region, c.into());
        self
    }
    /// Sets an obstacle from below in a region. Where regions meet the higher obstacle holds for
    /// unknowns that cells share.
    #[must_use]
    pub fn obstacle_below_in(mut self, region: &str, psi: impl Into<Datum<D>>) -> Self {
        self.lower.give(region, psi.into());
        self
    }
    /// Sets an obstacle from above in a region. Where regions meet the lower obstacle holds for
    /// unknowns that cells share.
    #[must_use]
    pub fn obstacle_above_in(mut self, region: &str, psi: impl Into<Datum<D>>) -> Self {
        self.upper.give(region, psi.into());
        self
    }
    /// Sets Dirichlet data on a boundary group. Unknowns on several Dirichlet groups take the value of
    /// the group whose data were given first; schemes that impose Dirichlet data weakly take on each
    /// facet those of its own group.
    #[must_use]
    pub fn dirichlet_on(mut self, group: &str, u: impl Into<Datum<D>>) -> Self {
        self.dirichlet.give(group, u.into());
        self
    }
    /// Sets Neumann data on a boundary group, a function of the point and the outward normal.
    #[must_use]
    pub fn neumann_on(
        mut self,
        group: &str,
        q: impl Fn(&Point<D>, &Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        let flux = BoundaryFlux::Function(Arc::new(q));
        self.neumann.give(group, flux);
        self
    }
    /// Makes a boundary group a Robin side, `alpha du/dn + k (u - g) = 0` with the coefficient `k >= 0` and the value `g`:
    /// numbers or closures, as for [`Problem::coefficient_in`].
    #[must_use]
    pub fn robin_on(
        mut self,
        group: &str,
        coefficient: impl Into<Datum<D>>,
        value: impl Into<Datum<D>>,
    ) -> Self {
        self.robin.give(group, Robin::new(coefficient, value));
        self
    }
    /// Gives a boundary group simplified friction (Tresca): the flux is at most `g >= 0`, `|alpha du/dn| <= g`; where it is
    /// less, `u = 0` (stick), where `u > 0` it is `-g`, where `u < 0` it is `g` (slip). The problem is then the inequality of
    /// the second kind `a(u, v - u) + int g |v| - int g |u| >= l(v - u)` (F. Wang, W. Han, X. Cheng, SIAM J. Numer. Anal.
    /// 48 (2010), 708-733, section 2).
    #[must_use]
    pub fn friction_on(mut self, group: &str, threshold: impl Into<Datum<D>>) -> Self {
        self.friction.give(group, threshold.into());
        self
    }
    /// Sets the Signorini condition `u >= g` on a boundary group.
    #[must_use]
    pub fn signorini_on(mut self, group: &str, gap: impl Into<Datum<D>>) -> Self {
        self.gap.give(group, gap.into());
        self
    }

    /// All data with their names in messages; those of the boundary with the condition of their facets.
    pub(super) fn data(&self) -> [(&'static str, Option<BoundaryCondition>, &dyn AnyGiven); 11] {
        use BoundaryCondition::{Contact, Dirichlet, Neumann};
        [
            ("source", None, &self.source),
            ("coefficient", None, &self.coefficient),
            ("tensor coefficient", None, &self.tensor),
            ("reaction", None, &self.reaction),
            ("lower obstacle", None, &self.lower),
            ("upper obstacle", None, &self.upper),
            ("Dirichlet datum", Some(Dirichlet), &self.dirichlet),
            ("gap", Some(Contact), &self.gap),
            ("Neumann datum", Some(Neumann), &self.neumann),
            ("Robin datum", Some(Neumann), &self.robin),
            ("threshold of friction", Some(Neumann), &self.friction),
        ]
    }
    /// The names of regions that have data, and those of boundary groups with their condition.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, Option<BoundaryCondition>)> {
        self.data().into_iter().flat_map(|(_, condition, given)| {
            given.names().into_iter().map(move |name| (name, condition))
        })
    }
    /// Refuses two data of one kind for one name, or without a name.
    pub(crate) fn check_given_once(&self) -> Result<(), Error> {
        for (datum, _, given) in self.data() {
            if let Some(name) = given.given_twice() {
                let place = match name {
                    ALL => "without a name".to_owned(),
                    name => format!("for {}", excerpt(name)),
                };
                return Err(Error::GivenTwice(format!(
                    "the {datum} {place} is given twice: give it once; only sources add up"
                )));
            }
        }
        Ok(())
    }
    /// The boundary groups that have data, each with its condition.
    fn boundary_groups(&self) -> impl Iterator<Item = (&str, BoundaryCondition)> {
        self.names().filter_map(|(name, condition)| Some((name, condition?)))
    }
    /// The condition to which the data of a group belong.
    pub(super) fn condition_of(&self, group: &str) -> Option<BoundaryCondition> {
        self.boundary_groups().find(|(name, _)| *name == group).map(|(_, condition)| condition)
    }
    /// Whether some data are those of a named region or boundary group.
    pub(crate) fn has_named_data(&self) -> bool {
        self.names().next().is_some()
    }
    /// The data in a region with these names and on a boundary group with these names, without names.
    pub(crate) fn in_group(&self, region: &[String], boundary: &[String]) -> Self {
        fn of<F: Clone>(given: &Given<F>, names: &[String]) -> Given<F> {
            given.of(names).cloned().map_or_else(Given::default, Given::from)
        }
        Self {
            coefficient: of(&self.coefficient, region),
            tensor: of(&self.tensor, region),
            source: of(&self.source, region),
            reaction: of(&self.reaction, region),
            lower: of(&self.lower, region),
            upper: of(&self.upper, region),
            dirichlet: of(&self.dirichlet, boundary),
            neumann: of(&self.neumann, boundary),
            robin: of(&self.robin, boundary),
            friction: of(&self.friction, boundary),
            gap: of(&self.gap, boundary),
            ..self.clone()
        }
    }

    /// The mesh with the conditions of its boundary groups as the data of this problem say: Dirichlet where
    /// [`Problem::dirichlet_on`] names the group, and so on. Groups that the problem does not name keep
    /// their condition.
    ///
    /// # Errors
    /// `MeshErrorKind::GroupWithTwoConditions`, also where a group `dirichlet`, `neumann` or `contact` is given
    /// data of another kind.
    pub fn bind_boundary(&self, mesh: Mesh<D>) -> Result<Mesh<D>, MeshError> {
        compiled!(const D: fn(&Problem<D>, Mesh<D>) -> Result<Mesh<D>, MeshError>
                = Problem::bind
        )(self, mesh)
    }
    fn bind(&self, mesh: Mesh<D>) -> Result<Mesh<D>, MeshError> {
        let all: Vec<(&str, BoundaryCondition)> = self.boundary_groups().collect();
        for &(name, condition) in &all {
            let own = BoundaryCondition::from_name(name).map(|own| (name, own));
            let first = own.or_else(|| all.iter().copied().find(|(other, _)| *other == name));
            if let Some((first, other)) = first.filter(|(_, other)| *other != condition) {
                return Err(MeshError::two_conditions([first, name], [other, condition]));
            }
        }
        if all.is_empty() {
            return Ok(mesh);
        }
        mesh.with_boundary_conditions(&|name| self.condition_of(name))
    }
}
