//! From coarse to fine functions and back.

use crate::algebra::transpose;
use crate::memory::in_large_pages;
use crate::parallel::vectors::{each_mut, zeros};
use crate::real::Real;

/// A rectangular sparse matrix by rows.
#[derive(Clone, Debug)]
pub(crate) struct RectangularMatrix<T> {
    pub starts: Vec<u32>,
    pub columns: Vec<u32>,
    pub values: Vec<T>,
}

impl<T: Real> RectangularMatrix<T> {
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    #[inline(always)]
    pub fn row(&self, i: usize) -> (&[u32], &[T]) {
        let range = self.starts[i] as usize..self.starts[i + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }

    #[inline(always)]
    fn dot<S: Real>(&self, i: usize, x: &[S]) -> S {
        let (columns, values) = self.row(i);
        let product = |s, (&j, a): (&u32, &T)| s + S::lit(a.to_f64()) * x[j as usize];
        columns.iter().zip(values).fold(S::lit(0.0), product)
    }

    /// The transpose, which has `n_columns` rows.
    pub fn transpose(&self, n_columns: usize) -> Self {
        let rows = (&self.starts[..], &self.columns[..], &self.values[..]);
        let (starts, columns, values) = transpose(rows, n_columns);
        Self { starts, columns, values }
    }
}

/// How coarse functions are written in the fine basis.
#[derive(Clone, Debug)]
pub struct Prolongation<T> {
    kind: Kind<T>,
    n_coarse: usize,
}

#[derive(Clone, Debug)]
enum Kind<T> {
    /// Every fine unknown is the mean of its two parents; the children of a coarse one are itself
    /// and the midpoints it is a parent of.
    Midpoints { parents: Vec<[u32; 2]>, starts: Vec<u32>, children: Vec<u32>, own: Vec<u32> },
    /// Any weights, by fine unknowns and by coarse ones.
    Weights { fine: RectangularMatrix<T>, coarse: RectangularMatrix<T> },
}

impl<T: Real> Prolongation<T> {
    /// Piecewise linear functions on a uniform refinement: each fine vertex is the midpoint of two
    /// coarse ones, of twice the same if it was there before.
    pub fn midpoints(parents: Vec<[u32; 2]>, n_coarse: usize) -> Self {
        let mut starts = vec![0_u32; n_coarse + 1];
        let mut own = vec![0_u32; n_coarse];
        for (i, &[a, b]) in parents.iter().enumerate() {
            if a == b {
                own[a as usize] = i as u32;
            } else {
                starts[a as usize + 1] += 1;
                starts[b as usize + 1] += 1;
            }
        }
        for j in 0..n_coarse {
            starts[j + 1] += starts[j];
        }
        let mut next = starts.clone();
        let mut children = in_large_pages(vec![0_u32; starts[n_coarse] as usize]);
        for (i, &[a, b]) in parents.iter().enumerate().filter(|(_, [a, b])| a != b) {
            for parent in [a, b] {
                let at = &mut next[parent as usize];
                children[*at as usize] = i as u32;
                *at += 1;
            }
        }
        Self { kind: Kind::Midpoints { parents, starts, children, own }, n_coarse }
    }

    /// Any weights, by fine unknowns.
    pub(crate) fn weights(fine: RectangularMatrix<T>, n_coarse: usize) -> Self {
        let coarse = fine.transpose(n_coarse);
        Self { kind: Kind::Weights { fine, coarse }, n_coarse }
    }

    /// Number of coarse unknowns.
    pub fn n_coarse(&self) -> usize {
        self.n_coarse
    }

    /// Number of fine unknowns.
    pub fn n_fine(&self) -> usize {
        match &self.kind {
            Kind::Midpoints { parents, .. } => parents.len(),
            Kind::Weights { fine, .. } => fine.len(),
        }
    }

