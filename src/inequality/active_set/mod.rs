//! The primal-dual active set method.
//!
//! | file | content |
//! |---|---|
//! | `settings` | [`ActiveSet`], the settings |
//! | `solver` | the choice between the direct and the inexact driver, and the fallback from the inexact to the direct one |
//! | `direct_driver` | the iteration with factors: active set steps, condensation, interior point, projected Newton |
//! | `direct_iterate` | the iterate of the direct driver: values, contact states, merit, the prediction of the active set |
//! | `inactive_system` | the linear system of the direct iterate on the inactive unknowns |
//! | `inexact_driver` | the iteration with preconditioned Krylov methods |
//! | `inexact_iterate` | the iterate of the inexact driver: values, contact states, residual |
//! | `kkt_evaluation` | residual, prediction of the active set and merit of an inexact iterate |
//! | `progress` | when an inexact iteration stagnates |
//! | `algebraic_bound` | the bound on the error of an inexact iterate |
//! | `contact_state` | the states a bound admits, the value a state prescribes |
//! | `state_history` | which active sets have occurred before |
//! | `condensation/` | the problem condensed on the unknowns of a cycle |
//! | `condensation/dense_lcp` | the solution of the condensed problem, a dense linear complementarity problem |
//! | `projected_newton` | the descent method for symmetric matrices |

mod algebraic_bound;
mod condensation;
mod contact_state;
mod direct_driver;
mod direct_iterate;
mod inactive_system;
mod inexact_driver;
mod inexact_iterate;
mod kkt_evaluation;
mod progress;
mod projected_newton;
mod settings;
mod solver;
mod state_history;

pub use settings::{ActiveSet, Globalisation};
