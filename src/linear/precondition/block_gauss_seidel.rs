//! Symmetric Gauss-Seidel smoothing in single precision with blocks of one size: single unknowns, or those of a cell.
//!
//! Within a chunk of blocks an iteration is a Gauss-Seidel iteration, between chunks a Jacobi iteration, so that chunks
//! run in parallel. The backward iteration is the transpose of the forward one.
//!
//! Let `D` be the block diagonal of the matrix `A`, `L` the strictly lower triangle within chunks, `O` the entries
//! between chunks, and `E` a non-negative diagonal. The iteration with `M = D + E + L` reduces the energy of the error if
//! `M + M^T - A = D + 2 E - O` is positive definite. For blocks of more than one unknown `E` is zero: `D - O` is positive
//! definite for a sum of forms on facets each of which remains positive if the traces from one side change their sign,
//! such as the forms of interior penalty methods with a penalty above the proven bound. For single unknowns `E` is zero
//! in rows in which the entry of `D` is at least the sum of the entries of `|O|`; these are all rows of a matrix with
//! negative off-diagonal entries and non-negative row sums. In other rows `E` makes `D + 2 E` larger than that sum
//! (A. H. Baker, R. D. Falgout, T. V. Kolev, U. M. Yang, SIAM J. Sci. Comput. 33 (2011), 2864-2887). Meshes of flat
//! tetrahedra with a numbering without locality need a positive `E`: Jacobi's iteration diverges for their matrices.
//!
//! An iteration is limited by memory bandwidth. Only the strictly lower triangle of each chunk is stored: by symmetry, a
//! row of this triangle updates both the equations of its block and, once the values of the block are computed, the
//! residuals of the preceding ones. The forward iteration therefore returns the residual without a further product.

use std::array::from_fn;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::algebra::dense::invert_positive_definite;
use crate::linear::direct::FactorError;
use crate::parallel::for_each_item;
use crate::parallel::vectors::{
    chunk_length, for_each_chunk_of_groups, map_chunks_of_groups, sum_chunks_of_two,
};
use crate::real::Real;

/// The entry of `D + 2 E`, divided by the sum of the absolute values of the entries between chunks, in rows in which
/// `E` is positive.
const MARGIN: f64 = 1.1;

/// The first term of a sum: unlike with a positive zero, the addition of the second one takes no instruction.
const ZERO: f32 = -0.0;

/// The rows of a symmetric matrix, with ascending columns, and a scale: the smoother is that of the matrix divided by it.
#[derive(Clone, Copy)]
pub(crate) struct ScaledRows<'m, T> {
    pub row: &'m (dyn Fn(usize) -> (&'m [u32], &'m [T]) + Sync),
    pub scale: f64,
}

/// A smoother, whatever the size of its blocks.
pub(crate) trait Smoother<T>: Send + Sync {
    /// Reads the given rows and the columns with the same indices anew; the pattern must be the same as before.
    /// [`Smoother::set_fixed`] must follow.
    fn replace_rows(&mut self, changed: &[u32], rows: ScaledRows<'_, T>);
    /// Sets the fixed unknowns, and the unknowns `kept`, which are neither fixed nor smoothed: the forward iteration
    /// returns their residuals, and the backward iteration does not change their values. Blocks of more than one unknown
    /// cannot be kept.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if a block is not positive definite on its free unknowns.
    fn set_fixed(&mut self, fixed: &[bool], kept: &[u32]) -> Result<(), FactorError>;
    /// A forward iteration from zero: sets `x`, and `r = b - A x` on free unknowns, zero on fixed ones.
    fn forward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]);
    /// A backward iteration from `x`. `r` is workspace.
    fn backward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]);
}

