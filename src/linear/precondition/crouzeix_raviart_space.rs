//! The Crouzeix-Raviart functions on the mesh of a discontinuous linear element.

use super::facet_mean_form::stiffness;
use super::prolongation::Prolongation;
use crate::algebra::{
    NO_INDEX, PenalisedMatrix, SidePenalties, SparseMatrix, Support, sort_by_column,
};
use crate::memory::in_large_pages;
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
        let n = penalties.opposite.len();
        let mut facet_of_side = in_large_pages(vec![0; n]);
        let is_first =
            |side: usize, opposite: u32| opposite == NO_INDEX || side < opposite as usize;
        let all = penalties.opposite.iter().enumerate();
        let n_facets = all.filter(|&(side, &opposite)| is_first(side, opposite)).count();
        let mut sides_of_facet = in_large_pages(Vec::with_capacity(n_facets));
        for (side, &opposite) in penalties.opposite.iter().enumerate() {
            if is_first(side, opposite) {
                facet_of_side[side] = sides_of_facet.len() as u32;
                sides_of_facet.push([side as u32, opposite]);
            } else {
                facet_of_side[side] = facet_of_side[opposite as usize];
            }
        }
        Self { facet_of_side, sides_of_facet }
    }

    /// The matrix of the stiffness in the basis of all Crouzeix-Raviart functions.
    pub fn matrix<T: Real>(
        &self,
        penalties: &SidePenalties<T>,
        penalised: &PenalisedMatrix<T>,
    ) -> SparseMatrix<T> {
        let size = penalties.cell_size;
        let capacity = self.sides_of_facet.len() * (2 * size - 1);
        let mut matrix = SparseMatrix {
            row_starts: in_large_pages(Vec::with_capacity(self.sides_of_facet.len() + 1)),
            columns: in_large_pages(Vec::with_capacity(capacity)),
            values: in_large_pages(Vec::with_capacity(capacity)),
        };
        matrix.row_starts.push(0);
        for (own, sides) in (0..).zip(&self.sides_of_facet) {
            // the facet itself, and at most three other facets of each of its two cells
            let mut row = [(NO_INDEX, T::lit(0.0)); 7];
            row[0].0 = own;
            let mut n = 1;
            for &side in sides.iter().filter(|&&side| side != NO_INDEX) {
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
            matrix.columns.extend(row[..n].iter().map(|entry| entry.0));
            matrix.values.extend(row[..n].iter().map(|entry| entry.1));
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        matrix
    }

    /// The prolongation of conforming linear functions, whose mean on a facet is that of its vertex values;
    /// `None` if a vertex of a support is not less than `n_vertices`.
    pub fn prolongation<T: Real>(
        &self,
        penalties: &SidePenalties<T>,
        supports: &[Support],
        n_vertices: usize,
    ) -> Option<Prolongation<T>> {
        let size = penalties.cell_size;
        let length = size - 1;
        let mut vertices: Vec<u32> =
            in_large_pages(Vec::with_capacity(self.sides_of_facet.len() * length));
        for &[side, _] in &self.sides_of_facet {
            let side = side as usize;
            if penalties.are_means {
                vertices.extend(supports[side].vertices());
            } else {
                let first = side / size * size;
                let others = (first..first + size).filter(|&i| i != side);
                vertices.extend(others.flat_map(|i| supports[i].vertices()));
            }
        }
        Prolongation::to_means(vertices.chunks_exact(length), n_vertices)
    }
}
