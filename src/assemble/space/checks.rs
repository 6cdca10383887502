//! Checks of the data of the problem: each number is finite, a coefficient is positive.

use crate::error::{Error, InCell};
use crate::mesh::Mesh;
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
        let rest = "data must be finite";
        Err(Error::DataNotFinite(InCell::value((datum, value), at, cell, rest)))
    }
}

/// A datum that must be finite and not negative.
pub(crate) fn not_negative<const D: usize>(
    value: f64,
    datum: &'static str,
    at: &Point<D>,
    cell: usize,
) -> Result<f64, Error> {
    if finite(value, datum, at, cell)? < 0.0 {
        let found = InCell::value((datum, value), at, cell, "it must not be negative");
        return Err(Error::CoefficientNotPositive(found));
    }
    Ok(value)
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
        let rest = "it must be positive and finite";
        let found = InCell::value(("coefficient", value), x, cell, rest);
        return Err(match value.is_finite() {
            true => Error::CoefficientNotPositive(found),
            false => Error::DataNotFinite(found),
        });
    }
    // harmonic means multiply two coefficients
    match (value * value).is_normal() {
        true => Ok(value),
        false => {
            let allowed = "numbers whose square is a floating-point number; scale the problem";
            Err(Error::parameter("coefficient", format!("{value:e} in cell {cell}"), allowed))
        }
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
