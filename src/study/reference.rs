//! Against what rows are measured: the exact solution, or a fine solution in place of it.

use std::sync::Arc;

use crate::error::Error;
use crate::mesh::Domain;
use crate::nested::Solved;
use crate::problem::{Problem, ValueOf};
use crate::scheme::Scheme;
use crate::study::row::Row;

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

/// The kinds of the values for which a problem asks.
pub(super) fn kinds<const D: usize>(wanted: &[(String, ValueOf<D>)]) -> Vec<ValueOf<D>> {
    wanted.iter().map(|(_, of)| of.clone()).collect()
}

/// Against what rows are measured.
#[derive(Clone, Copy)]
pub(super) struct Measured<'m, 'p, const D: usize> {
    /// Where the exact solution breaks the contact condition of the mesh.
    pub failure: Option<&'m str>,
    /// The reference, where one was asked for.
    pub reference: Option<&'m FoundReference<'p, D>>,
}

impl<const D: usize> Measured<'_, '_, D> {
    /// Fills in energy, bound and errors, and why there are none.
    pub fn measure(&self, row: &mut Row, solved: &Solved<'_, D>) -> Result<(), Error> {
        row.energy = solved.energy()?;
        row.set_penetration(solved.penetration()?);
        match (self.reference, self.failure) {
            (Some(Ok(reference)), _) => {
                row.error = solved.difference(&reference.solved)?;
                row.contact = solved.contact_difference(&reference.solved)?;
                row.against = Some(reference.name.clone());
            }
            (Some(Err(why)), _) => row.warnings.push(format!("{why}: no errors")),
            (None, Some(at)) => row.warnings.push(format!(
                "the exact solution breaks the contact condition of this mesh at {at}: no errors"
            )),
            (None, None) if solved.discretisation().problem().exact.is_some() => {
                (row.error, row.bound) = solved.errors_and_bound_figures()?;
                row.contact = solved.contact_errors()?;
                row.against = Some("exact".to_owned());
            }
            (None, None) => {}
        }
        if row.against.as_deref() != Some("exact") {
            let with_v = self.failure.is_none() && self.reference.is_some();
            row.bound = solved.bound_figures(row.error.broken_energy, with_v);
        }
        self.set_values(row, solved)?;
        row.seconds.bound = solved.bound_seconds();
        let remark = row.bound.remark(row.against.as_deref());
        row.warnings.extend(remark.filter(|_| row.converged()));
        Ok(())
    }

    /// Fills in the values for which the problem asks, and their errors.
    fn set_values(&self, row: &mut Row, solved: &Solved<'_, D>) -> Result<(), Error> {
        let wanted = &solved.discretisation().problem().values;
        if wanted.is_empty() {
            return Ok(());
        }
        let kinds = kinds(wanted);
        let found = solved.values_of(&kinds)?;
        let of_exact;
        let known = match (self.reference, row.against.as_deref()) {
            (Some(Ok(reference)), _) => &reference.values[..],
            (_, Some("exact")) => {
                of_exact = solved.discretisation().exact_values_of(&kinds)?;
                &of_exact
            }
            _ => &[],
        };
        row.set_values(wanted, &found, known);
        Ok(())
    }
}
