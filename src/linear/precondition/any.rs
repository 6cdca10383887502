//! The preconditioner that fits an inequality.

use std::sync::Arc;

use super::auxiliary_space::{AuxiliarySpace, VertexCorrection};
use super::coarse_level::{CoarseLevel, P1Level};
use super::coarse_spaces::CoarseSpaces;
use super::mean_jump_splitting::MeanJumpSplitting;
use super::multigrid::Multigrid;
use super::preconditioner::Preconditioner;
use crate::algebra::{
    Bound, Inequality, RectangularMatrix, SparseMatrix, Support, galerkin_product,
};
use crate::linear::direct::FactorError;
use crate::real::Real;

/// One of the preconditioners, chosen by the supports of the unknowns, the matrix and the known spaces.
pub(crate) enum AnyPreconditioner<'a, T: Real> {
    Multigrid(Box<Multigrid<'a, T>>),
    AuxiliarySpace(Box<AuxiliarySpace<'a, T>>),
    MeanJumpSplitting(Box<MeanJumpSplitting<'a, T>>),
}

impl<'a, T: Real> AnyPreconditioner<'a, T> {
    /// The spaces of conforming linear functions for a symmetric matrix: the spaces `known` if they
    /// fit, else constructed from the matrix and the supports of the inequality; `None` if the
    /// inequality does not have a support for each unknown.
    pub fn coarse_spaces(
        matrix: &SparseMatrix<T>,
        inequality: &Inequality<T>,
        known: &CoarseSpaces<T>,
    ) -> Option<CoarseSpaces<T>> {
        let Inequality { bounds, supports, .. } = inequality;
        if supports.len() != inequality.size() || supports.is_empty() {
            return None;
        }
        let fixed: Vec<bool> = bounds.iter().map(|b| matches!(b, Bound::Fixed(_))).collect();
        match known {
            CoarseSpaces::CoarseLevel(coarser)
                if coarser.prolongation.n_fine() == matrix.size() =>
            {
                Some(known.clone())
            }
            CoarseSpaces::SameMesh(_) => Some(known.clone()),
            _ if are_vertex_values(supports) => {
                Some(match CoarseLevel::aggregated(matrix, &fixed) {
                    Some(coarser) => CoarseSpaces::CoarseLevel(coarser),
                    None => CoarseSpaces::Unknown,
                })
            }
            _ => {
                let level = p1_level(matrix, supports, &fixed)?;
                Some(CoarseSpaces::SameMesh(Arc::new(level)))
            }
        }
    }

    /// The preconditioner of a symmetric matrix; `None` if none fits. [`MeanJumpSplitting`] is
    /// considered only if `allow_splitting`: in the symmetric part of a matrix fluxes can cancel, so
    /// that only a penalty couples the cells, which need not be large.
    pub fn new(
        matrix: &'a SparseMatrix<T>,
        supports: &[Support],
        spaces: &'a CoarseSpaces<T>,
        allow_splitting: bool,
    ) -> Option<Self> {
        match spaces {
            CoarseSpaces::Unknown => Some(Self::Multigrid(Box::new(Multigrid::new(matrix, None)))),
            CoarseSpaces::CoarseLevel(coarser) => {
                Some(Self::Multigrid(Box::new(Multigrid::new(matrix, Some(coarser)))))
            }
            CoarseSpaces::SameMesh(level) => {
                let correction = || {
                    let multigrid = Multigrid::new(&level.matrix, level.coarser.as_ref());
                    VertexCorrection::new(multigrid, &level.fixed, supports)
                };
                let splitting = match allow_splitting {
                    true => MeanJumpSplitting::new(matrix, supports, correction),
                    false => None,
                };
                if let Some(splitting) = splitting {
                    return Some(Self::MeanJumpSplitting(Box::new(splitting)));
                }
                let space = AuxiliarySpace::new(matrix, supports, correction()?)?;
                Some(Self::AuxiliarySpace(Box::new(space)))
            }
        }
    }

    /// Sets the fixed unknowns; must be called before the first use.
    ///
    /// # Errors
    /// [`FactorError`] if a diagonal block or a coarse matrix is not positive definite.
    pub fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        match self {
            Self::Multigrid(multigrid) => multigrid.set_fixed(fixed),
            Self::AuxiliarySpace(space) => space.set_fixed(fixed),
            Self::MeanJumpSplitting(splitting) => splitting.set_fixed(fixed),
        }
    }

    /// The factor by which the norm of the residual is reduced by the solution of a system while
    /// the active set changes. The factor is smaller for over-penalised elements: an error that is
    /// small in the energy norm can be large in single unknowns, and change their contact states.
    pub fn inexact_reduction(&self) -> f64 {
        match self {
            Self::MeanJumpSplitting(_) => 0.01,
            _ => 0.1,
        }
    }

    /// The name in reports and in [`Solution`](crate::inequality::Solution).
    pub fn name(&self) -> &'static str {
        match self {
            Self::Multigrid(_) => "multigrid",
            Self::AuxiliarySpace(_) => "auxiliary-space",
            Self::MeanJumpSplitting(_) => "facet-split",
        }
    }
}

impl<T: Real> Preconditioner<T> for AnyPreconditioner<'_, T> {
    fn apply(&mut self, r: &[T], z: &mut [T]) {
        match self {
            Self::Multigrid(multigrid) => multigrid.apply(r, z),
            Self::AuxiliarySpace(space) => space.apply(r, z),
            Self::MeanJumpSplitting(splitting) => splitting.apply(r, z),
        }
    }
}

/// Whether unknown `i` is the value at vertex `i`, for all `i`.
fn are_vertex_values(supports: &[Support]) -> bool {
    let is_vertex = |(i, support): (usize, &Support)| {
        support.cell().is_none() && support.vertices() == [i as u32]
    };
    supports.iter().enumerate().all(is_vertex)
}

/// The conforming linear functions on the mesh of another finite element, with the Galerkin matrix
/// `P^T A P`, where an unknown of the element is the mean of the values at the vertices of its
/// support. Vertices in the supports of fixed unknowns are fixed, and vertices whose diagonal entry
/// is not positive. `None` without supports.
fn p1_level<T: Real>(
    matrix: &SparseMatrix<T>,
    supports: &[Support],
    fixed: &[bool],
) -> Option<P1Level<T>> {
    let last = supports.iter().flat_map(|p| p.vertices()).max()?;
    let n = *last as usize + 1;
    let mut rows = RectangularMatrix { starts: vec![0], columns: Vec::new(), values: Vec::new() };
    let mut fixed_vertices = vec![false; n];
    for (support, &fixed) in supports.iter().zip(fixed) {
        let vertices = support.vertices();
        let weight = T::lit(1.0 / vertices.len().max(1) as f64);
        rows.columns.extend(vertices);
        rows.values.extend(vertices.iter().map(|_| weight));
        rows.starts.push(rows.columns.len() as u32);
        if fixed {
            vertices.iter().for_each(|&v| fixed_vertices[v as usize] = true);
        }
    }
    let form = galerkin_product(matrix, &rows, n);
    for (v, fixed) in fixed_vertices.iter_mut().enumerate() {
        *fixed |= form.get(v, v) <= T::lit(0.0);
    }
    Some(P1Level::new(form, fixed_vertices, None))
}
