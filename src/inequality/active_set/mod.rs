//! The primal-dual active set method.
//!
//! | file | content |
//! |---|---|
//! | `settings` | [`ActiveSet`], the settings |
//! | `solver` | the method as a solver, [`Preconditioned`] |
//! | `strategy` | the stages of a solve in their order, with all thresholds |
//! | `solve/` | the solve by the stages of `strategy`, the run of each stage |
//! | `iteration` | the active set iteration, for every linear solver |
//! | `iterate` | values, contact states and residual of a step, and the best values |
//! | `evaluation` | violations, merit and prediction of the next active set |
//! | `small_violations` | violations below the tolerance that are not small in energy because of large penalties |
//! | `local_inequality` | the inequality near unknowns whose states keep changing |
//! | `progress` | cycles and stagnation of the active set, accuracy of linear solutions |
//! | `linear_solver` | the trait of solvers of the linear systems |
//! | `direct_solver` | factors of the assembled matrix, static condensation of a penalised one |
//! | `preconditioned_solver` | preconditioned Krylov methods |
//! | `algebraic_bound` | the bound on the error after a Krylov method |
//! | `contact_state` | the contact states that a bound admits, the value that a state prescribes |

mod algebraic_bound;
mod contact_state;
mod direct_solver;
mod evaluation;
mod iterate;
mod iteration;
mod linear_solver;
mod local_inequality;
mod preconditioned_solver;
mod progress;
mod settings;
mod small_violations;
mod solve;
mod solver;
mod strategy;

pub use settings::{ActiveSet, Globalisation};
pub use solver::Preconditioned;
