//! The primal-dual active set method.

mod condensed_lcp;
pub(crate) mod cycles;
mod dense_lcp;
pub(crate) mod driver;
pub(crate) mod inexact;
pub(crate) mod iterate;
mod kkt_evaluation;

use super::initial_guess::InitialGuess;
use super::monotone_multigrid::MonotoneMultigrid;
use super::{InequalitySolver, Outcome, Solution};
use crate::algebra::{Contact, Inequality, Start};
use crate::instances::compiled;
use crate::linear::direct::factors::{FactorError, is_positive_definite};
use crate::linear::direct::static_condensation::StaticCondensation;
use crate::linear::{CoarseSpaces, LinearMethod};
use crate::real::Real;
use driver::Search;
use inexact::{InVain, Inexact};
use iterate::Iterate;

/// The primal-dual active set method, which is a semismooth Newton method (Hintermueller, Ito,
/// Kunisch, SIAM J. Optim. 13 (2002) 865-888).
///
/// Every outer step fixes the unknowns in contact at their bounds and the Dirichlet ones at their
/// values, solves for the rest, and lets go where a multiplier has the wrong sign, takes hold
/// where a bound is violated. For M-matrices it ends in the solution after finitely many steps.
/// For other matrices it may cycle: a state that returns is recognised, and the problem condensed
/// on all unknowns that have moved since is solved exactly ([`Outcome::Cycling`] if that is not
/// possible within the limits below). The same is done where the method wanders, which is a cycle
/// too long to be waited for: no iterate has been better than the best for `patience` steps. Where
/// that does not help either, or too many unknowns move, there is a [`LastResort`].
///
/// What differs by rounding only does not change state, or ties would cycle for ever. A bound is
/// violated beyond rounding by `band` units of the scalar's epsilon times the largest
/// displacement: an unknown left out of contact by mistake harms the solution by its violation and
/// no more, so a global scale is safe. A multiplier has the wrong sign beyond rounding by `band`
/// units of the forces whose sum it is, where forces between unknowns at rest on given values are
/// exact to `f64`: multipliers shrink like the volume of a patch and there are many of them, so
/// that a global scale would hide all of them on fine meshes. Each time the condensed solution is
/// disputed the band widens fourfold, to 64 times itself at most, forces then on the global scale
/// too.
///
/// A cold start takes the solution without inequalities. If that does not exist because nothing
/// but the bounds holds the body (the matrix is singular, not indefinite), it starts from
/// contact everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveSet {
    /// Largest number of linear systems with a new active set.
    pub max_outer: usize,
    /// Units of rounding within which nothing changes state.
    pub band: f64,
    /// Corrections of each linear solution by its residual in `f64`. Every step starts from the
    /// iterate before and so corrects it anyway; one more matters where a single step suffices
    /// (a warm start), in `f32` by two digits and more.
    pub refinements: usize,
    /// LinearMethod systems within which the number of changes of state must fall to a half, or the
    /// interior point method is asked.
    pub hesitation: usize,
    /// LinearMethod systems without a better iterate after which the unknowns that moved are condensed.
    pub patience: usize,
    /// Largest number of condensed problems.
    pub max_condensations: usize,
    /// Largest number of unknowns of a condensed problem; its matrix is dense.
    pub max_condensed: usize,
    /// What else is done.
    pub last_resort: LastResort,
    /// Whether to make sure first that the matrix is positive definite on all unknowns that are
    /// not Dirichlet values, its symmetric part if it is not symmetric. Error size does not detect
    /// loss of coercivity. Free of cost for a cold start with a symmetric matrix.
    pub check_definite: bool,
    /// The linear solver inside.
    pub linear: LinearMethod,
}

/// What is done where the active set does not settle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LastResort {
    /// Nothing: the outcome says so.
    Never,
    /// The active set is found anew by an interior point method (Mehrotra, SIAM J. Optim. 2 (1992)
    /// 575-601); if it does not settle from there, energy is lowered monotonically.
    #[default]
    WhenUnsettled,
    /// The interior point method is asked first.
    AtOnce,
    /// Energy is lowered monotonically from the start: a face of the bounds after the other is
    /// searched for its minimum. Ends for every symmetric positive definite matrix (Bertsekas, SIAM
    /// J. Control Optim. 20 (1982) 221-246; More, Toraldo, SIAM J. Optim. 1 (1991) 93-113), if
    /// `max_outer` is large enough. Others are solved as if unsettled.
    Monotone,
}

/// Unknowns above which the iterative solver is faster where nested meshes are known.
const CROSSOVER: usize = 10_000;

impl Default for ActiveSet {
    fn default() -> Self {
        Self {
            max_outer: 200,
            band: 16.0,
            refinements: 1,
            hesitation: 3,
            patience: 20,
            max_condensations: 10,
            max_condensed: 500,
            last_resort: LastResort::default(),
            check_definite: false,
            linear: LinearMethod::default(),
        }
    }
}

