//! A preconditioner of an engine as one of the vectors of a part.

use std::sync::Arc;

use super::engine::{Engine, EngineMethod, EngineSolver, OwnRows};
use crate::algebra::{Distribution, SparseMatrix, sum_over_parts};
use crate::linear::{FactorError, Preconditioner};
use crate::processes::OverParts;

/// The own rows of a matrix whose unknowns are those of a discretisation.
struct RowsOfPart<'m> {
    matrix: &'m SparseMatrix<f64>,
    over_parts: &'m OverParts,
}

impl OwnRows for RowsOfPart<'_> {
    fn first(&self) -> u64 {
        self.over_parts.numbering.first()[self.over_parts.number as usize]
    }
    fn count(&self) -> usize {
        self.over_parts.numbering.own().len()
    }
    fn row(&self, own: usize, entries: &mut Vec<(u64, f64)>) {
        let numbering = &self.over_parts.numbering;
        let (columns, values) = self.matrix.row(numbering.own()[own] as usize);
        let number = |&column: &u32| numbering.numbers()[column as usize];
        entries.clear();
        entries.extend(columns.iter().map(number).zip(values.iter().copied()));
    }
}

/// The preconditioner of an engine. Residuals count at own unknowns; corrections are those of the owners at
/// ghosts, too.
pub(super) struct OnOwnUnknowns {
    name: &'static str,
    /// The number of unknowns of all parts up to which changes of fixed unknowns do not set up the engine again: the
    /// multigrid of an earlier set of fixed unknowns, with corrections that vanish at the present ones, is a
    /// preconditioner, too.
    few_changes: f64,
    solver: Box<dyn EngineSolver>,
    over_parts: Arc<OverParts>,
    fixed: Vec<bool>,
    /// The fixed unknowns for which the engine was set up; empty before.
    set_up: Vec<bool>,
    residual: Vec<f64>,
    correction: Vec<f64>,
}

impl OnOwnUnknowns {
    /// That of a matrix.
    pub fn new(
        engine: &dyn Engine,
        matrix: &SparseMatrix<f64>,
        over_parts: Arc<OverParts>,
        (method, few_changes): (EngineMethod, f64),
    ) -> Self {
        let rows = RowsOfPart { matrix, over_parts: &over_parts };
        let solver = engine.solver(&rows, method);
        let n = over_parts.numbering.own().len();
        let (fixed, residual, correction) = (vec![false; n], vec![0.0; n], vec![0.0; n]);
        let name = match method {
            EngineMethod::Multigrid => "algebraic-multigrid",
            EngineMethod::Factors => "direct",
        };
        let set_up = Vec::new();
        Self { name, few_changes, solver, over_parts, fixed, set_up, residual, correction }
    }

    /// Number of unknowns of the part, ghosts included.
    pub fn n_unknowns(&self) -> usize {
        self.over_parts.numbering.numbers().len()
    }

    /// Whether the engine is set up for nearly the same fixed unknowns in all parts.
    fn is_nearly_set_up(&self) -> bool {
        let pairs = self.fixed.iter().zip(&self.set_up);
        let changes = match self.set_up.len() == self.fixed.len() {
            true => pairs.filter(|(one, other)| one != other).count() as f64,
            false => f64::INFINITY,
        };
        sum_over_parts(&*self.over_parts, changes) <= self.few_changes
    }
}

impl Preconditioner<f64> for OnOwnUnknowns {
    fn name(&self) -> &'static str {
        self.name
    }

    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let own = self.over_parts.numbering.own();
        self.fixed.iter_mut().zip(own).for_each(|(own, &i)| *own = fixed[i as usize]);
        if !self.is_nearly_set_up() {
            self.set_up.clear();
            self.solver.set_fixed(&self.fixed)?;
            self.set_up.clone_from(&self.fixed);
        }
        Ok(())
    }

    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let own = self.over_parts.numbering.own();
        for ((residual, &i), &fixed) in self.residual.iter_mut().zip(own).zip(&self.fixed) {
            *residual = if fixed { 0.0 } else { r[i as usize] };
        }
        self.solver.apply(&self.residual, &mut self.correction);
        for ((&correction, &i), &fixed) in self.correction.iter().zip(own).zip(&self.fixed) {
            z[i as usize] = if fixed { 0.0 } else { correction };
        }
        let distribution: &dyn Distribution = &*self.over_parts;
        distribution.update(z);
    }
}
