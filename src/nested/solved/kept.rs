//! What of a result outlives its problem and its meshes.

use super::Solved;
use crate::inequality::{Certificate, Solution};
use crate::problem::DiscreteFunction;

/// A result without its problem and its meshes: it owns all it has, and may be sent to other threads.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct KeptSolution<const D: usize> {
    /// The discrete function, which is a datum of other problems.
    pub function: DiscreteFunction<D>,
    /// The solution of the algebraic inequality, from which another solve
    /// [starts](crate::nested::NestedIteration::start_from).
    pub solution: Solution<f64>,
    /// The certificate of the solution.
    pub certificate: Certificate,
}

impl<const D: usize> Solved<'_, D> {
    /// The discrete function with a mesh of its own; none without an iterate. On a part of a mesh that of the part.
    pub fn function(&self) -> Option<DiscreteFunction<D>> {
        self.has_iterate.then(|| self.discretisation().function(&self.solution.values))
    }
    /// What of the result outlives problem and meshes; none without an iterate. Errors, fields and the error bound need
    /// both: ask for them before.
    pub fn keep(&self) -> Option<KeptSolution<D>> {
        let (solution, certificate) = (self.solution.clone(), self.certificate);
        self.function().map(|function| KeptSolution { function, solution, certificate })
    }
}
