//! The solve that takes the place of the exact solution.

use std::sync::Arc;

use super::{Progress, Study};
use crate::inequality::ActiveSet;
use crate::nested::{Hierarchy, NestedIteration};
use crate::real::Precision;
use crate::study::reference::{FoundReference, ReferenceSolution};

impl<const D: usize> Study<'_, D> {
    /// The reference on the finest mesh and its name in rows, where one is asked for. Where it cannot be had, rows have
    /// no errors and say why.
    pub(super) fn find_reference<'h>(
        &'h self,
        hierarchies: &'h [Hierarchy<D>],
    ) -> Option<FoundReference<'h, D>> {
        let (reference, hierarchy) = (self.reference.as_ref()?, hierarchies.first()?);
        let name = reference.name();
        (self.observer)(Progress::Started(&self.scene.name, &name, reference.level));
        // errors in single precision are measured against a reference in double precision
        let solver = match self.precision() {
            Precision::Double => self.solvers()[0].clone(),
            Precision::Single => Arc::new(ActiveSet::default()),
        };
        let mut nested = NestedIteration::new(&reference.problem, hierarchy)
            .shared_solver(solver)
            .quadrature(self.quadrature);
        let fails = |why: &str| format!("the reference, {name}, was not found: {why}");
        let kinds: Vec<_> = reference.problem.values.iter().map(|(_, of)| of.clone()).collect();
        let found = nested.solve(&*reference.scheme).and_then(|solved| {
            let values = if solved.converged() { solved.values_of(&kinds)? } else { Vec::new() };
            Ok((solved, values.iter().map(|found| found.value).collect()))
        });
        Some(match found {
            Ok((solved, _)) if !solved.converged() => Err(fails(solved.outcome().message())),
            Ok((solved, values)) => Ok(ReferenceSolution { solved, name, values }),
            Err(error) => Err(fails(&error.to_string())),
        })
    }
}
