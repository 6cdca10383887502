//! The header of a file and the sections that follow.

use super::contents::Contents;
use super::error::{GmshError, GmshErrorKind};
use super::source::{Source, integer, unsigned};
use super::{version_four, version_two};
use crate::input::excerpt;

/// The revisions of the format that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

/// Reads a file up to its end.
pub(super) fn read_contents(bytes: Vec<u8>) -> Result<Contents, GmshError> {
    let mut source = Source::new(&bytes);
    let version = read_header(&mut source)?;
    let mut contents = Contents { is_binary: source.is_binary(), ..Contents::default() };
    let (mut has_nodes, mut has_elements) = (false, false);
    while let Some(name) = open_section(&mut source)? {
        match (name, version) {
            (b"$PhysicalNames", _) => read_names(&mut source, &mut contents)?,
            (b"$Entities", Version::Four) => {
                version_four::read_entities(&mut source, &mut contents)?;
            }
            (b"$PartitionedEntities", Version::Four) => {
                let message = "the mesh is partitioned; save it unpartitioned (in Gmsh: Mesh > Delete > Partitions, or leave out `-part`)";
                return Err(source.error(GmshErrorKind::Partitioned, message));
            }
            (b"$Periodic", _) => {
                contents.is_periodic = true;
                source.skip_section()?;
            }
            (b"$Nodes", Version::Four) => {
                has_nodes = true;
                version_four::read_nodes(&mut source, &mut contents)?;
            }
            (b"$Nodes" | b"$ParametricNodes", Version::Two) => {
                has_nodes = true;
                let is_parametric = name == b"$ParametricNodes";
                version_two::read_nodes(&mut source, &mut contents, is_parametric)?;
            }
            (b"$Elements", version) => {
                has_elements = true;
                match version {
                    Version::Four => version_four::read_elements(&mut source, &mut contents)?,
                    Version::Two => version_two::read_elements(&mut source, &mut contents)?,
                }
            }
            _ => source.skip_section()?,
        }
    }
    for (present, section) in [(has_nodes, "$Nodes"), (has_elements, "$Elements")] {
        if !present {
            let message =
                format!("the file has no section {section}; save the mesh again from Gmsh");
            return Err(GmshError::new(GmshErrorKind::MissingSection, message));
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
    source.section = format!("after {}", source.section);
    let name = source.word();
    if name.len() < 2 || name[0] != b'$' || name.starts_with(b"$End") {
        return Err(source.unexpected_word("the beginning of a section", name));
    }
    source.section = String::from_utf8_lossy(name).into_owned();
    source.end_line()?;
    source.rest_of_line();
    Ok(Some(name))
}

/// Reads `$MeshFormat`: version and encoding.
fn read_header(source: &mut Source) -> Result<Version, GmshError> {
    loop {
        source.skip_blank_lines();
        let found = match source.word() {
            b"$MeshFormat" => break,
            // Comments may come first.
            b"$Comments" => {
                source.section = "$Comments".into();
                source.skip_section()?;
                continue;
            }
            b"$NOD" => return Err(unsupported_version(source, "1")),
            b"" => "the end of the file".to_owned(),
            word => format!("`{}`", excerpt(word)),
        };
        let message = format!(
            "not a Gmsh mesh: the file begins with {found} where `$MeshFormat` is expected; save the mesh from Gmsh as .msh"
        );
        return Err(GmshError::new(GmshErrorKind::NotGmsh, message));
    }
    source.section = "$MeshFormat".into();
    source.skip_blank_lines();
    let version = match source.word() {
        b"4.1" => Version::Four,
        b"2.2" => Version::Two,
        b"" => return Err(source.truncated()),
        word => {
            let is_number = std::str::from_utf8(word).is_ok_and(|text| text.parse::<f64>().is_ok());
            return Err(match is_number {
                true => unsupported_version(source, &excerpt(word)),
                false => source.not_a_number("the version of the format", word),
            });
        }
    };
    let file_type = source.text("the file type, 0 for text or 1 for binary", integer)?;
    let data_size = source.text("the size of numbers in bytes, 8", unsigned)?;
    if data_size != 8 {
        let message = format!(
            "numbers of {data_size} bytes are not read, only of 8; save again from a 64-bit Gmsh"
        );
        return Err(source.error(GmshErrorKind::UnsupportedDataSize, message));
    }
    source.end_line()?;
    match file_type {
        0 => {}
        1 => {
            source.rest_of_line();
            source.read_byte_order()?;
        }
        other => return Err(source.unexpected("file type 0 (text) or 1 (binary)", other)),
    }
    source.end_section("lines", 1)?;
    Ok(version)
}

fn unsupported_version(source: &Source, version: &str) -> GmshError {
    let message = format!(
        "MSH version {version} is not read, only 4.1 and 2.2 are; save again from Gmsh with `-format msh41` or `-format msh22`"
    );
    source.error(GmshErrorKind::UnsupportedVersion, message)
}

/// Reads the names of the physical groups, which are text also in binary files.
fn read_names(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    source.skip_blank_lines();
    let announced = source.text("the number of physical names", unsigned)?;
    source.end_line()?;
    for found in 0..announced {
        source.skip_blank_lines();
        let dimension = match source.word() {
            b"" => return Err(source.truncated()),
            word @ [b'$', ..] if word.starts_with(b"$End") => {
                return Err(source.miscounted("physical names", announced, found));
            }
            [digit @ b'0'..=b'3'] => usize::from(digit - b'0'),
            word => {
                let expected = "the dimension of a physical group, 0 to 3";
                return Err(source.unexpected_word(expected, word));
            }
        };
        let tag = source.text("the tag of a physical group", integer)?;
        let line = source.rest_of_line().trim_ascii();
        let name = line.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
        let name = name.ok_or_else(|| source.unexpected_word("a name in double quotes", line))?;
        let name = String::from_utf8_lossy(name).into_owned();
        contents.groups.insert((dimension, tag), name);
    }
    source.end_section("physical names", announced)
}
