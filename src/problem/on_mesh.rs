//! The data of a problem on a mesh: found by region and boundary group once, then by number.

use std::sync::Arc;

use super::datum::{BoundaryFlux, Datum, Shifted};
use super::unknown_name::unknown_name;
use super::{BodyConstants, Given, Problem, Robin, Tensor};
use crate::error::Error;
use crate::input::{excerpt, excerpts};
use crate::mesh::{BoundaryCondition, BoundaryGroup, Mesh, MeshError};

/// What is given in each region, or on each boundary group.
#[derive(Clone)]
pub(crate) struct ByGroup<F> {
    /// Where no data have names.
    everywhere: Option<F>,
    /// By number of the group; empty if no data have names.
    by_group: Vec<Option<F>>,
}

impl<F: Clone> ByGroup<F> {
    /// A datum of a problem in regions, or on boundary groups, with these names.
    fn new(given: &Given<F>, groups: &[&[String]]) -> Self {
        let groups = if given.named.is_empty() { &[] } else { groups };
        let by_group = groups.iter().map(|names| given.of(names).cloned()).collect();
        Self { everywhere: given.everywhere.clone(), by_group }
    }
    /// The same with a datum for groups that have none.
    fn or(self, other: Option<&F>) -> Self {
        let or = |datum: Option<F>| datum.or_else(|| other.cloned());
        Self {
            everywhere: or(self.everywhere),
            by_group: self.by_group.into_iter().map(or).collect(),
        }
    }
    /// What a function makes of the datum of each of so many groups, which are told apart only where data have names or
    /// the function tells them apart.
    fn changed(
        &self,
        (groups, tells_apart): (usize, bool),
        change: impl Fn(usize, Option<&F>) -> Option<F>,
    ) -> Self {
        match self.has_names() || tells_apart {
            true => {
                let by_group = (0..groups).map(|group| change(group, self.of(group))).collect();
                Self { everywhere: None, by_group }
            }
            false => Self { everywhere: change(0, self.everywhere.as_ref()), by_group: Vec::new() },
        }
    }
    /// The same, told apart by groups, with none on boundary groups of another condition: it is no part of the problem.
    fn on(self, condition: BoundaryCondition, groups: &[BoundaryGroup]) -> Self {
        let has_condition = |group: usize| groups[group].condition == Some(condition);
        let on_group = |group, datum: Option<&F>| datum.filter(|_| has_condition(group)).cloned();
        if self.everywhere.is_none() && self.by_group.is_empty() {
            return self;
        }
        self.changed((groups.len(), true), on_group)
    }
}

impl<F> ByGroup<F> {
    /// The datum of a group.
    #[inline(always)]
    pub fn of(&self, group: usize) -> Option<&F> {
        match self.by_group.is_empty() {
            true => self.everywhere.as_ref(),
            false => self.by_group[group].as_ref(),
        }
    }
    /// The data of all groups; one entry if none have names.
    pub fn all(&self) -> impl Iterator<Item = &F> {
        let everywhere = self.everywhere.as_ref().filter(|_| self.by_group.is_empty());
        everywhere.into_iter().chain(self.by_group.iter().flatten())
    }
    /// Whether there is a datum anywhere.
    pub fn is_given(&self) -> bool {
        self.any(&|_| true)
    }
    /// Whether some datum has a property.
    pub fn any(&self, has: &dyn Fn(&F) -> bool) -> bool {
        self.all().any(has)
    }
    /// Whether all data have a property.
    pub fn every(&self, has: &dyn Fn(&F) -> bool) -> bool {
        self.all().all(has)
    }
    /// Whether some data have names.
    pub fn has_names(&self) -> bool {
        !self.by_group.is_empty()
    }
}

/// Data that are functions of space.
pub(crate) type DataByGroup<const D: usize> = ByGroup<Datum<D>>;

/// The data of a problem on a mesh, those of the boundary on facets with their condition.
#[derive(Clone)]
pub(crate) struct DataOnMesh<const D: usize> {
    pub coefficient: DataByGroup<D>,
    pub tensor: ByGroup<Tensor<D>>,
    pub source: DataByGroup<D>,
    pub reaction: DataByGroup<D>,
    pub lower: DataByGroup<D>,
    pub upper: DataByGroup<D>,
    pub dirichlet: DataByGroup<D>,
    pub gap: DataByGroup<D>,
    pub neumann: ByGroup<BoundaryFlux<D>>,
    pub robin: ByGroup<Robin<D>>,
    pub friction: DataByGroup<D>,
    /// For each boundary group the rank of its Dirichlet datum: of unknowns on several groups those of
    /// the lowest rank take precedence.
    pub dirichlet_rank: Vec<usize>,
    /// Whether bodies have different constants, which were taken off.
    constants_differ: bool,
}

impl<const D: usize> DataOnMesh<D> {
    /// The data of a problem on a mesh.
    ///
    /// # Errors
    /// [`Error::GivenTwice`], [`Error::UnknownGroup`] for a name that the mesh does not have, [`Error::Mesh`] for a boundary
    /// group of undecided condition, [`Error::UnboundBoundary`] for one with another condition than its data.
    pub fn new(problem: &Problem<D>, mesh: &Mesh<D>) -> Result<Self, Error> {
        problem.check_given_once()?;
        mesh.check_boundary_conditions()?;
        let mut found = Self::of_groups(problem, mesh)?;
        let on_mesh =
            |_: usize, source: Option<&Datum<D>>| source.map(|source| source.on_mesh(mesh));
        found.source = found.source.changed((mesh.regions().len(), false), on_mesh);
        let Self { coefficient, source, reaction, lower, upper, gap, .. } = &found;
        let data = [coefficient, source, reaction, lower, upper, gap].into_iter();
        let robin = found.robin.all().flat_map(Robin::data).chain(found.friction.all());
        let data = data.flat_map(|data| data.all()).chain(robin);
        let discrete = data.flat_map(|datum| datum.discrete());
        discrete.for_each(|u| u.prepare_for(mesh));
        Ok(found)
    }

