//! The data of the cells of a conforming function that patches need.

use super::corners::Corner;
use crate::error_bound::flux::Flux;

/// The numbers of the flux of a cell, on its facets at the vertex, as an affine function of the multipliers: the
/// numbers `c` with the sum `s` for which `c . G c / 2 - b . c + m . c` is least.
#[derive(Clone, Copy)]
pub(super) struct CellProblem<const N: usize> {
    /// `S`, minus the derivative of the numbers.
    pub slopes: [[f64; N]; N],
    /// The numbers for multipliers that vanish.
    pub numbers: [f64; N],
}

/// The cells of a conforming function, as patches read them: a flux has `N` numbers at most on the facets of a cell at
/// a vertex.
pub(super) trait PatchCells<const D: usize, const N: usize>: Sync {
    /// The degree of the flux, zero or one.
    const DEGREE: usize;
    /// How many numbers a facet has.
    const PER_FACET: usize = if Self::DEGREE == 0 { 1 } else { D };

    /// Where number `p` of a facet stands among those of a cell.
    fn place(facet: usize, p: usize) -> usize {
        // the vertices of a facet are those of the cell without the opposite one
        if Self::DEGREE == 0 { facet } else { Flux::<D>::place(facet, p + usize::from(p >= facet)) }
    }

    /// Sets the numbers that the flux of a cell, in the order of [`Flux`], has by `alpha grad u . n`: zeros unless stated.
    fn normals(&self, _cell: usize, numbers: &mut [f64]) {
        numbers.fill(0.0);
    }
    /// The numbers of `phi alpha grad u . n` on a facet, `phi` the hat function of a vertex of it; likewise.
    fn normal(&self, _corner: Corner, _facet: usize) -> [f64; 3] {
        [0.0; 3]
    }
    /// The numbers that the flux of a vertex, with that of `phi alpha grad u . n`, has on a Neumann or contact facet;
    /// likewise.
    fn given(&self, _corner: Corner, _facet: usize) -> [f64; 3] {
        [0.0; 3]
    }
    /// The least squares problem of a cell in the patch of a vertex with these corners, as if all numbers were free.
    fn problem(&self, corner: Corner, corners: &[Corner]) -> CellProblem<N>;
}
