//! Errors of discrete solutions: orders, figures of other programs, exact cases.

mod family;
mod meshes;
mod orders;
mod own_sets;
mod patch;
mod precision;
mod quadratic;
mod reference;
mod unstructured;