/// The smoother of a matrix with `n` rows by blocks of `size` consecutive unknowns: one, or the number of linear or
/// quadratic functions on a simplex.
pub(crate) fn smoother<T: Real>(
    (n, size): (usize, usize),
    rows: ScaledRows<'_, T>,
) -> Box<dyn Smoother<T>> {
    match size {
        2 => Box::new(BlockGaussSeidel::<2>::new(n, rows)),
        3 => Box::new(BlockGaussSeidel::<3>::new(n, rows)),
        4 => Box::new(BlockGaussSeidel::<4>::new(n, rows)),
        6 => Box::new(BlockGaussSeidel::<6>::new(n, rows)),
        10 => Box::new(BlockGaussSeidel::<10>::new(n, rows)),
        _ => Box::new(BlockGaussSeidel::<1>::new(n, rows)),
    }
}

/// The entries of a matrix in the rows of one block and the columns of another.
type Block<const N: usize> = [[f32; N]; N];

/// Blocks of a row with their columns.
type BlocksOfRow<const N: usize> = Vec<(usize, Block<N>)>;

/// The block Gauss-Seidel smoother of a matrix with blocks of `N` unknowns.
struct BlockGaussSeidel<const N: usize> {
    chunks: Vec<ChunkRows<N>>,
    /// The number of blocks of a chunk; the last one may have fewer.
    chunk_length: usize,
}

/// The rows of a chunk of blocks: the diagonal blocks, the strictly lower triangle within the chunk, and all blocks
/// outside of it.
struct ChunkRows<const N: usize> {
    diagonal: Vec<Block<N>>,
    /// The diagonal `E`; empty if it is zero.
    added: Vec<[f32; N]>,
    /// The inverses of the blocks of `D + E` on free unknowns, zero in rows and columns of others and of unknowns whose
    /// diagonal entry is zero.
    inverses: Vec<Block<N>>,
    /// Which unknowns of a block are fixed; `None` if the inverse is outdated, or zero because the unknown is kept.
    fixed: Vec<Option<[bool; N]>>,
    /// Start of each row in `columns` and `lower`, and the number of blocks at the end.
    starts: Vec<u32>,
    /// For each row the preceding ones of the chunk that are coupled to it, relative to the chunk.
    columns: Vec<u16>,
    lower: Vec<Block<N>>,
    /// The blocks outside of the chunk: row relative to the chunk, column, block.
    outside: Vec<(u16, u32, Block<N>)>,
}

/// Where a chunk stores a block of one of its rows.
enum Place {
    Diagonal,
    /// In the strictly lower triangle, with the column relative to the chunk.
    Lower(u16),
    /// Outside of the chunk, with the column.
    Outside(u32),
}

impl<T: Real> ScaledRows<'_, T> {
    /// Reads the blocks of a row whose columns are asked for. Their order follows from the pattern alone: where all `N` rows
    /// of the matrix have the same columns, these ascend.
    #[inline(always)]
    fn read<const N: usize>(
        &self,
        own: usize,
        blocks: &mut BlocksOfRow<N>,
        is_asked: impl Fn(usize) -> bool,
    ) {
        blocks.clear();
        for i in 0..N {
            let (columns, values) = (self.row)(own * N + i);
            let mut at = 0;
            for (&j, a) in columns.iter().zip(values) {
                let (other, j) = (j as usize / N, j as usize % N);
                if !is_asked(other) {
                    continue;
                }
                if blocks.get(at).is_none_or(|block| block.0 != other) {
                    // a single row has each column once
                    let known =
                        if N == 1 { None } else { blocks.iter().position(|b| b.0 == other) };
                    at = known.unwrap_or(blocks.len());
                    if known.is_none() {
                        blocks.push((other, [[0.0; N]; N]));
                    }
                }
                blocks[at].1[i][j] = (a.to_f64() / self.scale) as f32;
            }
        }
    }

    /// Visits the blocks that the chunk of the rows `range` stores for one of them, always in the same order.
    fn visit_stored<const N: usize>(
        &self,
        (own, range): (usize, &Range<usize>),
        [blocks, transposed]: &mut [BlocksOfRow<N>; 2],
        mut visit: impl FnMut(Place, Block<N>),
    ) {
        self.read(own, blocks, |other| !(own + 1..range.end).contains(&other));
        for &(other, block) in &*blocks {
            if other == own {
                visit(Place::Diagonal, block);
            } else if range.contains(&other) {
                visit(Place::Lower((other - range.start) as u16), block);
            } else if other < own {
                visit(Place::Outside(other as u32), block);
            } else {
                // of two symmetric blocks that in the later row is read, so that both rows store the same
                self.read(other, transposed, |column| column == own);
                let block =
                    transposed.first().map_or(block, |(_, b)| from_fn(|i| from_fn(|j| b[j][i])));
                visit(Place::Outside(other as u32), block);
            }
        }
    }
}

