//! The directions in which the jump multipliers of a block do no work on its free unknowns.

use crate::algebra::dense::extend_basis;

/// Null directions `y` of blocks, and the multipliers `q` of these directions as unknowns of the
/// condensed system.
///
/// Let `B` be the means over the sides of a block as functions of its free unknowns, `a` the facet
/// means, `p` the jump multipliers, `W` the diagonal of the reciprocal weights: `B u - W p = a`. In a
/// direction with `B^T y = 0`, elimination of the block has the pivot `-W` alone, so that a weight is
/// added to stiffnesses. With all such directions `Y`, `Y^T W Y = c I`, `Z = W Y / c`, a stiffness `k`
/// and `p = p' - Y q`, the same equation is
///
/// ```text
/// B u - X p' = a,    X = W + Z Z^T / k,
/// Y^T a - (c + k c^2) q = 0,
/// ```
///
/// and `X` is moderate in all directions. `q` must be eliminated after the facet means of its block:
/// before them, its pivot is the reciprocal weight alone.
#[derive(Default)]
pub(super) struct NullDirections {
    /// The block of each direction, ascending.
    blocks: Vec<u32>,
    /// Start of each direction in `entries`, and the number of entries at the end.
    starts: Vec<u32>,
    /// The entries of the directions, one for each side of the block.
    entries: Vec<f64>,
    /// `c + k c^2` for each direction.
    pivots: Vec<f64>,
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
        Self { starts: vec![0], ..Self::default() }
    }

    /// The block of each direction.
    pub fn blocks(&self) -> &[u32] {
        &self.blocks
    }

    /// The entries of a direction.
    pub fn entries(&self, direction: usize) -> &[f64] {
        &self.entries[self.starts[direction] as usize..self.starts[direction + 1] as usize]
    }

    /// The diagonal entry of a direction in the condensed matrix.
    pub fn diagonal(&self, direction: usize) -> f64 {
        -self.pivots[direction]
    }

    /// Appends the directions of a block with the matrix `[[K, B^T], [B, -W]]`, `n_free` of its `n`
    /// rows those of free unknowns, in which `K` is divided and `W` multiplied by `unit`. Replaces `W`
    /// by `X`.
    ///
    /// Sides on which no free unknown has a mean have no part in a direction: their weights are
    /// diagonal entries. Columns of `B` of relative norm up to `tolerance` count as dependent.
    pub fn append(
        &mut self,
        block: u32,
        matrix: &mut [f64],
        (n_free, n): (usize, usize),
        unit: f64,
        tolerance: f64,
    ) {
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
        let is_coupled = |l: &usize| squares[*l] > tolerance.powi(2) * largest_square;
        let n_coupled = (0..n_sides).filter(is_coupled).count();
        // W = largest * roots^2; with V = roots * Y the conditions are V^T V = I and
        // (B / roots)^T V = 0
        let largest = sides.clone().map(|l| -matrix[l * n + l]).fold(0.0, f64::max);
        roots.clear();
        roots.extend(sides.map(|l| (-matrix[l * n + l] / largest).sqrt()));
        let column = |k: usize| (0..n_sides).map(move |l| (k * n + n_free + l, l));
        let norm = |k: usize| column(k).map(|(i, l)| (matrix[i] / roots[l]).powi(2)).sum::<f64>();
        let tolerance = tolerance * (0..n_free).map(norm).fold(0.0, f64::max).sqrt();
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
        for v in basis[rank * n_sides..].chunks_exact(n_sides) {
            self.entries.extend(v.iter().zip(&*roots).map(|(v, root)| v / root));
            self.starts.push(self.entries.len() as u32);
            self.blocks.push(block);
            self.pivots.push(c + k * c * c);
            for l in 0..n_sides {
                for m in 0..n_sides {
                    let product = v[l] * roots[l] * v[m] * roots[m];
                    matrix[(n_free + l) * n + n_free + m] -= largest_square * product;
                }
            }
        }
    }
}
