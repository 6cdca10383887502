//! The directions in which the jump multipliers of a block do no work on its free unknowns.

use crate::algebra::dense::extend_basis;

/// Largest norm of a column of `B`, relative to the largest column, that counts as dependent on others. Any
/// number between rounding and one is right; weights up to the inverse square of the number remain beside
/// stiffnesses.
const DEPENDENT: f64 = 1e-2;

/// Null directions `y` of blocks, and the multipliers `q` of these directions as unknowns of the
/// condensed system.
///
/// Let `A` be the stiffness of a block on its free unknowns, `B` the means over its sides as functions of
/// them, `a` the facet means, `p` the jump multipliers, `W` the diagonal of the reciprocal weights, and `r`
/// the load: `A u + B^T p = r`, `B u - W p = a`. In a direction in which `B^T y` is small beside `A`,
/// elimination of the block has a small pivot, so that a weight, or the large diagonal of an unknown, is
/// added to stiffnesses. With such directions `Y`, `Y^T W Y = c I`, `Z = W Y / c`, `E = B^T Y`, a stiffness `k` and
/// `p = p' - Y q`, the same equations are
///
/// ```text
/// A u + B^T p' = r + E q,
/// B u - X p' = a,    X = W + Z Z^T / k,
/// Y^T a - E^T u - (c + k c^2) q = 0,
/// ```
///
/// for any `Y`, and `X` is moderate in all directions. With the inverse `N` of the first two equations and
/// `G = N E`, `G_u` on unknowns and `G_p` on sides, elimination of the block leaves
///
/// ```text
/// (Y - G_p)^T a - (c + k c^2 + E^T G_u) q = G_u^T r.
/// ```
///
/// `q` must be eliminated after the facet means of its block: before them, its pivot is the small one.
#[derive(Default)]
pub(super) struct NullDirections {
    /// The block of each direction, ascending.
    blocks: Vec<u32>,
    /// Start of each direction in `entries`, and the number of entries at the end.
    starts: Vec<u32>,
    /// The entries of `Y - G_p`, one for each side of the block.
    entries: Vec<f64>,
    /// Start of each direction in `responses`, and the number of responses at the end.
    response_starts: Vec<u32>,
    /// The entries of `G_u`, one for each free unknown of the block.
    responses: Vec<f64>,
    /// Start of each direction in `products`, and the number of products at the end.
    product_starts: Vec<u32>,
    /// The row of `-(c + k c^2 + E^T G_u)` of each direction, up to its diagonal entry.
    products: Vec<f64>,
    /// `E` for the directions of the last block, one entry for each of its free unknowns.
    works: Vec<f64>,
    /// Workspace: orthonormal vectors.
    basis: Vec<f64>,
    /// Workspace: sums of the squares of each row of `B`.
    squares: Vec<f64>,
    /// Workspace: the roots of `W`, divided by the largest.
    roots: Vec<f64>,
}

impl NullDirections {
    /// No directions.
    pub fn new() -> Self {
        let starts = || vec![0];
        Self {
            starts: starts(),
            response_starts: starts(),
            product_starts: starts(),
            ..Self::default()
        }
    }

    /// The block of each direction.
    pub fn blocks(&self) -> &[u32] {
        &self.blocks
    }

    /// The directions of a block, none of which is before `start`.
    pub fn of_block(&self, block: usize, start: usize) -> std::ops::Range<usize> {
        let is_own = |b: &&u32| **b as usize == block;
        start..start + self.blocks[start..].iter().take_while(is_own).count()
    }

    /// The entries of a direction.
    pub fn entries(&self, direction: usize) -> &[f64] {
        &self.entries[self.starts[direction] as usize..self.starts[direction + 1] as usize]
    }

    /// The values of the free unknowns of the block where the multiplier of a direction is one.
    pub fn responses(&self, direction: usize) -> &[f64] {
        let range = self.response_starts[direction]..self.response_starts[direction + 1];
        &self.responses[range.start as usize..range.end as usize]
    }

    /// The entries of the condensed matrix in the row of a direction and the columns of the directions of
    /// the same block up to it; the diagonal entry is the last.
    pub fn products(&self, direction: usize) -> &[f64] {
        let range = self.product_starts[direction]..self.product_starts[direction + 1];
        &self.products[range.start as usize..range.end as usize]
    }

