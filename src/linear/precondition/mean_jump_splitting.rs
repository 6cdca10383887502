//! A preconditioner for discontinuous linear functions that are coupled only by a penalty on jumps
//! of facet means.
//!
//! A facet has a facet mean from each side. The form is nearly diagonal in the sum and the
//! difference of the two, the mean and the jump: jumps have the penalty as diagonal, means are
//! Crouzeix-Raviart functions, with conforming linear functions as auxiliary space. Source: B.
//! Ayuso de Dios, L. Zikatanov, J. Sci. Comput. 40 (2009), 4-36.

use super::auxiliary_space::VertexCorrection;
use super::facet_mean_form::{FacetMeanForm, cr_basis};
use super::preconditioner::Preconditioner;
use crate::algebra::{
    NO_INDEX, PenalisedMatrix, RectangularMatrix, SparseMatrix, Support, galerkin_product,
};
use crate::linear::direct::{FactorError, Factors};
use crate::parallel::vectors::for_each_chunk_of_groups;
use crate::real::Real;

/// The sum of diagonal corrections of means and jumps, an exact solution on cells with free and fixed
/// vertex values, and a multigrid cycle on conforming linear functions.
///
/// A cell without fixed unknowns has facet mean functions as basis. On a facet between two such cells
/// mean and jump are corrected separately. On a facet to a cell with all unknowns fixed, or with
/// Dirichlet data, the mean over the one side is corrected. The free vertex values of the remaining
/// cells, with the means of the adjacent sides, form the mixed block.
pub(crate) struct MeanJumpSplitting<'a, T: Real> {
    matrix: &'a SparseMatrix<T>,
    form: FacetMeanForm<T>,
    correction: VertexCorrection<'a, T>,
    /// The diagonal correction of each side.
    sides: Vec<SideCorrection<T>>,
    mixed_block: MixedBlock<T>,
    /// Workspace: residuals and corrections in the basis of facet mean functions.
    mean_residuals: Vec<T>,
    means: Vec<T>,
}

/// The diagonal correction of the mean over one side of a facet.
#[derive(Clone, Copy)]
struct SideCorrection<T> {
    /// The opposite side, if the two are corrected together; else [`NO_INDEX`].
    opposite: u32,
    /// The reciprocal of the form of the sum of the two functions; zero if there is no opposite side.
    inverse_mean: T,
    /// The reciprocal of the form of the difference of the two functions; of the function of this
    /// side if there is no opposite side; zero without a correction.
    inverse_jump: T,
}

/// The block of the matrix that is solved exactly.
struct MixedBlock<T> {
    /// The free vertex values of cells with free and fixed unknowns.
    vertex_values: Vec<u32>,
    /// The sides of cells without fixed unknowns that are opposite to such cells.
    sides: Vec<u32>,
    /// `None` if the block is empty.
    factors: Option<Factors<T>>,
    vector: Vec<T>,
}

impl<'a, T: Real> MeanJumpSplitting<'a, T> {
    /// The preconditioner of `matrix`, which is `penalised` multiplied out; `None` if its unknowns are
    /// not those of discontinuous linear functions, or cells are coupled by more than facet means, or
    /// `correction` returns `None`.
    pub fn new(
        matrix: &'a SparseMatrix<T>,
        penalised: &PenalisedMatrix<T>,
        supports: &[Support],
        correction: impl FnOnce() -> Option<VertexCorrection<'a, T>>,
    ) -> Option<Self> {
        let form = FacetMeanForm::new(penalised, supports)?;
        let zero = T::lit(0.0);
        let n = matrix.size();
        let no_correction =
            SideCorrection { opposite: NO_INDEX, inverse_mean: zero, inverse_jump: zero };
        Some(Self {
            matrix,
            form,
            correction: correction()?,
            sides: vec![no_correction; n],
            mixed_block: MixedBlock {
                vertex_values: vec![],
                sides: vec![],
                factors: None,
                vector: vec![],
            },
            mean_residuals: vec![zero; n],
            means: vec![zero; n],
        })
    }
}

/// The reciprocal of a positive number; [`FactorError::NotPositive`] for any other.
fn invert<T: Real>(x: T) -> Result<T, FactorError> {
    if x > T::lit(0.0) { Ok(T::lit(1.0) / x) } else { Err(FactorError::NotPositive) }
}

