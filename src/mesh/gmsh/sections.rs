//! The sections of a file.
//!
//! | | MSH 2.2 | MSH 4.1 |
//! |---|---|---|
//! | tags of nodes and elements | four bytes | eight bytes |
//! | groups | one with each element | those of the entity of a block, in `$Entities` |
//! | `$Nodes` | tag and point of each | blocks: all tags, then all points |
//! | `$Elements` | text: a header for each element; binary: a header for all elements of one type | blocks with a header |

use std::collections::HashMap;

use super::contents::Contents;
use super::error::{GmshError, GmshErrorKind};
use super::source::Source;
use crate::input::excerpt;

/// The element types that are read: their numbers, dimensions and numbers of nodes, of which the corners come first.
const TYPES: [(i64, usize, usize); 7] =
    [(15, 0, 1), (1, 1, 2), (8, 1, 3), (2, 2, 3), (9, 2, 6), (4, 3, 4), (11, 3, 10)];

/// The physical groups of the entities, by dimension and tag.
type Entities = HashMap<(usize, i64), Vec<i64>>;

/// Reads a file up to its end.
pub(super) fn read_contents(bytes: Vec<u8>) -> Result<Contents, GmshError> {
    let source = &mut Source::new(&bytes);
    read_header(source)?;
    let (is_binary, lists_by_group) = (source.is_binary, !source.is_four);
    let mut contents = Contents { is_binary, lists_by_group, ..Contents::default() };
    let (mut entities, mut has_nodes, mut has_elements) = (Entities::new(), false, false);
    while let Some(name) = open_section(source)? {
        match (name, source.is_four) {
            (b"$PhysicalNames", _) => read_names(source, &mut contents)?,
            (b"$Entities", true) => entities = read_entities(source)?,
            (b"$PartitionedEntities", true) => {
                let message = "the mesh is partitioned; save it unpartitioned (in Gmsh: Mesh > Delete > Partitions, or leave out `-part`)";
                return Err(source.error(GmshErrorKind::Unsupported, message));
            }
            (b"$Nodes", true) => {
                has_nodes = true;
                read_blocks_of_nodes(source, &mut contents)?;
            }
            (b"$Nodes" | b"$ParametricNodes", false) => {
                has_nodes = true;
                read_nodes(source, &mut contents, name == b"$ParametricNodes")?;
            }
            (b"$Elements", is_four) => {
                has_elements = true;
                match is_four {
                    true => read_blocks_of_elements(source, &mut contents, &entities)?,
                    false => read_elements(source, &mut contents)?,
                }
            }
            _ => source.skip_section()?,
        }
    }
    for (present, section) in [(has_nodes, "$Nodes"), (has_elements, "$Elements")] {
        if !present {
            let message =
                format!("the file has no section {section}; save the mesh again from Gmsh");
            return Err(GmshError::new(GmshErrorKind::Damaged, message));
        }
    }
    Ok(Contents { bytes, ..contents })
}

/// Reads the line of the name of the next section; returns the name, nothing at the end of the file.
fn open_section<'a>(source: &mut Source<'a>) -> Result<Option<&'a [u8]>, GmshError> {
    source.skip_blank_lines();
    if source.is_at_end() {
        return Ok(None);
    }
    let name = source.word();
    if name.len() < 2 || name[0] != b'$' || name.starts_with(b"$End") {
        return Err(source.unexpected_word("the beginning of a section after its end", name));
    }
    source.section = String::from_utf8_lossy(name).into_owned();
    source.end_line()?;
    Ok(Some(name))
}

