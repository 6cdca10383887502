//! A preconditioner for discontinuous linear functions that are coupled only by a penalty on jumps
//! of facet means.
//!
//! A function has one mean over each of the two sides of a facet. In the basis of the averages of these two means and
//! of their differences, the jumps, the coupling of averages and jumps is weak. The form of jumps is nearly diagonal,
//! with the penalty on the diagonal. Functions without jumps are Crouzeix-Raviart functions, with multigrid for their
//! stiffness. Source: B. Ayuso de Dios, L. Zikatanov, J. Sci. Comput. 40 (2009), 4-36.

use std::borrow::Cow;

use super::coarse_level::P1Level;
use super::crouzeix_raviart_space::CrouzeixRaviartSpace;
use super::facet_mean_form::stiffness;
use super::mixed_block::{BlockFactors, BlockSolver, MixedBlock};
use super::multigrid::Multigrid;
use super::preconditioner::{FacetMeansSolver, Preconditioner};
use crate::algebra::{DofLocation, NO_INDEX, PenalisedMatrix, SidePenalties, SparseMatrix};
use crate::linear::direct::FactorError;
use crate::parallel::vectors::{all, collect, for_each_chunk, for_each_chunk_of_groups, indices};
use crate::real::Real;

/// The sum of a diagonal correction of jumps, a solution with factors on cells with free and fixed vertex values
/// (the mixed block), and a multigrid cycle on Crouzeix-Raviart functions, whose next coarser level has the conforming
/// linear functions.
///
/// In a cell without fixed unknowns the basis consists of facet mean functions. On a facet between two such cells,
/// average and jump are corrected separately. On a facet between such a cell and a cell with all unknowns fixed, and on
/// a facet with Dirichlet data, the mean over the one side is corrected. The free vertex values of cells with free and
/// fixed unknowns, and the means over the sides opposite to these cells, form the mixed block, in which two means are not
/// coupled; conforming linear functions that vanish at all vertices with fixed values correct both as well.
pub(crate) struct MeanJumpSplitting<'a, T: Real> {
    matrix: &'a SparseMatrix<T>,
    penalties: SidePenalties<T>,
    /// The form `K + M^T S M` of the facet mean function of each side with itself.
    diagonal: Vec<T>,
    space: CrouzeixRaviartSpace,
    /// The preconditioner of the stiffness on Crouzeix-Raviart functions.
    facet_means_solver: Box<dyn FacetMeansSolver<T> + 'a>,
    /// The location of each unknown.
    locations: &'a [DofLocation],
    /// Whether an unknown is fixed.
    fixed: Vec<bool>,
    /// Whether the values on each side are free.
    states: Vec<SideState>,
    /// Whether a facet has no Crouzeix-Raviart function in the correction.
    fixed_facets: Vec<bool>,
    /// The facets that are corrected by conforming linear functions alone.
    kept_facets: Vec<u32>,
    /// Whether a vertex has a fixed value in a cell; empty if the unknowns are means.
    fixed_vertices: Vec<bool>,
    /// Workspace: residuals and values of Crouzeix-Raviart functions.
    facet_residuals: Vec<T>,
    facet_means: Vec<T>,
    sides: SideCorrections<T>,
    mixed_block: MixedBlock<'a, T>,
    /// Workspace: residuals and corrections in the basis of facet mean functions.
    mean_residuals: Vec<T>,
    means: Vec<T>,
}

/// The diagonal corrections of the means over the sides of facets.
struct SideCorrections<T> {
    /// Whether a side and the opposite one are a pair, of which the jump is corrected.
    is_pair: Vec<bool>,
    /// For a side of a pair, the reciprocal of the form of the difference of the facet mean functions of the two sides
    /// with itself. For another side, the reciprocal of the form of its facet mean function with itself, or zero if the
    /// side has no diagonal correction.
    inverse_jump: Vec<T>,
}

