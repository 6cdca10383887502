//! The header of a file and the sections that follow.

use super::contents::Contents;
use super::error::GmshError;
use super::position::FilePosition;
use super::source::Source;
use super::{version_four, version_two};
use crate::input::excerpt;

/// The revisions of the format that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

/// The sections to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    Everything,
    /// Only the elements, which determine the dimension.
    Elements,
}

/// Reads a file up to its end.
pub(super) fn read_contents(bytes: &[u8], wanted: Wanted) -> Result<Contents, GmshError> {
    let mut source = Source::new(bytes);
    let version = read_header(&mut source)?;
    let mut contents = Contents::new();
    contents.binary = source.is_binary();
    let (mut has_nodes, mut has_elements) = (false, false);
    while let Some((name, position)) = open_section(&mut source)? {
        let wants_all = wanted == Wanted::Everything;
        match (name, version) {
            (b"$PhysicalNames", _) => read_names(&mut source, &mut contents)?,
            (b"$Entities", Version::Four) if wants_all => {
                version_four::read_entities(&mut source, &mut contents)?;
            }
            (b"$PartitionedEntities", Version::Four) => {
                return Err(GmshError::Partitioned { position });
            }
            (b"$Periodic", _) => {
                contents.is_periodic = true;
                source.skip_section()?;
            }
            (b"$Nodes", _) | (b"$ParametricNodes", Version::Two) => {
                has_nodes = true;
                match version {
                    _ if !wants_all => source.skip_section()?,
                    Version::Four => version_four::read_nodes(&mut source, &mut contents)?,
                    Version::Two => {
                        let is_parametric = name == b"$ParametricNodes";
                        version_two::read_nodes(&mut source, &mut contents, is_parametric)?;
                    }
                }
            }
            (b"$Elements", _) => {
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
            return Err(GmshError::MissingSection { section });
        }
    }
    Ok(contents)
}

/// Reads the line of the name of the next section; returns the name and its position, nothing at the
/// end of the file.
fn open_section<'a>(
    source: &mut Source<'a>,
) -> Result<Option<(&'a [u8], FilePosition)>, GmshError> {
    source.skip_blank_lines();
    if source.remaining() == 0 {
        return Ok(None);
    }
    if !source.section.is_empty() && !source.section.starts_with("after ") {
        source.section = format!("after {}", source.section);
    }
    let name = source.word();
    let position = source.position();
    if name.len() < 2 || name[0] != b'$' || name.starts_with(b"$End") {
        return Err(source.unexpected("the beginning of a section", format!("`{}`", excerpt(name))));
    }
    source.section = String::from_utf8_lossy(name).into_owned();
    source.end_line()?;
    source.rest_of_line();
    Ok(Some((name, position)))
}

/// Reads `$MeshFormat`: version and encoding.
fn read_header(source: &mut Source) -> Result<Version, GmshError> {
    loop {
        source.skip_blank_lines();
        let position = source.position();
        match source.word() {
            b"$MeshFormat" => break,
            // Comments may come first.
            b"$Comments" => {
                source.section = "$Comments".into();
                source.skip_section()?;
            }
            b"$NOD" => {
                return Err(GmshError::UnsupportedVersion { position, version: "1".into() });
            }
            b"" => {
                return Err(GmshError::NotGmsh { found: "the end of the file".into() });
            }
            word => {
                return Err(GmshError::NotGmsh { found: format!("`{}`", excerpt(word)) });
            }
        }
    }
    source.section = "$MeshFormat".into();
    source.skip_blank_lines();
    let position = source.position();
    let version = match source.word() {
        b"4.1" => Version::Four,
        b"2.2" => Version::Two,
        b"" => return Err(source.truncated()),
        word => {
            let looks_like_a_version =
                std::str::from_utf8(word).is_ok_and(|text| text.parse::<f64>().is_ok());
            let version = excerpt(word);
            return Err(if looks_like_a_version {
                GmshError::UnsupportedVersion { position, version }
            } else {
                let section = source.section_name();
                GmshError::NotANumber {
                    position,
                    section,
                    expected: "the version of the format",
                    word: version,
                }
            });
        }
    };
    let file_type = source.text_integer("the file type, 0 for text or 1 for binary")?;
    let data_size = source.text_count("the size of numbers in bytes, 8")?;
    if data_size != 8 {
        return Err(GmshError::UnsupportedDataSize { position, data_size });
    }
    source.end_line()?;
    match file_type {
        0 => {}
        1 => {
            source.rest_of_line();
            source.encoding = source.byte_order()?;
        }
        other => {
            return Err(source.unexpected("file type 0 (text) or 1 (binary)", other.to_string()));
        }
    }
    source.end_section("lines", 1)?;
    Ok(version)
}

/// Reads the names of the physical groups, which are text also in binary files.
fn read_names(source: &mut Source, contents: &mut Contents) -> Result<(), GmshError> {
    source.skip_blank_lines();
    let announced = source.text_count("the number of physical names")?;
    source.end_line()?;
    for found in 0..announced {
        source.skip_blank_lines();
        let position = source.position_of(source.mark());
        let dimension = match source.word() {
            b"" => return Err(source.truncated()),
            word @ [b'$', ..] if word.starts_with(b"$End") => {
                return Err(source.miscounted("physical names", announced, found.to_string()));
            }
            [digit @ b'0'..=b'3'] => usize::from(digit - b'0'),
            word => {
                return Err(source.unexpected(
                    "the dimension of a physical group, 0 to 3",
                    format!("`{}`", excerpt(word)),
                ));
            }
        };
        let tag = source.text_integer("the tag of a physical group")?;
        let line = source.rest_of_line().trim_ascii();
        let name = line.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
        let Some(name) = name else {
            let (section, expected) = (source.section_name(), "a name in double quotes".into());
            let found = format!("`{}`", excerpt(line));
            return Err(GmshError::Unexpected { position, section, expected, found });
        };
        let name = String::from_utf8_lossy(name).into_owned();
        contents.groups.insert((dimension, tag), name);
    }
    source.end_section("physical names", announced)
}
