//! The directions in which the jump multipliers of a block do no work, or little work, on its free unknowns.

use crate::algebra::dense::extend_basis;

/// A column of `B` counts as linearly dependent on other columns if its part orthogonal to them has at most this norm,
/// relative to the largest column. Any number between rounding errors and one is admissible: entries of the block
/// inverse exceed stiffnesses by at most the inverse square of the number.
const DEPENDENT: f64 = 1e-2;

/// Null directions `y` of blocks, and the multipliers `q` of these directions as unknowns of the
/// condensed system.
///
/// Let `A` be the stiffness of a block on its free unknowns, `B` the means over its sides as functions of
/// these unknowns, `a` the facet means, `p` the jump multipliers, `W` the diagonal of the reciprocal weights, and `r`
/// the load: `A u + B^T p = r`, `B u - W p = a`. For a direction `y` of jump multipliers with a small `B^T y`,
/// elimination of the block has a small pivot: the inverse then contains a weight, or the large diagonal entry of an
/// unknown, added to stiffnesses, which loses their digits. With such directions as columns of `Y`, scaled by
/// `Y^T W Y = c I`, with `Z = W Y / c`, `E = B^T Y`, a stiffness `k` and `p = p' - Y q`, the equations are
/// equivalent to
///
/// ```text
/// A u + B^T p' = r + E q,
/// B u - X p' = a,    X = W + Z Z^T / k,
/// Y^T a - E^T u - (c + k c^2) q = 0,
/// ```
///
/// The equivalence holds for any such `Y`. In the directions `Y` the matrix `X` has the size `1 / k`, so that no pivot
/// is small. Let `N` be the inverse of the matrix of the first two equations, and `G = N [E, 0]` with the parts `G_u`
/// on unknowns and `G_p` on sides. Elimination of `u` and `p'` leaves
///
/// ```text
/// (Y - G_p)^T a - (c + k c^2 + E^T G_u) q = G_u^T r.
/// ```
///
/// The multiplier `q` must be eliminated after the facet means of its block; before them, its pivot is the small one.
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
    /// The columns of `E` for the directions of the last block, one entry for each free unknown of this block.
    works: Vec<f64>,
    /// Workspace: orthonormal vectors with one entry for each side of a block.
    basis: Vec<f64>,
    /// Workspace: the sum of the squares of each row of `B`.
    squares: Vec<f64>,
    /// Workspace: the square roots of the entries of `W`, divided by the largest root.
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

    /// The entries `Y - G_p` of a direction in the condensed matrix, one for each side of the block.
    pub fn entries(&self, direction: usize) -> &[f64] {
        &self.entries[self.starts[direction] as usize..self.starts[direction + 1] as usize]
    }

    /// The values `G_u` of the free unknowns of the block if the multiplier of the direction is one, and the load, the
    /// facet means and all other multipliers are zero.
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

    /// Appends the directions of a block with the matrix `[[A, B^T], [B, -W]]` of `n` rows, the first `n_free` of
    /// which are those of free unknowns; `A` is divided and `W` multiplied by `unit`. Replaces `W` by `X`. A call of
    /// [`NullDirections::couple`] with the inverse must follow.
    ///
    /// A side is uncoupled if the norm of its row of `B` is at most `tolerance_of_rows`, the square root of machine
    /// epsilon, times the largest norm of a row. Uncoupled sides have no direction: elimination of the block adds their
    /// weights to no stiffness.
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
        // W = largest * roots^2. With V = roots * Y the columns of V are orthonormal, and (up to the tolerance)
        // orthogonal to the columns of B / roots.
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

    /// Computes the entries that couple the directions of the last block with its facet means and with one another,
    /// from the inverse of the matrix that [`NullDirections::append`] has left, in the scaling of that matrix. The
    /// unscaled values of the free unknowns are the scaled ones times `scales`.
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
