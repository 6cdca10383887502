//! Symmetric block Gauss-Seidel smoothing in single precision, with one block for the unknowns of each cell.
//!
//! As in [`GaussSeidel`](super::gauss_seidel::GaussSeidel), an iteration is a Gauss-Seidel iteration within
//! a chunk of cells and a Jacobi iteration between chunks, only the strictly lower triangle of a chunk is
//! stored, and the forward iteration returns the residual. An iteration takes a third of the time of an iteration by
//! unknowns: only one index is read for each block, and the rows of a product with a block are independent.
//!
//! Let `D` be the block diagonal, `L` the strictly lower triangle within chunks and `O` the entries between chunks. The
//! iteration with `D + L` reduces the energy of the error if `D - O` is positive definite. This is so for a sum of
//! forms on facets each of which remains positive if the traces from one side change their sign, such as the forms of
//! interior penalty methods with a penalty above the proven bound.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::algebra::SparseMatrix;
use crate::algebra::dense::invert_positive_definite;
use crate::linear::direct::FactorError;
use crate::parallel::for_each_item;
use crate::parallel::vectors::{
    chunk_length, for_each_chunk_of_groups, map_chunks_of_groups, sum_chunks_of_two, zeros,
};
use crate::real::Real;

/// A smoother by cells, whatever the number of their unknowns.
pub(crate) trait CellSmoother: Send + Sync {
    /// Sets the fixed unknowns.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if a block is not positive definite on its free unknowns.
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError>;
    /// One for free unknowns, zero for fixed ones.
    fn mask(&self) -> &[f32];
    /// A forward iteration from zero: sets `x`, and `r = b - A x` on free unknowns, zero on fixed ones.
    fn forward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]);
    /// A backward iteration from `x`. `r` is workspace.
    fn backward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]);
}

/// The block Gauss-Seidel smoother of a symmetric matrix, divided by a scale, with `N` unknowns in each cell.
pub(crate) struct CellGaussSeidel<const N: usize> {
    chunks: Vec<CellRows<N>>,
    /// The diagonal blocks.
    diagonal: Vec<[[f32; N]; N]>,
    /// The inverses of the diagonal blocks on free unknowns, zero in rows and columns of fixed unknowns.
    inverses: Vec<[[f32; N]; N]>,
    /// One for free unknowns, zero for fixed ones; empty before the first call of
    /// [`CellGaussSeidel::set_fixed`].
    mask: Vec<f32>,
}

/// The blocks in the rows of a chunk of cells: the strictly lower triangle within the chunk, and all blocks outside of
/// it.
struct CellRows<const N: usize> {
    /// Start of each cell in `cells` and `blocks`, and the number of blocks at the end.
    starts: Vec<u32>,
    /// For each cell the preceding cells of the chunk that are coupled to it, relative to the chunk.
    cells: Vec<u16>,
    /// For each entry of `cells` the block that couples the two cells.
    blocks: Vec<[[f32; N]; N]>,
    /// The blocks outside of the chunk: cell relative to the chunk, other cell, block.
    outside: Vec<(u16, u32, [[f32; N]; N])>,
}

impl<const N: usize> CellRows<N> {
    /// The rows `range` of a matrix divided by `scale`, and their diagonal blocks.
    fn new<T: Real>(
        matrix: &SparseMatrix<T>,
        scale: f64,
        range: std::ops::Range<usize>,
    ) -> (Self, Vec<[[f32; N]; N]>) {
        let cells = range.start / N..range.end / N;
        let mut rows = Self {
            starts: vec![0],
            cells: Vec::with_capacity(3 * cells.len()),
            blocks: Vec::with_capacity(3 * cells.len()),
            outside: Vec::new(),
        };
        let mut diagonal = Vec::with_capacity(cells.len());
        let mut found: Vec<(usize, [[f32; N]; N])> = Vec::new();
        for cell in cells.clone() {
            found.clear();
            for k in 0..N {
                let (columns, values) = matrix.row(cell * N + k);
                let mut last = 0;
                for (&j, a) in columns.iter().zip(values) {
                    let (other, column) = (j as usize / N, j as usize % N);
                    if found.get(last).is_none_or(|block| block.0 != other) {
                        let known = found.iter().position(|block| block.0 == other);
                        last = known.unwrap_or(found.len());
                        if known.is_none() {
                            found.push((other, [[0.0; N]; N]));
                        }
                    }
                    found[last].1[k][column] = (a.to_f64() / scale) as f32;
                }
            }
            let mut own = [[0.0; N]; N];
            for &(other, block) in &found {
                if other == cell {
                    own = block;
                } else if !cells.contains(&other) {
                    rows.outside.push(((cell - cells.start) as u16, other as u32, block));
                } else if other < cell {
                    rows.cells.push((other - cells.start) as u16);
                    rows.blocks.push(block);
                }
            }
            diagonal.push(own);
            rows.starts.push(rows.cells.len() as u32);
        }
        (rows, diagonal)
    }

