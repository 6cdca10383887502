//! A scheme applied to a problem on a mesh, and what solves it.

use std::sync::Arc;
use std::time::Instant;

use super::piece::SharedPart;
use crate::algebra::{Inequality, any_part};
use crate::assemble::{DataQuadrature, Discretisation};
use crate::error::Error;
use crate::error_bound::NoBound;
use crate::inequality::{InequalitySolver, InitialGuess, Solution};
use crate::measure::SquaredErrors;
use crate::mesh::{Mesh, Part};
use crate::parallel::vectors::collect;
use crate::problem::{BodyConstants, Problem};
use crate::processes::{Numbering, OverParts, agree, agree_on_data, check_bounds};
use crate::real::Precision;
use crate::scheme::Scheme;

/// A mesh, or the part of a mesh that one process has, with the quadrature of data on it.
#[derive(Clone, Debug)]
pub(super) struct MeshOfSystem<'a, const D: usize> {
    pub mesh: &'a Mesh<D>,
    pub shared: Option<SharedPart<'a, D>>,
    pub quadrature: DataQuadrature,
    /// The constants of bodies on the mesh.
    pub constants: Arc<BodyConstants>,
}

/// A scheme applied to a problem on a mesh: its discretisation and its inequality. On a part of a mesh the unknowns
/// have numbers over all parts, and the inequality is distributed.
pub struct System<'a, const D: usize> {
    pub(super) discretisation: Discretisation<'a, D>,
    pub(super) inequality: Inequality<f64>,
    place: MeshOfSystem<'a, D>,
    over_parts: Option<Arc<OverParts>>,
    /// Seconds of assembly.
    pub(crate) assemble_seconds: f64,
    /// Seconds for the numbers of unknowns over all parts.
    pub(crate) numbering_seconds: f64,
}

