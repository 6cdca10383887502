//! Preconditioners of the schemes on the parts of a mesh.
//!
//! They are [`AuxiliarySpace`] and that of one mesh, [`MeanJumpSplitting`], with an engine in place of multigrid
//! for conforming linear and Crouzeix-Raviart functions, and of factors. What is local they compute at all
//! unknowns of a part, ghosts included, of residuals that are those of the owners at ghosts: an own unknown
//! then has what it has on the whole mesh.

use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};

use super::auxiliary_space::{AuxiliarySpace, VertexCorrection};
use super::engine::{Engine, EngineMethod, EngineSolver, OwnRows};
use super::own_unknowns::OnOwnUnknowns;
use crate::algebra::{Distribution, SparseMatrix, any_part};
use crate::linear::precondition::{BlockSolver, FacetMeansSolver, MeanJumpSplitting};
use crate::linear::{FactorError, PreconditionedSystem, Preconditioner, PreconditionerFamily};
use crate::processes::OverParts;

/// What corrects where. The preconditioners of engines are made before, so that their matrices are gone while
/// the inequality is solved; the first preconditioner of a scheme takes them.
pub(super) enum Auxiliary {
    /// The engine, all unknowns by this method, set up again for more changes than this number.
    None(EngineMethod, f64),
    /// The engine, conforming linear functions that vanish at vertices with Dirichlet data; blocks of cells
    /// correct all unknowns.
    Conforming(Mutex<Option<OnOwnUnknowns>>, Vec<bool>),
    /// The engine, Crouzeix-Raviart functions, whose unknown is known for each side of each cell; jumps and
    /// the vertex values of cells with free and fixed ones are corrected besides.
    FacetMeans(Mutex<Option<OnOwnUnknowns>>, Vec<u32>),
}

/// The preconditioners of a scheme on a part.
pub(super) struct EnginePreconditioners {
    pub engine: Arc<dyn Engine>,
    pub over_parts: Arc<OverParts>,
    pub auxiliary: Auxiliary,
    /// Number of vertices of the part.
    pub n_vertices: usize,
}

impl PreconditionerFamily<f64> for EnginePreconditioners {
    fn name(&self) -> &'static str {
        "active-set"
    }

    fn preconditioner<'a>(
        &self,
        system: PreconditionedSystem<'a, f64>,
    ) -> Option<Box<dyn Preconditioner<f64> + 'a>> {
        let PreconditionedSystem { matrix, inequality, .. } = system;
        let (engine, locations) = (&*self.engine, &inequality.locations);
        let take = |of: &Mutex<Option<OnOwnUnknowns>>| {
            of.lock().unwrap_or_else(PoisonError::into_inner).take()
        };
        let inner: Box<dyn Preconditioner<f64> + 'a> = match &self.auxiliary {
            Auxiliary::None(method, few_changes) => {
                let by = (*method, *few_changes);
                let over_parts = self.over_parts.clone();
                Box::new(OnOwnUnknowns::new(engine, matrix, over_parts, by))
            }
            Auxiliary::Conforming(of, dirichlet) => {
                let dirichlet = Cow::Owned(dirichlet.clone());
                let coarse = Box::new(take(of)?);
                let correction = VertexCorrection::new(coarse, dirichlet, locations)?;
                let is_own = |i: usize| self.over_parts.owns(i);
                let own = (0..matrix.size()).map(is_own).collect();
                Box::new(AuxiliarySpace::new(matrix, locations, own, correction)?)
            }
            Auxiliary::FacetMeans(of, unknowns) => {
                let penalised = inequality.penalised.as_ref()?;
                let block = BlockOverParts::new(self.engine.clone(), self.over_parts.clone());
                let places = (&locations[..], self.n_vertices);
                let solver = take(of)?;
                let splitting = MeanJumpSplitting::with_solvers(
                    matrix,
                    penalised,
                    places,
                    |_, space| {
                        let mut unknown_of = vec![0; space.sides_of_facet.len()];
                        for (&facet, &unknown) in space.facet_of_side.iter().zip(unknowns) {
                            unknown_of[facet as usize] = unknown;
                        }
                        let n = solver.n_unknowns();
                        Some(Box::new(FacetMeansOverParts {
                            solver,
                            unknown_of,
                            fixed: vec![true; n],
                            residual: vec![0.0; n],
                            correction: vec![0.0; n],
                        }))
                    },
                    Box::new(block),
                );
                Box::new(splitting?)
            }
        };
        let n = matrix.size();
        let residual = vec![0.0; n];
        Some(Box::new(WithGhosts { inner, over_parts: self.over_parts.clone(), residual }))
    }
}

/// A preconditioner that needs residuals and fixed unknowns of ghosts.
struct WithGhosts<'a> {
    inner: Box<dyn Preconditioner<f64> + 'a>,
    over_parts: Arc<OverParts>,
    residual: Vec<f64>,
}

impl Preconditioner<f64> for WithGhosts<'_> {
    fn name(&self) -> &'static str {
        self.inner.name()
    }

    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let distribution: &dyn Distribution = &*self.over_parts;
        let mut fixed = fixed.to_vec();
        distribution.update_flags(&mut fixed);
        let set = self.inner.set_fixed(&fixed);
        // one error in all parts, so that all take the same way on
        let is_too_large = any_part(distribution, set == Err(FactorError::OutOfMemory));
        match any_part(distribution, set.is_err()) {
            true if is_too_large => Err(FactorError::OutOfMemory),
            true => Err(FactorError::NotPositive),
            false => Ok(()),
        }
    }

    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        let distribution: &dyn Distribution = &*self.over_parts;
        self.residual.copy_from_slice(r);
        distribution.update(&mut self.residual);
        self.inner.apply(&self.residual, z);
        for (i, z) in z.iter_mut().enumerate() {
            if !distribution.owns(i) {
                *z = 0.0;
            }
        }
    }

    fn forcing_term(&self) -> f64 {
        self.inner.forcing_term()
    }
}