impl<T: Real> InequalitySolver<T> for ActiveSet {
    fn name(&self) -> &'static str {
        "active-set"
    }

    fn solve(&self, inequality: &Inequality<T>) -> Solution<T> {
        self.solve_from(inequality, &InitialGuess::default())
    }

    fn solve_from(&self, inequality: &Inequality<T>, nearby: &InitialGuess<T>) -> Solution<T> {
        compiled!(
            T: fn(&ActiveSet, &Inequality<T>, &InitialGuess<T>) -> Solution<T>
                = ActiveSet::choose_and_solve
        )(self, inequality, nearby)
    }

    fn uses_coarse_spaces(&self, unknowns: usize) -> bool {
        match self.linear {
            LinearMethod::Direct => false,
            LinearMethod::Iterative => true,
            LinearMethod::BySize => unknowns >= CROSSOVER,
        }
    }
}

impl ActiveSet {
    fn choose_and_solve<T: Real>(
        &self,
        inequality: &Inequality<T>,
        nearby: &InitialGuess<T>,
    ) -> Solution<T> {
        let is_iterative =
            <Self as InequalitySolver<T>>::uses_coarse_spaces(self, inequality.size());
        let is_known = !matches!(nearby.functions, CoarseSpaces::Unknown);
        let is_asked = self.linear == LinearMethod::Iterative;
        if is_iterative && (is_known || is_asked) && check_input(inequality).is_ok() {
            return match self.solve_inexactly(inequality, nearby) {
                Ok(solution) => solution,
                Err(in_vain) => self.take_over(inequality, nearby, in_vain),
            };
        }
        self.solve_directly(inequality, None)
    }

    /// Without factors of the matrix. The error is what was done in vain.
    fn solve_inexactly<T: Real>(
        &self,
        inequality: &Inequality<T>,
        nearby: &InitialGuess<T>,
    ) -> Result<Solution<T>, InVain> {
        if self.check_definite && check_definite(inequality).is_err() {
            return Err(InVain::default());
        }
        Inexact::new(inequality, nearby).run(self, nearby)
    }

    /// What is done where the iterative solver did not arrive: where it did not settle on nested
    /// meshes of conforming linears, multigrid that has no need to; elsewhere factors.
    fn take_over<T: Real>(
        &self,
        inequality: &Inequality<T>,
        nearby: &InitialGuess<T>,
        in_vain: InVain,
    ) -> Solution<T> {
        let InVain { mut outer, mut linear, unsettled } = in_vain;
        let mut found = None;
        let is_symmetric = inequality.symmetric;
        if unsettled.is_some()
            && is_symmetric
            && matches!(nearby.functions, CoarseSpaces::CoarseLevel(_))
        {
            let solution = MonotoneMultigrid::default().solve_from(inequality, nearby);
            if solution.outcome == Outcome::Converged {
                found = Some(solution);
            } else {
                (outer, linear) = (outer + solution.outer, linear + solution.linear);
            }
        }
        let mut solution = found.unwrap_or_else(|| self.solve_directly(inequality, unsettled));
        solution.outer += outer;
        solution.linear += linear;
        solution
    }

    /// With factors, from contact that did not settle if there is such.
    fn solve_directly<T: Real>(
        &self,
        inequality: &Inequality<T>,
        unsettled: Option<Vec<Contact>>,
    ) -> Solution<T> {
        let mut iterate = Iterate::new(inequality);
        let outcome = match (self.check(inequality), unsettled) {
            (Ok(()), None) => Search::new(self, &mut iterate).run(),
            (Ok(()), Some(contact)) => {
                iterate.state = contact;
                Search::new(self, &mut iterate).impatient().run()
            }
            (Err(outcome), _) => outcome,
        };
        iterate.into_solution(outcome)
    }
}

impl ActiveSet {
    /// What can be said before anything is solved.
    fn check<T: Real>(&self, inequality: &Inequality<T>) -> Result<(), Outcome> {
        check_input(inequality)?;
        let is_checked_by_factors = inequality.start == Start::Cold && inequality.symmetric;
        if self.check_definite && !is_checked_by_factors {
            check_definite(inequality)?;
        }
        Ok(())
    }
}

pub(crate) fn check_input<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    if !inequality.is_well_formed() {
        Err(Outcome::Malformed)
    } else if !inequality.is_finite() {
        Err(Outcome::NotFinite)
    } else if !inequality.is_feasible() {
        Err(Outcome::Infeasible)
    } else {
        Ok(())
    }
}

pub(crate) fn check_definite<T: Real>(inequality: &Inequality<T>) -> Result<(), Outcome> {
    if let Some(factored) = &inequality.factored {
        let not_given: Vec<bool> =
            inequality.bounds.iter().map(|bound| bound.only_value().is_none()).collect();
        StaticCondensation::new(factored).factor(&not_given)?;
        return Ok(());
    }
    let Inequality { matrix, symmetric, .. } = inequality;
    if is_positive_definite(matrix, *symmetric, &inequality.not_given())? {
        Ok(())
    } else {
        Err(Outcome::NotCoercive)
    }
}

impl From<FactorError> for Outcome {
    fn from(error: FactorError) -> Self {
        match error {
            FactorError::NotPositive => Outcome::NotCoercive,
            FactorError::Singular => Outcome::Singular,
            FactorError::OutOfMemory => Outcome::OutOfMemory,
        }
    }
}