impl<'a, const D: usize> System<'a, D> {
    /// The system; all parts call it.
    ///
    /// # Errors
    /// Those of assembly; on a part [`Error::Processes`] in all parts, with the error of the lowest part that has one.
    pub(super) fn new(
        scheme: &dyn Scheme<D>,
        problem: &'a Problem<D>,
        place: MeshOfSystem<'a, D>,
    ) -> Result<Self, Error> {
        if place.shared.is_some() && problem.friction.is_given() {
            let allowed = "on a whole mesh only: leave out the processes";
            return Err(Error::parameter("friction", "given", allowed));
        }
        let clock = Instant::now();
        let assemble = || {
            let data = (problem, place.constants.clone());
            let discretisation =
                Discretisation::with_constants(scheme, data, place.mesh, place.quadrature)?;
            let inequality = discretisation.inequality()?;
            Ok((discretisation, inequality))
        };
        let assembled = match place.shared {
            None => assemble()?,
            Some(SharedPart { part, exchange }) => {
                let assembled = agree_on_data(assemble(), &part.cells, &**exchange)?;
                check_bounds(part, &assembled.0, &**exchange)?;
                assembled
            }
        };
        let assemble_seconds = clock.elapsed().as_secs_f64();
        let (mut discretisation, mut inequality) = assembled;
        discretisation.forget_prepared();
        let clock = Instant::now();
        let number = |SharedPart { part, exchange }: SharedPart<'a, D>| {
            let numbering = Numbering::new(part, &discretisation, &**exchange)?;
            Ok::<_, Error>(Arc::new(OverParts::new(part.number, numbering, exchange.clone())))
        };
        let over_parts = place.shared.map(number).transpose()?;
        if let Some(over_parts) = &over_parts {
            inequality.distribution = Some(over_parts.clone());
        }
        let numbering_seconds = clock.elapsed().as_secs_f64();
        inequality.is_definite = !any_part(inequality.distribution(), !inequality.is_definite);
        Ok(Self {
            discretisation,
            inequality,
            place,
            over_parts,
            assemble_seconds,
            numbering_seconds,
        })
    }

    /// The system of another scheme for another problem, in the same place; all parts call it.
    pub(crate) fn beside<'p>(
        &self,
        scheme: &dyn Scheme<D>,
        problem: &'p Problem<D>,
    ) -> Result<System<'p, D>, Error>
    where
        'a: 'p,
    {
        System::new(scheme, problem, self.place.clone())
    }

    /// Values to which constants were to be added, one for each unknown or an empty list for zeros, as values to which
    /// those of this discretisation are.
    pub(super) fn with_own_constants(&self, values: &[f64], constants: &[f64]) -> Vec<f64> {
        let own = self.discretisation.constants();
        let at = |of: &[f64], i: usize| of.get(i).copied().unwrap_or(0.0);
        collect(values.len(), |i| values[i] + (at(constants, i) - at(&own, i)))
    }
    /// The discretisation.
    pub fn discretisation(&self) -> &Discretisation<'a, D> {
        &self.discretisation
    }
    /// The inequality; on a part of a mesh that of own unknowns and of ghosts.
    pub fn inequality(&self) -> &Inequality<f64> {
        &self.inequality
    }
    /// The mesh; on a part of a mesh, the mesh of the part.
    pub fn mesh(&self) -> &'a Mesh<D> {
        self.place.mesh
    }
    /// The part of a mesh that this process has; none if it has the whole.
    pub fn part(&self) -> Option<&'a Part<D>> {
        self.place.shared.map(|shared| shared.part)
    }
    /// The unknowns over all parts; none on a whole mesh.
    pub(crate) fn over_parts(&self) -> Option<&Arc<OverParts>> {
        self.over_parts.as_ref()
    }

    /// Whether a cell counts: on a part if it is an own one.
    pub(super) fn owns(&self, cell: usize) -> bool {
        self.part().is_none_or(|part| part.owns(cell))
    }
    /// A result that parts find each for itself; on parts an error of one is one of all.
    ///
    /// # Errors
    /// The error of the result; [`Error::Processes`] in all parts.
    pub(crate) fn agreed<V>(&self, result: Result<V, Error>) -> Result<V, Error> {
        match self.place.shared {
            None => result,
            Some(SharedPart { part, exchange }) => {
                Ok(agree_on_data(result, &part.cells, &**exchange)?)
            }
        }
    }
    /// As [`System::agreed`], of a bound.
    ///
    /// # Errors
    /// Why there is no bound; on parts [`Error::Processes`] in all.
    pub(super) fn agreed_bound<V>(&self, result: Result<V, NoBound>) -> Result<V, NoBound> {
        match self.place.shared {
            None => result,
            Some(SharedPart { exchange, .. }) => {
                agree(result, &**exchange).map_err(|error| NoBound::Data(error.into()))
            }
        }
    }
    /// The squared errors of all parts, of those of this one.
    pub(super) fn merged(&self, own: Result<SquaredErrors, Error>) -> Result<SquaredErrors, Error> {
        Ok(self.agreed(own)?.over_parts(self.inequality.distribution()))
    }
    /// Numbers of this part summed over all parts.
    pub(super) fn sums<const N: usize>(&self, mut own: [f64; N]) -> [f64; N] {
        self.inequality.distribution().sum(&mut own);
        own
    }
    /// The numbers of cells, unknowns and stored entries of the matrix; over all parts.
    pub(super) fn sizes(&self) -> [u64; 3] {
        let (cells, inequality) = (self.mesh().n_cells(), &self.inequality);
        let own_cells = (0..cells).filter(|&cell| self.owns(cell)).count();
        let own = (0..inequality.size()).filter(|&i| inequality.owns(i));
        let (mut unknowns, mut entries) = (0, 0);
        for i in own {
            unknowns += 1;
            entries += inequality.matrix.row(i).0.len();
        }
        self.sums([own_cells, unknowns, entries].map(|n| n as f64)).map(|n| n as u64)
    }
}

/// Solves the inequality of a system, of which it may ask more than the inequality says.
///
/// Every [`InequalitySolver`] is one.
pub trait SystemSolver<const D: usize> {
    /// The name in reports and options.
    fn name(&self) -> &'static str;
    /// The precision in which the solver computes.
    fn precision(&self) -> Precision {
        Precision::Double
    }
    /// Solves the inequality; on a part of a mesh all parts call it. What does not converge is an
    /// [`Outcome`](crate::inequality::Outcome).
    ///
    /// # Errors
    /// [`Error::Parameter`] for a system that the solver does not take, [`Error::Processes`].
    fn solve(
        &self,
        system: &System<'_, D>,
        guess: &InitialGuess<f64>,
    ) -> Result<Solution<f64>, Error>;
    /// As [`InequalitySolver::uses_coarse_spaces`].
    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        let _ = unknowns;
        false
    }
}

/// A solver that asks for the inequality alone.
pub(super) struct ByInequality<'a>(pub Arc<dyn InequalitySolver<f64> + 'a>);

impl<const D: usize> SystemSolver<D> for ByInequality<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn precision(&self) -> Precision {
        self.0.precision()
    }
    fn solve(
        &self,
        system: &System<'_, D>,
        guess: &InitialGuess<f64>,
    ) -> Result<Solution<f64>, Error> {
        Ok(self.0.solve_from(&system.inequality, guess))
    }
    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        self.0.uses_coarse_spaces(unknowns)
    }
}
