//! Input from outside: files of limited size, and foreign text in messages.

use std::fs::{File, metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// The most bytes that are read of a file, 2 GiB: a binary Gmsh mesh of forty million tetrahedra.
pub const LARGEST_FILE: u64 = 1 << 31;

/// Reads a regular file of at most [`LARGEST_FILE`] bytes. Devices and pipes, which may have no end,
/// are not opened.
///
/// # Errors
/// Those of the operating system, [`ErrorKind::InvalidInput`] for what is not a regular file,
/// [`ErrorKind::FileTooLarge`].
pub fn read_file(path: &Path) -> Result<Vec<u8>> {
    let about = metadata(path)?;
    if !about.is_file() {
        let why = "not a regular file; directories, devices and pipes are not read";
        return Err(Error::new(ErrorKind::InvalidInput, why));
    }
    let mut bytes = Vec::new();
    // files of the system may state a length of zero
    if about.len() <= LARGEST_FILE {
        bytes.reserve_exact(about.len() as usize);
        File::open(path)?.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
    }
    if about.len().max(bytes.len() as u64) > LARGEST_FILE {
        let why = format!("larger than {LARGEST_FILE} bytes, the most that are read");
        return Err(Error::new(ErrorKind::FileTooLarge, why));
    }
    Ok(bytes)
}

/// The length and a hash of the contents of a file.
pub fn fingerprint(bytes: &[u8]) -> String {
    // the hash of Fowler, Noll and Vo, which has the same value on every machine
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325, step);
    format!("{} bytes {hash:016x}", bytes.len())
}

/// Foreign text for a message: at most 40 characters, an ellipsis in place of the rest, control
/// characters and those that turn the direction of text as escapes, bytes that are not UTF-8 replaced by U+FFFD.
pub fn excerpt(text: impl AsRef<[u8]>) -> String {
    beginning(text.as_ref(), 40)
}

/// As [`excerpt`], with so many characters.
pub fn beginning(bytes: &[u8], longest: usize) -> String {
    // no character is longer than four bytes
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * longest + 4)]);
    let rest = text.chars().nth(longest).map(|_| '…');
    let mut shown = String::new();
    for c in text.chars().take(longest).chain(rest) {
        match c.is_control() || turns_direction(c) {
            true => shown.extend(c.escape_default()),
            false => shown.push(c),
        }
    }
    shown
}

/// Whether a character sets the direction of the text after it, which a name could use to look like another.
fn turns_direction(c: char) -> bool {
    matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Foreign names in a list: excerpts of the first twenty in alphabetical order, and how many more there are.
pub fn excerpts<S: AsRef<str>>(names: impl IntoIterator<Item = S>) -> String {
    const MOST: usize = 20;
    let mut names: Vec<String> = names.into_iter().map(|name| excerpt(name.as_ref())).collect();
    names.sort_unstable();
    names.dedup();
    let more = names.len().saturating_sub(MOST);
    names.truncate(MOST);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    names.join(", ") + &rest
}

/// A text with the markup characters of HTML and XML escaped, also for the value of an attribute.
#[cfg(feature = "report")]
pub(crate) fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// A number, NaN for null: reports have null for numbers that are not finite.
#[cfg(feature = "report")]
pub(crate) fn number_or_nan<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<f64, D::Error> {
    serde::Deserialize::deserialize(deserializer).map(|x: Option<f64>| x.unwrap_or(f64::NAN))
}

/// A number, infinity for null.
#[cfg(feature = "report")]
pub(crate) fn number_or_infinity<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<f64, D::Error> {
    serde::Deserialize::deserialize(deserializer).map(|x: Option<f64>| x.unwrap_or(f64::INFINITY))
}
