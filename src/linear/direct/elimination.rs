//! In which order the unknowns of a symmetric matrix are eliminated.

use std::sync::OnceLock;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;

use super::factors::{Analysis, FactorError, Factors, columns};
use super::nested_dissection::Cloud;
use crate::algebra::submatrix::Submatrix;
use crate::algebra::{Inequality, PenalisedMatrix, SparseMatrix, barycentre};
use crate::real::Real;

/// No place.
const NONE: u32 = u32::MAX;

/// Unknowns from which dissection pays: below, the two orders differ by a tenth of a millisecond.
const DISSECTED: usize = 2_000;

/// An order in which to eliminate the unknowns of a symmetric matrix: one for all sets of free
/// unknowns.
///
/// The order matters for the size of Cholesky factors and the time they take. It is found once and
/// kept while an active set moves. Analysis and factors of a step then take, in milliseconds of one
/// thread (two hyperthreads of an AMD EPYC shared with other work, November 2026;
/// `cargo test --release --test ordering -- --ignored --nocapture`):
///
/// | | unknowns | order: degree | dissection | step: degree anew | degree kept | dissection kept |
/// |---|---|---|---|---|---|---|
/// | P1, `2 * 128^2` triangles | 16 129 | 1.6 | 5.7 | 15 | 13 | 13 |
/// | the same in contact | 10 308 | | | 7.6 | 5.0 | 4.7 |
/// | P1, `2 * 256^2` triangles | 65 025 | 6.5 | 27 | 39 | 33 | 31 |
/// | the same in contact | 41 956 | | | 27 | 36 | 32 |
/// | SIPG, `2 * 128^2` triangles | 98 304 | 8 | 22 | 93 | 87 | 80 |
/// | P1, `6 * 32^3` tetrahedra | 29 791 | 9 | 24 | 287 | 275 | 139 |
/// | the same in contact | 24 264 | | | 132 | 125 | 68 |
/// | Crouzeix-Raviart, `6 * 12^3` tetrahedra | 19 872 | 3 | 17 | 25 | 22 | 12 |
/// | SIPG, `6 * 12^3` tetrahedra | 41 472 | 6 | 9 | 238 | 234 | 205 |
///
/// (36 instead of 27: fewer entries, so few that faer eliminates them column by column and not in
/// blocks.)
///
/// Dissection stores 36 % fewer numbers in space with conforming linears, 4 % fewer in the plane: there
/// it pays only from the fourth or so step on, except for broken elements, whose cells are ordered
/// instead of their unknowns.
#[derive(Clone, Debug)]
pub struct EliminationOrder {
    unknowns: Vec<u32>,
}

impl EliminationOrder {
    /// The order for the unknowns `kept` of a matrix, whose rows live at `points` if these are known:
    /// dissection of many unknowns in space, or where cells own them; else by degree. Fewer points
    /// than rows are as good as none.
    ///
    /// Of the matrix only entries on and left of the diagonal are read, except that cells are told by
    /// rows with the same entries.
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    ///
    /// # Panics
    /// If `kept` names a row that the matrix does not have. It is to be ascending, each unknown once;
    /// of other lists the order may be no permutation.
    pub fn new<T: Real>(
        matrix: &SparseMatrix<T>,
        kept: &[u32],
        points: Option<&[[f32; 3]]>,
    ) -> Result<Self, FactorError> {
        if let Some(points) =
            points.filter(|points| kept.len() >= DISSECTED && points.len() >= matrix.size())
        {
            let cloud = Cloud::new(matrix, kept, points);
            if cloud.axes().len() == 3 || 2 * cloud.different() <= kept.len() {
                return Ok(Self { unknowns: cloud.order() });
            }
        }
        Self::by_degree(matrix, kept)
    }

    /// Nested dissection of points of space, for `kept` as in [`EliminationOrder::new`].
    ///
    /// # Panics
    /// If there are fewer points than rows, or as [`EliminationOrder::new`].
    pub fn by_dissection<T>(matrix: &SparseMatrix<T>, kept: &[u32], points: &[[f32; 3]]) -> Self {
        Self { unknowns: Cloud::new(matrix, kept, points).order() }
    }

