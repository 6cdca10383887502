//! Values of discrete functions at points, and what errors are measured against.

use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::assemble::space::tables::BasisAt;
use crate::element::MAX_BASIS;
use crate::instances::compiled;
use crate::problem::Exact;
use crate::real::Point;

/// A barycentric coordinate that is negative by no more than this counts as zero.
const ROUNDING: f64 = 1e-10;

/// The function against which errors are measured.
pub(super) enum Reference<'r, const D: usize> {
    /// A function with its gradient.
    Exact(&'r Exact<D>),
    /// A discrete function on the mesh of which the mesh of the error is a refinement.
    Coarse { space: &'r Space<'r, D>, values: &'r [f64], refinements: usize },
}

impl<const D: usize> Reference<'_, D> {
    /// The value at a point of a cell, less a constant.
    pub fn value(&self, cell: usize, x: &Point<D>, constant: f64) -> f64 {
        match self {
            Self::Exact(exact) => exact.value.at(x) - constant,
            Self::Coarse { space, values, refinements } => {
                let cell = cell >> (D * refinements);
                let (basis, local) = space.evaluate(cell, x, values);
                basis.value(&local) + (space.body_constants.of_cell(cell) - constant)
            }
        }
    }
    pub fn gradient(&self, cell: usize, x: &Point<D>) -> Point<D> {
        match self {
            Self::Exact(exact) => (exact.gradient)(x),
            Self::Coarse { space, values, refinements } => {
                let cell = cell >> (D * refinements);
                let (basis, local) = space.evaluate(cell, x, values);
                let geometry = space.mesh.geometry(cell);
                (0..D + 1).fold(Point::zeros(), |sum: Point<D>, k| {
                    let slope: f64 =
                        local.iter().zip(&basis.derivatives).map(|(c, d)| c * d[k]).sum();
                    sum + geometry.gradient(k) * slope
                })
            }
        }
    }
}

impl<const D: usize> Space<'_, D> {
    /// The basis at a point of a cell, and the unknowns of the cell.
    fn evaluate(&self, cell: usize, x: &Point<D>, u: &[f64]) -> (BasisAt, [f64; MAX_BASIS]) {
        (self.basis_at(&self.mesh.barycentric(cell, x)), self.local_values(cell, u))
    }
    fn value_in(&self, u: &[f64], cell: usize, x: &Point<D>) -> f64 {
        let (basis, local) = self.evaluate(cell, x, u);
        basis.value(&local) + self.body_constants.of_cell(cell)
    }
    fn value_at(&self, u: &[f64], x: &Point<D>) -> Option<f64> {
        let mut cells = self.mesh.cells_containing(x, ROUNDING);
        cells.next().map(|cell| self.value_in(u, cell, x))
    }
}

impl<const D: usize> Discretisation<'_, D> {
    /// The value of a vector of unknowns at a point, in the first cell that contains the point; none
    /// outside the mesh. The search takes a time proportional to the number of cells.
    pub fn value_at(&self, u: &[f64], point: &Point<D>) -> Option<f64> {
        self.demand_length(u);
        compiled!(const D: fn(&Discretisation<'_, D>, &[f64], &Point<D>) -> Option<f64>
                = |of, u, point| of.space.value_at(u, point)
        )(self, u, point)
    }
    /// The value of a vector of unknowns at a point of a cell; outside the cell that of the polynomial there.
    ///
    /// # Panics
    /// If there is no such cell.
    #[cfg(feature = "report")]
    pub(crate) fn value_in(&self, u: &[f64], cell: usize, point: &Point<D>) -> f64 {
        self.space.value_in(u, cell, point)
    }
}