    /// The blocks of a cell in the strictly lower triangle, each with the number of the other cell relative to the
    /// chunk.
    #[inline(always)]
    fn lower_row(&self, cell: usize) -> impl Iterator<Item = (usize, &[[f32; N]; N])> {
        let range = self.starts[cell] as usize..self.starts[cell + 1] as usize;
        let cells = self.cells[range.clone()].iter().map(|&other| usize::from(other));
        cells.zip(&self.blocks[range])
    }
}

/// `y = y - B x`.
#[inline(always)]
fn subtract_product<const N: usize>(block: &[[f32; N]; N], x: &[f32; N], y: &mut [f32; N]) {
    for (row, y) in block.iter().zip(y) {
        let mut sum = 0.0;
        for j in 0..N {
            sum += row[j] * x[j];
        }
        *y -= sum;
    }
}

/// `y = y - B^T x`.
#[inline(always)]
fn subtract_transposed<const N: usize>(block: &[[f32; N]; N], x: &[f32; N], y: &mut [f32; N]) {
    let mut sum = [0.0; N];
    for (row, &x) in block.iter().zip(x) {
        for j in 0..N {
            sum[j] += row[j] * x;
        }
    }
    y.iter_mut().zip(sum).for_each(|(y, sum)| *y -= sum);
}

/// `B x` for a symmetric block.
#[inline(always)]
fn product<const N: usize>(block: &[[f32; N]; N], x: &[f32; N]) -> [f32; N] {
    let mut y = [0.0; N];
    for (column, &x) in block.iter().zip(x) {
        for j in 0..N {
            y[j] += column[j] * x;
        }
    }
    y
}

/// The inverse of a diagonal block on its free unknowns, zero in the rows and columns of fixed ones; `None` if the
/// block is not positive definite there.
fn inverse_of_free<const N: usize>(
    diagonal: &[[f32; N]; N],
    fixed: &[bool; N],
) -> Option<[[f32; N]; N]> {
    let mut block = [[0.0_f64; N]; N];
    for i in (0..N).filter(|&i| !fixed[i]) {
        for j in (0..N).filter(|&j| !fixed[j]) {
            // the matrix is symmetric up to rounding errors only
            block[i][j] = 0.5 * f64::from(diagonal[i][j] + diagonal[j][i]);
        }
    }
    invert_positive_definite(block.as_flattened_mut(), N, fixed)
        .then(|| block.map(|row| row.map(|a| a as f32)))
}

impl<const N: usize> CellGaussSeidel<N> {
    /// The smoother of a matrix divided by `scale`, whose unknowns belong to cells in groups of `N`.
    pub fn new<T: Real>(matrix: &SparseMatrix<T>, scale: f64) -> Self {
        let n = matrix.size();
        let chunks_made = map_chunks_of_groups(n, N, |range| CellRows::new(matrix, scale, range));
        let (mut chunks, mut diagonal) = (Vec::with_capacity(chunks_made.len()), Vec::new());
        diagonal.reserve_exact(n / N);
        for (rows, blocks) in chunks_made {
            chunks.push(rows);
            diagonal.extend(blocks);
        }
        let inverses = vec![[[0.0; N]; N]; n / N];
        Self { chunks, diagonal, inverses, mask: Vec::new() }
    }
}