impl<const N: usize> ChunkRows<N> {
    /// The rows `range` of a matrix.
    fn new<T: Real>(rows: ScaledRows<'_, T>, range: Range<usize>) -> Self {
        let n = range.len();
        let zero = [[0.0; N]; N];
        let mut chunk = Self {
            diagonal: vec![zero; n],
            added: Vec::new(),
            inverses: vec![zero; n],
            fixed: vec![None; n],
            starts: Vec::with_capacity(n + 1),
            columns: Vec::with_capacity(3 * n),
            lower: Vec::with_capacity(3 * n),
            outside: Vec::new(),
        };
        chunk.starts.push(0);
        let mut work = Default::default();
        for (k, own) in range.clone().enumerate() {
            let first = chunk.outside.len();
            rows.visit_stored((own, &range), &mut work, |place, block| match place {
                Place::Diagonal => chunk.diagonal[k] = block,
                Place::Lower(column) => {
                    chunk.columns.push(column);
                    chunk.lower.push(block);
                }
                Place::Outside(column) => chunk.outside.push((k as u16, column, block)),
            });
            chunk.starts.push(chunk.columns.len() as u32);
            chunk.update_added(k, first..chunk.outside.len());
        }
        chunk
    }

    /// Reads row `own` anew; the range of the rows of the chunk is given.
    fn replace_row<T: Real>(
        &mut self,
        rows: ScaledRows<'_, T>,
        (own, range): (usize, &Range<usize>),
        work: &mut [BlocksOfRow<N>; 2],
    ) {
        let k = own - range.start;
        let first = self.first_outside(k);
        let (mut lower, mut outside) = (self.starts[k] as usize, first);
        rows.visit_stored((own, range), work, |place, block| match place {
            Place::Diagonal => self.diagonal[k] = block,
            Place::Lower(_) => {
                self.lower[lower] = block;
                lower += 1;
            }
            Place::Outside(_) => {
                self.outside[outside].2 = block;
                outside += 1;
            }
        });
        self.update_added(k, first..outside);
        self.fixed[k] = None;
    }

    /// The position of the first block outside of the chunk in row `k`, relative to the chunk, or after it.
    fn first_outside(&self, k: usize) -> usize {
        self.outside.partition_point(|entry| usize::from(entry.0) < k)
    }

    /// Computes the entry of the diagonal `E` in a row with the entries `outside` of the chunk.
    fn update_added(&mut self, k: usize, outside: Range<usize>) {
        if N > 1 {
            return;
        }
        let size = |entry: &(u16, u32, Block<N>)| f64::from(entry.2[0][0].abs());
        let sum: f64 = self.outside[outside].iter().map(size).sum();
        let diagonal = f64::from(self.diagonal[k][0][0]);
        // sum and diagonal entry are equal up to rounding in some rows of second differences: no increase there
        let is_exceeded = sum > diagonal * (1.0 + 1e-4);
        if is_exceeded {
            self.added.resize(self.diagonal.len(), [0.0; N]);
        }
        if let Some(added) = self.added.get_mut(k) {
            added[0] = if is_exceeded { (0.5 * (MARGIN * sum - diagonal)) as f32 } else { 0.0 };
        }
    }

    /// The blocks of a row in the strictly lower triangle, each with the number of the other row relative to the chunk.
    #[inline(always)]
    fn lower_row(&self, row: usize) -> impl Iterator<Item = (usize, &Block<N>)> {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        let columns = self.columns[range.clone()].iter().map(|&other| usize::from(other));
        columns.zip(&self.lower[range])
    }

