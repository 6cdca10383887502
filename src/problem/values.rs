//! Numbers of a solution for which a problem asks by name.

use super::Problem;
use super::given::ALL;
use super::unknown_name::unknown;
use crate::mesh::{BoundaryCondition, Mesh, describe_point};
use crate::real::Point;

/// A barycentric coordinate that is negative by no more than this counts as zero.
pub(crate) const ROUNDING: f64 = 1e-8;

/// A number that a solution has. Names are those of regions or of boundary groups; `default` stands for all of them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ValueOf<const D: usize> {
    /// The solution at a point: the mean over the cells that contain it.
    At(Point<D>),
    /// The mean over a region.
    Mean(String),
    /// The largest value in a region.
    Largest(String),
    /// The smallest value in a region.
    Smallest(String),
    /// The integral over a boundary group.
    Integral(String),
    /// The force that a Dirichlet group or a Robin side exerts on the body, positive in the direction of the solution.
    Reaction(String),
    /// The force of a contact group, or of friction on a group, on the body.
    Force(String),
}

impl<const D: usize> ValueOf<D> {
    /// Whether a region or boundary group with these names is meant by a name.
    pub(crate) fn is_meant(name: &str, names: &[String]) -> bool {
        name == ALL || names.iter().any(|of| of == name)
    }

    /// Why a mesh does not have the value, in a sentence, if it does not.
    pub(crate) fn fault(&self, problem: &Problem<D>, mesh: &Mesh<D>) -> Option<String> {
        let (name, condition) = match self {
            Self::At(x) => {
                return mesh.cells_containing(x, ROUNDING).next().is_none().then(|| {
                    format!("the point {} lies outside of the domain", describe_point(x))
                });
            }
            Self::Mean(name) | Self::Largest(name) | Self::Smallest(name) => {
                let known = mesh.regions();
                return (!known.iter().any(|names| Self::is_meant(name, names)))
                    .then(|| unknown("region", name, known.iter().flatten()));
            }
            Self::Integral(name) => (name, None),
            Self::Reaction(name) => (name, Some(BoundaryCondition::Dirichlet)),
            Self::Force(name) => (name, Some(BoundaryCondition::Contact)),
        };
        let is_of_kind = |group: &usize| {
            let group = &mesh.boundary_groups()[*group];
            let is_side = || match self {
                Self::Reaction(_) => problem.robin.of(&group.names).is_some(),
                Self::Force(_) => problem.friction.of(&group.names).is_some(),
                _ => false,
            };
            condition.is_none_or(|condition| group.condition == Some(condition) || is_side())
        };
        let names = |group: usize| &mesh.boundary_groups()[group].names;
        let mut known = (0..mesh.boundary_groups().len()).filter(is_of_kind);
        let kind = match (self, condition) {
            (Self::Reaction(_), _) => "dirichlet or robin ".to_owned(),
            (Self::Force(_), _) => "contact or friction ".to_owned(),
            (_, condition) => condition.map_or(String::new(), |of| format!("{} ", of.name())),
        };
        let all = known.clone().flat_map(names);
        (!known.any(|group| Self::is_meant(name, names(group))))
            .then(|| unknown(&format!("{kind}boundary group"), name, all))
    }
}
