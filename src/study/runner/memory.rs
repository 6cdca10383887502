//! The memory that the runs of a study will need.

use super::Study;
use crate::element::Layout;
use crate::instances::compiled;
use crate::real::Real;
use crate::scheme::AnyScheme;
use crate::study::memory::{MemoryEstimate, estimate, estimate_without_factors, unknowns_about};

impl<T: Real, const D: usize> Study<'_, T, D> {
    /// An estimate of the memory of the largest run, with factors if the solver computes them from
    /// the start; none for a study without schemes or levels.
    pub fn memory_estimate(&self) -> Option<MemoryEstimate> {
        compiled!(
            T, D: fn(&Study<'_, T, D>) -> Option<MemoryEstimate>
                = |study| study.estimate_memory()
        )(self)
    }
    fn estimate_memory(&self) -> Option<MemoryEstimate> {
        let obstacle = self.scene.problem.has_obstacle();
        let solvers = self.solvers();
        let bytes = |layout: Layout, cells: f64| {
            let unknowns = unknowns_about(D, layout, cells) as usize;
            match D > 1 && solvers.iter().all(|s| s.uses_coarse_spaces(unknowns)) {
                true => estimate_without_factors(D, layout, cells, size_of::<T>()),
                false => estimate(D, layout, cells, obstacle, size_of::<T>()),
            }
        };
        let of = |scheme: &dyn AnyScheme<T, D>, level: usize| {
            let cells = match &self.adaptive {
                Some(of) => of.unknowns as f64 / unknowns_about(D, scheme.layout(), 1.0),
                None => self.coarsest().cells(level),
            };
            let bytes = bytes(scheme.layout(), cells);
            MemoryEstimate { bytes, scheme: scheme.name().to_owned(), level }
        };
        let finest = self.row_levels().into_iter().max()?;
        let reference = self.reference.iter().map(|r| of(&*r.scheme, r.level));
        let runs = self.entries.iter().map(|e| of(&*e.scheme, finest));
        runs.chain(reference).max_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }
}
