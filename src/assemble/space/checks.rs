//! Checks of the data of the problem: each number is finite, a coefficient is positive.

use crate::error::Error;
use crate::mesh::{Mesh, describe_point};
use crate::problem::DataByGroup;
use crate::real::Point;

/// A datum that must be finite.
pub(crate) fn finite<const D: usize>(
    value: f64,
    datum: &'static str,
    at: &Point<D>,
    cell: usize,
) -> Result<f64, Error> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::DataNotFinite { datum, value, at: describe_point(at), cell: cell as u64 })
    }
}

/// The diffusion coefficient at a point of a cell; one that would vanish or overflow when
/// rounded is refused.
pub(crate) fn coefficient_at<const D: usize>(
    alpha: &DataByGroup<D>,
    mesh: &Mesh<D>,
    cell: usize,
    x: &Point<D>,
) -> Result<f64, Error> {
    let Some(alpha) = alpha.of(mesh.region(cell)) else {
        return Ok(1.0);
    };
    let value = alpha.in_cell(mesh, cell, x);
    if !(value > 0.0 && value.is_finite()) {
        return Err(Error::CoefficientNotPositive {
            value,
            at: describe_point(x),
            cell: cell as u64,
        });
    }
    // harmonic means multiply two coefficients
    match (value * value).is_normal() {
        true => Ok(value),
        false => Err(Error::Parameter {
            parameter: "coefficient",
            value: format!("{value:e} in cell {cell}"),
            allowed: "numbers whose square is a floating-point number; scale the problem"
                .to_owned(),
        }),
    }
}

/// The diffusion coefficient at the barycentre of every cell, if there is one.
pub(crate) fn coefficients<const D: usize>(
    alpha: &DataByGroup<D>,
    mesh: &Mesh<D>,
) -> Result<Option<Vec<f64>>, Error> {
    if !alpha.is_given() {
        return Ok(None);
    }
    let at = |cell: usize| coefficient_at(alpha, mesh, cell, &mesh.barycentre(cell));
    (0..mesh.n_cells()).map(at).collect::<Result<Vec<_>, _>>().map(Some)
}
