//! The Crouzeix-Raviart functions on the mesh of a discontinuous linear element.

use std::ops::Range;

use super::facet_mean_form::stiffness;
use super::prolongation::Prolongation;
use crate::algebra::{
    DofLocation, NO_INDEX, PenalisedMatrix, RectangularMatrix, SidePenalties, SparseMatrix,
    sort_by_column,
};
use crate::memory::in_large_pages;
use crate::parallel::cells::{items, n_chunks};
use crate::parallel::vectors::{collect, indices, positions, zeros};
use crate::parallel::{for_each_item, split};
use crate::real::Real;

/// The Crouzeix-Raviart functions on a mesh, one for each facet; the sides of facets have the indices of
/// [`SidePenalties`].
///
/// The means of a Crouzeix-Raviart function over the two sides of a facet are equal. Such functions have no jumps of
/// means, and their form is the stiffness alone.
pub(crate) struct CrouzeixRaviartSpace {
    /// The facet of each side.
    pub facet_of_side: Vec<u32>,
    /// The sides of each facet; the second is [`NO_INDEX`] on the boundary.
    pub sides_of_facet: Vec<[u32; 2]>,
}

impl CrouzeixRaviartSpace {
    /// The facets in the order of their first sides.
    pub fn new<T>(penalties: &SidePenalties<T>) -> Self {
        let opposite = &penalties.opposite;
        let n = opposite.len();
        // the index of no side is the largest
        let firsts = indices(n, |side| side < opposite[side] as usize);
        let sides = |side: u32| [side, opposite[side as usize]];
        let sides_of_facet = collect(firsts.len(), |facet| sides(firsts[facet]));
        let facets = positions(n, &firsts);
        let facet_of_side = collect(n, |side| facets[side.min(opposite[side] as usize)]);
        Self { facet_of_side, sides_of_facet }
    }

    /// The matrix of the stiffness in the basis of all Crouzeix-Raviart functions.
    pub fn matrix<T: Real>(
        &self,
        penalties: &SidePenalties<T>,
        penalised: &PenalisedMatrix<T>,
    ) -> SparseMatrix<T> {
        let size = penalties.cell_size;
        let n = self.sides_of_facet.len();
        let mut row_starts = in_large_pages(Vec::with_capacity(n + 1));
        row_starts.push(0);
        let mut end = 0;
        row_starts.extend(self.sides_of_facet.iter().map(|sides| {
            end += if sides[1] == NO_INDEX { size } else { 2 * size - 1 } as u32;
            end
        }));
        let (mut columns, mut values) =
            (in_large_pages(vec![0; end as usize]), zeros(end as usize));
        let starts = &row_starts;
        let length = |facets: Range<usize>| (starts[facets.end] - starts[facets.start]) as usize;
        let lengths = || (0..n_chunks(n)).map(|chunk| length(items(chunk, n)));
        let entries = split(&mut columns, lengths()).zip(split(&mut values, lengths()));
        for_each_item(entries.collect(), &|chunk, (columns, values): (&mut [u32], &mut [T])| {
            let mut entries = columns.iter_mut().zip(values);
            for own in items(chunk, n) {
                let (row, n) = self.row(own, penalties, penalised);
                for (&(column, value), to) in row[..n].iter().zip(&mut entries) {
                    (*to.0, *to.1) = (column, value);
                }
            }
        });
        SparseMatrix { row_starts, columns, values }
    }

    /// The row of a facet, sorted by column, with the number of its entries: the facet itself, and at most three other
    /// facets of each of its two cells.
    fn row<T: Real>(
        &self,
        own: usize,
        penalties: &SidePenalties<T>,
        penalised: &PenalisedMatrix<T>,
    ) -> ([(u32, T); 7], usize) {
        let size = penalties.cell_size;
        let mut row = [(NO_INDEX, T::lit(0.0)); 7];
        row[0].0 = own as u32;
        let mut n = 1;
        for &side in self.sides_of_facet[own].iter().filter(|&&side| side != NO_INDEX) {
            let side = side as usize;
            let first = side / size * size;
            for other in first..first + size {
                let value = stiffness(penalised, [side, other], penalties.are_means);
                if other == side {
                    row[0].1 += value;
                } else {
                    row[n] = (self.facet_of_side[other], value);
                    n += 1;
                }
            }
        }
        sort_by_column(&mut row[..n]);
        (row, n)
    }

    /// The prolongation of conforming linear functions, whose mean on a facet is that of its vertex values;
    /// `None` if a vertex of a location is not less than `n_vertices`.
    pub fn prolongation<T: Real>(
        &self,
        penalties: &SidePenalties<T>,
        locations: &[DofLocation],
        n_vertices: usize,
    ) -> Option<Prolongation<T>> {
        let size = penalties.cell_size;
        let length = size - 1;
        let n = self.sides_of_facet.len();
        let vertices = collect(n * length, |k| {
            let (side, place) = (self.sides_of_facet[k / length][0] as usize, k % length);
            if penalties.are_means {
                return locations[side].vertices()[place];
            }
            // all vertices of the cell but the one opposite the facet
            let opposite = side % size;
            let local = place + usize::from(place >= opposite);
            locations[side - opposite + local].vertices()[0]
        });
        if vertices.iter().any(|&v| v as usize >= n_vertices) {
            return None;
        }
        let rows = RectangularMatrix {
            starts: (0..=n as u32).map(|facet| facet * length as u32).collect(),
            values: vec![T::lit(1.0 / length as f64); vertices.len()],
            columns: vertices,
        };
        Some(Prolongation::from_weights(rows, n_vertices))
    }
}
