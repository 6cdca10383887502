//! The result of a solver.

use super::Outcome;
use super::certificate::contact_states;
use super::history::HistoryPoint;
use super::stage::StageRun;
use crate::algebra::{Bound, Contact, Inequality};
use crate::real::{Precision, Real};

/// The result of a solver of an inequality.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution<T> {
    /// The values of the unknowns: the solution if converged. Else, from the active set method, the iterate with the
    /// smallest projected Jacobi step, in the norm of the diagonal of `A`; from the proximal point method the iterate with
    /// the smallest certificate; from the other methods the last iterate.
    pub values: Vec<T>,
    /// What the values lack of those of the problem's solution, by unknown: the constants that were taken off its
    /// [data](crate::assemble::Discretisation::constants). Empty if they are zero, and before the result has a problem.
    pub constants: Vec<f64>,
    /// Which bound, if any, is active at each unknown.
    pub contact: Vec<Contact>,
    /// How the solve ended.
    pub outcome: Outcome,
    /// Number of outer iterations:
    ///
    /// * active set method with factors: linear systems with a new active set, and steps of the interior
    ///   point method;
    /// * active set method with a Krylov method: active sets for which linear systems were solved;
    /// * monotone multigrid: cycles;
    /// * interior point method and proximal point method alone: linear systems, the first one without bounds included;
    /// * several methods one after the other: the sum.
    pub outer: usize,
    /// Number of iterations of the linear solver: of the Krylov method, or cycles of monotone
    /// multigrid; zero for a direct solver.
    pub linear: usize,
    /// Number of linear systems, each solved with factors or by a Krylov method; `None` if the solver does not say:
    ///
    /// * active set method: active sets, those of which the system was solved again for more accuracy each time, and the
    ///   correction that gives jump multipliers;
    /// * monotone multigrid: cycles, each with one linear correction;
    /// * interior point method and proximal point method: steps, whatever the right-hand sides of a step, and the start;
    /// * several methods one after the other: the sum.
    ///
    /// Inequalities near unknowns that change in turn, which the active set method solves where it makes little progress,
    /// and bounds on the error do not count.
    pub systems: Option<usize>,
    /// The linear solver: `direct`, or the name of a preconditioner.
    pub linear_solver: &'static str,
    /// Bound on the relative algebraic error in the energy norm, if the solver computes one: the energy norm of the
    /// difference between `values` and the exact solution of the inequality, divided by the energy norm of the iterate.
    pub algebraic_bound: Option<f64>,
    /// The jump multipliers `p = S (M u - g)` of a
    /// [`PenalisedMatrix`](crate::algebra::PenalisedMatrix), which defines `S`, `M` and `g`, if the
    /// solver determines them more accurately than they follow from `values`; else empty.
    pub jump_multipliers: Vec<T>,
    /// The largest violation of the certificate times the energy norm to which it is relative: what the solver leaves
    /// of residuals and multipliers in the dual norm. Zero before the solution has a certificate.
    pub(crate) dual_residual: f64,
    /// The positions of the [kinks](crate::algebra::Kink) of whose place the solution lies on the other side than load
    /// and bounds of the inequality say: it solves the inequality with these [turned](Inequality::turn).
    pub turned: Vec<u32>,
    /// The stages of the solver that ran, in their order; empty for a solver without stages.
    pub stages: Vec<StageRun>,
    /// A point after every outer step, all stages included, if the initial guess asks for it and the solver keeps it
    /// ([`InitialGuess::keeps_history`](super::InitialGuess::keeps_history)); else empty. A step whose system has no
    /// solution has no point. The last point need not be that of `values`: these may be moved onto their bounds, or be
    /// those of an earlier step if they are better. Where bounds alone hold a body, the points are those of the
    /// inequalities that are solved on the way; in single precision, those of the rounded inequality.
    pub history: Vec<HistoryPoint>,
    /// The precision in which the values were computed.
    pub precision: Precision,
}