    /// Appends the directions of a block with the matrix `[[A, B^T], [B, -W]]`, `n_free` of its `n`
    /// rows those of free unknowns, in which `A` is divided and `W` multiplied by `unit`. Replaces `W`
    /// by `X`. [`NullDirections::couple`] must follow with the inverse.
    ///
    /// Sides on which no free unknown has a mean have no part in a direction: their weights are
    /// diagonal entries; such is a row of `B` whose relative norm is at most `tolerance_of_rows`, the root
    /// of machine epsilon. Columns of `B` of relative norm up to [`DEPENDENT`] count as dependent.
    pub fn append(
        &mut self,
        block: u32,
        matrix: &mut [f64],
        (n_free, n): (usize, usize),
        unit: f64,
        tolerance_of_rows: f64,
    ) {
        self.works.clear();
        let n_sides = n - n_free;
        if n_sides == 0 {
            return;
        }
        let Self { basis, squares, roots, .. } = self;
        let sides = n_free..n;
        squares.clear();
        squares.extend(
            sides.clone().map(|l| -> f64 { (0..n_free).map(|k| matrix[k * n + l].powi(2)).sum() }),
        );
        let largest_square = squares.iter().copied().fold(0.0, f64::max);
        let is_coupled = |l: &usize| squares[*l] > tolerance_of_rows.powi(2) * largest_square;
        let n_coupled = (0..n_sides).filter(is_coupled).count();
        // W = largest * roots^2; with V = roots * Y the conditions are V^T V = I and
        // (B / roots)^T V = 0
        let largest = sides.clone().map(|l| -matrix[l * n + l]).fold(0.0, f64::max);
        roots.clear();
        roots.extend(sides.map(|l| (-matrix[l * n + l] / largest).sqrt()));
        let column = |k: usize| (0..n_sides).map(move |l| (k * n + n_free + l, l));
        let norm = |k: usize| column(k).map(|(i, l)| (matrix[i] / roots[l]).powi(2)).sum::<f64>();
        let tolerance = DEPENDENT * (0..n_free).map(norm).fold(0.0, f64::max).sqrt();
        basis.clear();
        for k in 0..n_free {
            extend_basis(basis, column(k).map(|(i, l)| matrix[i] / roots[l]), tolerance);
        }
        let rank = basis.len() / n_sides;
        for _ in rank..n_coupled {
            let share = |l: &usize| basis.iter().skip(*l).step_by(n_sides).map(|v| v * v).sum();
            let compare = |a: &usize, b: &usize| f64::total_cmp(&share(a), &share(b));
            let Some(side) = (0..n_sides).filter(is_coupled).min_by(compare) else { break };
            extend_basis(basis, (0..n_sides).map(|l| f64::from(u8::from(l == side))), 0.0);
        }
        let (c, k) = (largest / unit, unit / largest_square);
        for (index, v) in basis[rank * n_sides..].chunks_exact(n_sides).enumerate() {
            let y = || v.iter().zip(&*roots).map(|(v, root)| v / root);
            self.entries.extend(y());
            self.starts.push(self.entries.len() as u32);
            self.blocks.push(block);
            self.products.extend((0..index).map(|_| 0.0));
            self.products.push(-(c + k * c * c));
            self.product_starts.push(self.products.len() as u32);
            let work = |i: usize| column(i).zip(y()).map(|((m, _), y)| matrix[m] * y).sum::<f64>();
            self.works.extend((0..n_free).map(work));
        }
        for v in basis[rank * n_sides..].chunks_exact(n_sides) {
            for l in 0..n_sides {
                for m in 0..n_sides {
                    let product = v[l] * roots[l] * v[m] * roots[m];
                    matrix[(n_free + l) * n + n_free + m] -= largest_square * product;
                }
            }
        }
    }

    /// Couples the directions of the last block with its facet means and with one another, given the
    /// inverse of the matrix that [`NullDirections::append`] has left, in the same scaling. The true
    /// values of the free unknowns are those of the inverse times `scales`.
    pub fn couple(
        &mut self,
        inverse: &[f64],
        (n_free, n): (usize, usize),
        unit: f64,
        scales: &[f64],
    ) {
        let n_directions = self.works.len() / n_free.max(1);
        let first = self.blocks.len() - n_directions;
        for (index, work) in self.works.chunks_exact(n_free.max(1)).enumerate() {
            let response = |row: usize| -> f64 {
                work.iter().zip(&inverse[row * n..row * n + n_free]).map(|(e, x)| e * x).sum()
            };
            let start = self.responses.len();
            self.responses.extend((0..n_free).map(response));
            let of_unknowns = &mut self.responses[start..];
            for (column, work) in self.works.chunks_exact(n_free).take(index + 1).enumerate() {
                let product: f64 = work.iter().zip(&*of_unknowns).map(|(e, x)| e * x).sum();
                self.products[self.product_starts[first + index] as usize + column] -=
                    product / unit;
            }
            of_unknowns.iter_mut().zip(scales).for_each(|(x, scale)| *x *= scale / unit);
            self.response_starts.push(self.responses.len() as u32);
            let entries = &mut self.entries[self.starts[first + index] as usize..];
            entries.iter_mut().zip(n_free..n).for_each(|(y, row)| *y -= response(row));
        }
    }
}
