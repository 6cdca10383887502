//! The preconditioners of this library.

use std::borrow::Cow;

use super::coarse_spaces::CoarseSpaces;
use super::mean_jump_splitting::MeanJumpSplitting;
use super::multigrid::Multigrid;
use super::preconditioner::{PreconditionedSystem, Preconditioner, PreconditionerFamily};
use super::prolongation::Prolongation;
use crate::algebra::DofLocation;
use crate::element::MAX_BASIS;
use crate::instances::compiled;
use crate::parallel::vectors::all;
use crate::real::Real;

/// The preconditioner that fits the coarse spaces and the element. The first case that applies counts:
///
/// 1. Multigrid, whose hierarchy comes from the coarser level or from aggregation, where the coarse spaces do not
///    contain conforming linear functions on the mesh of the inequality.
/// 2. The splitting into facet means and jumps, for discontinuous linear functions coupled by a penalty on jumps of
///    facet means alone.
/// 3. Multigrid with conforming linear functions as its second level. It smooths by unknowns where cells share unknowns
///    (conforming quadratics, Crouzeix-Raviart), and by cells for discontinuous linear and quadratic functions. There is
///    none for discontinuous elements with another number of unknowns in a cell.
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
        compiled!(
            T: for<'s> fn(PreconditionedSystem<'s, T>) -> Option<Box<dyn Preconditioner<T> + 's>>
                = fitting
        )(system)
    }
}

/// The preconditioner that fits a system.
fn fitting<T: Real>(
    system: PreconditionedSystem<'_, T>,
) -> Option<Box<dyn Preconditioner<T> + '_>> {
    let PreconditionedSystem { matrix, inequality, spaces } = system;
    let level = match spaces {
        CoarseSpaces::Unknown => return Some(Box::new(Multigrid::new(matrix, None))),
        CoarseSpaces::CoarseLevel(coarser) => {
            return Some(Box::new(Multigrid::new(matrix, Some(coarser))));
        }
        CoarseSpaces::SameMesh(level) => level,
    };
    let locations = &inequality.locations;
    if let Some(penalised) = &inequality.penalised
        && let Some(splitting) = MeanJumpSplitting::new(matrix, penalised, locations, level)
    {
        return Some(Box::new(splitting));
    }
    // 1: cells share unknowns
    let cell_size = unknowns_per_cell(locations)
        .filter(|size| [1, 2, 3, 4, 6, 10].contains(size) && matrix.size().is_multiple_of(*size))?;
    let prolongation = Prolongation::to_element(locations, level.size())?;
    let matrix = Cow::Borrowed(matrix);
    Some(Box::new(Multigrid::of_element(matrix, prolongation, level, cell_size)))
}

/// The number of unknowns of a cell, from the locations of all unknowns: one if no unknown belongs to a single cell.
/// If every unknown belongs to a cell: the number `n` of unknowns at the beginning of the list that belong to the cell
/// of the first unknown, provided that `n` is at most [`MAX_BASIS`] and the list consists of groups of `n` consecutive
/// unknowns, each group with one cell. `None` for every other list, and for the empty list.
///
/// The function does not check that two groups belong to different cells.
pub(crate) fn unknowns_per_cell(locations: &[DofLocation]) -> Option<usize> {
    let first = locations.first()?.cell();
    if first.is_none() {
        return all(locations.len(), |i| locations[i].cell().is_none()).then_some(1);
    }
    let size = locations.iter().take_while(|p| p.cell() == first).count();
    let is_of_group = |i: usize| {
        let cell = locations[i].cell();
        cell.is_some() && cell == locations[i / size * size].cell()
    };
    let are_groups = size <= MAX_BASIS && locations.len().is_multiple_of(size);
    (are_groups && all(locations.len(), is_of_group)).then_some(size)
}
