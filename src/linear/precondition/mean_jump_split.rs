//! A preconditioner for broken linear functions that only a penalty on facet means ties together.
//!
//! Such a form all but decouples in means and jumps of the facet means: jumps feel the penalty and
//! nothing else, means are Crouzeix-Raviart functions, for which conforming linear functions are an
//! auxiliary space. Source of the splitting: B. Ayuso de Dios, L. Zikatanov, J. Sci. Comput. 40
//! (2009), 4-36.

use super::aggregation::galerkin;
use super::auxiliary_space::{Vertices, cell_size};
use super::facet_pairs::{NONE, Pairs, bump};
use super::prolongation::RectangularMatrix;
use crate::algebra::{SparseMatrix, Support};
use crate::linear::direct::factors::{FactorError, Factors};
use crate::linear::krylov::conjugate_gradients::Preconditioner;
use crate::parallel::vectors::each_mut_of;
use crate::real::Real;

/// Diagonal on means and jumps of facet means, exact on the strip of cells where some vertex values
/// are fixed and some are not, and a multigrid cycle on conforming linear functions.
///
/// A cell without fixed unknowns is described by its facet means. Where the cell across is one too,
/// mean and jump of the two are corrected each by itself; where all of it is fixed, or a Dirichlet
/// facet lies, the mean is one-sided and penalised. Cells with both fixed and free vertex values
/// keep these, and are solved for together with the one-sided means next to them.
pub(crate) struct FacetSplit<'a, T: Real> {
    matrix: &'a SparseMatrix<T>,
    pairs: Pairs<T>,
    vertices: Vertices<'a, T>,
    sides: Vec<Side<T>>,
    strip: Strip<T>,
    forces: Vec<T>,
    means: Vec<T>,
}

/// How the mean over one side of a facet is corrected.
#[derive(Clone, Copy)]
struct Side<T> {
    /// The side across, if its mean is corrected together with this one.
    across: u32,
    /// Weight of the sum of the forces on the two.
    sum: T,
    /// Weight of their difference, of the only one if there is but one.
    difference: T,
}

/// What is solved for exactly.
struct Strip<T> {
    /// Vertex values.
    values: Vec<u32>,
    /// Facet means.
    sides: Vec<u32>,
    factors: Option<Factors<T>>,
    vector: Vec<T>,
}

impl<'a, T: Real> FacetSplit<'a, T> {
    /// For a matrix on broken linear functions; `None` if cells are tied together by anything else.
    pub fn new(
        matrix: &'a SparseMatrix<T>,
        supports: &[Support],
        vertices: impl FnOnce() -> Option<Vertices<'a, T>>,
    ) -> Option<Self> {
        let pairs = Pairs::find(matrix, supports, cell_size(supports)?)?;
        let zero = T::lit(0.0);
        let n = matrix.size();
        Some(Self {
            matrix,
            pairs,
            vertices: vertices()?,
            sides: vec![Side { across: NONE, sum: zero, difference: zero }; n],
            strip: Strip { values: vec![], sides: vec![], factors: None, vector: vec![] },
            forces: vec![zero; n],
            means: vec![zero; n],
        })
    }

    /// Sets which unknowns are fixed.
    ///
    /// # Errors
    /// If something that has to be inverted is not positive definite.
    pub fn fix(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let pairs = &self.pairs;
        let size = pairs.size;
        let zero = T::lit(0.0);
        self.strip.values.clear();
        self.strip.sides.clear();
        let whole = |cell: usize| !fixed[cell * size..(cell + 1) * size].contains(&true);
        let gone = |cell: usize| !fixed[cell * size..(cell + 1) * size].contains(&false);
        let has_mean = |s: usize| if pairs.are_means { !fixed[s] } else { whole(s / size) };
        for s in 0..fixed.len() {
            self.sides[s] = Side { across: NONE, sum: zero, difference: zero };
            if !has_mean(s) {
                if !fixed[s] {
                    self.strip.values.push(s as u32);
                }
                continue;
            }
            let own = pairs.own[s];
            let across = pairs.across[s];
            if across != NONE && has_mean(across as usize) {
                let (other, coupling) = (pairs.own[across as usize], pairs.coupling[s]);
                let both = own + other;
                let twice = coupling + coupling;
                self.sides[s] =
                    Side { across, sum: invert(both + twice)?, difference: invert(both - twice)? };
            } else if across != NONE && !pairs.are_means && !gone(across as usize / size) {
                self.strip.sides.push(s as u32);
            } else {
                self.sides[s].difference = invert(own)?;
            }
        }
        self.strip.factor(self.matrix, pairs)?;
        self.vertices.fix(fixed)
    }
}

