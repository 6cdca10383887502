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
use super::facet_mean_form::diagonal;
use super::mixed_block::{BlockFactors, BlockSolver, MixedBlock};
use super::multigrid::Multigrid;
use super::preconditioner::Preconditioner;
use crate::algebra::{DofLocation, NO_INDEX, PenalisedMatrix, SidePenalties, SparseMatrix};
use crate::linear::direct::FactorError;
use crate::parallel::vectors::{
    all, chunk_length, flags, for_each_chunk, for_each_chunk_of_groups, map_chunks,
};
use crate::parallel::{both, map_items};
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

/// A preconditioner of the stiffness on Crouzeix-Raviart functions.
pub(crate) trait FacetMeansSolver<T>: Send + Sync {
    /// Sets the facets without a function, the facets with a function that conforming linear functions
    /// alone may correct, and the vertices at which conforming linear functions vanish.
    ///
    /// # Errors
    /// [`FactorError`] if a coarse matrix is not positive definite.
    fn set_fixed(
        &mut self,
        fixed_facets: &[bool],
        kept_facets: &[u32],
        fixed_vertices: &[bool],
    ) -> Result<(), FactorError>;
    /// Sets `means` to the correction of the means on facets for a residual that is zero on facets without a function.
    fn apply(&mut self, residual: &[T], means: &mut [T]);
}

impl<T: Real> FacetMeansSolver<T> for Multigrid<'_, T> {
    fn set_fixed(
        &mut self,
        fixed_facets: &[bool],
        kept_facets: &[u32],
        fixed_vertices: &[bool],
    ) -> Result<(), FactorError> {
        self.set_fixed_and_kept(fixed_facets, kept_facets, fixed_vertices)
    }
    fn apply(&mut self, residual: &[T], means: &mut [T]) {
        Multigrid::apply(self, residual, means);
    }
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
        let diagonal = diagonal(penalised, &penalties);
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
        let (fixed, size) = (&self.fixed, self.penalties.cell_size);
        if self.penalties.are_means {
            for_each_chunk(&mut self.states, |range, states| {
                for (state, &fixed) in states.iter_mut().zip(&fixed[range]) {
                    *state = if fixed { SideState::Fixed } else { SideState::Free };
                }
            });
            return;
        }
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
        let length = chunk_length(states.len(), 1);
        mixed_block.vertex_values.clear();
        mixed_block.sides.clear();
        // the free vertex values and the sides of the mixed block, of one chunk of sides
        let of_chunk = |k: usize, (are_pairs, inverse_jumps): (&mut [bool], &mut [T])| {
            let (mut vertex_values, mut mixed_sides) = (Vec::new(), Vec::new());
            let corrections = are_pairs.iter_mut().zip(inverse_jumps);
            for (s, (is_pair, inverse_jump)) in (k * length..).zip(corrections) {
                (*is_pair, *inverse_jump) = (false, T::lit(0.0));
                if states[s] != SideState::Free {
                    if !fixed[s] {
                        vertex_values.push(s as u32);
                    }
                    continue;
                }
                let (own, opposite) = (diagonal[s], penalties.opposite[s]);
                match states.get(opposite as usize) {
                    Some(SideState::Free) => {
                        let (other, penalty) = (diagonal[opposite as usize], penalties.penalty[s]);
                        *is_pair = true;
                        *inverse_jump = invert(own + other + (penalty + penalty))?;
                    }
                    Some(SideState::Mixed) => {
                        *inverse_jump = invert(own)?;
                        mixed_sides.push(s as u32);
                    }
                    Some(SideState::Fixed) => *inverse_jump = invert(own)?,
                    None if penalties.has_jump(s) => *inverse_jump = invert(own)?,
                    None => {}
                }
            }
            Ok((vertex_values, mixed_sides))
        };
        let chunks = sides.is_pair.chunks_mut(length).zip(sides.inverse_jump.chunks_mut(length));
        for found in map_items(chunks.collect(), &of_chunk) {
            let (vertex_values, mixed_sides) = found?;
            mixed_block.vertex_values.extend(vertex_values);
            mixed_block.sides.extend(mixed_sides);
        }
        Ok(())
    }

    /// Marks the vertices that have a fixed value in a cell.
    fn set_fixed_vertices(&mut self) {
        let n = self.fixed_vertices.len();
        if n == 0 {
            return;
        }
        self.fixed_vertices = flags(n, |set| {
            map_chunks(self.fixed.len(), |range| {
                for i in range.filter(|&i| self.fixed[i]) {
                    self.locations[i].vertices().iter().for_each(|&v| set(v as usize));
                }
            });
        });
    }

    /// Sets the facets without Crouzeix-Raviart functions, and the facets that conforming functions alone
    /// correct: the facets of cells with free and fixed vertex values, in which facet mean functions are not free.
    fn set_facets(&mut self) {
        let Self { penalties, space, states, fixed_facets, kept_facets, .. } = self;
        let length = chunk_length(fixed_facets.len(), 1);
        let of_chunk = |k: usize, are_fixed: &mut [bool]| {
            let mut kept = Vec::new();
            for (facet, is_fixed) in (k * length..).zip(are_fixed) {
                let [one, other] = space.sides_of_facet[facet].map(|side| side as usize);
                // on a facet with Dirichlet data the jump has no opposite side
                let opposite = match states.get(other) {
                    Some(&state) => state,
                    None if penalties.has_jump(one) => SideState::Fixed,
                    None => states[one],
                };
                let pair = [states[one], opposite];
                *is_fixed = pair.contains(&SideState::Fixed);
                if !*is_fixed && pair.contains(&SideState::Mixed) {
                    kept.push(facet as u32);
                }
            }
            kept
        };
        *kept_facets = map_items(fixed_facets.chunks_mut(length).collect(), &of_chunk).concat();
    }
}

/// The reciprocal of a positive number; [`FactorError::NotPositive`] for any other.
fn invert<T: Real>(x: T) -> Result<T, FactorError> {
    if x > T::lit(0.0) { Ok(T::lit(1.0) / x) } else { Err(FactorError::NotPositive) }
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
        // most of the work on the block is that of one thread
        let at_once = mixed_block.may_run_beside();
        let factor = || mixed_block.factor(self.matrix, &self.penalties, &self.sides.inverse_jump);
        let set = || self.facet_means_solver.set_fixed(fixed_facets, kept_facets, fixed_vertices);
        let (factored, set) = both(at_once, factor, set);
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
        let at_once = mixed_block.may_run_beside();
        let solve = || mixed_block.solve(r, g);
        let apply = || facet_means_solver.apply(facet_residuals, facet_means);
        both(at_once, solve, apply);
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
