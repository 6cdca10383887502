//! Products with over-penalised matrices, by the sum `K + M^T S M`.

use std::ops::Range;

use crate::algebra::{NO_INDEX, PenalisedMatrix, SidePenalties};
use crate::real::Real;

/// The matrix `K + M^T S M` of discontinuous linear functions, without assembled entries. A product reads for each
/// cell the block of `K`, and a penalty and an index for each facet: 176 bytes for a tetrahedron in `f64`, whereas the
/// entries of the assembled matrix and their columns take 936.
///
/// The rows of a cell need the means over both sides of its facets. Each penalty is computed once for each of the two
/// cells of a facet, so that no cell writes to the rows of another cell.
pub(crate) struct PenalisedProduct<'m, T> {
    /// The blocks of `K`.
    blocks: &'m [T],
    /// The penalties `M^T S M`. If the unknowns are vertex values, each penalty is divided by the square of the number
    /// of vertices of a facet, so that sums over these vertices replace means.
    penalties: SidePenalties<T>,
}

impl<'m, T: Real> PenalisedProduct<'m, T> {
    /// The product with a penalised matrix; `None` if [`SidePenalties::new`] returns `None`.
    pub fn new(penalised: &'m PenalisedMatrix<T>) -> Option<Self> {
        let mut penalties = SidePenalties::new(penalised)?;
        if !penalties.are_means {
            let vertices = (penalties.cell_size - 1) as f64;
            let scale = T::lit(1.0 / (vertices * vertices));
            penalties.penalty.iter_mut().for_each(|penalty| *penalty *= scale);
        }
        Some(Self { blocks: &penalised.blocks, penalties })
    }

    pub fn size(&self) -> usize {
        self.penalties.penalty.len()
    }

    pub fn cell_size(&self) -> usize {
        self.penalties.cell_size
    }

    /// See [`Product::rows`](super::product::Product::rows).
    pub fn rows(&self, range: Range<usize>, fixed: &[bool], p: &[T], q: &mut [T]) -> f64 {
        match (self.cell_size(), self.penalties.are_means) {
            (3, true) => self.rows_of_cells::<3, true>(range, fixed, p, q),
            (3, false) => self.rows_of_cells::<3, false>(range, fixed, p, q),
            (_, true) => self.rows_of_cells::<4, true>(range, fixed, p, q),
            (_, false) => self.rows_of_cells::<4, false>(range, fixed, p, q),
        }
    }

    fn rows_of_cells<const N: usize, const ARE_MEANS: bool>(
        &self,
        range: Range<usize>,
        fixed: &[bool],
        p: &[T],
        q: &mut [T],
    ) -> f64 {
        let zero = T::lit(0.0);
        let Self { blocks, penalties } = self;
        let mut sum = 0.0;
        for (q, first) in q.chunks_exact_mut(N).zip(range.step_by(N)) {
            let fixed = &fixed[first..first + N];
            if fixed.iter().all(|&fixed| fixed) {
                q.fill(zero);
                continue;
            }
            let x = values_of::<T, N>(p, first);
            let own = means::<T, N, ARE_MEANS>(&x);
            let (opposite, penalty) =
                (&penalties.opposite[first..first + N], &penalties.penalty[first..first + N]);
            let mut multipliers = [zero; N];
            for s in 0..N {
                let other = match opposite[s] as usize {
                    _ if opposite[s] == NO_INDEX => zero,
                    side if ARE_MEANS => p[side],
                    side => {
                        let values = values_of::<T, N>(p, side / N * N);
                        means::<T, N, ARE_MEANS>(&values)[side % N]
                    }
                };
                multipliers[s] = penalty[s] * (own[s] - other);
            }
            // the map from the unknowns of a cell to its means is symmetric
            let penalty_product = means::<T, N, ARE_MEANS>(&multipliers);
            let block = &blocks[first * N..(first + N) * N];
            for (i, row) in block.chunks_exact(N).enumerate() {
                let product =
                    row.iter().zip(&x).fold(penalty_product[i], |sum, (&a, &x)| sum + a * x);
                q[i] = if fixed[i] { zero } else { product };
                sum += x[i].to_f64() * q[i].to_f64();
            }
        }
        sum
    }
}

/// The values of a cell of which `first` is the first unknown.
#[inline(always)]
fn values_of<T: Real, const N: usize>(p: &[T], first: usize) -> [T; N] {
    let mut values = [T::lit(0.0); N];
    values.copy_from_slice(&p[first..first + N]);
    values
}

/// The means over the facets of a cell if these are the unknowns, else for each facet the sum of the vertex
/// values on it.
#[inline(always)]
fn means<T: Real, const N: usize, const ARE_MEANS: bool>(values: &[T; N]) -> [T; N] {
    if ARE_MEANS {
        return *values;
    }
    let total = values.iter().fold(T::lit(0.0), |sum, &x| sum + x);
    values.map(|x| total - x)
}