/// Reads `$MeshFormat`: version and encoding.
fn read_header(source: &mut Source) -> Result<(), GmshError> {
    source.skip_blank_lines();
    let mut word = source.word();
    while word == b"$Comments" {
        source.section = "$Comments".into();
        source.skip_section()?;
        source.skip_blank_lines();
        word = source.word();
    }
    if word != b"$MeshFormat" {
        let message = format!(
            "not a Gmsh mesh: the file begins with `{}` where `$MeshFormat` is expected; save the mesh from Gmsh as .msh",
            excerpt(word)
        );
        return Err(GmshError::new(GmshErrorKind::NotGmsh, message));
    }
    source.section = "$MeshFormat".into();
    source.skip_blank_lines();
    match source.word() {
        b"4.1" => source.is_four = true,
        b"2.2" => {}
        word => {
            let message = format!(
                "MSH version `{}` is not read, only 4.1 and 2.2 are; save again from Gmsh with `-format msh41` or `-format msh22`",
                excerpt(word)
            );
            return Err(source.error(GmshErrorKind::Unsupported, &message));
        }
    }
    let file_type: u64 = source.text("the file type, 0 for text or 1 for binary")?;
    let data_size: u64 = source.text("the size of numbers in bytes, 8")?;
    if data_size != 8 {
        let message = format!(
            "numbers of {data_size} bytes are not read, only of 8; save again from a 64-bit Gmsh"
        );
        return Err(source.error(GmshErrorKind::Unsupported, &message));
    }
    source.end_line()?;
    match file_type {
        0 => {}
        1 => source.read_byte_order()?,
        other => return Err(source.unexpected("file type 0 (text) or 1 (binary)", other)),
    }
    source.end_section()
}

/// Reads the names of the physical groups, which are text also in binary files.
fn read_names(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    for _ in 0..source.line_of_count("the number of physical names")? {
        source.skip_blank_lines();
        let dimension = match source.word() {
            [digit @ b'0'..=b'3'] => usize::from(digit - b'0'),
            word => {
                let expected = "the dimension of a physical group, 0 to 3";
                return Err(source.unexpected_word(expected, word));
            }
        };
        let tag = source.text("the tag of a physical group")?;
        let line = source.rest_of_line().trim_ascii();
        let name = line.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
        let name = name.ok_or_else(|| source.unexpected_word("a name in double quotes", line))?;
        contents.groups.insert((dimension, tag), String::from_utf8_lossy(name).into_owned());
    }
    source.end_section()
}

/// Reads which physical groups the entities belong to; the rest of `$Entities` is geometry.
fn read_entities(source: &mut Source) -> Result<Entities, GmshError> {
    source.record("the numbers of entities")?;
    let mut entities = Entities::new();
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = source.count("the number of entities of a dimension")?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            source.record("an entity")?;
            let entity = source.integer("the tag of an entity")?;
            // a point has coordinates, every other entity a box and a list of bounding entities
            source.skip(if dimension == 0 { 3 } else { 6 }, 8, "a coordinate of an entity")?;
            let mut groups = Vec::new();
            for _ in 0..source.count("the number of physical groups of an entity")? {
                // the sign is an orientation
                groups.push(source.integer("the tag of a physical group")?.saturating_abs());
            }
            if dimension > 0 {
                let bounding = source.count("the number of bounding entities")?;
                source.skip(bounding, 4, "the tag of a bounding entity")?;
            }
            entities.insert((dimension, entity), groups);
        }
    }
    source.end_section()?;
    Ok(entities)
}

/// The number of blocks at the beginning of a section of MSH 4.1.
fn read_number_of_blocks(source: &mut Source) -> Result<u64, GmshError> {
    source.record("the number of blocks")?;
    let blocks = source.count("the number of blocks")?;
    source.skip(3, 8, "the number of records and the range of their tags")?;
    Ok(blocks)
}

fn read_dimension(source: &mut Source) -> Result<usize, GmshError> {
    let expected = "the dimension of an entity, 0 to 3";
    match source.integer(expected)? {
        dimension @ 0..=3 => Ok(dimension as usize),
        other => Err(source.unexpected(expected, other)),
    }
}

fn read_blocks_of_nodes(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    for _ in 0..read_number_of_blocks(source)? {
        source.record("a block of nodes")?;
        let dimension = read_dimension(source)?;
        source.integer("the tag of an entity")?;
        let is_parametric = source.integer("0 or 1 for parametric coordinates")? != 0;
        let parameters = if is_parametric { dimension as u64 } else { 0 };
        let first = contents.nodes.tags.len();
        for _ in 0..source.count("the number of nodes of a block")? {
            source.record("the tag of a node")?;
            contents.nodes.tags.push(source.tag("the tag of a node")?);
        }
        for k in first..contents.nodes.tags.len() {
            source.record("the coordinates of a node")?;
            contents.nodes.offsets.push(source.offset());
            contents.nodes.points.push(source.point(contents.nodes.tags[k])?);
            source.skip(parameters, 8, "a parametric coordinate")?;
        }
    }
    source.end_section()
}

