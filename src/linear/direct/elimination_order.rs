//! Orders of elimination for the unknowns of a symmetric matrix.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;

use super::error::{FactorError, out_of_memory};
use super::nested_dissection::GeometricGraph;
use super::symbolic_factor::transpose_view;
use crate::algebra::{Inequality, NO_INDEX, SparseMatrix, Submatrix};
use crate::real::Real;

/// Least number of unknowns for nested dissection. With fewer unknowns the times with the two
/// orders differ by a tenth of a millisecond.
const MIN_DISSECTED: usize = 2_000;

/// An order of elimination for the unknowns of a symmetric matrix, and by restriction for each subset
/// of them.
///
/// The order determines the size of the Cholesky factor. An active set method computes it once for
/// all active sets. Times in milliseconds of one thread (two hyperthreads of a shared AMD EPYC,
/// November 2026; `cargo test --release --test inequalities ordering::times -- --ignored --nocapture`),
/// in the columns:
///
/// * *degree*, *dissection*: computation of the order by minimum degree and by nested dissection;
/// * *new degree*: symbolic and numeric factorisation of one step with an order by minimum degree
///   that is computed anew, its computation included;
/// * *old degree*, *old dissection*: symbolic and numeric factorisation of one step with the order
///   of all free unknowns, which has been computed before, restricted to the unknowns of the step.
///
/// | | unknowns | degree | dissection | new degree | old degree | old dissection |
/// |---|---|---|---|---|---|---|
/// | P1, `2 * 128^2` triangles | 16 129 | 1.6 | 5.7 | 15 | 13 | 13 |
/// | inactive unknowns of this system | 10 308 | | | 7.6 | 5.0 | 4.7 |
/// | P1, `2 * 256^2` triangles | 65 025 | 6.5 | 27 | 39 | 33 | 31 |
/// | inactive unknowns of this system | 41 956 | | | 27 | 36 (a) | 32 |
/// | SIPG, `2 * 128^2` triangles | 98 304 | 8 | 22 | 93 | 87 | 80 |
/// | P1, `6 * 32^3` tetrahedra | 29 791 | 9 | 24 | 287 | 275 | 139 |
/// | inactive unknowns of this system | 24 264 | | | 132 | 125 | 68 |
/// | Crouzeix-Raviart, `6 * 12^3` tetrahedra | 19 872 | 3 | 17 | 25 | 22 | 12 |
/// | SIPG, `6 * 12^3` tetrahedra | 41 472 | 6 | 9 | 238 | 234 | 205 |
///
/// (a) More than with a new order although the factor has fewer entries: it has so few that faer chooses its
/// simplicial algorithm instead of the supernodal one.
///
/// With an order that is computed once, the sum of the times up to step `k` is, by the rows of full
/// systems, smaller for dissection than for minimum degree from the first or second step on in
/// three dimensions, from the third on for SIPG on triangles (where dissection orders the cells
/// instead of the unknowns), and from the eleventh on at the earliest for P1 on triangles. Compared
/// with a new order in every step, it is smaller from the fourth step on at the latest.
///
/// Not in the table: for conforming linear elements nested dissection stores 36 % fewer entries of the
/// factor in three dimensions, 4 % fewer in two.
#[derive(Clone, Debug)]
pub struct EliminationOrder {
    unknowns: Vec<u32>,
}

impl EliminationOrder {
    /// The order for the unknowns `free` (ascending) of a matrix whose row `i` has the node
    /// `points[i]`: nested dissection for at least `MIN_DISSECTED` (2 000) unknowns if the domain
    /// is three-dimensional (the points vary along all three axes) or the elements are
    /// discontinuous (the graph of cells has at most half as many nodes as there are unknowns);
    /// else approximate minimum degree, also if `points` is `None` or has fewer entries than the
    /// matrix has rows.
    ///
    /// Only the lower triangle is read, except that two consecutive unknowns belong to the same
    /// cell if their whole rows have the same pattern. A pattern that is not symmetric is treated
    /// as the pattern of its lower triangle and the transpose of this triangle; the result is a
    /// permutation all the same.
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    ///
    /// # Panics
    /// If `free` contains a row that the matrix does not have. If `free` is not strictly ascending, the
    /// result need not be a permutation.
    pub fn new<T: Real>(
        matrix: &SparseMatrix<T>,
        free: &[u32],
        points: Option<&[[f32; 3]]>,
    ) -> Result<Self, FactorError> {
        if let Some(points) =
            points.filter(|points| free.len() >= MIN_DISSECTED && points.len() >= matrix.size())
        {
            let graph = GeometricGraph::new(matrix, free, points);
            if graph.varying_axes().len() == 3 || 2 * graph.n_nodes() <= free.len() {
                return Ok(Self { unknowns: graph.elimination_order() });
            }
        }
        Self::by_degree(matrix, free)
    }

