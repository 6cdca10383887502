//! Data for named regions of cells and named groups of boundary facets.

use std::sync::Arc;

use super::Problem;
use super::datum::{BoundaryFlux, Datum};
use crate::input::excerpt;
use crate::instances::compiled;
use crate::mesh::{BoundaryPart, Mesh, MeshError};
use crate::real::Point;

/// Data by the name of a region or boundary group, in the order in which they were given.
///
/// A cell in several named groups takes the datum that was given first; a cell in none of them takes
/// the datum of the problem without a name. Boundary facets likewise.
#[derive(Clone, Default)]
#[non_exhaustive]
pub struct NamedData<const D: usize> {
    /// Diffusion coefficients by region.
    pub coefficient: Vec<(String, Datum<D>)>,
    /// Loads by region.
    pub source: Vec<(String, Datum<D>)>,
    /// Reaction coefficients by region.
    pub reaction: Vec<(String, Datum<D>)>,
    /// Obstacles from below by region.
    pub lower: Vec<(String, Datum<D>)>,
    /// Obstacles from above by region.
    pub upper: Vec<(String, Datum<D>)>,
    /// Dirichlet data by boundary group.
    pub dirichlet: Vec<(String, Datum<D>)>,
    /// Neumann data by boundary group.
    pub neumann: Vec<(String, BoundaryFlux<D>)>,
    /// Signorini gaps by boundary group.
    pub gap: Vec<(String, Datum<D>)>,
}

impl<const D: usize> NamedData<D> {
    /// The boundary groups that have data, each with its part.
    fn boundary_groups(&self) -> impl Iterator<Item = (&str, BoundaryPart)> {
        let dirichlet = self.dirichlet.iter().map(|(name, _)| (&name[..], BoundaryPart::Dirichlet));
        let contact = self.gap.iter().map(|(name, _)| (&name[..], BoundaryPart::Contact));
        let neumann = self.neumann.iter().map(|(name, _)| (&name[..], BoundaryPart::Neumann));
        dirichlet.chain(contact).chain(neumann)
    }
    /// The part of the boundary to which the data of a group belong.
    pub fn part_of(&self, group: &str) -> Option<BoundaryPart> {
        self.boundary_groups().find(|(name, _)| *name == group).map(|(_, part)| part)
    }
    /// The names of all data, with whether each is that of a boundary group.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, bool)> {
        let on_cells = [&self.coefficient, &self.source, &self.reaction, &self.lower, &self.upper];
        let on_cells = on_cells.into_iter().flatten().map(|(name, _)| (&name[..], false));
        on_cells.chain(self.boundary_groups().map(|(name, _)| (name, true)))
    }
}

