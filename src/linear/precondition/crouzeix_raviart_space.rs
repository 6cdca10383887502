//! The Crouzeix-Raviart functions on the mesh of a discontinuous linear element.

use std::array::from_fn;

use super::facet_mean_form::stiffness;
use super::prolongation::Prolongation;
use crate::algebra::{
    DofLocation, NO_INDEX, PenalisedMatrix, SidePenalties, SparseMatrix, sort_by_column,
};
use crate::parallel::vectors::{collect, indices, positions};
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
        SparseMatrix::by_groups(self.sides_of_facet.len(), &|range| {
            SparseMatrix::by_rows(range, |own, columns, values| {
                let (row, n) = self.row(own, penalties, penalised);
                columns.extend(row[..n].iter().map(|entry| entry.0));
                values.extend(row[..n].iter().map(|entry| entry.1));
            })
        })
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
    ) -> Option<Prolongation> {
        let size = penalties.cell_size;
        let of_facet = |facet: usize| {
            let side = self.sides_of_facet[facet][0] as usize;
            if penalties.are_means {
                return locations[side];
            }
            // all vertices of the cell but the one opposite the facet
            let (first, opposite) = (side / size * size, side % size);
            let vertex = |place: usize| first + place + usize::from(place >= opposite);
            let vertices: [u32; 3] = from_fn(|place| match place + 1 < size {
                true => locations[vertex(place)].vertices()[0],
                false => NO_INDEX,
            });
            DofLocation::new(None, &vertices[..size - 1])
        };
        let of_facets = collect(self.sides_of_facet.len(), of_facet);
        Prolongation::to_element(&of_facets, n_vertices)
    }
}
