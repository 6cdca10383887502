//! Names of regions and boundary groups that a mesh does not have.

use crate::input::{excerpt, excerpts};
use crate::mesh::Mesh;

/// The sentence for a name that is not among those of a kind which a mesh has.
pub(super) fn unknown<'n>(
    kind: &str,
    name: &str,
    known: impl Iterator<Item = &'n String>,
) -> String {
    let known = match &excerpts(known)[..] {
        "" => "it has none with a name".to_owned(),
        known => format!("it has {known}"),
    };
    format!("the mesh has no {kind} `{}`; {known}", excerpt(name))
}

/// Why a mesh has no region, or no boundary group, of this name, in a sentence, if it has none.
pub(crate) fn unknown_name<const D: usize>(
    mesh: &Mesh<D>,
    name: &str,
    is_boundary: bool,
) -> Option<String> {
    let is_name = |other: &&String| *other == name;
    let groups = mesh.boundary_groups().iter().flat_map(|group| &group.names);
    if is_boundary {
        let is_inside = mesh.groups_inside().iter().any(|other| other == name);
        return (!groups.clone().any(|other| is_name(&other))).then(|| match is_inside {
            true => format!(
                "`{}` lies inside the domain, between two cells: data are given on the boundary only, where the mesh has {}",
                excerpt(name),
                excerpts(groups)
            ),
            false => unknown("boundary group", name, groups),
        });
    }
    let regions = mesh.regions().iter().flatten();
    (!regions.clone().any(|other| is_name(&other))).then(|| unknown("region", name, regions))
}
