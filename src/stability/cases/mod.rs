//! The cases of the stability study, one file each; [`CASES`] lists them in the order of reports.

mod biactive;
mod coercivity;
mod condition_numbers;
mod constant;
mod contact_ends;
mod contrast;
mod curved_obstacle;
mod graded_meshes;
mod orders;
mod penalty_factor;
mod round_off;
mod scaling;
mod slivers;
mod stretched_cells;

use super::case::{Case, Criterion};

/// All cases.
pub(crate) const CASES: [Case; 13] = [
    round_off::CASE,
    penalty_factor::CASE,
    stretched_cells::CASE,
    graded_meshes::CASE,
    contrast::CASE,
    coercivity::CASE,
    curved_obstacle::CASE,
    biactive::CASE,
    scaling::CASE,
    constant::CASE,
    contact_ends::CASE,
    orders::CASE,
    slivers::CASE,
];

/// Names of the cases.
pub const STABILITY_CASES: [&str; CASES.len()] = {
    let mut names = [""; CASES.len()];
    let mut k = 0;
    while k < names.len() {
        names[k] = CASES[k].name;
        k += 1;
    }
    names
};

/// All criteria, each with the name of its case, in the order of reports.
pub fn criteria() -> impl Iterator<Item = (&'static str, &'static Criterion)> {
    CASES.into_iter().flat_map(|case| case.criteria.iter().map(move |c| (case.name, c)))
}
