//! Vectors as arrays of NumPy.

use std::path::Path;

use crate::error::{Error, read_error};
use crate::input::{excerpt, read_file};

const MAGIC: &[u8] = b"\x93NUMPY";

/// An array of no, one or two axes in the format `.npy`, version 1.0: its type as NumPy writes it, and its bytes.
pub(super) fn array(kind: &str, shape: &[usize], data: impl Iterator<Item = u8>) -> Vec<u8> {
    let shape = match shape {
        [length] => format!("({length},)"),
        axes => format!("({})", axes.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    };
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // the data begin at a multiple of 64
    let padding = 64 - (MAGIC.len() + 4 + header.len() + 1) % 64;
    header += &" ".repeat(padding % 64);
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

/// Reads a vector: `.npy` with one axis (or one column) of type `<f8` or `<f4`, or numbers in text,
/// separated by white space or commas.
///
/// # Errors
/// [`Error::Read`].
pub fn read_vector(path: impl AsRef<Path>) -> Result<Vec<f64>, Error> {
    let path = path.as_ref();
    let bytes = read_file(path).map_err(|why| read_error(path, why))?;
    let values = if bytes.starts_with(MAGIC) { from_npy(&bytes) } else { from_text(&bytes) };
    values.map_err(|why| read_error(path, why))
}

fn from_text(bytes: &[u8]) -> Result<Vec<f64>, String> {
    let is_between = |b: &u8| b.is_ascii_whitespace() || *b == b',';
    let number = |word: &[u8]| {
        let text = std::str::from_utf8(word).ok();
        text.and_then(|text| text.parse().ok())
            .ok_or_else(|| format!("\"{}\" is no number", excerpt(word)))
    };
    bytes.split(is_between).filter(|word| !word.is_empty()).map(number).collect()
}

fn from_npy(bytes: &[u8]) -> Result<Vec<f64>, String> {
    let short = || "the file ends within its header".to_owned();
    // the length of the header has two bytes in version 1 and four in later ones
    let version = *bytes.get(MAGIC.len()).ok_or_else(short)?;
    let (at, width) = (MAGIC.len() + 2, if version == 1 { 2 } else { 4 });
    let length = bytes.get(at..at + width).ok_or_else(short)?;
    let length = length.iter().rev().fold(0_usize, |n, &b| n << 8 | usize::from(b));
    let header = bytes.get(at + width..).and_then(|rest| rest.get(..length)).ok_or_else(short)?;
    let header = String::from_utf8_lossy(header);
    let value = |key: &str| {
        let rest = header.split_once(&format!("'{key}':"))?.1.trim_start();
        Some(rest.split([')', '}']).next()?.to_owned())
    };
    let allowed = "a vector of 64-bit or 32-bit floating-point numbers is read";
    let shape = value("shape").ok_or_else(short)?;
    let axes: Vec<usize> = shape.split([',', '(', ' ']).filter_map(|n| n.parse().ok()).collect();
    if axes.iter().filter(|n| **n != 1).count() > 1 {
        return Err(format!("an array of {} axes: {allowed}", axes.len()));
    }
    let data = &bytes[at + width + length..];
    let kind = value("descr").unwrap_or_default();
    let values: Vec<f64> = match kind.split(['\'', '"']).nth(1) {
        Some("<f8") => {
            let numbers = data.as_chunks::<8>().0.iter();
            numbers.map(|b| f64::from_le_bytes(*b)).collect()
        }
        Some("<f4") => {
            let numbers = data.as_chunks::<4>().0.iter();
            numbers.map(|b| f64::from(f32::from_le_bytes(*b))).collect()
        }
        other => {
            return Err(format!("numbers of type {}: {allowed}", excerpt(other.unwrap_or("?"))));
        }
    };
    let expected: usize = axes.iter().product();
    if values.len() == expected {
        Ok(values)
    } else {
        Err(format!("{} numbers where the header states {expected}", values.len()))
    }
}