impl<'a, T: Real> MeanJumpSplitting<'a, T> {
    /// The preconditioner of `matrix`, which contains the assembled entries of `penalised`; `None` if `penalised` is no
    /// penalty on jumps of means of discontinuous linear functions alone, or if
    /// a location has a vertex that `level` does not have.
    pub fn new(
        matrix: &'a SparseMatrix<T>,
        penalised: &PenalisedMatrix<T>,
        locations: &'a [DofLocation],
        level: &'a P1Level<T>,
    ) -> Option<Self> {
        let multigrid = |penalties: &SidePenalties<T>, space: &CrouzeixRaviartSpace| {
            let prolongation = space.prolongation(penalties, locations, level.size())?;
            let stiffness = Cow::Owned(space.matrix(penalties, penalised));
            let multigrid = Multigrid::of_element(stiffness, prolongation, level, 1);
            Some(Box::new(multigrid) as Box<dyn FacetMeansSolver<T> + 'a>)
        };
        let factors = Box::new(BlockFactors(None));
        Self::with_solvers(matrix, penalised, (locations, level.size()), multigrid, factors)
    }

    /// The preconditioner with given solvers for Crouzeix-Raviart functions and for the mixed block; all vertices
    /// of locations must be less than `n_vertices`. `None` as for [`MeanJumpSplitting::new`], or if there is no solver
    /// for Crouzeix-Raviart functions.
    pub fn with_solvers(
        matrix: &'a SparseMatrix<T>,
        penalised: &PenalisedMatrix<T>,
        (locations, n_vertices): (&'a [DofLocation], usize),
        facet_means_solver: impl FnOnce(
            &SidePenalties<T>,
            &CrouzeixRaviartSpace,
        ) -> Option<Box<dyn FacetMeansSolver<T> + 'a>>,
        block_solver: Box<dyn BlockSolver<T> + 'a>,
    ) -> Option<Self> {
        let penalties = SidePenalties::new(penalised)?;
        // the vertices of the facet of a mean, or the vertex of a value
        let length = if penalties.are_means { penalties.cell_size - 1 } else { 1 };
        let has_length = |location: &DofLocation| location.vertices().len() == length;
        if locations.len() != penalised.size()
            || !all(locations.len(), |i| has_length(&locations[i]))
        {
            return None;
        }
        let diagonal = collect(penalised.size(), |side| {
            stiffness(penalised, [side, side], penalties.are_means) + penalties.penalty[side]
        });
        let zero = T::lit(0.0);
        let n = matrix.size();
        let space = CrouzeixRaviartSpace::new(&penalties);
        let facet_means_solver = facet_means_solver(&penalties, &space)?;
        let n_facets = space.sides_of_facet.len();
        let are_means = penalties.are_means;
        let n_vertices = if are_means { 0 } else { n_vertices };
        Some(Self {
            matrix,
            penalties,
            diagonal,
            space,
            facet_means_solver,
            locations,
            fixed: vec![false; n],
            states: vec![SideState::Free; n],
            fixed_facets: vec![true; n_facets],
            kept_facets: Vec::new(),
            fixed_vertices: vec![false; n_vertices],
            facet_residuals: vec![zero; n_facets],
            facet_means: vec![zero; n_facets],
            sides: SideCorrections { is_pair: vec![false; n], inverse_jump: vec![zero; n] },
            mixed_block: MixedBlock::new(block_solver),
            mean_residuals: vec![zero; if are_means { 0 } else { n }],
            means: vec![zero; if are_means { 0 } else { n }],
        })
    }
}

/// The state of a side. If the unknowns are vertex values, all sides of a cell have the same state.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SideState {
    /// The mean over the side is free: its own unknown, or all vertex values of its cell.
    Free,
    /// Some vertex values of the cell are free, but not all.
    Mixed,
    /// The mean over the side, or all vertex values of the cell, are fixed.
    Fixed,
}

impl<T: Real> MeanJumpSplitting<'_, T> {
    /// Sets the states of all sides by the fixed unknowns.
    fn set_side_states(&mut self) {
        let size = if self.penalties.are_means { 1 } else { self.penalties.cell_size };
        let fixed = &self.fixed;
        for_each_chunk_of_groups(&mut self.states, size, |range, states| {
            let cells = states.chunks_exact_mut(size).zip(fixed[range].chunks_exact(size));
            for (states, fixed) in cells {
                states.fill(match fixed.iter().filter(|&&fixed| fixed).count() {
                    0 => SideState::Free,
                    n if n < size => SideState::Mixed,
                    _ => SideState::Fixed,
                });
            }
        });
    }

