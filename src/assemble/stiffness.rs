//! The stiffness of the reference element.

use super::space::tables::CellTable;
use crate::element::MAX_BASIS;

/// A small dense matrix, of which an element uses the upper left corner.
pub(crate) type Local = [[f64; MAX_BASIS]; MAX_BASIS];

pub(crate) fn zero_local() -> Local {
    [[0.0; MAX_BASIS]; MAX_BASIS]
}

/// The stiffness of the reference element: for each pair `k < l` of barycentric coordinates what
/// their product of gradients contributes. Pairs are enough, because gradients sum to zero.
pub(crate) struct StiffnessTable {
    pairs: Vec<Local>,
    /// The square by which products of gradients of barycentric coordinates are those of basis functions, if they are.
    square: Option<f64>,
}

impl StiffnessTable {
    /// From the basis at the points of a rule that integrates products of derivatives, and the factor by which gradients of
    /// basis functions are those of barycentric coordinates, if they are.
    pub fn new(dimension: usize, table: &CellTable, gradient_factor: Option<f64>) -> Self {
        let mut pairs = Vec::new();
        for k in 0..dimension {
            for l in k + 1..=dimension {
                let mut pair: Local = zero_local();
                for (basis, &weight) in table.basis.iter().zip(&table.weights) {
                    let along = basis.derivatives.map(|d| d[k] - d[l]);
                    for i in 0..MAX_BASIS {
                        for j in 0..MAX_BASIS {
                            pair[i][j] -= weight * along[i] * along[j];
                        }
                    }
                }
                pairs.push(pair);
            }
        }
        Self { pairs, square: gradient_factor.map(|factor| factor * factor) }
    }
    /// Calls a function with `i <= j` and the entry `(grad phi_j, grad phi_i)` over a cell with these products of
    /// gradients, for the first `n` basis functions.
    #[inline(always)]
    pub fn for_each_entry<const D: usize>(
        &self,
        products: &[[f64; 4]; 4],
        n: usize,
        mut visit: impl FnMut(usize, usize, f64),
    ) {
        for i in 0..n {
            for j in i..n {
                visit(
                    i,
                    j,
                    match self.square {
                        Some(square) => square * products[i][j],
                        None => self.entry::<D>(products, i, j),
                    },
                );
            }
        }
    }
    /// Entry `(i, j)` of `(grad phi_j, grad phi_i)` over a cell with these products of gradients.
    #[inline(always)]
    pub fn entry<const D: usize>(&self, products: &[[f64; 4]; 4], i: usize, j: usize) -> f64 {
        let mut sum = 0.0;
        let mut pair = 0;
        for k in 0..D {
            for l in k + 1..=D {
                sum += products[k][l] * self.pairs[pair][i][j];
                pair += 1;
            }
        }
        sum
    }
}
