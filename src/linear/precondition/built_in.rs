//! The preconditioners of this library.

use std::borrow::Cow;

use super::auxiliary_space::{AuxiliarySpace, VertexCorrection, unknowns_per_cell};
use super::coarse_spaces::CoarseSpaces;
use super::mean_jump_splitting::MeanJumpSplitting;
use super::multigrid::Multigrid;
use super::preconditioner::{PreconditionedSystem, Preconditioner, PreconditionerFamily};
use super::prolongation::Prolongation;
use crate::real::Real;

/// Multigrid for conforming linear functions, mean-jump splitting for linear functions that are coupled
/// by a penalty on jumps of facet means alone, multigrid with conforming linear functions as auxiliary space
/// for other linear functions and for all elements whose cells share unknowns, the sum of blocks of cells
/// and auxiliary space for other discontinuous elements.
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
        if let Some(penalised) = &inequality.penalised
            && let Some(splitting) = MeanJumpSplitting::new(matrix, penalised, supports, level)
        {
            return Some(Box::new(splitting));
        }
        if let Some(cell_size @ (1 | 3 | 4)) = unknowns_per_cell(supports)
            && matrix.size().is_multiple_of(cell_size)
        {
            let prolongation = Prolongation::to_element(supports, level.size())?;
            let matrix = Cow::Borrowed(matrix);
            return Some(Box::new(Multigrid::of_element(matrix, prolongation, level, cell_size)));
        }
        let multigrid = Multigrid::new(&level.matrix, level.coarser.as_ref());
        let correction =
            VertexCorrection::new(Box::new(multigrid), Cow::Borrowed(&level.fixed), supports)?;
        Some(Box::new(AuxiliarySpace::new(matrix, supports, correction)?))
    }
}