/// Crouzeix-Raviart functions by an engine.
struct FacetMeansOverParts {
    solver: OnOwnUnknowns,
    /// The unknown of each facet.
    unknown_of: Vec<u32>,
    /// Workspace: fixed unknowns, residuals and corrections.
    fixed: Vec<bool>,
    residual: Vec<f64>,
    correction: Vec<f64>,
}

impl FacetMeansSolver<f64> for FacetMeansOverParts {
    fn set_fixed(
        &mut self,
        fixed_facets: &[bool],
        kept_facets: &[u32],
        _: &[bool],
    ) -> Result<(), FactorError> {
        for (&unknown, &is_fixed) in self.unknown_of.iter().zip(fixed_facets) {
            self.fixed[unknown as usize] = is_fixed;
        }
        for &facet in kept_facets {
            self.fixed[self.unknown_of[facet as usize] as usize] = true;
        }
        self.solver.set_fixed(&self.fixed)
    }

    fn apply(&mut self, residual: &[f64], means: &mut [f64]) {
        for (&unknown, &r) in self.unknown_of.iter().zip(residual) {
            self.residual[unknown as usize] = r;
        }
        self.solver.apply(&self.residual, &mut self.correction);
        for (&unknown, mean) in self.unknown_of.iter().zip(means) {
            *mean = self.correction[unknown as usize];
        }
    }
}

/// A block of the matrix over all parts, by factors of an engine.
struct BlockOverParts {
    engine: Arc<dyn Engine>,
    over_parts: Arc<OverParts>,
    /// `None` if the block is empty in all parts.
    solver: Option<Box<dyn EngineSolver>>,
    /// The unknowns of the block in this part.
    unknowns: Vec<u32>,
    /// The positions of own unknowns among these.
    own: Vec<u32>,
    /// Workspace: a value at each unknown of the part.
    values: Vec<f64>,
    right_side: Vec<f64>,
    solution: Vec<f64>,
}

impl BlockOverParts {
    fn new(engine: Arc<dyn Engine>, over_parts: Arc<OverParts>) -> Self {
        let values = vec![0.0; over_parts.numbering.numbers().len()];
        let (unknowns, own, right_side, solution) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { engine, over_parts, solver: None, unknowns, own, values, right_side, solution }
    }
}

/// The own rows of a block.
struct RowsOfBlock<'b> {
    block: &'b SparseMatrix<f64>,
    own: &'b [u32],
    numbers: Vec<u64>,
    first: u64,
}

impl OwnRows for RowsOfBlock<'_> {
    fn first(&self) -> u64 {
        self.first
    }
    fn count(&self) -> usize {
        self.own.len()
    }
    fn row(&self, own: usize, entries: &mut Vec<(u64, f64)>) {
        let (columns, values) = self.block.row(self.own[own] as usize);
        let number = |&column: &u32| self.numbers[column as usize];
        entries.clear();
        entries.extend(columns.iter().map(number).zip(values.iter().copied()));
    }
}

impl BlockSolver<f64> for BlockOverParts {
    fn factor(&mut self, block: &SparseMatrix<f64>, unknowns: &[u32]) -> Result<(), FactorError> {
        let over_parts = &*self.over_parts;
        let is_own = |&k: &u32| over_parts.owns(unknowns[k as usize] as usize);
        self.own = (0..unknowns.len() as u32).filter(is_own).collect();
        self.unknowns = unknowns.to_vec();
        self.right_side = vec![0.0; self.own.len()];
        self.solution = vec![0.0; self.own.len()];
        self.solver = None;
        let mut counts = vec![0.0; over_parts.exchange.parts()];
        counts[over_parts.number as usize] = self.own.len() as f64;
        over_parts.sum(&mut counts);
        if counts.iter().sum::<f64>() == 0.0 {
            return Ok(());
        }
        let first = counts[..over_parts.number as usize].iter().sum::<f64>() as u64;
        let mut numbers = vec![0.0; over_parts.numbering.numbers().len()];
        for (number, &k) in (first..).zip(&self.own) {
            numbers[unknowns[k as usize] as usize] = number as f64;
        }
        (over_parts as &dyn Distribution).update(&mut numbers);
        let numbers = unknowns.iter().map(|&i| numbers[i as usize] as u64).collect();
        let rows = RowsOfBlock { block, own: &self.own, numbers, first };
        let mut solver = self.engine.solver(&rows, EngineMethod::Factors);
        solver.set_fixed(&vec![false; self.own.len()])?;
        self.solver = Some(solver);
        Ok(())
    }

    fn solve(&mut self, vector: &mut [f64]) {
        let Some(solver) = &mut self.solver else { return };
        for (b, &k) in self.right_side.iter_mut().zip(&self.own) {
            *b = vector[k as usize];
        }
        solver.apply(&self.right_side, &mut self.solution);
        for (&x, &k) in self.solution.iter().zip(&self.own) {
            self.values[self.unknowns[k as usize] as usize] = x;
        }
        // the mean over an own side needs the values of the opposite cell, which may be a ghost
        (&*self.over_parts as &dyn Distribution).update(&mut self.values);
        for (x, &i) in vector.iter_mut().zip(&self.unknowns) {
            *x = self.values[i as usize];
        }
    }
}
