//! A scene: a named inequality on a domain.

use crate::mesh::Domain;
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
    /// The built-in domain.
    pub domain: Domain<D>,
    /// The data.
    pub problem: Problem<D>,
    /// What is known of the solution's regularity.
    pub regularity: Regularity,
}

impl<const D: usize> Scene<D> {
    /// A scene without a summary, of whose solution no more is known than that it has finite energy
    /// ([`Regularity::finite_energy`]).
    pub fn new(name: impl Into<String>, domain: impl Into<Domain<D>>, problem: Problem<D>) -> Self {
        let (name, domain, regularity) = (name.into(), domain.into(), Regularity::finite_energy());
        Self { name, summary: "", domain, problem, regularity }
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
