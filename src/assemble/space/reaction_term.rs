//! The reaction term in the matrix of a cell.

use super::data::finite;
use super::tables::CellTable;
use crate::assemble::count;
use crate::assemble::local::Local;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::problem::Datum;
use crate::real::{Real, point_f64};

/// The reaction term, with the rule that integrates it.
pub(crate) struct ReactionTerm<'a, T, const D: usize> {
    datum: &'a Datum<D>,
    table: CellTable<T>,
    n: usize,
}

impl<'a, T: Real, const D: usize> ReactionTerm<'a, T, D> {
    /// The term of a datum with `n` basis functions at the points of a rule.
    pub fn new(datum: &'a Datum<D>, table: &CellTable<f64>, n: usize) -> Self {
        Self { datum, table: table.rounded(), n }
    }
    /// Adds `(c phi_j, phi_i)` over a cell.
    pub fn add(&self, mesh: &Mesh<T, D>, cell: usize, volume: T, out: &mut Local<T>) {
        let table = &self.table;
        for ((point, basis), &weight) in table.points.iter().zip(&table.basis).zip(&table.weights) {
            count::reaction(1);
            let c = match self.datum {
                Datum::Constant(c) => *c,
                Datum::Function(c) => c(&point_f64(&mesh.point(cell, &point[..=D]))),
            };
            let scale = T::lit(c) * volume * weight;
            for i in 0..self.n {
                for j in 0..self.n {
                    out[i][j] += scale * basis.values[i] * basis.values[j];
                }
            }
        }
    }
    /// Whether the datum is not negative at the points of the rule.
    pub fn is_nonnegative(&self, mesh: &Mesh<T, D>) -> bool {
        let at_point = |cell: usize, point: &[T; 4]| {
            self.datum.at(&point_f64(&mesh.point(cell, &point[..=D]))) >= 0.0
        };
        match self.datum {
            Datum::Constant(c) => *c >= 0.0,
            Datum::Function(_) => (0..mesh.n_cells())
                .all(|cell| self.table.points.iter().all(|point| at_point(cell, point))),
        }
    }
    /// Finds the point at which the datum is not finite.
    pub fn check(&self, mesh: &Mesh<T, D>) -> Result<(), Error> {
        for cell in 0..mesh.n_cells() {
            for point in &self.table.points {
                let x = point_f64(&mesh.point(cell, &point[..=D]));
                finite(self.datum.at(&x), "reaction", &x, cell)?;
            }
        }
        Ok(())
    }
}