/// Reads the nodes of MSH 2.2, which may each have a geometric entity and their coordinates on it.
fn read_nodes(
    source: &mut Source,
    contents: &mut Contents,
    is_parametric: bool,
) -> Result<(), GmshError> {
    for _ in 0..source.line_of_count("the number of nodes")? {
        source.record("a node")?;
        contents.nodes.offsets.push(source.offset());
        let node = source.tag("the tag of a node")?;
        contents.nodes.tags.push(node);
        contents.nodes.points.push(source.point(node)?);
        if is_parametric {
            let dimension = read_dimension(source)?;
            source.integer("the tag of an entity")?;
            // in a volume the coordinates are those of space
            let parameters = if dimension < 3 { dimension as u64 } else { 0 };
            source.skip(parameters, 8, "a parametric coordinate")?;
        }
    }
    source.end_section()
}

fn read_blocks_of_elements(
    source: &mut Source,
    contents: &mut Contents,
    entities: &Entities,
) -> Result<(), GmshError> {
    for _ in 0..read_number_of_blocks(source)? {
        source.record("a block of elements")?;
        let dimension = read_dimension(source)?;
        let entity = source.integer("the tag of an entity")?;
        let of_type = read_type(source)?;
        // an entity that the file does not list is in no group
        let groups = entities.get(&(dimension, entity)).map_or(&[][..], Vec::as_slice);
        for _ in 0..source.count("the number of elements of a block")? {
            source.record("an element")?;
            let element = (source.offset(), source.tag("the tag of an element")?);
            read_element(source, contents, (of_type, element), groups)?;
        }
    }
    source.end_section()
}

/// Reads the elements of MSH 2.2. The tag of an element stands before its header in text, after that of all of one type
/// in binary files.
fn read_elements(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    let announced = source.line_of_count("the number of elements")?;
    let mut found = 0_u64;
    while found < announced {
        source.record("an element")?;
        let read_tag = |source: &mut Source| {
            Ok::<_, GmshError>((source.offset(), source.tag("the tag of an element")?))
        };
        let first = if source.is_binary { None } else { Some(read_tag(source)?) };
        let of_type = read_type(source)?;
        let count = match first {
            Some(_) => 1,
            None => source.tag("the number of elements of one type")?,
        };
        let tags = source.tag("the number of tags of an element")?;
        for _ in 0..count {
            let element = first.map_or_else(|| read_tag(source), Ok)?;
            // the first tag is the physical group, zero for none; the others tell the entity and the partitions
            let group = if tags > 0 {
                source.integer("the tag of a physical group")?.saturating_abs()
            } else {
                0
            };
            source.skip(tags.saturating_sub(1), 4, "a tag of an element")?;
            let groups = if group == 0 { &[][..] } else { &[group] };
            read_element(source, contents, (of_type, element), groups)?;
        }
        found = found.saturating_add(count);
    }
    source.end_section()
}

/// Reads the number of an element type; returns its dimension and number of nodes.
fn read_type(source: &mut Source) -> Result<(usize, usize), GmshError> {
    let number = source.integer("the type of an element")?;
    let found = TYPES.iter().find(|(known, ..)| *known == number);
    found.map(|(_, dimension, nodes)| (*dimension, *nodes)).ok_or_else(|| {
        let message = format!(
            "elements of type {number} are not read, only points, lines, triangles and tetrahedra of order one and two; mesh again with `Mesh.ElementOrder = 1` and without `Recombine`, `Mesh.RecombineAll` and `Mesh.SubdivisionAlgorithm`"
        );
        source.error(GmshErrorKind::Unsupported, &message)
    })
}

/// Reads the nodes of an element, whose offset and tag are known.
fn read_element(
    source: &mut Source,
    contents: &mut Contents,
    ((dimension, nodes), element): ((usize, usize), (usize, u64)),
    groups: &[i64],
) -> Result<(), GmshError> {
    let simplices = &mut contents.simplices[dimension];
    for _ in 0..=dimension {
        simplices.corners.push(source.tag("the tag of a node")?);
    }
    let others = nodes - dimension - 1;
    source.skip_tags(others)?;
    simplices.curved += usize::from(others > 0);
    simplices.push(element, groups);
    Ok(())
}