    /// Sets the diagonal corrections of all sides, and the unknowns of the mixed block.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if the form of a corrected function with itself is not positive.
    fn set_side_corrections(&mut self) -> Result<(), FactorError> {
        let Self { penalties, diagonal, states, sides, mixed_block, fixed, .. } = self;
        let (n, zero) = (states.len(), T::lit(0.0));
        let is_free = |s: usize| states[s] == SideState::Free;
        let opposite = |s: usize| states.get(penalties.opposite[s] as usize).copied();
        mixed_block.vertex_values = indices(n, |s| !is_free(s) && !fixed[s]);
        mixed_block.sides = indices(n, |s| is_free(s) && opposite(s) == Some(SideState::Mixed));
        for_each_chunk(&mut sides.is_pair, |range, is_pair| {
            for (s, is_pair) in range.zip(is_pair) {
                *is_pair = is_free(s) && opposite(s) == Some(SideState::Free);
            }
        });
        // the form of the corrected function with itself
        let form = |s: usize| match opposite(s) {
            _ if !is_free(s) => None,
            Some(SideState::Free) => {
                let other = diagonal[penalties.opposite[s] as usize];
                Some(diagonal[s] + other + (penalties.penalty[s] + penalties.penalty[s]))
            }
            Some(_) => Some(diagonal[s]),
            None => penalties.has_jump(s).then(|| diagonal[s]),
        };
        for_each_chunk(&mut sides.inverse_jump, |range, inverse_jump| {
            for (s, inverse) in range.zip(inverse_jump) {
                *inverse = form(s).map_or(zero, |form| T::lit(1.0) / form);
            }
        });
        // the reciprocal of zero is infinite
        let is_valid = |inverse: T| inverse >= zero && inverse.to_f64().is_finite();
        match all(n, |s| is_valid(sides.inverse_jump[s])) {
            true => Ok(()),
            false => Err(FactorError::NotPositive),
        }
    }

    /// Marks the vertices that have a fixed value in a cell.
    fn set_fixed_vertices(&mut self) {
        let Self { fixed_vertices, fixed, locations, .. } = self;
        if !fixed_vertices.is_empty() {
            fixed_vertices.fill(false);
            for (location, _) in locations.iter().zip(fixed).filter(|(_, fixed)| **fixed) {
                location.vertices().iter().for_each(|&v| fixed_vertices[v as usize] = true);
            }
        }
    }

    /// Sets the facets without Crouzeix-Raviart functions, and the facets that conforming functions alone
    /// correct: the facets of cells with free and fixed vertex values, in which facet mean functions are not free.
    fn set_facets(&mut self) {
        let Self { penalties, space, states, fixed_facets, kept_facets, .. } = self;
        // on a facet with Dirichlet data the jump has no opposite side
        let sides = |facet: usize| {
            let [one, other] = space.sides_of_facet[facet].map(|side| side as usize);
            let opposite = match states.get(other) {
                Some(&state) => state,
                None if penalties.has_jump(one) => SideState::Fixed,
                None => states[one],
            };
            [states[one], opposite]
        };
        let n = fixed_facets.len();
        *fixed_facets = collect(n, |facet| sides(facet).contains(&SideState::Fixed));
        let is_mixed = |facet: usize| sides(facet).contains(&SideState::Mixed);
        *kept_facets = indices(n, |facet| !fixed_facets[facet] && is_mixed(facet));
    }
}

