//! The sections of MSH 4.1, in which nodes and elements form blocks, one for each entity.

use super::contents::{Contents, Membership};
use super::element_types::{element_type, simplex_dimension};
use super::error::GmshError;
use super::source::Source;

/// Reads which physical groups the entities belong to; the rest of `$Entities` is geometry.
pub(super) fn read_entities(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    if !source.is_binary() {
        source.skip_blank_lines();
    }
    let mut announced = [0; 4];
    for (count, expected) in announced.iter_mut().zip([
        "the number of points",
        "the number of curves",
        "the number of surfaces",
        "the number of volumes",
    ]) {
        *count = source.count(expected)?;
    }
    source.end_record()?;
    let what = ["points", "curves", "surfaces", "volumes"];
    for (dimension, &count) in announced.iter().enumerate() {
        // A point has coordinates, every other entity a box and a list of bounding entities.
        let reals = if dimension == 0 { 3 } else { 6 };
        source.check_room(what[dimension], count, 4 + 8 * reals as usize + 8)?;
        for found in 0..count {
            source.begin_record(what[dimension], count, found)?;
            let entity = source.integer("the tag of an entity")?;
            source.skip(reals, 8, "a coordinate of an entity")?;
            let groups = source.count("the number of physical groups of an entity")?;
            source.check_room("physical groups", groups, 4)?;
            let mut tags = Vec::new();
            for _ in 0..groups {
                // The sign is an orientation.
                tags.push(source.integer("the tag of a physical group")?.abs());
            }
            if dimension > 0 {
                let bounding = source.count("the number of bounding entities")?;
                source.check_room("bounding entities", bounding, 4)?;
                source.skip(bounding, 4, "the tag of a bounding entity")?;
            }
            source.end_record()?;
            contents.entities.insert((dimension, entity), tags);
        }
    }
    source.end_section(
        "entities",
        announced.iter().fold(0, |sum: u64, &count| sum.saturating_add(count)),
    )
}

/// The four numbers at the beginning of `$Nodes` and `$Elements`: of blocks, and of records in all.
fn read_counts(source: &mut Source) -> Result<(u64, u64), GmshError> {
    if !source.is_binary() {
        source.skip_blank_lines();
    }
    let blocks = source.count("the number of blocks")?;
    let records = source.count("the number of records in all blocks")?;
    source.skip(2, 8, "the smallest and the largest tag")?;
    source.end_record()?;
    Ok((blocks, records))
}

pub(super) fn read_nodes(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    let (blocks, announced) = read_counts(source)?;
    source.check_room("nodes", announced, 32)?;
    contents.nodes.reserve(source.capacity(announced, 8));
    let mut total = 0u64;
    for block in 0..blocks {
        source.begin_record("blocks of nodes", blocks, block)?;
        let dimension = entity_dimension(source)?;
        source.integer("the tag of an entity")?;
        let parametric = match source.integer("0 or 1 for parametric coordinates")? {
            0 => 0,
            1 => dimension as u64,
            other => {
                return Err(source.unexpected("0 or 1 for parametric coordinates", other));
            }
        };
        let count = source.count("the number of nodes of a block")?;
        source.end_record()?;
        source.check_room("nodes of a block", count, 32 + 8 * parametric as usize)?;
        total = total.saturating_add(count);
        if total > announced {
            return Err(source.miscounted("nodes", announced, format_args!("{total} or more")));
        }
        let mut tags = Vec::with_capacity(source.capacity(count, 2));
        for found in 0..count {
            source.begin_record("nodes of a block", count, found)?;
            tags.push(source.count("the tag of a node")?);
        }
        source.end_record()?;
        for (node, found) in tags.into_iter().zip(0..) {
            source.begin_record("nodes of a block", count, found)?;
            let offset = source.offset();
            let point = source.point()?;
            source.skip(parametric, 8, "a parametric coordinate")?;
            source.end_record()?;
            contents.nodes.push(source, offset, node, point)?;
        }
    }
    if total != announced {
        return Err(source.miscounted("nodes", announced, total));
    }
    source.end_section("nodes", announced)
}

pub(super) fn read_elements(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    let (blocks, announced) = read_counts(source)?;
    source.check_room("elements", announced, 16)?;
    let mut total = 0u64;
    for block in 0..blocks {
        source.begin_record("blocks of elements", blocks, block)?;
        let dimension = entity_dimension(source)?;
        let entity = source.integer("the tag of an entity")?;
        let of_type = element_type(source)?;
        let count = source.count("the number of elements of a block")?;
        source.end_record()?;
        total = total.saturating_add(count);
        if total > announced {
            return Err(source.miscounted("elements", announced, format_args!("{total} or more")));
        }
        source.check_room("elements of a block", count, 8 + 8 * of_type.nodes)?;
        for found in 0..count {
            source.begin_record("elements of a block", count, found)?;
            let offset = source.offset();
            let element = source.count("the tag of an element")?;
            let simplex = simplex_dimension(source, &of_type, element)?;
            if simplex != dimension {
                let expected = format!("elements of dimension {dimension}");
                let found =
                    format_args!("elements of type {}, a {}", of_type.number, of_type.shape.name());
                return Err(source.unexpected(&expected, found));
            }
            let simplices = &mut contents.simplices[simplex];
            if found == 0 {
                simplices.reserve(source.capacity(count, 2 * simplex + 4), simplex + 1);
            }
            for _ in 0..=simplex {
                simplices.corners.push(source.count("the tag of a node")?);
            }
            source.skip((of_type.nodes - simplex - 1) as u64, 8, "the tag of a node")?;
            source.end_record()?;
            simplices.push(offset, element, of_type.order, Membership::Entity(entity));
        }
    }
    if total != announced {
        return Err(source.miscounted("elements", announced, total));
    }
    source.end_section("elements", announced)
}

pub(super) fn entity_dimension(source: &mut Source) -> Result<usize, GmshError> {
    let expected = "the dimension of an entity, 0 to 3";
    match source.integer(expected)? {
        dimension @ 0..=3 => Ok(dimension as usize),
        other => Err(source.unexpected(expected, other)),
    }
}
