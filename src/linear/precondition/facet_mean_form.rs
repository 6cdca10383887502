//! The form of an over-penalised discontinuous linear element on its facet mean functions.

use crate::algebra::{JumpTerm, NO_INDEX, PenalisedMatrix, Support};
use crate::real::Real;

/// The entries of `K + M^T S M` between the facet mean functions of the two sides of a facet.
///
/// The facet mean function of a side is the linear function on its cell with mean one on the facet
/// and mean zero on the other facets of the cell: the Crouzeix-Raviart basis. Sides have the indices of
/// unknowns: side `i` of a cell belongs to facet `i` of the cell, which is opposite to vertex `i`.
pub(crate) struct FacetMeanForm<T> {
    /// Number of unknowns of a cell.
    pub cell_size: usize,
    /// Whether the unknowns are the means over sides; else they are vertex values.
    pub are_means: bool,
    /// The other side of the same facet, [`NO_INDEX`] if there is none with a jump.
    pub opposite: Vec<u32>,
    /// Whether a side has a jump: over the facet, or from Dirichlet data.
    pub has_jump: Vec<bool>,
    /// The form of the function of a side with itself.
    pub diagonal: Vec<T>,
    /// The form of the function of a side with the function of the opposite side; zero if there is
    /// none.
    pub coupling: Vec<T>,
}

/// The facet mean function of a facet at a vertex, in a cell of `cell_size` vertices.
#[inline(always)]
pub(crate) fn cr_basis<T: Real>(cell_size: usize, vertex: usize, facet: usize) -> T {
    T::lit(if vertex == facet { 2.0 - cell_size as f64 } else { 1.0 })
}

impl<T: Real> FacetMeanForm<T> {
    /// The entries of a penalised matrix; `None` if its unknowns are not those of discontinuous linear
    /// functions in two or three dimensions, or a facet has jumps besides that of its mean.
    pub fn new(penalised: &PenalisedMatrix<T>, supports: &[Support]) -> Option<Self> {
        let (n, cell_size) = (penalised.load.len(), penalised.block_size);
        if !(3..=4).contains(&cell_size) || supports.len() != n {
            return None;
        }
        let are_means = supports[0].vertices().len() == cell_size - 1;
        let length = if are_means { cell_size - 1 } else { 1 };
        if supports.iter().any(|p| p.cell().is_none() || p.vertices().len() != length) {
            return None;
        }
        let zero = T::lit(0.0);
        let mut form = Self {
            cell_size,
            are_means,
            opposite: vec![NO_INDEX; n],
            diagonal: (0..n).map(|side| stiffness(penalised, [side, side], are_means)).collect(),
            coupling: vec![zero; n],
            has_jump: vec![false; n],
        };
        for jump in 0..penalised.n_jumps() {
            let terms = penalised.terms_of(jump);
            let here = form.side(terms, |t| t.here)?;
            let there = form.side(terms, |t| t.there);
            let weight = penalised.weights[jump];
            let mean = terms.iter().fold(zero, |sum, t| sum + t.weight);
            let product = weight * mean * mean;
            for side in [Some(here), there].into_iter().flatten() {
                // a second jump is a moment of higher degree
                if std::mem::replace(&mut form.has_jump[side], true) {
                    return None;
                }
                form.diagonal[side] += product;
            }
            if let Some(there) = there {
                (form.opposite[here], form.opposite[there]) = (there as u32, here as u32);
                (form.coupling[here], form.coupling[there]) = (-product, -product);
            }
        }
        Some(form)
    }

    /// The side whose mean is the part of a jump with the unknowns `unknown` of its terms; `None` if the
    /// part is not the mean over a side.
    fn side(&self, terms: &[JumpTerm<T>], unknown: impl Fn(&JumpTerm<T>) -> u32) -> Option<usize> {
        let size = self.cell_size;
        if terms.iter().any(|t| unknown(t) == JumpTerm::<T>::NO_UNKNOWN) {
            return None;
        }
        let mut unknowns = terms.iter().map(|t| unknown(t) as usize);
        if self.are_means {
            return unknowns.next().filter(|_| terms.len() == 1);
        }
        if terms.len() != size - 1 {
            return None;
        }
        // The facet is opposite to the vertex without a term.
        let cell = unknowns.next()? / size;
        let has_term = |i: usize| terms.iter().any(|t| unknown(t) as usize == cell * size + i);
        (0..size).find(|&i| !has_term(i)).map(|facet| cell * size + facet)
    }
}

/// The stiffness form of the facet mean functions of two sides of a cell.
pub(super) fn stiffness<T: Real>(
    penalised: &PenalisedMatrix<T>,
    [one, other]: [usize; 2],
    are_means: bool,
) -> T {
    let size = penalised.block_size;
    let first = one / size * size;
    let entry = |i: usize, j: usize| penalised.blocks[(first + i) * size + j];
    let (one, other) = (one - first, other - first);
    if are_means {
        return entry(one, other);
    }
    let mut sum = T::lit(0.0);
    for i in 0..size {
        for j in 0..size {
            let weight: T = cr_basis::<T>(size, i, one) * cr_basis::<T>(size, j, other);
            sum += weight * entry(i, j);
        }
    }
    sum
}
