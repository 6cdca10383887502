//! Loops over unknowns that cells share, each with the places at which cells have it.

use super::unknowns::{CellUnknowns, with_constant_count};
use crate::assemble::space::dofs::{Dofs, KINDS};
use crate::mesh::incidence::{Incidence, partition};
use crate::parallel::{map_items, split};

/// Calls `work` with the value of each unknown and each place of the unknown, a cell and the number of the unknown in
/// it, by ascending cells, in parallel over unknowns.
///
/// # Errors
/// The error at the first place for which `work` fails.
pub(crate) fn for_each_place<const D: usize, V: Send, E: Send>(
    dofs: &Dofs<'_>,
    values: &mut [V],
    work: impl Fn(&mut V, (usize, usize)) -> Result<(), E> + Sync,
) -> Result<(), E> {
    with_constant_count!(D, dofs, N => visit_places::<D, N, V, E>(dofs, values, &work))
}

/// As [`for_each_place`], for cells of `N` unknowns.
fn visit_places<const D: usize, const N: usize, V: Send, E: Send>(
    dofs: &Dofs<'_>,
    values: &mut [V],
    work: &(impl Fn(&mut V, (usize, usize)) -> Result<(), E> + Sync),
) -> Result<(), E> {
    let table = dofs.table().expect("unknowns that cells share have a table");
    let incidence = Incidence::<_, KINDS>::new(table, CellUnknowns::<D, N>::new(dofs));
    let subsets = partition(dofs.kinds());
    // the values of each subset, by kinds of owners
    let mut values_of: Vec<Vec<&mut [V]>> = subsets.iter().map(|_| Vec::new()).collect();
    let lengths = (0..KINDS).flat_map(|kind| subsets.iter().map(move |rows| rows[kind].len()));
    for (k, part) in split(values, lengths).enumerate() {
        values_of[k % subsets.len()].push(part);
    }
    let failed = map_items(values_of, &|k, mut values| {
        let mut failed = None;
        incidence.visit(&subsets[k], |kind, number, place| {
            if failed.is_none()
                && let Err(error) = work(&mut values[kind][number], place)
            {
                failed = Some((place, error));
            }
        });
        failed
    });
    match failed.into_iter().flatten().min_by_key(|(place, _)| *place) {
        Some((_, error)) => Err(error),
        None => Ok(()),
    }
}
