//! Levels of a multigrid hierarchy of conforming linear functions: matrices and prolongations.

use std::sync::Arc;

use super::aggregation::aggregate;
use super::prolongation::Prolongation;
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// Largest number of unknowns of a level that is factored instead of being coarsened by aggregation.
const MAX_FACTORED: usize = 600;

/// Largest number of free unknowns of a coarsest level that is factored instead of smoothed.
pub(crate) const MAX_COARSEST_FACTORED: usize = 20_000;

/// The conforming linear functions on a mesh: the matrix of the form on all vertices, the vertices with Dirichlet data,
/// and the next coarser level.
#[derive(Debug)]
pub struct P1Level<T> {
    pub(crate) matrix: SparseMatrix<T>,
    pub(crate) fixed: Vec<bool>,
    pub(crate) coarser: Option<CoarseLevel<T>>,
}

impl<T: Real> P1Level<T> {
    /// The level with the symmetric `matrix` on all vertices, of which `fixed` are those with Dirichlet
    /// data. Without a coarser level, one is constructed by aggregation if the matrix is large and can
    /// be coarsened. `None` if the matrix violates an invariant of its type, or if `fixed` or the prolongation from
    /// the coarser level has another number of vertices.
    #[must_use]
    pub fn new(
        matrix: SparseMatrix<T>,
        fixed: Vec<bool>,
        coarser: Option<CoarseLevel<T>>,
    ) -> Option<Self> {
        let n = fixed.len();
        let fits = coarser.as_ref().is_none_or(|coarser| coarser.prolongation.n_fine() == n);
        if !fits || matrix.size() != n || !matrix.is_well_formed() {
            return None;
        }
        let coarser = coarser.or_else(|| CoarseLevel::aggregated(&matrix, &fixed));
        Some(Self { matrix, fixed, coarser })
    }

    /// Number of vertices.
    pub fn size(&self) -> usize {
        self.fixed.len()
    }

    /// The matrix on all vertices.
    pub fn matrix(&self) -> &SparseMatrix<T> {
        &self.matrix
    }

    /// The vertices with Dirichlet data.
    pub fn fixed(&self) -> &[bool] {
        &self.fixed
    }

    /// The next coarser level, if any.
    pub fn coarser(&self) -> Option<&CoarseLevel<T>> {
        self.coarser.as_ref()
    }
}

/// The next coarser level, with the prolongation from it.
#[derive(Clone, Debug)]
pub struct CoarseLevel<T> {
    pub(crate) level: Arc<P1Level<T>>,
    pub(crate) prolongation: Arc<Prolongation>,
}

impl<T: Real> CoarseLevel<T> {
    /// A coarser level with its prolongation; `None` if the prolongation has another number of coarse
    /// unknowns than the level has vertices.
    #[must_use]
    pub fn new(level: Arc<P1Level<T>>, prolongation: Arc<Prolongation>) -> Option<Self> {
        (level.size() == prolongation.n_coarse()).then_some(Self { level, prolongation })
    }

    /// The coarser level.
    pub fn level(&self) -> &P1Level<T> {
        &self.level
    }

    /// The prolongation from the coarser level.
    pub fn prolongation(&self) -> &Prolongation {
        &self.prolongation
    }

    /// The coarser level by smoothed aggregation; `None` if the matrix is small enough to be factored,
    /// or if aggregation does not halve the number of unknowns.
    pub(crate) fn aggregated(matrix: &SparseMatrix<T>, fixed: &[bool]) -> Option<Self> {
        if matrix.size() <= MAX_FACTORED {
            return None;
        }
        let (prolongation, coarse) = aggregate(matrix, fixed)?;
        let size = coarse.size();
        let level = P1Level::new(coarse, vec![false; size], None)?;
        Some(Self { level: Arc::new(level), prolongation: Arc::new(prolongation) })
    }
}
