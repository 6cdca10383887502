//! A fine solution in place of the exact one, against which rows are measured.

use std::sync::Arc;

use super::{Progress, Study};
use crate::error::Error;
use crate::inequality::ActiveSet;
use crate::mesh::Domain;
use crate::nested::{Hierarchy, NestedIteration, Solved};
use crate::problem::Problem;
use crate::real::Precision;
use crate::scheme::Scheme;

/// How many times as fine as every other level of a domain a reference is at least.
const FINER: usize = 4;

/// How many refinements finer than every other level of a mesh a reference is at least.
const REFINEMENTS: usize = 2;

/// The scheme, with its problem, and the level whose solution takes the place of the exact one.
pub(super) struct Reference<'a, const D: usize> {
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
pub(super) struct ReferenceSolution<'p, const D: usize> {
    pub solved: Solved<'p, D>,
    /// The name in rows.
    pub name: String,
    /// The values for which the problem asks.
    pub values: Vec<Option<f64>>,
}

/// A solution in place of the exact one, or why there is none.
pub(super) type FoundReference<'p, const D: usize> = Result<ReferenceSolution<'p, D>, String>;

impl<const D: usize> Study<'_, D> {
    /// The reference on the finest mesh and its name in rows, where one is asked for. Where it cannot be had, rows have
    /// no errors and say why.
    pub(super) fn find_reference<'h>(
        &'h self,
        hierarchies: &'h [Hierarchy<D>],
    ) -> Option<FoundReference<'h, D>> {
        let (reference, hierarchy) = (self.reference.as_ref()?, hierarchies.first()?);
        let name = reference.name();
        (self.observer)(Progress::Started(&self.scene.name, &name, reference.level));
        // errors in single precision are measured against a reference in double precision
        let solver = match self.precision() {
            Precision::Double => self.solvers()[0].clone(),
            Precision::Single => Arc::new(ActiveSet::default()),
        };
        let mut nested = NestedIteration::new(&reference.problem, hierarchy)
            .shared_solver(solver)
            .quadrature(self.quadrature);
        let fails = |why: &str| format!("the reference, {name}, was not found: {why}");
        let kinds: Vec<_> = reference.problem.values.iter().map(|(_, of)| of.clone()).collect();
        let found = nested.solve(&*reference.scheme).and_then(|solved| {
            let values = if solved.converged() { solved.values_of(&kinds)? } else { Vec::new() };
            Ok((solved, values.iter().map(|found| found.value).collect()))
        });
        Some(match found {
            Ok((solved, _)) if !solved.converged() => Err(fails(solved.outcome().message())),
            Ok((solved, values)) => Ok(ReferenceSolution { solved, name, values }),
            Err(error) => Err(fails(&error.to_string())),
        })
    }
}
