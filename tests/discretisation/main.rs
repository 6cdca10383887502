//! Matrices and loads of discretisations, and the accuracy of their solutions.

mod absent_terms;
mod accuracy;
mod adaptive;
mod constants;
mod contact_forces;
mod discrete_functions;
mod eigenvalues;
mod elements;
mod error_bounds;
mod error_bounds_constants;
mod error_bounds_contact;
mod error_bounds_discrete;
mod error_bounds_facets;
mod error_bounds_fluxes;
mod error_bounds_guarantee;
mod error_bounds_quadratics;
mod forms;
mod friction;
mod gradients;
mod matrices;
mod named_data;
mod observed_orders;
mod parts;
mod problems;
mod robin;
mod runs;
mod shapes;
mod tensors;
mod unknowns;

#[path = "../support"]
mod support {
    pub mod checks;
    pub mod meshes;
    pub mod panics;
    pub mod rows;
    pub mod scheme_lists;
    pub mod schemes;
    pub mod tables;
    pub mod tolerances;
}
