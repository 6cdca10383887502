//! How much of an error in a cell no polynomial has: whether a rule of low degree integrates its square.

use crate::real::Point;

/// The values of orthonormal polynomials at a point: at most those of degree two in the plane.
pub(super) type Polynomials = [f64; 6];

/// Moments of two fluxes in a cell: that of the error of the discrete function, and that of the function in cells.
pub(super) struct Roughness<const D: usize> {
    /// Number of polynomials.
    n: usize,
    /// Number of fluxes that have moments: one or two.
    n_fluxes: usize,
    /// The means of the squares.
    squares: [f64; 2],
    /// The means of the products with polynomials.
    moments: [[Point<D>; 6]; 2],
}

impl<const D: usize> Roughness<D> {
    /// No points yet, for these numbers of polynomials and of fluxes.
    pub fn new(n: usize, n_fluxes: usize) -> Self {
        Self { n, n_fluxes, squares: [0.0; 2], moments: [[Point::zeros(); 6]; 2] }
    }

    /// Adds a point of a rule.
    pub fn add(&mut self, weight: f64, fluxes: &[Point<D>; 2], polynomials: &Polynomials) {
        for (k, flux) in fluxes.iter().enumerate().take(self.n_fluxes) {
            let flux_of_weight = flux * weight;
            self.squares[k] += flux.dot(&flux_of_weight);
            for (moment, polynomial) in self.moments[k].iter_mut().zip(polynomials).take(self.n) {
                *moment += flux_of_weight * *polynomial;
            }
        }
    }

    /// The share of the square of a flux that is no polynomial's, the larger one of both; zero without a flux.
    pub fn share(&self) -> f64 {
        let share = |k: usize| {
            let of_polynomials: f64 = self.moments[k].iter().map(|m| m.norm_squared()).sum();
            let rest = self.squares[k] - of_polynomials;
            if self.squares[k] > 0.0 { rest / self.squares[k] } else { 0.0 }
        };
        share(0).max(share(1))
    }
}