    /// The data less constants of bodies: of Dirichlet data, obstacles and gaps the constant, of sources the constant
    /// times the reaction.
    #[must_use]
    pub fn less(mut self, constants: &Arc<BodyConstants>, mesh: &Mesh<D>) -> Self {
        if constants.are_zero() {
            return self;
        }
        let (regions, groups) = (mesh.regions().len(), mesh.boundary_groups().len());
        let bound = |_: usize, datum: Option<&Datum<D>>| {
            datum.map(|datum| Shifted::datum(Some(datum), None, (constants, mesh)))
        };
        self.lower = self.lower.changed((regions, false), bound);
        self.upper = self.upper.changed((regions, false), bound);
        self.gap = self.gap.changed((groups, false), bound);
        // groups without a datum have the value zero
        self.dirichlet = self.dirichlet.changed((groups, false), |_, datum| {
            Some(Shifted::datum(datum, None, (constants, mesh)))
        });
        self.robin =
            self.robin.changed((groups, false), |_, side| Some(side?.less(constants, mesh)));
        let reaction = &self.reaction;
        self.source = self.source.changed((regions, reaction.has_names()), |region, source| {
            match reaction.of(region) {
                Some(reaction) => Some(Shifted::datum(source, Some(reaction), (constants, mesh))),
                None => source.cloned(),
            }
        });
        self.constants_differ = constants.differ();
        self
    }

    /// Whether two cells may have different obstacles at a point that both contain.
    pub fn obstacles_differ(&self) -> bool {
        let differ = |data: &DataByGroup<D>| data.has_names() || data.any(&|psi| psi.is_discrete());
        self.constants_differ || differ(&self.lower) || differ(&self.upper)
    }

    /// The data of a problem in regions and boundary groups.
    fn of_groups(problem: &Problem<D>, mesh: &Mesh<D>) -> Result<Self, Error> {
        for (name, condition) in problem.names() {
            if let Some(message) = unknown_name(mesh, name, condition.is_some()) {
                return Err(Error::UnknownGroup(message));
            }
        }
        let boundary = mesh.boundary_groups();
        let regions: Vec<&[String]> = mesh.regions().iter().map(|names| &names[..]).collect();
        let groups: Vec<&[String]> = boundary.iter().map(|group| &group.names[..]).collect();
        let given = |group: &&BoundaryGroup| {
            let Problem { neumann, robin, friction, .. } = problem;
            let names = &group.names;
            let of = [neumann.position(names), robin.position(names), friction.position(names)];
            of.iter().flatten().count() > 1
        };
        if let Some(group) = boundary.iter().find(given) {
            return Err(Error::GivenTwice(format!(
                "facets of boundary group {} have two of a flux, Robin data and friction: give one of them",
                excerpts(group.names.iter())
            )));
        }
        for group in boundary {
            let given = group.names.iter().find_map(|n| Some((n, problem.condition_of(n)?)));
            match (given, group.condition) {
                (Some((name, given)), Some(found)) if given != found => {
                    return Err(Error::UnboundBoundary(format!(
                        "the problem has {} data on boundary group {}, whose facets are {} in the mesh: bind the problem to the mesh by Problem::bind_boundary",
                        given.name(),
                        excerpt(name),
                        found.name()
                    )));
                }
                (None, Some(BoundaryCondition::Contact))
                    if problem.gap.everywhere.is_none() && problem.gap.is_given() =>
                {
                    return Err(MeshError::undecided(&group.names).into());
                }
                _ => {}
            }
        }
        let in_regions = |given| ByGroup::new(given, &regions);
        let exact = problem.exact.as_ref().map(|exact| &exact.value);
        let rank = |names: &[String]| {
            problem.dirichlet.position(names).unwrap_or(problem.dirichlet.named.len())
        };
        Ok(Self {
            coefficient: in_regions(&problem.coefficient),
            tensor: ByGroup::new(&problem.tensor, &regions),
            source: in_regions(&problem.source),
            reaction: in_regions(&problem.reaction),
            lower: in_regions(&problem.lower),
            upper: in_regions(&problem.upper),
            dirichlet: ByGroup::new(&problem.dirichlet, &groups)
                .or(exact)
                .on(BoundaryCondition::Dirichlet, boundary),
            gap: ByGroup::new(&problem.gap, &groups).on(BoundaryCondition::Contact, boundary),
            neumann: ByGroup::new(&problem.neumann, &groups)
                .on(BoundaryCondition::Neumann, boundary),
            robin: ByGroup::new(&problem.robin, &groups).on(BoundaryCondition::Neumann, boundary),
            friction: ByGroup::new(&problem.friction, &groups)
                .on(BoundaryCondition::Neumann, boundary),
            dirichlet_rank: groups.iter().map(|names| rank(names)).collect(),
            constants_differ: false,
        })
    }
}
