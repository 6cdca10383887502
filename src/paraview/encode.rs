//! Arrays of a VTK file: little-endian numbers, compressed in blocks, after the text that describes them.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::arrays::array_of;
use crate::input::escaped;
use crate::parallel::map_groups;
use crate::real::Point;

/// Bytes of a block before compression; the blocks of an array are compressed in parallel.
const BLOCK: usize = 1 << 18;

/// An array.
pub(super) struct Array {
    /// The element that describes it, without its name and its end.
    description: String,
    /// The number of blocks, the length of a block and of the last one if that is shorter, the compressed length of each,
    /// all with 64 bits, and the blocks.
    pub data: Vec<u8>,
}

impl Array {
    /// From the bytes of numbers.
    pub fn new(kind: &str, name: &str, components: usize, bytes: &[u8]) -> Self {
        let compress = |range: std::ops::Range<usize>| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            let written = encoder.write_all(&bytes[range]);
            written.and_then(|()| encoder.finish()).expect("memory takes all bytes")
        };
        let blocks: Vec<Vec<u8>> = map_groups(bytes.len(), BLOCK, &compress);
        let lengths = [blocks.len(), BLOCK, bytes.len() % BLOCK];
        let lengths = lengths.into_iter().chain(blocks.iter().map(Vec::len));
        let mut data: Vec<u8> = lengths.flat_map(|length| (length as u64).to_le_bytes()).collect();
        data.extend(blocks.into_iter().flatten());
        // some readers take an attribute of one component for one column of a matrix
        let components = match components {
            1 => String::new(),
            n => format!(" NumberOfComponents=\"{n}\""),
        };
        let description = format!(" type=\"{kind}\" Name=\"{}\"{components}", escaped(name));
        Self { description, data }
    }
    /// Of integers.
    pub fn integers(name: &str, list: impl Iterator<Item = i64>) -> Self {
        Self::new("Int64", name, 1, &list.flat_map(i64::to_le_bytes).collect::<Vec<u8>>())
    }
    /// Of numbers.
    pub fn floats(name: &str, list: impl Iterator<Item = f64>) -> Self {
        Self::new("Float64", name, 1, &list.flat_map(f64::to_le_bytes).collect::<Vec<u8>>())
    }
    /// Of vectors with three components, missing ones zero.
    pub fn vectors<const D: usize>(name: &str, list: impl Iterator<Item = Point<D>>) -> Self {
        let of_space = |x: Point<D>| -> [f64; 3] { array_of(|k| if k < D { x[k] } else { 0.0 }) };
        let bytes = list.flat_map(of_space).flat_map(f64::to_le_bytes);
        Self::new("Float64", name, 3, &bytes.collect::<Vec<u8>>())
    }
    /// The element of this name that describes the array, with further attributes.
    pub fn element(&self, name: &str, attributes: &str) -> String {
        format!("<{name}{}{attributes}/>\n", self.description)
    }
}
