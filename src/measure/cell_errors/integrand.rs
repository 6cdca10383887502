//! Squares of the pointwise error in a cell.

use crate::assemble::space::checks;
use crate::assemble::space::tables::BasisAt;
use crate::element::MAX_BASIS;
use crate::error::Error;
use crate::measure::admissible::Admissible;
use crate::measure::evaluation::Reference;
use crate::measure::squared_errors::Squares;
use crate::problem::Datum;
use crate::real::Point;

/// A discrete function in a cell.
pub(super) struct LocalFunction<const D: usize> {
    /// Number of basis functions.
    pub n: usize,
    /// The unknowns of the cell.
    pub values: [f64; MAX_BASIS],
    /// The gradient of a linear function; none for functions of a higher degree.
    pub slope: Option<Point<D>>,
}

/// The data with which the error is integrated in a cell.
pub(super) struct CellIntegrand<'a, const D: usize> {
    pub exact: &'a Reference<'a, D>,
    pub cell: usize,
    /// What was taken off the values of the discrete function.
    pub constant: f64,
    pub volume: f64,
    /// The gradients of the barycentric coordinates.
    pub gradients: [Point<D>; 4],
    /// The discrete function, if its error is measured.
    pub discrete: Option<LocalFunction<D>>,
    /// The admissible function, if its error is measured and not known by that of the discrete function.
    pub admissible: Option<Admissible<'a, D>>,
    /// Whether the admissible function is the discrete function, with the same coefficient.
    pub is_admissible: bool,
    /// The diffusion coefficient in the energy norm of the discrete function, where it is constant in the cell.
    pub alpha: f64,
    /// The diffusion coefficient where the scheme evaluates it at the points of a rule.
    pub varying: Option<&'a Datum<D>>,
    pub coefficient: Option<&'a Datum<D>>,
    pub reaction: Option<&'a Datum<D>>,
}

impl<const D: usize> CellIntegrand<'_, D> {
    /// Adds the squares of the error at a point, with the weight of the point, to sums over points. The result are the
    /// fluxes of the errors of the discrete and of the admissible function, zero without one.
    pub fn add(
        &self,
        sums: &mut Squares,
        (point, x): (&[f64; 4], &Point<D>),
        weight: f64,
        basis: &BasisAt,
    ) -> [Point<D>; 2] {
        let mut fluxes = [Point::zeros(); 2];
        let weight = weight * self.volume;
        let value = self.exact.value(self.cell, x, self.constant);
        let gradient = self.exact.gradient(self.cell, x);
        let reaction = self.reaction.map_or(0.0, |c| c.at(x));
        if let Some(discrete) = &self.discrete {
            let term = |i: usize| discrete.values[i] * basis.values[i];
            // linear functions have one basis function for each vertex
            let (own, slope): (f64, _) = match discrete.slope {
                Some(slope) => ((0..D + 1).map(term).sum(), slope),
                None => {
                    let coefficients = &discrete.values[..discrete.n];
                    let slope = basis.gradient(coefficients, &self.gradients);
                    ((0..discrete.n).map(term).sum(), slope)
                }
            };
            let difference = slope - gradient;
            let square = difference.norm_squared();
            let of_value = (own - value) * (own - value);
            let alpha = self.varying.map_or(self.alpha, |alpha| alpha.at(x));
            fluxes[0] = difference * alpha;
            sums[0] += weight * of_value;
            sums[1] += weight * square;
            sums[2] += weight * (alpha * square + reaction * of_value);
        }
        if let Some(admissible) = &self.admissible {
            let (own, slope) = admissible.at(point, x);
            let alpha = self.coefficient.map_or(1.0, |alpha| alpha.at(x));
            let difference = slope - gradient;
            fluxes[1] = difference * alpha;
            let of_value = (own - value) * (own - value);
            sums[3] += weight * (alpha * difference.norm_squared() + reaction * of_value);
        }
        fluxes
    }

    /// Sums over all points, if the exact solution is finite there. Finite sums prove that; only if a sum is not finite
    /// are the points visited a second time. Sums are not finite either where values of the discrete function are not.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`] with the first point at which the exact solution is not finite.
    pub fn checked(
        &self,
        mut sums: Squares,
        points: impl FnOnce() -> Vec<Point<D>>,
    ) -> Result<Squares, Error> {
        if self.is_admissible {
            sums[3] = sums[2];
        }
        if sums.iter().all(|square| square.is_finite()) {
            return Ok(sums);
        }
        points().into_iter().try_for_each(|x| {
            checks::finite(
                self.exact.value(self.cell, &x, self.constant),
                "exact solution",
                &x,
                self.cell,
            )?;
            let square = self.exact.gradient(self.cell, &x).norm_squared();
            checks::finite(square, "exact gradient", &x, self.cell).map(|_| ())
        })?;
        Ok(sums)
    }
}
