//! A fine solution in place of the exact one, against which rows are measured.

use std::sync::Arc;

use crate::error::Error;
use crate::mesh::Domain;
use crate::nested::Solved;
use crate::problem::Problem;
use crate::scheme::Scheme;

/// How many times as fine as every other level of a domain a reference is at least.
const FINER: usize = 4;

/// How many refinements finer than every other level of a mesh a reference is at least.
const REFINEMENTS: usize = 2;

/// The scheme, with its problem, and the level whose solution takes the place of the exact one.
pub(in crate::study) struct Reference<'a, const D: usize> {
    pub scheme: Arc<dyn Scheme<D> + 'a>,
    pub problem: Problem<D>,
    pub level: usize,
}

impl<const D: usize> Reference<'_, D> {
    /// The name in rows.
    pub fn name(&self) -> String {
        let label = self.scheme.label_on(self.problem.constraint_set());
        format!("{label} at level {}", self.level)
    }

    /// Checks that the reference is fine enough, and its mesh a refinement of all others.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self, domain: &Domain<D>, levels: &[usize]) -> Result<(), Error> {
        let refuse =
            |allowed: String| Err(Error::parameter("level of the reference", self.level, allowed));
        let finest = levels.iter().copied().max().unwrap_or(0);
        if matches!(domain, Domain::Mesh(mesh) if mesh.has_shapes()) {
            return refuse(
                "none: a boundary group of the mesh has a shape, onto which refinements move, so that they are not nested"
                    .to_owned(),
            );
        }
        if domain.is_mesh() {
            let least = finest + REFINEMENTS;
            return match self.level >= least {
                true => Ok(()),
                false => refuse(format!(
                    "at least {least}, {REFINEMENTS} refinements finer than the finest level"
                )),
            };
        }
        if matches!(domain, Domain::Disc { .. }) {
            return refuse(
                "none: meshes of a disc are refined towards the circle and are not nested"
                    .to_owned(),
            );
        }
        let is_refined = |&level: &usize| {
            level > 0 && self.level.is_multiple_of(level) && (self.level / level).is_power_of_two()
        };
        match levels.iter().find(|level| !is_refined(level)) {
            Some(level) => refuse(format!(
                "a power of two times every level, which {} is not of {level}",
                self.level
            )),
            None if self.level < FINER * finest => {
                refuse(format!("at least {}, {FINER} times the finest level", FINER * finest))
            }
            None => Ok(()),
        }
    }
}

/// A solution in place of the exact one.
pub(in crate::study) struct ReferenceSolution<'p, const D: usize> {
    pub solved: Solved<'p, D>,
    /// The name in rows.
    pub name: String,
    /// The values for which the problem asks.
    pub values: Vec<Option<f64>>,
}

/// A solution in place of the exact one, or why there is none.
pub(in crate::study) type FoundReference<'p, const D: usize> =
    Result<ReferenceSolution<'p, D>, String>;
