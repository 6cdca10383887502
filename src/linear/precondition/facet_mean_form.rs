//! The form of an over-penalised discontinuous element on its facet mean functions, read from the
//! matrix.

use crate::algebra::{NO_INDEX, SparseMatrix, Support};
use crate::real::Real;

/// Entries up to this multiple of machine epsilon times the largest entry of their block count as zero.
const ROUNDING: f64 = 64.0;

/// The entries of a symmetric form between the facet mean functions of the two sides of a facet.
///
/// The facet mean function of a side is the linear function on its cell with mean one on the facet
/// and mean zero on the other facets of the cell: the Crouzeix-Raviart basis. Sides have the indices of
/// unknowns: side `i` of a cell belongs to facet `i` of the cell, which is opposite to vertex `i`.
pub(crate) struct FacetMeanForm<T> {
    /// Number of unknowns of a cell.
    pub cell_size: usize,
    /// Whether the unknowns are the means over sides; else they are vertex values.
    pub are_means: bool,
    /// The other side of the same facet, [`NO_INDEX`] if no entry couples the two cells.
    pub opposite: Vec<u32>,
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
    /// The entries of a matrix; `None` if its unknowns are not those of discontinuous linear
    /// functions in two or three dimensions, or cells are coupled by more than the means over their
    /// common facet.
    pub fn from_matrix(
        matrix: &SparseMatrix<T>,
        supports: &[Support],
        cell_size: usize,
    ) -> Option<Self> {
        let n = matrix.size();
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
            diagonal: vec![zero; n],
            coupling: vec![zero; n],
        };
        for cell in 0..n / cell_size {
            form.read_cell(matrix, supports, cell)?;
        }
        Some(form)
    }

    /// Reads the rows of a cell; `None` as in [`FacetMeanForm::from_matrix`].
    fn read_cell(
        &mut self,
        matrix: &SparseMatrix<T>,
        supports: &[Support],
        cell: usize,
    ) -> Option<()> {
        let size = self.cell_size;
        let columns = matrix.row(cell * size).0;
        // All rows of a cell have the same columns, those of whole cells.
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
                    self.diagonal[cell * size + facet] = self.form(&entry, facet, facet);
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
            let tolerance = ROUNDING * T::EPSILON * largest;
            // A product of the two means has these entries only.
            let couples_means = |i: usize, j: usize| match self.are_means {
                true => i == here && j == there,
                false => i != here && j != there,
            };
            let is_other_coupling = |e: usize| {
                let (i, j) = (e / size, e % size);
                !couples_means(i, j) && entry(i, j).to_f64().abs() > tolerance
            };
            if (0..size * size).any(is_other_coupling) {
                return None;
            }
            self.opposite[cell * size + here] = (other * size + there) as u32;
            self.coupling[cell * size + here] = self.form(&entry, here, there);
        }
        Some(())
    }

    /// The form of the functions of the facets `here` and `there`, from the block of their cells.
    fn form(&self, entry: &dyn Fn(usize, usize) -> T, here: usize, there: usize) -> T {
        if self.are_means {
            return entry(here, there);
        }
        let size = self.cell_size;
        let mut sum = T::lit(0.0);
        for i in 0..size {
            for j in 0..size {
                let weight: T = cr_basis::<T>(size, i, here) * cr_basis::<T>(size, j, there);
                sum += weight * entry(i, j);
            }
        }
        sum
    }

    /// The local numbers of the common facet of two cells; `None` if it is not unique.
    fn common_facet(
        &self,
        supports: &[Support],
        cell: usize,
        other: usize,
    ) -> Option<(usize, usize)> {
        let size = self.cell_size;
        let of = |cell: usize| &supports[cell * size..(cell + 1) * size];
        let (here, there) = (of(cell), of(other));
        let is_shared =
            |p: &Support, cell: &[Support]| cell.iter().any(|q| q.vertices() == p.vertices());
        // With means as unknowns, the common facet is the one whose mean both cells have; with
        // vertex values, the one opposite to the vertex that only one of the cells has.
        let wanted = self.are_means;
        let local = |from: &[Support], to: &[Support]| {
            let mut found = (0..size).filter(|&i| is_shared(&from[i], to) == wanted);
            found.next().filter(|_| found.next().is_none())
        };
        Some((local(here, there)?, local(there, here)?))
    }
}
