//! Data of the problem as the assembler meets them: evaluated in `f64`, checked, rounded once.

use crate::assemble::count;
use crate::error::Error;
use crate::mesh::{Mesh, describe_point};
use crate::problem::DataByGroup;
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
        Err(Error::DataNotFinite { datum, value, at: describe_point(at), cell: cell as u64 })
    }
}

/// The diffusion coefficient at a point of a cell of a region; one that would vanish or overflow when
/// rounded is refused.
pub(crate) fn coefficient_at<T: Real, const D: usize>(
    alpha: &DataByGroup<'_, D>,
    region: usize,
    x: &Point<f64, D>,
    cell: usize,
) -> Result<T, Error> {
    let Some(alpha) = alpha.of(region) else {
        return Ok(T::lit(1.0));
    };
    count::coefficient(1);
    let value = alpha.at(x);
    if !(value > 0.0 && value.is_finite()) {
        return Err(Error::CoefficientNotPositive {
            value,
            at: describe_point(x),
            cell: cell as u64,
        });
    }
    let rounded = T::lit(value);
    // harmonic means multiply two coefficients
    let square = (rounded * rounded).to_f64() / (value * value);
    if (square - 1.0).abs() <= 4.0 * T::EPSILON {
        Ok(rounded)
    } else {
        Err(Error::Parameter {
            parameter: "precision",
            value: T::NAME.to_owned(),
            allowed: format!(
                "cannot hold the coefficient {value:e} of cell {cell} and its square; choose another precision or scale the coefficient"
            ),
        })
    }
}

/// The diffusion coefficient at the barycentre of every cell, if there is one.
pub(crate) fn coefficients<T: Real, const D: usize>(
    alpha: &DataByGroup<'_, D>,
    mesh: &Mesh<T, D>,
) -> Result<Option<Vec<T>>, Error> {
    if !alpha.is_given() {
        return Ok(None);
    }
    let at = |cell: usize| {
        coefficient_at(alpha, mesh.region(cell), &point_f64(&mesh.barycentre(cell)), cell)
    };
    (0..mesh.n_cells()).map(at).collect::<Result<Vec<_>, _>>().map(Some)
}