impl<T: Real> MixedBlock<T> {
    /// Factors `P^T A P`, where the columns of `P` are the basis functions of the vertex values and
    /// the facet mean functions of the sides.
    ///
    /// # Errors
    /// See [`FactorError`].
    fn factor(&mut self, matrix: &SparseMatrix<T>, cell_size: usize) -> Result<(), FactorError> {
        let n = self.vertex_values.len() + self.sides.len();
        self.factors = None;
        if n == 0 {
            return Ok(());
        }
        let mut entries: Vec<(u32, u32, T)> = Vec::new();
        for (k, &i) in self.vertex_values.iter().enumerate() {
            entries.push((i, k as u32, T::lit(1.0)));
        }
        for (k, &s) in (self.vertex_values.len()..).zip(&self.sides) {
            let (cell, facet) = (s as usize / cell_size, s as usize % cell_size);
            let at_vertex =
                |i: usize| ((cell * cell_size + i) as u32, k as u32, cr_basis(cell_size, i, facet));
            entries.extend((0..cell_size).map(at_vertex));
        }
        entries.sort_unstable_by_key(|&(i, k, _)| (i, k));
        let mut rows =
            RectangularMatrix { starts: vec![0], columns: Vec::new(), values: Vec::new() };
        let mut rest = entries.iter().peekable();
        for i in 0..matrix.size() as u32 {
            while let Some(&(_, k, value)) = rest.next_if(|entry| entry.0 == i) {
                rows.columns.push(k);
                rows.values.push(value);
            }
            rows.starts.push(rows.columns.len() as u32);
        }
        let form = galerkin_product(matrix, &rows, n);
        let all: Vec<u32> = (0..n as u32).collect();
        self.factors = Some(Factors::new(&form, true, &all)?);
        Ok(())
    }

    /// Solves for the residual with the entries `r` for vertex values and `g` for facet mean
    /// functions; sets the entries of `z` for the vertex values and of `means` for the sides of the
    /// block.
    fn solve(&mut self, r: &[T], g: &[T], means: &mut [T], z: &mut [T]) {
        let Some(factors) = &self.factors else { return };
        self.vector.clear();
        self.vector.extend(self.vertex_values.iter().map(|&i| r[i as usize]));
        self.vector.extend(self.sides.iter().map(|&s| g[s as usize]));
        factors.solve_in_place(&mut self.vector, 1);
        let (values, side_means) = self.vector.split_at(self.vertex_values.len());
        for (&i, &value) in self.vertex_values.iter().zip(values) {
            z[i as usize] = value;
        }
        for (&s, &mean) in self.sides.iter().zip(side_means) {
            means[s as usize] = mean;
        }
    }
}

impl<T: Real> Preconditioner<T> for MeanJumpSplitting<'_, T> {
    fn name(&self) -> &'static str {
        "facet-split"
    }

    /// An error that is small in the energy norm can be large in single unknowns of an over-penalised
    /// element, and change their contact states.
    fn reduction(&self) -> f64 {
        0.01
    }

    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let form = &self.form;
        let size = form.cell_size;
        let zero = T::lit(0.0);
        self.mixed_block.vertex_values.clear();
        self.mixed_block.sides.clear();
        let is_free_cell = |cell: usize| !fixed[cell * size..(cell + 1) * size].contains(&true);
        let is_fixed_cell = |cell: usize| !fixed[cell * size..(cell + 1) * size].contains(&false);
        let has_mean = |s: usize| if form.are_means { !fixed[s] } else { is_free_cell(s / size) };
        for s in 0..fixed.len() {
            self.sides[s] =
                SideCorrection { opposite: NO_INDEX, inverse_mean: zero, inverse_jump: zero };
            if !has_mean(s) {
                if !fixed[s] {
                    self.mixed_block.vertex_values.push(s as u32);
                }
                continue;
            }
            let own = form.diagonal[s];
            let opposite = form.opposite[s];
            if opposite != NO_INDEX && has_mean(opposite as usize) {
                let (other, coupling) = (form.diagonal[opposite as usize], form.coupling[s]);
                let both = own + other;
                let twice = coupling + coupling;
                self.sides[s] = SideCorrection {
                    opposite,
                    inverse_mean: invert(both + twice)?,
                    inverse_jump: invert(both - twice)?,
                };
            } else if opposite != NO_INDEX
                && !form.are_means
                && !is_fixed_cell(opposite as usize / size)
            {
                self.mixed_block.sides.push(s as u32);
            } else {
                self.sides[s].inverse_jump = invert(own)?;
            }
        }
        self.mixed_block.factor(self.matrix, size)?;
        self.correction.set_fixed(fixed)
    }

    fn apply(&mut self, r: &[T], z: &mut [T]) {
        let (size, are_means, sides) = (self.form.cell_size, self.form.are_means, &self.sides);
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
        let g = if are_means { r } else { &self.mean_residuals[..] };
        for_each_chunk_of_groups(&mut self.means, size, |range, chunk| {
            for (s, mean) in range.zip(chunk) {
                let side = &sides[s];
                *mean = match side.opposite {
                    NO_INDEX => side.inverse_jump * g[s],
                    opposite => {
                        let other = g[opposite as usize];
                        side.inverse_mean * (g[s] + other) + side.inverse_jump * (g[s] - other)
                    }
                };
            }
        });
        if are_means {
            z.copy_from_slice(&self.means);
        } else {
            z.fill(zero);
            self.mixed_block.solve(r, g, &mut self.means, z);
            let means = &self.means;
            for_each_chunk_of_groups(z, size, |range, chunk| {
                for (z, m) in chunk.chunks_exact_mut(size).zip(means[range].chunks_exact(size)) {
                    let sum = m.iter().fold(zero, |s, &m| s + m);
                    z.iter_mut().zip(m).for_each(|(z, &m)| *z += sum - d * m);
                }
            });
        }
        self.correction.add(r, z);
    }
}
