//! Squares of norms of the error, which add up over the parts of a mesh.

use super::errors::Errors;
use crate::algebra::Distribution;
use crate::real::maximum;

/// Squares of the L2 norm, the broken H1 seminorm and the broken energy norm of an error, and of the energy norm
/// of the error of a function in cells.
pub(super) type Squares = [f64; 4];

/// Squares of the norms of the error over some cells and facets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SquaredErrors {
    pub(super) squares: Squares,
    /// The facet terms of the energy norm.
    pub(super) of_facets: f64,
    /// Maximum over nodes.
    pub(super) max: f64,
}

impl SquaredErrors {
    pub(super) fn add(&mut self, squares: &Squares) {
        self.squares.iter_mut().zip(squares).for_each(|(sum, square)| *sum += square);
    }
    /// The squares over the cells and facets of both; none may be one of both.
    pub(super) fn merge(mut self, other: Self) -> Self {
        self.add(&other.squares);
        self.of_facets += other.of_facets;
        self.max = maximum(self.max, other.max);
        self
    }
    /// The squares over the cells and facets of all parts; all parts call it.
    pub(crate) fn over_parts(mut self, distribution: &dyn Distribution) -> Self {
        distribution.sum(&mut self.squares);
        distribution.sum(std::slice::from_mut(&mut self.of_facets));
        distribution.largest(std::slice::from_mut(&mut self.max));
        self
    }
    /// The norms.
    #[must_use]
    pub fn norms(&self) -> Errors {
        let [l2, h1, broken_energy, _] = self.squares;
        Errors {
            l2: Some(l2.sqrt()),
            h1: Some(h1.sqrt()),
            energy: Some((broken_energy + self.of_facets).sqrt()),
            broken_energy: Some(broken_energy.sqrt()),
            max: Some(self.max),
            ..Errors::default()
        }
    }
    /// The energy norm of the error of the function in cells.
    pub(crate) fn of_function(&self) -> f64 {
        self.squares[3].sqrt()
    }
}