fn invert<T: Real>(x: T) -> Result<T, FactorError> {
    if x > T::lit(0.0) { Ok(T::lit(1.0) / x) } else { Err(FactorError::NotPositive) }
}

impl<T: Real> Strip<T> {
    /// Factors the matrix in the basis of these values and means.
    fn factor(&mut self, matrix: &SparseMatrix<T>, pairs: &Pairs<T>) -> Result<(), FactorError> {
        let n_strip = self.values.len() + self.sides.len();
        self.factors = None;
        if n_strip == 0 {
            return Ok(());
        }
        let size = pairs.size;
        let mut entries: Vec<(u32, u32, T)> = Vec::new();
        for (k, &i) in self.values.iter().enumerate() {
            entries.push((i, k as u32, T::lit(1.0)));
        }
        for (k, &s) in (self.values.len()..).zip(&self.sides) {
            let (cell, facet) = (s as usize / size, s as usize % size);
            let one = |i: usize| ((cell * size + i) as u32, k as u32, bump(size, i, facet));
            entries.extend((0..size).map(one));
        }
        entries.sort_unstable_by_key(|&(i, k, _)| (i, k));
        let mut rows =
            RectangularMatrix { starts: vec![0], columns: Vec::new(), values: Vec::new() };
        let mut rest = entries.iter().peekable();
        for i in 0..matrix.size() as u32 {
            while let Some(&(_, k, value)) = rest.next_if(|entry| entry.0 == i) {
                rows.columns.push(k);
                rows.values.push(value);
            }
            rows.starts.push(rows.columns.len() as u32);
        }
        let form = galerkin(matrix, &rows, n_strip);
        let all: Vec<u32> = (0..n_strip as u32).collect();
        self.factors = Some(Factors::new(&form, true, &all)?);
        Ok(())
    }

    /// Solves for the forces `r` on values and `g` on means.
    fn solve(&mut self, r: &[T], g: &[T], means: &mut [T], z: &mut [T]) {
        let Some(factors) = &self.factors else { return };
        self.vector.clear();
        self.vector.extend(self.values.iter().map(|&i| r[i as usize]));
        self.vector.extend(self.sides.iter().map(|&s| g[s as usize]));
        factors.solve_in_place(&mut self.vector, 1);
        let (values, side_means) = self.vector.split_at(self.values.len());
        for (&i, &value) in self.values.iter().zip(values) {
            z[i as usize] = value;
        }
        for (&s, &mean) in self.sides.iter().zip(side_means) {
            means[s as usize] = mean;
        }
    }
}

impl<T: Real> Preconditioner<T> for FacetSplit<'_, T> {
    fn apply(&mut self, r: &[T], z: &mut [T]) {
        let (size, are_means, sides) = (self.pairs.size, self.pairs.are_means, &self.sides);
        let zero = T::lit(0.0);
        let d = T::lit((size - 1) as f64);
        if !are_means {
            // the force on a mean is that on the function which has it and no other
            each_mut_of(&mut self.forces, size, |range, piece| {
                for (g, r) in piece.chunks_exact_mut(size).zip(r[range].chunks_exact(size)) {
                    let sum = r.iter().fold(zero, |s, &r| s + r);
                    g.iter_mut().zip(r).for_each(|(g, &r)| *g = sum - d * r);
                }
            });
        }
        let g = if are_means { r } else { &self.forces[..] };
        each_mut_of(&mut self.means, size, |range, piece| {
            for (s, mean) in range.zip(piece) {
                let side = &sides[s];
                *mean = match side.across {
                    NONE => side.difference * g[s],
                    across => {
                        let other = g[across as usize];
                        side.sum * (g[s] + other) + side.difference * (g[s] - other)
                    }
                };
            }
        });
        if are_means {
            z.copy_from_slice(&self.means);
        } else {
            z.fill(zero);
            self.strip.solve(r, g, &mut self.means, z);
            let means = &self.means;
            each_mut_of(z, size, |range, piece| {
                for (z, m) in piece.chunks_exact_mut(size).zip(means[range].chunks_exact(size)) {
                    let sum = m.iter().fold(zero, |s, &m| s + m);
                    z.iter_mut().zip(m).for_each(|(z, &m)| *z += sum - d * m);
                }
            });
        }
        self.vertices.add(r, z);
    }
}
