//! Which means over the two sides of a facet belong together, and what a matrix says of them.

use crate::algebra::{SparseMatrix, Support};
use crate::real::Real;

/// No side across.
pub(crate) const NONE: u32 = u32::MAX;

/// Entries up to this many units of rounding of the largest in a block count as zero.
const ROUNDING: f64 = 64.0;

/// The sides of all facets, numbered like the unknowns: side `i` of a cell is that of its facet
/// `i`, opposite its vertex `i`.
pub(crate) struct Pairs<T> {
    /// Unknowns of a cell.
    pub size: usize,
    /// Whether unknowns are the means over the sides; else they are vertex values.
    pub are_means: bool,
    /// The other side of the facet.
    pub across: Vec<u32>,
    /// The form of the function whose means are one over this side and zero over the cell's others.
    pub own: Vec<T>,
    /// The form of the two such functions of a facet.
    pub coupling: Vec<T>,
}

/// The function of a cell with mean one over a facet and zero over the others, at a vertex.
#[inline(always)]
pub(crate) fn bump<T: Real>(size: usize, vertex: usize, facet: usize) -> T {
    T::lit(if vertex == facet { 2.0 - size as f64 } else { 1.0 })
}

impl<T: Real> Pairs<T> {
    /// `None` if unknowns are not those of broken linear functions in two or three dimensions, or
    /// if the matrix couples cells by anything but the means over their common facet.
    pub fn find(matrix: &SparseMatrix<T>, supports: &[Support], size: usize) -> Option<Self> {
        let n = matrix.size();
        if !(3..=4).contains(&size) || supports.len() != n {
            return None;
        }
        let are_means = supports[0].vertices().len() == size - 1;
        let length = if are_means { size - 1 } else { 1 };
        if supports.iter().any(|p| p.cell().is_none() || p.vertices().len() != length) {
            return None;
        }
        let zero = T::lit(0.0);
        let mut pairs = Self {
            size,
            are_means,
            across: vec![NONE; n],
            own: vec![zero; n],
            coupling: vec![zero; n],
        };
        for cell in 0..n / size {
            pairs.read_cell(matrix, supports, cell)?;
        }
        Some(pairs)
    }

    /// Reads the blocks of a cell.
    fn read_cell(
        &mut self,
        matrix: &SparseMatrix<T>,
        supports: &[Support],
        cell: usize,
    ) -> Option<()> {
        let size = self.size;
        let columns = matrix.row(cell * size).0;
        // blocks are dense: each row of a cell has the same columns, whole cells of them
        if !columns.len().is_multiple_of(size)
            || (1..size).any(|i| matrix.row(cell * size + i).0 != columns)
        {
            return None;
        }
        for (k, block) in columns.chunks_exact(size).enumerate() {
            let other = block[0] as usize / size;
            if block[0] as usize != other * size
                || block[size - 1] as usize != other * size + size - 1
            {
                return None;
            }
            let entry = |i: usize, j: usize| matrix.row(cell * size + i).1[k * size + j];
            if other == cell {
                for facet in 0..size {
                    self.own[cell * size + facet] = self.form(&entry, facet, facet);
                }
                continue;
            }
            let largest = (0..size * size)
                .map(|e| entry(e / size, e % size).to_f64().abs())
                .fold(0.0, f64::max);
            if largest == 0.0 {
                continue;
            }
            let (here, there) = self.common_facet(supports, cell, other)?;
            let noise = ROUNDING * T::EPSILON * largest;
            let is_in_form = |i: usize, j: usize| match self.are_means {
                true => i == here && j == there,
                false => i != here && j != there,
            };
            let stray = |e: usize| {
                let (i, j) = (e / size, e % size);
                !is_in_form(i, j) && entry(i, j).to_f64().abs() > noise
            };
            if (0..size * size).any(stray) {
                return None;
            }
            self.across[cell * size + here] = (other * size + there) as u32;
            self.coupling[cell * size + here] = self.form(&entry, here, there);
        }
        Some(())
    }

    /// The form of two facet functions, from a block of the matrix.
    fn form(&self, entry: &dyn Fn(usize, usize) -> T, here: usize, there: usize) -> T {
        if self.are_means {
            return entry(here, there);
        }
        let mut sum = T::lit(0.0);
        for i in 0..self.size {
            for j in 0..self.size {
                let weight: T = bump::<T>(self.size, i, here) * bump::<T>(self.size, j, there);
                sum += weight * entry(i, j);
            }
        }
        sum
    }

    /// The local numbers of the facet that two cells share.
    fn common_facet(
        &self,
        supports: &[Support],
        cell: usize,
        other: usize,
    ) -> Option<(usize, usize)> {
        let size = self.size;
        let of = |cell: usize| &supports[cell * size..(cell + 1) * size];
        let (here, there) = (of(cell), of(other));
        let shared =
            |p: &Support, cell: &[Support]| cell.iter().any(|q| q.vertices() == p.vertices());
        // means: the facet that both have; vertex values: the vertex that only one has
        let wanted = self.are_means;
        let local = |from: &[Support], to: &[Support]| {
            let mut found = (0..size).filter(|&i| shared(&from[i], to) == wanted);
            found.next().filter(|_| found.next().is_none())
        };
        Some((local(here, there)?, local(there, here)?))
    }
}
