//! Squares of norms of the error, which add up over the parts of a mesh.

use super::errors::Errors;
use crate::real::maximum;

/// Squares of the L2 norm, the broken H1 seminorm and the broken energy norm of an error, and of the energy norm
/// of the error of a function in cells.
pub(super) type Squares = [f64; 4];

/// Squares of the norms of the error over some cells and facets; those of the parts of a mesh
/// [merge](SquaredErrors::merge) into those of the whole.
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
    #[must_use]
    pub fn merge(mut self, other: Self) -> Self {
        self.add(&other.squares);
        self.of_facets += other.of_facets;
        self.max = maximum(self.max, other.max);
        self
    }
    /// All of it as numbers, to be sent to another part.
    pub fn to_numbers(&self) -> Vec<f64> {
        let Self { squares: [l2, h1, energy, function], of_facets, max } = *self;
        vec![l2, h1, energy, function, of_facets, max]
    }
    /// What [`SquaredErrors::to_numbers`] has made numbers of; none for another number of them.
    #[must_use]
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let &[l2, h1, energy, function, of_facets, max] = numbers else { return None };
        Some(Self { squares: [l2, h1, energy, function], of_facets, max })
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