impl<const N: usize> CellSmoother for CellGaussSeidel<N> {
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let is_first = self.mask.is_empty();
        if is_first {
            self.mask = zeros(fixed.len());
        }
        let fixed = fixed.as_chunks::<N>().0;
        let diagonal = &self.diagonal;
        let length = chunk_length(N * self.diagonal.len(), N) / N;
        let masks = self.mask.as_chunks_mut::<N>().0.chunks_mut(length);
        let tasks = masks.zip(self.inverses.chunks_mut(length)).collect();
        let is_positive = AtomicBool::new(true);
        for_each_item(tasks, &|chunk, (masks, inverses): (&mut [[f32; N]], &mut [_])| {
            for ((k, mask), inverse) in (chunk * length..).zip(masks).zip(inverses) {
                let mut of_fixed = fixed[k].iter().zip(&*mask);
                let is_same = of_fixed.all(|(&fixed, &mask)| fixed == (mask == 0.0));
                if is_same && !is_first {
                    continue;
                }
                match inverse_of_free(&diagonal[k], &fixed[k]) {
                    Some(block) => *inverse = block,
                    None => return is_positive.store(false, Ordering::Relaxed),
                }
                *mask = fixed[k].map(|fixed| if fixed { 0.0 } else { 1.0 });
            }
        });
        if is_positive.into_inner() { Ok(()) } else { Err(FactorError::NotPositive) }
    }

    fn mask(&self) -> &[f32] {
        &self.mask
    }

    fn forward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        let length = chunk_length(x.len(), N);
        sum_chunks_of_two(x, r, N, |range, x, r| {
            let chunk = &self.chunks[range.start / length];
            let (x, r) = (x.as_chunks_mut::<N>().0, r.as_chunks_mut::<N>().0);
            let inverses = &self.inverses[range.start / N..range.end / N];
            let b = b[range].as_chunks::<N>().0;
            for (cell, (b, inverse)) in b.iter().zip(inverses).enumerate() {
                let mut sum = *b;
                chunk
                    .lower_row(cell)
                    .for_each(|(other, a)| subtract_product(a, &x[other], &mut sum));
                let value = product(inverse, &sum);
                x[cell] = value;
                r[cell] = [0.0; N];
                chunk
                    .lower_row(cell)
                    .for_each(|(other, a)| subtract_transposed(a, &value, &mut r[other]));
            }
            0.0
        });
        let x = x.as_chunks::<N>().0;
        for_each_chunk_of_groups(r, N, |range, r| {
            let blocks = r.as_chunks_mut::<N>().0;
            for (cell, other, a) in &self.chunks[range.start / length].outside {
                subtract_product(a, &x[*other as usize], &mut blocks[usize::from(*cell)]);
            }
            r.iter_mut().zip(&self.mask[range]).for_each(|(r, mask)| *r *= mask);
        });
    }

    fn backward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        let length = chunk_length(x.len(), N);
        let old = x.as_chunks::<N>().0;
        for_each_chunk_of_groups(r, N, |range, r| {
            r.copy_from_slice(&b[range.clone()]);
            let blocks = r.as_chunks_mut::<N>().0;
            for (cell, other, a) in &self.chunks[range.start / length].outside {
                subtract_product(a, &old[*other as usize], &mut blocks[usize::from(*cell)]);
            }
        });
        sum_chunks_of_two(x, r, N, |range, x, r| {
            let chunk = &self.chunks[range.start / length];
            let (x, r) = (x.as_chunks_mut::<N>().0, r.as_chunks_mut::<N>().0);
            let inverses = &self.inverses[range.start / N..range.end / N];
            for (cell, inverse) in inverses.iter().enumerate().rev() {
                let mut sum = r[cell];
                chunk
                    .lower_row(cell)
                    .for_each(|(other, a)| subtract_product(a, &x[other], &mut sum));
                let value = product(inverse, &sum);
                x[cell] = value;
                chunk
                    .lower_row(cell)
                    .for_each(|(other, a)| subtract_transposed(a, &value, &mut r[other]));
            }
            0.0
        });
    }
}
