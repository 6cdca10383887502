//! The sections of MSH 2.2, in which the tags of an element stand before its nodes.

use super::contents::{Contents, Membership, simplex_dimension, type_properties};
use super::element_types::TypeProperties;
use super::error::GmshError;
use super::source::Source;
use super::version_four::entity_dimension;

/// The number of records of a section: text in every file, on a line of its own.
fn read_count(source: &mut Source, expected: &'static str) -> Result<u64, GmshError> {
    source.skip_blank_lines();
    let count = source.text_count(expected)?;
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
        let mark = source.mark();
        let node = source.unsigned("the tag of a node")?;
        let point = [
            source.real("coordinate x")?,
            source.real("coordinate y")?,
            source.real("coordinate z")?,
        ];
        if is_parametric {
            let dimension = entity_dimension(source)?;
            source.integer("the tag of an entity")?;
            // in a volume the coordinates are those of space
            let coordinates = if dimension < 3 { dimension as u64 } else { 0 };
            source.skip(coordinates, 8, "a parametric coordinate")?;
        }
        source.end_record()?;
        contents.nodes.push(source, mark, node, point)?;
    }
    source.end_section("nodes", announced)
}

/// Reads the elements.
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
        let mark = source.mark();
        let element = source.unsigned("the tag of an element")?;
        let element_type = source.integer("the type of an element")?;
        let properties = type_properties(source, element_type)?;
        let tags = source.unsigned("the number of tags of an element")?;
        read_element(
            source,
            contents,
            &ElementHeader { mark, element, element_type, properties, tags },
        )?;
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
    let element_type = source.integer("the type of elements")?;
    let properties = type_properties(source, element_type)?;
    let following = source.unsigned("the number of elements of one type")?;
    if following > announced - found {
        return Err(source.miscounted(
            "elements",
            announced,
            format!("{} or more", found + following),
        ));
    }
    let tags = source.unsigned("the number of tags of an element")?;
    source.check_room(
        "elements of one type",
        following,
        4 + 4 * (tags as usize + properties.nodes),
    )?;
    for _ in 0..following {
        let mark = source.mark();
        let element = source.unsigned("the tag of an element")?;
        read_element(
            source,
            contents,
            &ElementHeader { mark, element, element_type, properties, tags },
        )?;
    }
    Ok(following)
}

/// The numbers before the tags and nodes of an element.
struct ElementHeader {
    mark: usize,
    element: u64,
    element_type: i64,
    properties: TypeProperties,
    tags: u64,
}

/// The tags and nodes of an element.
fn read_element(
    source: &mut Source,
    contents: &mut Contents,
    header: &ElementHeader,
) -> Result<(), GmshError> {
    // The first tag is the physical group, zero for none; the others tell the entity and the
    // partitions.
    let group =
        if header.tags > 0 { source.integer("the tag of a physical group")?.abs() } else { 0 };
    source.skip(header.tags.saturating_sub(1), 4, "a tag of an element")?;
    let ElementHeader { properties, element_type, element, .. } = *header;
    let dimension = simplex_dimension(source, properties.shape, element_type, element)?;
    let simplices = &mut contents.simplices[dimension];
    for _ in 0..=dimension {
        simplices.corners.push(source.unsigned("the tag of a node")?);
    }
    source.skip((properties.nodes - dimension - 1) as u64, 4, "the tag of a node")?;
    source.end_record()?;
    simplices.push(header.mark, element, properties.order, Membership::Group(group));
    Ok(())
}
