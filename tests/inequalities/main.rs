//! Solvers of the algebraic inequality against slow solvers, their iteration counts and failures.

mod algebraic_error;
mod contact_sets;
mod contact_states;
mod double_precision;
mod exact_reference;
mod factors_or_krylov;
mod history;
mod iterations;
mod iterative;
mod krylov;
mod load;
mod monotone_multigrid;
mod nonsymmetric;
mod own_preconditioner;
mod penalised_cells;
mod preconditioners;
mod predictions;
mod problems;
mod proximal;
mod recession;
mod rounded_data;
mod solvers;
mod transpose;

#[path = "../support"]
mod support {
    pub mod checks;
    pub mod panics;
    pub mod rows;
    pub mod scheme_lists;
    pub mod schemes;
}