    /// Approximate minimum degree (P. R. Amestoy, T. A. Davis, I. S. Duff, SIAM J. Matrix Anal. Appl.
    /// 17 (1996), 886-905), for `kept` as in [`EliminationOrder::new`].
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    ///
    /// # Panics
    /// As [`EliminationOrder::new`].
    pub fn by_degree<T: Real>(matrix: &SparseMatrix<T>, kept: &[u32]) -> Result<Self, FactorError> {
        let restricted = Submatrix::left_of_diagonal(matrix, kept);
        let pattern = columns(&restricted);
        let n = kept.len();
        let (mut order, mut inverse) = (vec![0_u32; n], vec![0_u32; n]);
        let scratch = amd::order_scratch::<u32>(n, restricted.columns.len());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::OutOfMemory)?;
        let (stack, control) = (MemStack::new(&mut memory), amd::Control::default());
        amd::order(&mut order, &mut inverse, pattern.symbolic(), control, stack)?;
        Ok(Self { unknowns: order.into_iter().map(|k| kept[k as usize]).collect() })
    }

    /// The order for all unknowns of an inequality that are not given.
    ///
    /// # Errors
    /// [`FactorError::OutOfMemory`].
    pub(crate) fn of<T: Real>(inequality: &Inequality<T>) -> Result<Self, FactorError> {
        let points = inequality.points_of_unknowns();
        Self::new(&inequality.matrix, &inequality.not_given(), points.as_deref())
    }

    /// The unknowns, first eliminated first.
    pub fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    /// The same order among the unknowns `free` of a matrix of some size, as places in that list.
    /// Unknowns that the order does not know come last.
    pub(crate) fn among(&self, free: &[u32], size: usize) -> Vec<u32> {
        let mut places = vec![NONE; size];
        free.iter().enumerate().for_each(|(k, &i)| places[i as usize] = k as u32);
        let take =
            |&i: &u32| places.get_mut(i as usize).map(|place| std::mem::replace(place, NONE));
        let all = self.unknowns.iter().chain(free).filter_map(take);
        all.filter(|&k| k != NONE).collect()
    }
}

/// What is known of the factors of matrices with one pattern: it is analysed once.
#[derive(Default)]
pub(crate) struct KnownPattern {
    points: Option<Vec<[f32; 3]>>,
    analysis: OnceLock<Analysis>,
}

impl KnownPattern {
    /// For matrices with a row for each jump with two sides, at the mean of the points of its
    /// unknowns, if these are known.
    pub fn of_jumps<T: Real>(factored: &PenalisedMatrix<T>, points: Option<&[[f32; 3]]>) -> Self {
        let centres = |points: &[[f32; 3]]| {
            let shared = |&jump: &usize| factored.sides(jump).iter().all(Option::is_some);
            let jumps = (0..factored.n_jumps()).filter(shared);
            jumps.map(|jump| centre(factored, jump, points)).collect()
        };
        Self { points: points.map(centres), analysis: OnceLock::new() }
    }

    /// Factors a matrix with the pattern, of which the entries on and left of the diagonal are given.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor<T: Real>(&self, matrix: SparseMatrix<T>) -> Result<Factors<T>, FactorError> {
        if let Some(analysis) = self.analysis.get() {
            return Factors::definite(&mut Submatrix::from(matrix), analysis);
        }
        let all: Vec<u32> = (0..matrix.size() as u32).collect();
        let order = EliminationOrder::new(&matrix, &all, self.points.as_deref())?.unknowns;
        let mut matrix = Submatrix::from(matrix);
        let analysis = Analysis::new(&matrix, Some(order))?;
        Factors::definite(&mut matrix, self.analysis.get_or_init(|| analysis))
    }
}

/// The mean of the points of the unknowns of a jump.
fn centre<T: Real>(factored: &PenalisedMatrix<T>, jump: usize, points: &[[f32; 3]]) -> [f32; 3] {
    let unknowns = factored.terms_of(jump).iter().flat_map(|term| [term.here, term.there]);
    barycentre(unknowns.filter_map(|unknown| points.get(unknown as usize).copied()))
}