impl<T: Real> Preconditioner<T> for MeanJumpSplitting<'_, T> {
    fn name(&self) -> &'static str {
        "facet-split"
    }

    /// Smaller than the default: an error that is small in the energy norm can be large in single unknowns of an
    /// over-penalised element, and change the contact states of these unknowns.
    fn forcing_term(&self) -> f64 {
        0.03
    }

    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        self.fixed.copy_from_slice(fixed);
        self.set_side_states();
        // errors are returned at the end, because calls of both solvers are collective over the parts of a mesh
        let corrected = self.set_side_corrections();
        self.set_facets();
        self.set_fixed_vertices();
        let Self { mixed_block, fixed_facets, kept_facets, fixed_vertices, .. } = self;
        let factored = mixed_block.factor(self.matrix, &self.penalties, &self.sides.inverse_jump);
        let set = self.facet_means_solver.set_fixed(fixed_facets, kept_facets, fixed_vertices);
        corrected.and(factored).and(set)
    }

    fn apply(&mut self, r: &[T], z: &mut [T]) {
        let (size, are_means, sides) =
            (self.penalties.cell_size, self.penalties.are_means, &self.sides);
        let zero = T::lit(0.0);
        // The values of a facet mean function are 1 - d at the opposite vertex and 1 at the others,
        // where d is the number of dimensions.
        let d = T::lit((size - 1) as f64);
        if !are_means {
            for_each_chunk_of_groups(&mut self.mean_residuals, size, |range, chunk| {
                for (g, r) in chunk.chunks_exact_mut(size).zip(r[range].chunks_exact(size)) {
                    let sum = r.iter().fold(zero, |s, &r| s + r);
                    g.iter_mut().zip(r).for_each(|(g, &r)| *g = sum - d * r);
                }
            });
        }
        // the residual in the basis of facet mean functions
        let g = if are_means { r } else { &self.mean_residuals[..] };
        let (sides_of_facet, fixed_facets) = (&self.space.sides_of_facet, &self.fixed_facets);
        for_each_chunk(&mut self.facet_residuals, |range, out| {
            for (facet, out) in range.zip(out) {
                *out = match sides_of_facet[facet] {
                    _ if fixed_facets[facet] => zero,
                    [one, NO_INDEX] => g[one as usize],
                    [one, other] => g[one as usize] + g[other as usize],
                };
            }
        });
        let Self { mixed_block, facet_means_solver, facet_residuals, facet_means, .. } = self;
        mixed_block.solve(r, g);
        facet_means_solver.apply(facet_residuals, facet_means);
        let (facet_of_side, facet_means) = (&self.space.facet_of_side, &self.facet_means);
        let opposite = &self.penalties.opposite;
        let means = if are_means { &mut *z } else { &mut self.means[..] };
        for_each_chunk_of_groups(means, size, |range, chunk| {
            for (s, mean) in range.zip(chunk) {
                let jump = match sides.is_pair[s] {
                    true => g[s] - g[opposite[s] as usize],
                    false => g[s],
                };
                *mean = facet_means[facet_of_side[s] as usize] + sides.inverse_jump[s] * jump;
            }
        });
        if !are_means {
            for_each_chunk(z, |_, z| z.fill(zero));
            self.mixed_block.write_solution(&mut self.means, z);
            let (means, fixed) = (&self.means, &self.fixed);
            for_each_chunk_of_groups(z, size, |range, z| {
                let first = range.start;
                for (z, m) in z.chunks_exact_mut(size).zip(means[range].chunks_exact(size)) {
                    let sum = m.iter().fold(zero, |s, &m| s + m);
                    z.iter_mut().zip(m).for_each(|(z, &m)| *z += sum - d * m);
                }
                z.iter_mut()
                    .zip(&fixed[first..])
                    .filter(|(_, fixed)| **fixed)
                    .for_each(|(z, _)| *z = zero);
            });
        }
    }
}
