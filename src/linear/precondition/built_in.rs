//! The preconditioners of this library.

use super::auxiliary_space::{AuxiliarySpace, VertexCorrection};
use super::coarse_spaces::CoarseSpaces;
use super::mean_jump_splitting::MeanJumpSplitting;
use super::multigrid::Multigrid;
use super::preconditioner::{PreconditionedSystem, Preconditioner, PreconditionerFamily};
use crate::real::Real;

/// Multigrid for conforming linear functions, mean-jump splitting for linear functions that are coupled
/// by a penalty on jumps of facet means alone, auxiliary spaces for all other elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuiltInPreconditioners;

impl<T: Real> PreconditionerFamily<T> for BuiltInPreconditioners {
    fn name(&self) -> &'static str {
        "built-in"
    }

    fn preconditioner<'a>(
        &self,
        system: PreconditionedSystem<'a, T>,
    ) -> Option<Box<dyn Preconditioner<T> + 'a>> {
        let PreconditionedSystem { matrix, inequality, spaces } = system;
        let level = match spaces {
            CoarseSpaces::Unknown => return Some(Box::new(Multigrid::new(matrix, None))),
            CoarseSpaces::CoarseLevel(coarser) => {
                return Some(Box::new(Multigrid::new(matrix, Some(coarser))));
            }
            CoarseSpaces::SameMesh(level) => level,
        };
        let supports = &inequality.supports;
        let correction = || {
            let multigrid = Multigrid::new(&level.matrix, level.coarser.as_ref());
            VertexCorrection::new(multigrid, &level.fixed, supports)
        };
        if let Some(penalised) = &inequality.penalised
            && let Some(splitting) = MeanJumpSplitting::new(matrix, penalised, supports, correction)
        {
            return Some(Box::new(splitting));
        }
        Some(Box::new(AuxiliarySpace::new(matrix, supports, correction()?)?))
    }
}
