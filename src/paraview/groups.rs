//! The named groups of a mesh as arrays on its cells and boundary facets.

use std::collections::BTreeSet;

use crate::input::excerpt;
use crate::mesh::Mesh;

/// The groups of cells and of boundary facets: the name of the array of each, distinct from those that are
/// taken, and the name of the group. A group of cells and one of facets with the same name are one.
pub(super) fn array_names<const D: usize>(
    mesh: &Mesh<D>,
    mut taken: BTreeSet<String>,
) -> Vec<(String, &str)> {
    let regions = mesh.regions().iter();
    let names = regions.chain(mesh.boundary_groups().iter().map(|group| &group.names)).flatten();
    let (mut known, mut arrays) = (BTreeSet::new(), Vec::new());
    for group in names {
        if known.insert(group) {
            // the format has no control characters
            let mut name = excerpt(group);
            while name.is_empty() || !taken.insert(name.clone()) {
                name += "_group";
            }
            arrays.push((name, &group[..]));
        }
    }
    arrays
}

/// For each cell, then each boundary facet: one if it is in the group, otherwise zero.
pub(super) fn members<const D: usize>(mesh: &Mesh<D>, group: &str) -> Vec<u8> {
    let has = |names: &Vec<String>| u8::from(names.iter().any(|name| name == group));
    let regions: Vec<u8> = mesh.regions().iter().map(has).collect();
    let boundary: Vec<u8> = mesh.boundary_groups().iter().map(|g| has(&g.names)).collect();
    let cells = (0..mesh.n_cells()).map(|cell| regions[mesh.region(cell)]);
    let facets = mesh.boundary().iter().map(|facet| boundary[usize::from(facet.group)]);
    cells.chain(facets).collect()
}