impl Solution<f32> {
    /// The solution with values and jump multipliers as numbers in `f64`, exactly.
    pub(super) fn widened(self) -> Solution<f64> {
        let widen = |values: Vec<f32>| values.into_iter().map(f64::from).collect();
        Solution {
            values: widen(self.values),
            constants: self.constants,
            contact: self.contact,
            outcome: self.outcome,
            outer: self.outer,
            linear: self.linear,
            systems: self.systems,
            linear_solver: self.linear_solver,
            algebraic_bound: self.algebraic_bound,
            jump_multipliers: widen(self.jump_multipliers),
            dual_residual: self.dual_residual,
            turned: self.turned,
            stages: self.stages,
            history: self.history,
            precision: self.precision,
        }
    }
}

impl<T: Real> Solution<T> {
    /// A result with zero iterations, no number of linear systems, the linear solver `direct`, no algebraic bound and no
    /// jump multipliers, to be completed by the setters.
    #[must_use]
    pub fn new(values: Vec<T>, contact: Vec<Contact>, outcome: Outcome) -> Self {
        Self {
            values,
            constants: Vec::new(),
            contact,
            outcome,
            outer: 0,
            linear: 0,
            systems: None,
            linear_solver: "direct",
            algebraic_bound: None,
            jump_multipliers: Vec::new(),
            dual_residual: 0.0,
            turned: Vec::new(),
            stages: Vec::new(),
            history: Vec::new(),
            precision: T::PRECISION,
        }
    }
    /// A result from values alone, with jump multipliers if they are not empty: what a solver returns that has no
    /// contact states of its own.
    ///
    /// With the residual `b - A u` and the scales of the [`Certificate`](super::Certificate), an unknown is in contact
    /// with its nearer bound if its gap is at most the Gauss-Seidel step towards this bound, or if its value is on the
    /// bound and the multiplier has a wrong sign by no more than the limit of the certificate. A value on its bound
    /// whose multiplier vanishes is therefore in contact. So is an unknown whose bounds coincide, with the lower one.
    /// Without one value for each unknown there are no states, and the result has no iterate.
    #[must_use]
    pub fn of_values(
        inequality: &Inequality<T>,
        values: Vec<T>,
        jump_multipliers: Vec<T>,
        outcome: Outcome,
    ) -> Self {
        let is_complete = inequality.is_well_formed() && values.len() == inequality.size();
        let contact = match is_complete {
            true => contact_states(inequality, &values, &jump_multipliers),
            false => Vec::new(),
        };
        Self::new(values, contact, outcome).jump_multipliers(jump_multipliers)
    }
    /// The result of a solve that ends before the first iterate: the admissible values nearest to zero, all contact
    /// states inactive.
    pub(crate) fn without_iterate(inequality: &Inequality<T>, outcome: Outcome) -> Self {
        let nearest = |bound: &Bound<T>| bound.nearest(T::lit(0.0));
        let values: Vec<T> = inequality.bounds.iter().map(nearest).collect();
        let contact = vec![Contact::Inactive; values.len()];
        Self::new(values, contact, outcome)
    }
    /// Sets the numbers of outer iterations and of iterations of the linear solver.
    #[must_use]
    pub fn iterations(mut self, outer: usize, linear: usize) -> Self {
        (self.outer, self.linear) = (outer, linear);
        self
    }
    /// Sets the number of linear systems.
    #[must_use]
    pub fn systems(mut self, systems: usize) -> Self {
        self.systems = Some(systems);
        self
    }
    /// Sets the name of the linear solver.
    #[must_use]
    pub fn linear_solver(mut self, name: &'static str) -> Self {
        self.linear_solver = name;
        self
    }
    /// Sets the bound on the relative algebraic error in the energy norm.
    #[must_use]
    pub fn algebraic_bound(mut self, bound: Option<f64>) -> Self {
        self.algebraic_bound = bound;
        self
    }
    /// Sets the jump multipliers.
    #[must_use]
    pub fn jump_multipliers(mut self, jump_multipliers: Vec<T>) -> Self {
        self.jump_multipliers = jump_multipliers;
        self
    }
    /// Sets the stages that ran.
    #[must_use]
    pub fn stages(mut self, stages: Vec<StageRun>) -> Self {
        self.stages = stages;
        self
    }
}
