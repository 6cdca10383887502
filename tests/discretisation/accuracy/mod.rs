//! Errors of discrete solutions: orders, figures of other programs, exact cases.

mod axis;
mod coefficient;
mod contact;
mod cut_cells;
mod family;
mod loads;
mod meshes;
mod orders;
mod own_sets;
mod patch;
mod precision;
mod quadratic;
mod reference;
mod unstructured;
