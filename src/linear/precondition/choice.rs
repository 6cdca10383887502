//! Which preconditioner fits which unknowns: told by where they live and by the matrix.

use std::sync::Arc;

use super::aggregation::galerkin;
use super::auxiliary_space::{AuxiliarySpace, Vertices};
use super::coarse_level::{CoarseLevel, P1Level};
use super::mean_jump_split::FacetSplit;
use super::multigrid::Multigrid;
use super::prolongation::RectangularMatrix;
use crate::algebra::{Bound, Inequality, SparseMatrix, Support};
use crate::linear::CoarseSpaces;
use crate::linear::direct::factors::FactorError;
use crate::linear::krylov::conjugate_gradients::Preconditioner;
use crate::real::Real;

/// A preconditioner for the unknowns that are free.
pub(crate) enum Preconditioners<'a, T: Real> {
    Multigrid(Box<Multigrid<'a, T>>),
    AuxiliarySpace(Box<AuxiliarySpace<'a, T>>),
    FacetSplit(Box<FacetSplit<'a, T>>),
}

impl<'a, T: Real> Preconditioners<'a, T> {
    /// The conforming linear functions: those known, or what a symmetric matrix and supports tell of
    /// them.
    pub fn functions(
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
            CoarseSpaces::CoarseLevel(coarser) if coarser.transfer.n_fine() == matrix.size() => {
                Some(known.clone())
            }
            CoarseSpaces::Same(_) => Some(known.clone()),
            _ if are_vertices(supports) => Some(match CoarseLevel::aggregated(matrix, &fixed) {
                Some(coarser) => CoarseSpaces::CoarseLevel(coarser),
                None => CoarseSpaces::Unknown,
            }),
            _ => {
                let level = conforming(matrix, supports, &fixed)?;
                Some(CoarseSpaces::Same(Arc::new(level)))
            }
        }
    }

    /// What fits the unknowns of a symmetric matrix that live at `supports`; `None` if nothing does.
    /// `may_split` tells whether cells without fluxes between them are tied by a large penalty: in
    /// the symmetric part of a matrix fluxes may have cancelled, and the penalty need not be large.
    pub fn new(
        matrix: &'a SparseMatrix<T>,
        supports: &[Support],
        functions: &'a CoarseSpaces<T>,
        may_split: bool,
    ) -> Option<Self> {
        match functions {
            CoarseSpaces::Unknown => Some(Self::Multigrid(Box::new(Multigrid::new(matrix, None)))),
            CoarseSpaces::CoarseLevel(coarser) => {
                Some(Self::Multigrid(Box::new(Multigrid::new(matrix, Some(coarser)))))
            }
            CoarseSpaces::Same(level) => {
                let vertices = || {
                    let multigrid = Multigrid::new(&level.matrix, level.coarser.as_ref());
                    Vertices::new(multigrid, &level.fixed, supports)
                };
                let split = match may_split {
                    true => FacetSplit::new(matrix, supports, vertices),
                    false => None,
                };
                if let Some(split) = split {
                    return Some(Self::FacetSplit(Box::new(split)));
                }
                let space = AuxiliarySpace::new(matrix, supports, vertices()?)?;
                Some(Self::AuxiliarySpace(Box::new(space)))
            }
        }
    }

    /// Sets which unknowns are fixed.
    ///
    /// # Errors
    /// If something small that has to be inverted is not positive definite.
    pub fn fix(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        match self {
            Self::Multigrid(multigrid) => multigrid.fix(fixed),
            Self::AuxiliarySpace(space) => space.fix(fixed),
            Self::FacetSplit(split) => split.fix(fixed),
        }
    }

    /// The share of its initial error to which it pays to solve a system while the active set
    /// moves. Where facets are hardly tied, small errors in the energy are large ones in single
    /// unknowns, and these are what makes the set move.
    pub fn share(&self) -> f64 {
        match self {
            Self::FacetSplit(_) => 0.01,
            _ => 0.1,
        }
    }

    /// The name in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Multigrid(_) => "multigrid",
            Self::AuxiliarySpace(_) => "auxiliary-space",
            Self::FacetSplit(_) => "facet-split",
        }
    }
}

impl<T: Real> Preconditioner<T> for Preconditioners<'_, T> {
    fn apply(&mut self, r: &[T], z: &mut [T]) {
        match self {
            Self::Multigrid(multigrid) => multigrid.apply(r, z),
            Self::AuxiliarySpace(space) => space.apply(r, z),
            Self::FacetSplit(split) => split.apply(r, z),
        }
    }
}

/// Whether unknown `i` is the value at vertex `i`.
fn are_vertices(supports: &[Support]) -> bool {
    let is_vertex = |(i, support): (usize, &Support)| {
        support.cell().is_none() && support.vertices() == [i as u32]
    };
    supports.iter().enumerate().all(is_vertex)
}

/// The form on conforming linear functions, each written as its values at the unknowns' supports.
fn conforming<T: Real>(
    matrix: &SparseMatrix<T>,
    supports: &[Support],
    fixed: &[bool],
) -> Option<P1Level<T>> {
    let last = supports.iter().flat_map(|p| p.vertices()).max()?;
    let n = *last as usize + 1;
    let mut rows = RectangularMatrix { starts: vec![0], columns: Vec::new(), values: Vec::new() };
    let mut given = vec![false; n];
    for (support, &fixed) in supports.iter().zip(fixed) {
        let around = support.vertices();
        let weight = T::lit(1.0 / around.len().max(1) as f64);
        rows.columns.extend(around);
        rows.values.extend(around.iter().map(|_| weight));
        rows.starts.push(rows.columns.len() as u32);
        if fixed {
            around.iter().for_each(|&v| given[v as usize] = true);
        }
    }
    let form = galerkin(matrix, &rows, n);
    for (v, given) in given.iter_mut().enumerate() {
        *given |= form.get(v, v) <= T::lit(0.0);
    }
    Some(P1Level::new(form, given, None))
}
