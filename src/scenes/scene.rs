//! A scene: a named inequality on a domain.

use crate::mesh::{Domain, Mesh, MeshError};
use crate::problem::Problem;
use crate::scheme::Regularity;

/// A named inequality on a domain.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Scene<const D: usize> {
    /// The name users type.
    pub name: String,
    /// One line for lists.
    pub summary: &'static str,
    /// The domain: built in, or a mesh.
    pub domain: Domain<D>,
    /// The data.
    pub problem: Problem<D>,
    /// The known regularity of the solution.
    pub regularity: Regularity,
}

/// A problem over the plane obstacle `psi = 0`.
pub(super) fn over_plane<const D: usize>() -> Problem<D> {
    Problem::new().obstacle_below(|_| 0.0).obstacles_of_degree(0)
}

/// A Signorini problem with the gap zero.
pub(super) fn zero_gap<const D: usize>() -> Problem<D> {
    Problem::new().signorini(|_| 0.0).obstacles_of_degree(0)
}

impl<const D: usize> Scene<D> {
    /// A scene without a summary, of whose solution no more is known than that it has finite energy
    /// ([`Regularity::finite_energy`]).
    pub fn new(name: impl Into<String>, domain: impl Into<Domain<D>>, problem: Problem<D>) -> Self {
        let (name, domain, regularity) = (name.into(), domain.into(), Regularity::finite_energy());
        Self { name, summary: "", domain, problem, regularity }
    }
    /// A problem of one's own on a mesh and its refinements. The data of the problem give the boundary its conditions
    /// ([`Problem::bind_boundary`]).
    ///
    /// # Errors
    /// `MeshErrorKind::GroupWithTwoConditions` where two data claim one boundary group.
    pub fn of_problem(
        name: impl Into<String>,
        problem: Problem<D>,
        mesh: Mesh<D>,
    ) -> Result<Self, MeshError> {
        Ok(Self::new(name, problem.bind_boundary(mesh)?, problem))
    }
    /// The same inequality on another domain, such as a mesh.
    #[must_use]
    pub fn domain(mut self, domain: impl Into<Domain<D>>) -> Self {
        self.domain = domain.into();
        self
    }
    /// Sets the line for lists.
    #[must_use]
    pub fn summary(mut self, summary: &'static str) -> Self {
        self.summary = summary;
        self
    }
    /// Sets the regularity of the solution, on which promised orders depend.
    #[must_use]
    pub fn regularity(mut self, regularity: Regularity) -> Self {
        self.regularity = regularity;
        self
    }
}