    /// Fine forces to coarse ones, in any precision.
    pub(crate) fn restrict<S: Real>(&self, fine_force: &[S], coarse_force: &mut [S]) {
        let half = S::lit(0.5);
        each_mut(coarse_force, |range, piece| match &self.kind {
            Kind::Midpoints { starts, children, own, .. } => {
                for (j, out) in range.zip(piece) {
                    let list = &children[starts[j] as usize..starts[j + 1] as usize];
                    let sum = list.iter().fold(S::lit(0.0), |s, &i| s + fine_force[i as usize]);
                    *out = fine_force[own[j] as usize] + half * sum;
                }
            }
            Kind::Weights { coarse, .. } => {
                for (j, out) in range.zip(piece) {
                    *out = coarse.dot(j, fine_force);
                }
            }
        });
    }

    /// Adds a coarse function to the fine unknowns that are free: those whose `mask` is not zero.
    pub(crate) fn prolongate<S: Real>(
        &self,
        coarse_values: &[S],
        mask: &[S],
        fine_values: &mut [S],
    ) {
        let (zero, half) = (S::lit(0.0), S::lit(0.5));
        each_mut(fine_values, |range, piece| match &self.kind {
            Kind::Midpoints { parents, .. } => {
                let lists = parents[range.clone()].iter().zip(&mask[range]);
                for ((&[a, b], &mask), x) in lists.zip(piece) {
                    if mask != zero {
                        *x += half * (coarse_values[a as usize] + coarse_values[b as usize]);
                    }
                }
            }
            Kind::Weights { fine, .. } => {
                for (i, x) in range.zip(piece) {
                    if mask[i] != zero {
                        *x += fine.dot(i, coarse_values);
                    }
                }
            }
        });
    }

    /// A coarse function at the fine unknowns.
    pub fn values(&self, coarse_values: &[T]) -> Vec<T> {
        let mut fine = zeros(self.n_fine());
        let mask = vec![T::lit(1.0); self.n_fine()];
        self.prolongate(coarse_values, &mask, &mut fine);
        fine
    }

    /// Fixes every coarse unknown whose function is nothing but fixed fine ones.
    pub(crate) fn fix_covered(&self, fine_fixed: &[bool], coarse_fixed: &mut [bool]) {
        each_mut(coarse_fixed, |range, piece| {
            for (j, fixed) in range.zip(piece).filter(|(_, fixed)| !**fixed) {
                *fixed = !self.any_child(j, |i| !fine_fixed[i]);
            }
        });
    }

    /// Whether something holds for any fine unknown that a coarse function does not vanish on.
    pub(crate) fn any_child(&self, j: usize, holds: impl Fn(usize) -> bool) -> bool {
        let mut any = false;
        self.children(j, |i, _| any |= holds(i));
        any
    }

    /// Calls a function with each fine unknown of a coarse one, and its weight.
    #[inline(always)]
    pub(crate) fn children(&self, j: usize, mut call: impl FnMut(usize, T)) {
        match &self.kind {
            Kind::Midpoints { starts, children, own, .. } => {
                call(own[j] as usize, T::lit(1.0));
                for &i in &children[starts[j] as usize..starts[j + 1] as usize] {
                    call(i as usize, T::lit(0.5));
                }
            }
            Kind::Weights { coarse, .. } => {
                let (columns, weights) = coarse.row(j);
                columns.iter().zip(weights).for_each(|(&i, &w)| call(i as usize, w));
            }
        }
    }

    /// Calls a function with each coarse unknown of a fine one, and its weight.
    #[inline(always)]
    pub(crate) fn parents(&self, i: usize, mut call: impl FnMut(u32, T)) {
        match &self.kind {
            Kind::Midpoints { parents, .. } => {
                for parent in parents[i] {
                    call(parent, T::lit(0.5));
                }
            }
            Kind::Weights { fine, .. } => {
                let (columns, weights) = fine.row(i);
                columns.iter().zip(weights).for_each(|(&j, &w)| call(j, w));
            }
        }
    }
}