    /// The inverse of a block of `D + E` on its free unknowns; `None` if the block is not positive definite there.
    fn inverse(&self, row: usize, fixed: &[bool; N]) -> Option<Block<N>> {
        let diagonal = &self.diagonal[row];
        let is_out: [bool; N] = from_fn(|k| fixed[k] || diagonal[k][k] == 0.0);
        let mut block = [[0.0_f64; N]; N];
        for i in (0..N).filter(|&i| !is_out[i]) {
            for j in (0..N).filter(|&j| !is_out[j]) {
                // the matrix is symmetric up to rounding errors only
                block[i][j] = 0.5 * f64::from(diagonal[i][j] + diagonal[j][i]);
            }
            block[i][i] += self.added.get(row).map_or(0.0, |added| f64::from(added[i]));
        }
        invert_positive_definite(block.as_flattened_mut(), N, &is_out)
            .then(|| block.map(|row| row.map(|a| a as f32)))
    }
}

impl<const N: usize> BlockGaussSeidel<N> {
    /// The smoother of a matrix with `n` rows. [`Smoother::set_fixed`] must follow.
    fn new<T: Real>(n: usize, rows: ScaledRows<'_, T>) -> Self {
        let chunks = map_chunks_of_groups(n, N, |range| {
            ChunkRows::new(rows, range.start / N..range.end / N)
        });
        Self { chunks, chunk_length: chunk_length(n, N) / N }
    }
}

impl<T: Real, const N: usize> Smoother<T> for BlockGaussSeidel<N> {
    fn replace_rows(&mut self, changed: &[u32], rows: ScaledRows<'_, T>) {
        let length = self.chunk_length;
        let mut replaced: Vec<usize> = changed.iter().map(|&i| i as usize / N).collect();
        for k in 0..replaced.len() {
            // a preceding row of another chunk stores entries of this one
            let (own, of_chunk) = (replaced[k] % length, &self.chunks[replaced[k] / length]);
            let first = replaced[k] - own;
            let outside = of_chunk.outside[of_chunk.first_outside(own)..].iter();
            let of_row = outside.take_while(|entry| usize::from(entry.0) == own);
            replaced.extend(of_row.map(|entry| entry.1 as usize).filter(|&i| i < first));
        }
        replaced.sort_unstable();
        replaced.dedup();
        let mut work = Default::default();
        for of_chunk in replaced.chunk_by(|one, other| one / length == other / length) {
            let number = of_chunk[0] / length;
            let chunk = &mut self.chunks[number];
            let range = number * length..number * length + chunk.diagonal.len();
            of_chunk.iter().for_each(|&own| chunk.replace_row(rows, (own, &range), &mut work));
        }
    }

    fn set_fixed(&mut self, fixed: &[bool], kept: &[u32]) -> Result<(), FactorError> {
        let length = self.chunk_length;
        let tasks = self.chunks.iter_mut().zip(fixed.as_chunks::<N>().0.chunks(length)).collect();
        let is_positive = AtomicBool::new(true);
        for_each_item(tasks, &|_, (chunk, fixed): (&mut ChunkRows<N>, &[[bool; N]])| {
            for (k, fixed) in fixed.iter().enumerate() {
                if chunk.fixed[k] != Some(*fixed) {
                    match chunk.inverse(k, fixed) {
                        Some(block) => chunk.inverses[k] = block,
                        None => return is_positive.store(false, Ordering::Relaxed),
                    }
                    chunk.fixed[k] = Some(*fixed);
                }
            }
        });
        for i in kept.iter().map(|&i| i as usize / N) {
            let chunk = &mut self.chunks[i / length];
            (chunk.inverses[i % length], chunk.fixed[i % length]) = ([[0.0; N]; N], None);
        }
        if is_positive.into_inner() { Ok(()) } else { Err(FactorError::NotPositive) }
    }