    /// Nested dissection with the nodes `points` of all rows, for the unknowns `free` (ascending) of a
    /// matrix.
    ///
    /// # Panics
    /// If there are fewer points than rows, or `free` contains a row that the matrix does not have.
    #[must_use]
    pub fn by_dissection<T>(matrix: &SparseMatrix<T>, free: &[u32], points: &[[f32; 3]]) -> Self {
        Self { unknowns: GeometricGraph::new(matrix, free, points).elimination_order() }
    }

    /// Approximate minimum degree for the unknowns `free` (ascending) of a matrix; P. R. Amestoy,
    /// T. A. Davis, I. S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996), 886-905.
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    ///
    /// # Panics
    /// If `free` contains a row that the matrix does not have.
    pub fn by_degree<T: Real>(matrix: &SparseMatrix<T>, free: &[u32]) -> Result<Self, FactorError> {
        let lower = Submatrix::lower_triangle(matrix, free);
        let pattern = transpose_view(&lower);
        let n = free.len();
        let (mut order, mut inverse) = (vec![0_u32; n], vec![0_u32; n]);
        let scratch = amd::order_scratch::<u32>(n, lower.columns.len());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        let (stack, control) = (MemStack::new(&mut memory), amd::Control::default());
        amd::order(&mut order, &mut inverse, pattern.symbolic(), control, stack)
            .map_err(out_of_memory)?;
        Ok(Self { unknowns: order.into_iter().map(|k| free[k as usize]).collect() })
    }

    /// The order of [`EliminationOrder::new`] for the free unknowns of an inequality.
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    pub(crate) fn for_inequality<T: Real>(inequality: &Inequality<T>) -> Result<Self, FactorError> {
        let points = inequality.points_of_unknowns();
        Self::new(&inequality.matrix, &inequality.free_unknowns(), points.as_deref())
    }

    /// The unknowns in the order of elimination: the one at position zero is eliminated first.
    pub fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    /// The list [`EliminationOrder::unknowns`], without a copy.
    pub(crate) fn into_unknowns(self) -> Vec<u32> {
        self.unknowns
    }

    /// An order of all rows of a matrix, given by its lower triangle. The unknowns of this order are the first rows of
    /// the matrix; each further row follows the last one, in this order, of the unknowns with which it is coupled.
    pub(crate) fn with_rows_after_their_columns<T: Real>(
        &self,
        lower: &SparseMatrix<T>,
    ) -> Vec<u32> {
        let n = self.unknowns.len();
        let mut positions = vec![0; n];
        self.unknowns.iter().enumerate().for_each(|(k, &i)| positions[i as usize] = k);
        let mut rows: Vec<(usize, u32)> = (n..lower.size())
            .map(|i| {
                let columns = lower.row(i).0.iter().filter_map(|&j| positions.get(j as usize));
                (columns.max().copied().unwrap_or(0), i as u32)
            })
            .collect();
        rows.extend(self.unknowns.iter().enumerate().map(|(k, &i)| (k, i)));
        // at equal positions the unknown comes first, because further rows have larger numbers
        rows.sort_unstable();
        rows.into_iter().map(|(_, i)| i).collect()
    }

    /// The restriction of the order to the unknowns `free` of a matrix with `size` rows: positions in
    /// `free` in the order of elimination. Unknowns of `free` that are not in the order come last.
    ///
    /// # Panics
    /// If `free` contains an unknown that is not less than `size`.
    pub(crate) fn restricted_to(&self, free: &[u32], size: usize) -> Vec<u32> {
        let mut positions = vec![NO_INDEX; size];
        free.iter().enumerate().for_each(|(k, &i)| positions[i as usize] = k as u32);
        let take = |&i: &u32| positions.get_mut(i as usize).map(|k| std::mem::replace(k, NO_INDEX));
        let all = self.unknowns.iter().chain(free).filter_map(take);
        all.filter(|&k| k != NO_INDEX).collect()
    }
}
