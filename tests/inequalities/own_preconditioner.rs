//! Preconditioners made outside the library.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::problems::{Random, sparse};
use unilateral::algebra::{Bound, Distribution, Inequality};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome, ProximalPoint, Stage, certify};
use unilateral::linear::{
    BuiltInPreconditioners, FactorError, LinearMethod, PreconditionedSystem, Preconditioner,
    PreconditionerFamily,
};
use unilateral::prelude::*;

/// Division by the diagonal.
#[derive(Clone, Debug)]
struct Jacobi;

struct JacobiOf {
    diagonal: Vec<f64>,
    fixed: Vec<bool>,
}

impl PreconditionerFamily<f64> for Jacobi {
    fn name(&self) -> &'static str {
        "active-set-jacobi"
    }
    fn preconditioner<'a>(
        &self,
        system: PreconditionedSystem<'a, f64>,
    ) -> Option<Box<dyn Preconditioner<f64> + 'a>> {
        Some(Box::new(JacobiOf { diagonal: system.matrix.diagonal(), fixed: Vec::new() }))
    }
}

impl Preconditioner<f64> for JacobiOf {
    fn name(&self) -> &'static str {
        "jacobi"
    }
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        self.fixed = fixed.to_vec();
        Ok(())
    }
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        for (i, z) in z.iter_mut().enumerate() {
            *z = if self.fixed[i] { 0.0 } else { r[i] / self.diagonal[i] };
        }
    }
}

#[test]
fn a_preconditioner_of_ones_own_runs_beside_the_built_in_ones() {
    let iterative = || ActiveSet::default().linear(LinearMethod::Iterative);
    let report = Study::<2>::new(scenes::radial(1.0))
        .scheme(ConformingP1)
        .scheme(Sipg::default())
        .solver(iterative())
        .solver(iterative().with_preconditioners(Jacobi))
        .levels([8, 16, 32])
        .run()
        .unwrap();
    let rows = |solver: &str| report.rows.iter().filter(|r| r.solver == solver).collect::<Vec<_>>();
    let (built_in, own) = (rows("active-set"), rows("active-set-jacobi"));
    assert_eq!((built_in.len(), own.len()), (6, 6));
    for (a, b) in built_in.iter().zip(&own) {
        assert!(a.converged() && b.converged());
        assert_eq!((&a.scheme, a.level, a.active), (&b.scheme, b.level, b.active));
        assert_eq!(b.linear, "jacobi");
        let (x, y) = (a.error.l2.unwrap(), b.error.l2.unwrap());
        assert!((x - y).abs() <= 1e-8, "{x} and {y}");
        let stages: Vec<Stage> = b.iterations.stages.iter().map(|run| run.stage).collect();
        assert_eq!(stages, [Stage::PreconditionedActiveSet]);
    }
    // the diagonal alone needs more iterations on finer meshes
    let iterations = |rows: &[&unilateral::study::Row]| rows[2].iterations.linear;
    assert!(iterations(&own) > iterations(&built_in));
}

/// The whole mesh as the only part: there are no factors, as on several parts.
#[derive(Debug)]
pub struct OnePart;

impl Distribution for OnePart {
    fn owns(&self, _unknown: usize) -> bool {
        true
    }
    fn number(&self, unknown: usize) -> u64 {
        unknown as u64
    }
    fn exchange(&self, _value: &dyn Fn(usize) -> f64, _receive: &mut dyn FnMut(usize, f64)) {}
    fn sum(&self, _numbers: &mut [f64]) {}
    fn largest(&self, _numbers: &mut [f64]) {}
}

/// Forty blocks with the symmetric part `[1, s; s, 1]` and the skew-symmetric part `[0, 1; -1, 0]`: GMRES converges in
/// two steps whatever the smallest eigenvalue `1 - s` of the symmetric part is.
pub fn blocks(s: f64) -> Inequality<f64> {
    let n = 80;
    let mut dense = vec![vec![0.0; n]; n];
    for i in (0..n).step_by(2) {
        (dense[i][i], dense[i][i + 1]) = (1.0, s + 1.0);
        (dense[i + 1][i], dense[i + 1][i + 1]) = (s - 1.0, 1.0);
    }
    let mut random = Random::new(1);
    let load = (0..n).map(|_| random.signed()).collect();
    Inequality::new(sparse(&dense), false, load, vec![Bound::Lower(-2.0); n])
}

/// Values with a small certificate have not converged where the estimate of the smallest eigenvalue fails, and there
/// are no factors.
#[test]
fn on_parts_values_without_a_bound_on_their_error_have_not_converged() {
    for (s, outcome) in [(0.5, Outcome::Converged), (0.99999, Outcome::Stalled)] {
        let mut given = blocks(s);
        given.distribution = Some(Arc::new(OnePart));
        let solution = ActiveSet::default().with_preconditioners(Jacobi).solve(&given);
        assert!(certify(&given, &solution.values).largest() <= 1e-9);
        assert_eq!(solution.outcome, outcome);
        assert_eq!(solution.algebraic_bound.is_some(), outcome == Outcome::Converged);
        // a method of one process
        assert_eq!(ProximalPoint.solve(&given).outcome, Outcome::Unsuitable);
    }
}

/// The preconditioners of the library, and how often they are applied.
#[derive(Clone, Debug, Default)]
struct Counted(Arc<AtomicUsize>);

struct CountedOf<'a> {
    preconditioner: Box<dyn Preconditioner<f64> + 'a>,
    applications: Arc<AtomicUsize>,
}

impl PreconditionerFamily<f64> for Counted {
    fn name(&self) -> &'static str {
        "active-set-counted"
    }
    fn preconditioner<'a>(
        &self,
        system: PreconditionedSystem<'a, f64>,
    ) -> Option<Box<dyn Preconditioner<f64> + 'a>> {
        let preconditioner = BuiltInPreconditioners.preconditioner(system)?;
        Some(Box::new(CountedOf { preconditioner, applications: Arc::clone(&self.0) }))
    }
}

impl Preconditioner<f64> for CountedOf<'_> {
    fn name(&self) -> &'static str {
        self.preconditioner.name()
    }
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        self.preconditioner.set_fixed(fixed)
    }
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        self.applications.fetch_add(1, Ordering::Relaxed);
        self.preconditioner.apply(r, z);
    }
    fn forcing_term(&self) -> f64 {
        self.preconditioner.forcing_term()
    }
}

/// Every iteration of conjugate gradients applies the preconditioner. Of a huge penalty the last system is
/// solved once more, for the jump multipliers.
#[test]
fn iterations_are_applications_of_the_preconditioner() {
    for eta in [1.0, 1e10] {
        let counted = Counted::default();
        let solver = ActiveSet::default().linear(LinearMethod::Iterative);
        let report = Study::<2>::new(scenes::signorini_2d())
            .scheme(Wopsip { eta: Eta::Absolute(eta), ..Wopsip::default() })
            .solver(solver.with_preconditioners(counted.clone()))
            .levels([16])
            .run()
            .unwrap();
        let row = &report.rows[0];
        assert!(row.converged());
        let (iterations, applications) = (row.iterations.linear, counted.0.load(Ordering::Relaxed));
        assert!(iterations > 0 && iterations <= applications, "{iterations} and {applications}");
    }
}