    fn forward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        let length = N * self.chunk_length;
        sum_chunks_of_two(x, r, N, |range, x, r| {
            let chunk = &self.chunks[range.start / length];
            let (x, r) = (x.as_chunks_mut::<N>().0, r.as_chunks_mut::<N>().0);
            let b = b[range].as_chunks::<N>().0;
            for (row, (b, inverse)) in b.iter().zip(&chunk.inverses).enumerate() {
                let mut sum = *b;
                chunk.lower_row(row).for_each(|(j, a)| subtract_product(a, &x[j], &mut sum));
                let value = product(inverse, &sum);
                x[row] = value;
                // residuals of fixed unknowns are set to zero below
                r[row] = match chunk.added.get(row) {
                    _ if is_kept(inverse) => sum,
                    Some(added) => from_fn(|k| added[k] * value[k]),
                    None => [0.0; N],
                };
                chunk.lower_row(row).for_each(|(j, a)| subtract_transposed(a, &value, &mut r[j]));
            }
            0.0
        });
        let x = x.as_chunks::<N>().0;
        for_each_chunk_of_groups(r, N, |range, r| {
            let r = r.as_chunks_mut::<N>().0;
            let chunk = &self.chunks[range.start / length];
            for (row, other, a) in &chunk.outside {
                subtract_product(a, &x[*other as usize], &mut r[usize::from(*row)]);
            }
            for (r, fixed) in r.iter_mut().zip(&chunk.fixed) {
                let is_fixed = fixed.unwrap_or([false; N]);
                for (r, is_fixed) in r.iter_mut().zip(is_fixed) {
                    *r = if is_fixed { 0.0 } else { *r };
                }
            }
        });
    }

    fn backward(&self, b: &[f32], x: &mut [f32], r: &mut [f32]) {
        let length = N * self.chunk_length;
        let old = x.as_chunks::<N>().0;
        for_each_chunk_of_groups(r, N, |range, r| {
            r.copy_from_slice(&b[range.clone()]);
            let r = r.as_chunks_mut::<N>().0;
            for (row, other, a) in &self.chunks[range.start / length].outside {
                subtract_product(a, &old[*other as usize], &mut r[usize::from(*row)]);
            }
        });
        sum_chunks_of_two(x, r, N, |range, x, r| {
            let chunk = &self.chunks[range.start / length];
            let (x, r) = (x.as_chunks_mut::<N>().0, r.as_chunks_mut::<N>().0);
            for (row, inverse) in chunk.inverses.iter().enumerate().rev() {
                let mut sum = r[row];
                if let Some(added) = chunk.added.get(row) {
                    for k in 0..N {
                        sum[k] += added[k] * x[row][k];
                    }
                }
                chunk.lower_row(row).for_each(|(j, a)| subtract_product(a, &x[j], &mut sum));
                let value = if is_kept(inverse) { x[row] } else { product(inverse, &sum) };
                x[row] = value;
                chunk.lower_row(row).for_each(|(j, a)| subtract_transposed(a, &value, &mut r[j]));
            }
            0.0
        });
    }
}

/// Whether a block is not smoothed: it is kept, or is a fixed unknown, whose value is zero.
#[inline(always)]
fn is_kept<const N: usize>(inverse: &Block<N>) -> bool {
    N == 1 && inverse[0][0] == 0.0
}

/// `y = y - B x`.
#[inline(always)]
fn subtract_product<const N: usize>(block: &Block<N>, x: &[f32; N], y: &mut [f32; N]) {
    for (row, y) in block.iter().zip(y) {
        let mut sum = ZERO;
        for j in 0..N {
            sum += row[j] * x[j];
        }
        *y -= sum;
    }
}

/// `y = y - B^T x`.
#[inline(always)]
fn subtract_transposed<const N: usize>(block: &Block<N>, x: &[f32; N], y: &mut [f32; N]) {
    let mut sum = [ZERO; N];
    for (row, &x) in block.iter().zip(x) {
        for j in 0..N {
            sum[j] += row[j] * x;
        }
    }
    y.iter_mut().zip(sum).for_each(|(y, sum)| *y -= sum);
}

/// `B x` for a symmetric block.
#[inline(always)]
fn product<const N: usize>(block: &Block<N>, x: &[f32; N]) -> [f32; N] {
    let mut y = [ZERO; N];
    for (column, &x) in block.iter().zip(x) {
        for j in 0..N {
            y[j] += column[j] * x;
        }
    }
    y
}
