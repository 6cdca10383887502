//! Products of jumps on the facets of the reference cell.

use super::space::tables::FacetTable;
use super::stiffness::{Local, zero_local};
use crate::element::MAX_BASIS;

/// For each pair of facets the sums over moments of the products of basis functions: what the
/// integral of `[v][u]` over a facet is, per unit measure. Moments whose penalty weights differ
/// make classes of their own.
pub(crate) struct JumpProducts {
    /// By what each class multiplies the penalty weight.
    pub weights: Vec<f64>,
    /// By facet of this cell, then by class.
    own: Vec<Local>,
    /// By facet of this cell, facet of the other cell, then by class.
    other: Vec<Local>,
}

impl JumpProducts {
    /// The products of the moments in a table, with the weight of each degree.
    pub fn new<const D: usize>(table: &FacetTable, weight: impl Fn(usize) -> f64) -> Self {
        let of_degree: Vec<f64> = table.degrees.iter().map(|&k| weight(k)).collect();
        let mut weights: Vec<f64> = Vec::new();
        for &w in &of_degree {
            if !weights.contains(&w) {
                weights.push(w);
            }
        }
        let sum = |local: usize, other: usize, class: f64| {
            let mut sum = zero_local();
            let moments = table.on(local).iter().zip(table.on(other)).zip(&of_degree);
            for ((own, other), _) in moments.filter(|(_, w)| **w == class) {
                for i in 0..MAX_BASIS {
                    for j in 0..MAX_BASIS {
                        sum[i][j] += own.values[i] * other.values[j];
                    }
                }
            }
            sum
        };
        let (mut own, mut others) = (Vec::new(), Vec::new());
        for local in 0..=D {
            for &class in &weights {
                own.push(sum(local, local, class));
            }
            for other in 0..=D {
                for &class in &weights {
                    others.push(sum(local, other, class));
                }
            }
        }
        Self { own, other: others, weights }
    }
    /// This cell with itself, by class.
    #[inline(always)]
    pub fn own(&self, local: usize) -> &[Local] {
        let n = self.weights.len();
        &self.own[local * n..(local + 1) * n]
    }
    /// This cell with the other, by class.
    #[inline(always)]
    pub fn other(&self, local: usize, other: usize) -> &[Local] {
        let n = self.weights.len();
        let start = local * self.own.len() + other * n;
        &self.other[start..start + n]
    }
}
