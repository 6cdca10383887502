//! The sections of MSH 2.2, in which the tags of an element stand before its nodes.

use super::contents::{Contents, Membership};
use super::element_types::{ElementType, element_type, simplex_dimension};
use super::error::GmshError;
use super::source::{Source, unsigned};
use super::version_four::entity_dimension;

/// The number of records of a section: text in every file, on a line of its own.
fn read_count(source: &mut Source, expected: &'static str) -> Result<u64, GmshError> {
    source.skip_blank_lines();
    let count = source.text(expected, unsigned)?;
    source.end_line()?;
    source.rest_of_line();
    Ok(count)
}

/// Reads the nodes, which may each have a geometric entity and their coordinates on it.
pub(super) fn read_nodes(
    source: &mut Source,
    contents: &mut Contents,
    is_parametric: bool,
) -> Result<(), GmshError> {
    let announced = read_count(source, "the number of nodes")?;
    source.check_room("nodes", announced, 28)?;
    contents.nodes.reserve(source.capacity(announced, 8));
    for found in 0..announced {
        source.begin_record("nodes", announced, found)?;
        let offset = source.offset();
        let node = source.unsigned("the tag of a node")?;
        let point = source.point()?;
        if is_parametric {
            let dimension = entity_dimension(source)?;
            source.integer("the tag of an entity")?;
            // in a volume the coordinates are those of space
            let coordinates = if dimension < 3 { dimension as u64 } else { 0 };
            source.skip(coordinates, 8, "a parametric coordinate")?;
        }
        source.end_record()?;
        contents.nodes.push(source, offset, node, point)?;
    }
    source.end_section("nodes", announced)
}

pub(super) fn read_elements(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    let announced = read_count(source, "the number of elements")?;
    source.check_room("elements", announced, 8)?;
    let mut found = 0;
    while found < announced {
        source.begin_record("elements", announced, found)?;
        if source.is_binary() {
            found += read_same_type(source, contents, announced, found)?;
            continue;
        }
        let offset = source.offset();
        let element = source.unsigned("the tag of an element")?;
        let of_type = element_type(source)?;
        let tags = source.unsigned("the number of tags of an element")?;
        read_element(source, contents, (&of_type, tags), (offset, element))?;
        found += 1;
    }
    source.end_section("elements", announced)
}

/// Reads the elements of one type after their common header in a binary file; returns their number.
fn read_same_type(
    source: &mut Source,
    contents: &mut Contents,
    announced: u64,
    found: u64,
) -> Result<u64, GmshError> {
    let of_type = element_type(source)?;
    let following = source.unsigned("the number of elements of one type")?;
    if following > announced - found {
        let found = format_args!("{} or more", found + following);
        return Err(source.miscounted("elements", announced, found));
    }
    let tags = source.unsigned("the number of tags of an element")?;
    let size = 4 + 4 * (tags as usize + of_type.nodes);
    source.check_room("elements of one type", following, size)?;
    for _ in 0..following {
        let offset = source.offset();
        let element = source.unsigned("the tag of an element")?;
        read_element(source, contents, (&of_type, tags), (offset, element))?;
    }
    Ok(following)
}

/// Reads the tags and nodes of an element, whose offset and tag are known.
fn read_element(
    source: &mut Source,
    contents: &mut Contents,
    (of_type, tags): (&ElementType, u64),
    (offset, element): (usize, u64),
) -> Result<(), GmshError> {
    // The first tag is the physical group, zero for none; the others tell the entity and the
    // partitions.
    let group = if tags > 0 { source.integer("the tag of a physical group")?.abs() } else { 0 };
    source.skip(tags.saturating_sub(1), 4, "a tag of an element")?;
    let dimension = simplex_dimension(source, of_type, element)?;
    let simplices = &mut contents.simplices[dimension];
    for _ in 0..=dimension {
        simplices.corners.push(source.unsigned("the tag of a node")?);
    }
    source.skip((of_type.nodes - dimension - 1) as u64, 4, "the tag of a node")?;
    source.end_record()?;
    simplices.push(offset, element, of_type.order, Membership::Group(group));
    Ok(())
}
