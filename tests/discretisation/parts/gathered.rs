//! An engine without a library: every part has all rows, and factors them.

use std::rc::Rc;
use std::sync::Arc;
use unilateral::algebra::SparseMatrix;
use unilateral::distributed::{
    Engine, EngineMethod, EngineSolver, OwnRows, Process, SolverOnParts,
};
use unilateral::linear::{FactorError, Factors};
use unilateral::mesh::Layers;
use unilateral::prelude::*;
use unilateral::processes::{Exchange, InProcess};

#[derive(Debug)]
pub struct Gathered {
    exchange: Arc<InProcess>,
}

/// A process of the exchange between threads with this engine.
pub fn process(number: u32, exchange: &Arc<InProcess>) -> Process {
    let engine = Gathered { exchange: exchange.clone() };
    Process::new(number, exchange.clone(), engine)
}

/// The part of a mesh and of its refinements, with layers across vertices.
pub fn parts_of<const D: usize>(
    mesh: &Mesh<D>,
    (refinements, layers): (usize, usize),
    process: &Process,
) -> Hierarchy<D> {
    let (number, exchange) = (process.number, &process.exchange);
    let layers = Layers::across_vertices(layers);
    Hierarchy::of_parts(mesh, refinements, layers, (number, exchange)).unwrap()
}

/// A problem on the parts of nested meshes.
pub fn on_parts<'a, const D: usize>(
    problem: &'a Problem<D>,
    parts: &'a Hierarchy<D>,
    process: Process,
) -> NestedIteration<'a, D> {
    NestedIteration::new(problem, parts).system_solver(Rc::new(SolverOnParts::new(process)))
}

/// The lists of all parts, one after the other.
fn gather(exchange: &InProcess, own: Vec<u64>) -> Vec<u64> {
    exchange.exchange(vec![own; exchange.parts()]).unwrap().concat()
}

impl Engine for Gathered {
    fn name(&self) -> String {
        "gathered".to_owned()
    }
    fn solver(&self, rows: &dyn OwnRows, _: EngineMethod) -> Box<dyn EngineSolver> {
        let (first, count) = (rows.first() as usize, rows.count());
        let mut own = Vec::new();
        let mut entries = Vec::new();
        for k in 0..count {
            rows.row(k, &mut entries);
            entries.sort_unstable_by_key(|entry| entry.0);
            own.push(entries.len() as u64);
            own.extend(entries.iter().flat_map(|(column, value)| [*column, value.to_bits()]));
        }
        let mut all = gather(&self.exchange, own).into_iter();
        let mut matrix =
            SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() };
        while let Some(length) = all.next() {
            for _ in 0..length {
                matrix.columns.push(all.next().unwrap() as u32);
                matrix.values.push(f64::from_bits(all.next().unwrap()));
            }
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
        Box::new(GatheredSolver {
            matrix,
            own: first..first + count,
            free: Vec::new(),
            factors: None,
            exchange: self.exchange.clone(),
        })
    }
    fn take_failure(&self) -> Option<String> {
        None
    }
}

struct GatheredSolver {
    matrix: SparseMatrix<f64>,
    own: std::ops::Range<usize>,
    free: Vec<u32>,
    factors: Option<Factors<f64>>,
    exchange: Arc<InProcess>,
}

impl EngineSolver for GatheredSolver {
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let own = fixed.iter().map(|&fixed| u64::from(fixed)).collect();
        let fixed = gather(&self.exchange, own);
        self.free = (0..).zip(fixed).filter(|(_, fixed)| *fixed == 0).map(|(i, _)| i).collect();
        self.factors = Some(Factors::new(&self.matrix, true, &self.free)?);
        Ok(())
    }
    fn apply(&mut self, residual: &[f64], correction: &mut [f64]) {
        let own = residual.iter().map(|r| r.to_bits()).collect();
        let all = gather(&self.exchange, own);
        let Some(factors) = &self.factors else { return correction.fill(f64::NAN) };
        let at = |&i: &u32| f64::from_bits(all[i as usize]);
        let mut x: Vec<f64> = self.free.iter().map(at).collect();
        factors.solve_in_place(&mut x, 1);
        // rows of fixed unknowns are those of a multiple of the identity
        let n = self.matrix.size();
        let mean = (0..n).map(|i| self.matrix.get(i, i)).sum::<f64>() / n as f64;
        correction.iter_mut().zip(residual).for_each(|(z, r)| *z = r / mean);
        for (&i, x) in self.free.iter().zip(x) {
            if self.own.contains(&(i as usize)) {
                correction[i as usize - self.own.start] = x;
            }
        }
    }
}