/// Data for named regions and boundary groups.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), Error> {
/// // the square with its sides, its lower half of another material
/// let domain = BoxDomain::<2>::centred(1.0).side(1, 0, BoundaryPart::Contact);
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
    /// Sets the diffusion coefficient in a region: a number, or a closure whose argument is written with
    /// its type, `|x: &Point<2>| ..`. It is one in regions for which none is given.
    #[must_use]
    pub fn coefficient_in(mut self, region: &str, alpha: impl Into<Datum<D>>) -> Self {
        self.named.coefficient.push((region.to_owned(), alpha.into()));
        self
    }
    /// Sets the load in a region, as [`Problem::coefficient_in`] the coefficient.
    #[must_use]
    pub fn source_in(mut self, region: &str, f: impl Into<Datum<D>>) -> Self {
        self.named.source.push((region.to_owned(), f.into()));
        self
    }
    /// Sets the reaction coefficient in a region.
    #[must_use]
    pub fn reaction_in(mut self, region: &str, c: impl Into<Datum<D>>) -> Self {
        self.named.reaction.push((region.to_owned(), c.into()));
        self
    }
    /// Sets an obstacle from below in a region. Where regions meet the higher obstacle holds for
    /// unknowns that cells share.
    #[must_use]
    pub fn obstacle_below_in(mut self, region: &str, psi: impl Into<Datum<D>>) -> Self {
        self.named.lower.push((region.to_owned(), psi.into()));
        self
    }
    /// Sets an obstacle from above in a region. Where regions meet the lower obstacle holds for
    /// unknowns that cells share.
    #[must_use]
    pub fn obstacle_above_in(mut self, region: &str, psi: impl Into<Datum<D>>) -> Self {
        self.named.upper.push((region.to_owned(), psi.into()));
        self
    }
    /// Sets Dirichlet data on a boundary group. Unknowns on several Dirichlet groups take the value of
    /// the group whose data were given first; schemes that impose Dirichlet data weakly take on each
    /// facet those of its own group.
    #[must_use]
    pub fn dirichlet_on(mut self, group: &str, u: impl Into<Datum<D>>) -> Self {
        self.named.dirichlet.push((group.to_owned(), u.into()));
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
        self.named.neumann.push((group.to_owned(), flux));
        self
    }
    /// Sets the Signorini condition `u >= g` on a boundary group.
    #[must_use]
    pub fn signorini_on(mut self, group: &str, gap: impl Into<Datum<D>>) -> Self {
        self.named.gap.push((group.to_owned(), gap.into()));
        self
    }

    /// Whether some data are those of a named region or boundary group.
    pub(crate) fn has_named_data(&self) -> bool {
        self.named.names().next().is_some()
    }
    /// The data in a region with these names and on a boundary group with these names, without names.
    pub(crate) fn in_group(&self, region: &[String], boundary: &[String]) -> Self {
        fn first<F: Clone>(
            named: &[(String, F)],
            names: &[String],
            other: &Option<F>,
        ) -> Option<F> {
            let found = named.iter().find(|(name, _)| names.contains(name));
            found.map(|(_, datum)| datum.clone()).or_else(|| other.clone())
        }
        let named = &self.named;
        Self {
            coefficient: first(&named.coefficient, region, &self.coefficient),
            source: first(&named.source, region, &self.source),
            reaction: first(&named.reaction, region, &self.reaction),
            lower: first(&named.lower, region, &self.lower),
            upper: first(&named.upper, region, &self.upper),
            dirichlet: first(&named.dirichlet, boundary, &self.dirichlet),
            neumann: first(&named.neumann, boundary, &self.neumann),
            gap: first(&named.gap, boundary, &self.gap),
            named: NamedData::default(),
            ..self.clone()
        }
    }

    /// The mesh with the parts of its boundary groups as the data of this problem say: Dirichlet where
    /// [`Problem::dirichlet_on`] names the group, and so on. Groups that the problem does not name keep
    /// their part.
    ///
    /// # Errors
    /// [`MeshError::GroupInTwoParts`], also where a group `dirichlet`, `neumann` or `contact` is given
    /// data of another kind.
    pub fn bind_boundary(&self, mesh: Mesh<D>) -> Result<Mesh<D>, MeshError> {
        compiled!(const D: fn(&Problem<D>, Mesh<D>) -> Result<Mesh<D>, MeshError>
                = Problem::bind
        )(self, mesh)
    }
    fn bind(&self, mesh: Mesh<D>) -> Result<Mesh<D>, MeshError> {
        let all: Vec<(&str, BoundaryPart)> = self.named.boundary_groups().collect();
        for &(name, part) in &all {
            let own = BoundaryPart::from_name(name).map(|part| (name, part));
            let first = own.or_else(|| all.iter().copied().find(|(other, _)| *other == name));
            if let Some((first, other)) = first.filter(|(_, other)| *other != part) {
                let groups = Box::new([first, name].map(excerpt));
                return Err(MeshError::GroupInTwoParts {
                    groups,
                    parts: [other.name(), part.name()],
                });
            }
        }
        if all.is_empty() {
            return Ok(mesh);
        }
        mesh.with_boundary_parts(&|name| self.named.part_of(name))
    }
}
