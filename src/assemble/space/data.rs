//! Data of the problem as the assembler meets them: evaluated in `f64`, checked, rounded once.

use super::Space;
use super::tables::CellTable;
use crate::assemble::count;
use crate::assemble::local::Local;
use crate::error::Error;
use crate::mesh::{Mesh, describe_point};
use crate::problem::{Datum, Problem};
use crate::real::{Point, Real, point_f64};

/// A datum that must be finite.
pub(crate) fn finite<const D: usize>(
    value: f64,
    datum: &'static str,
    at: &Point<f64, D>,
    cell: usize,
) -> Result<f64, Error> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::DataNotFinite { datum, value, at: describe_point(at), cell: cell as u32 })
    }
}

/// The diffusion coefficient at the barycentre of every cell, if there is one; a coefficient that
/// would vanish or overflow when rounded is refused.
pub(crate) fn coefficients<T: Real, const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<T, D>,
) -> Result<Option<Vec<T>>, Error> {
    let Some(alpha) = &problem.coefficient else {
        return Ok(None);
    };
    let at = |cell: usize| {
        count::coefficient(1);
        let value = alpha(&point_f64(&mesh.barycentre(cell)));
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::CoefficientNotPositive { value, cell: cell as u32 });
        }
        let rounded = T::lit(value);
        if (rounded.to_f64() / value - 1.0).abs() <= T::EPSILON {
            Ok(rounded)
        } else {
            Err(Error::Parameter {
                parameter: "precision",
                value: T::NAME.to_owned(),
                allowed: format!(
                    "cannot hold the coefficient {value:e} of cell {cell}; choose another precision or scale the coefficient"
                ),
            })
        }
    };
    (0..mesh.n_cells()).map(at).collect::<Result<Vec<_>, _>>().map(Some)
}

/// The reaction term, with the rule that integrates it.
pub(crate) struct ReactionTerm<'a, T, const D: usize> {
    datum: &'a Datum<D>,
    table: CellTable<T>,
    n: usize,
}

impl<'a, T: Real, const D: usize> ReactionTerm<'a, T, D> {
    /// Nothing if the problem has no reaction.
    pub fn new(space: &Space<'a, T, D>) -> Option<Self> {
        let datum = space.problem.reaction.as_ref()?;
        let products = 2 * space.degree;
        let degree = match datum {
            Datum::Constant(_) => products,
            Datum::Function(_) => products.max(space.quadrature.cell),
        };
        let table = space.cell_table(degree).rounded();
        Some(Self { datum, table, n: space.per_cell() })
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
