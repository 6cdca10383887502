//! The primal-dual active set method.
//!
//! | file | content |
//! |---|---|
//! | `settings` | [`ActiveSet`], the settings |
//! | `solver` | the method as a solver, [`Preconditioned`] |
//! | `ladder` | the solve: the methods in their order, and the run of each |
//! | `iteration` | the active set iteration, for every linear solver |
//! | `iterate` | values, contact states and residual of a step, and the best values |
//! | `evaluation` | violations, merit and prediction of the next active set |
//! | `cell_inequality` | prediction of the active set of a cell under a penalty on jumps of means |
//! | `local_inequality` | the inequality near unknowns whose states keep changing |
//! | `progress` | cycles and stagnation of the active set, accuracy of linear solutions |
//! | `linear_solver` | the trait of solvers of the linear systems |
//! | `direct_solver` | systems of active sets by factors |
//! | `preconditioned_solver` | preconditioned Krylov methods |
//! | `contact_state` | the contact states that a bound admits, the value that a state prescribes |

mod cell_inequality;
mod contact_state;
mod direct_solver;
mod evaluation;
mod iterate;
mod iteration;
mod ladder;
mod linear_solver;
mod local_inequality;
mod preconditioned_solver;
mod progress;
mod settings;
mod solver;

pub(super) use contact_state::prescribed_value;
pub use settings::ActiveSet;
pub use solver::Preconditioned;
