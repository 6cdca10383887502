//! Conforming linear functions on nested meshes, as numbers only.

use std::sync::Arc;

use super::aggregation::aggregate;
use super::prolongation::Prolongation;
use crate::algebra::SparseMatrix;
use crate::real::Real;

/// Up to this many unknowns a system is factored, not coarsened.
pub(crate) const FACTORED: usize = 600;

/// Up to this many unknowns a level that will not be coarsened is factored all the same.
pub(crate) const LARGEST_FACTORED: usize = 20_000;

/// The conforming linear functions on a mesh: the form on its vertices, and coarser functions.
#[derive(Debug)]
pub struct P1Level<T> {
    pub(crate) matrix: SparseMatrix<T>,
    pub(crate) fixed: Vec<bool>,
    pub(crate) coarser: Option<CoarseLevel<T>>,
}

impl<T: Real> P1Level<T> {
    /// A level with the form on all vertices, those of Dirichlet data included, and which of them
    /// these are. A level without a coarser one makes its own by aggregation where that pays.
    pub fn new(matrix: SparseMatrix<T>, fixed: Vec<bool>, coarser: Option<CoarseLevel<T>>) -> Self {
        let coarser = coarser.or_else(|| CoarseLevel::aggregated(&matrix, &fixed));
        Self { matrix, fixed, coarser }
    }

    /// Number of vertices.
    pub fn size(&self) -> usize {
        self.fixed.len()
    }
}

/// A coarser level, and how its functions are written in the finer basis.
#[derive(Clone, Debug)]
pub struct CoarseLevel<T> {
    pub(crate) level: Arc<P1Level<T>>,
    pub(crate) transfer: Arc<Prolongation<T>>,
}

impl<T: Real> CoarseLevel<T> {
    /// A coarser level; `None` if the transfer is to a level of another size.
    pub fn new(level: Arc<P1Level<T>>, transfer: Arc<Prolongation<T>>) -> Option<Self> {
        (level.size() == transfer.n_coarse()).then_some(Self { level, transfer })
    }

    /// A coarser level from the matrix alone; `None` if the matrix is small enough to be factored
    /// or will not be coarsened.
    pub(crate) fn aggregated(matrix: &SparseMatrix<T>, fixed: &[bool]) -> Option<Self> {
        if matrix.size() <= FACTORED {
            return None;
        }
        let (transfer, coarse) = aggregate(matrix, fixed)?;
        let size = coarse.size();
        let level = P1Level::new(coarse, vec![false; size], None);
        Some(Self { level: Arc::new(level), transfer: Arc::new(transfer) })
    }
}
