//! Arrays of a VTK file: little-endian numbers, compressed in blocks, after the text that describes them.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::parallel::map_groups;

/// Bytes of a block before compression; the blocks of an array are compressed in parallel.
const BLOCK: usize = 1 << 18;

/// The bytes of integers.
pub(super) fn integers(list: &mut dyn Iterator<Item = i64>) -> Vec<u8> {
    list.flat_map(i64::to_le_bytes).collect()
}

/// The bytes of numbers.
pub(super) fn doubles(list: &mut dyn Iterator<Item = f64>) -> Vec<u8> {
    list.flat_map(f64::to_le_bytes).collect()
}

/// A file under construction: its text, and the arrays that follow it.
#[derive(Default)]
pub(super) struct Arrays {
    pub text: Vec<u8>,
    /// For each array where in the text its offset belongs, and its data.
    data: Vec<(usize, Vec<u8>)>,
}

impl Arrays {
    /// Adds an array: in the text its name; in the data the number of blocks, the length of a block and of the
    /// last one if that is shorter, the compressed length of each, all with 64 bits, and the blocks.
    pub fn push(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        bytes: &[u8],
    ) -> io::Result<()> {
        let compress = |range: std::ops::Range<usize>| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(&bytes[range])?;
            encoder.finish()
        };
        let blocks: io::Result<Vec<Vec<u8>>> =
            map_groups(bytes.len(), BLOCK, &compress).into_iter().collect();
        let blocks = blocks?;
        write!(self.text, "<DataArray type=\"{kind}\" Name=\"{name}\"")?;
        // Some readers take an attribute of one component for one column of a matrix.
        if components > 1 {
            write!(self.text, " NumberOfComponents=\"{components}\"")?;
        }
        write!(self.text, " format=\"appended\" offset=\"")?;
        let lengths = [blocks.len(), BLOCK, bytes.len() % BLOCK];
        let lengths = lengths.into_iter().chain(blocks.iter().map(Vec::len));
        let mut data: Vec<u8> = lengths.flat_map(|length| (length as u64).to_le_bytes()).collect();
        data.extend(blocks.into_iter().flatten());
        self.data.push((self.text.len(), data));
        writeln!(self.text, "\"/>")
    }

    /// Writes the text, the data after an underscore, and the end of the file.
    ///
    /// The data stand in the reverse order of the text. meshio 5 searches the text for the array at each offset,
    /// and gives the array that it finds another offset: an array that stands before the one that is meant would be
    /// found in its place.
    pub fn write(&self, w: &mut impl Write) -> io::Result<()> {
        let mut offset: usize = self.data.iter().map(|(_, data)| data.len()).sum();
        let mut done = 0;
        for (place, data) in &self.data {
            offset -= data.len();
            w.write_all(&self.text[done..*place])?;
            write!(w, "{offset}")?;
            done = *place;
        }
        w.write_all(&self.text[done..])?;
        w.write_all(b"<AppendedData encoding=\"raw\">\n_")?;
        self.data.iter().rev().try_for_each(|(_, data)| w.write_all(data))?;
        w.write_all(b"\n</AppendedData>\n</VTKFile>\n")
    }
}
