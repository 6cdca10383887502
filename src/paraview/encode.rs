//! Arrays of a VTK file: little-endian numbers, compressed in blocks, in base64.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::parallel::map_groups;

/// Bytes of a block before compression; the blocks of an array are compressed in parallel.
const BLOCK: usize = 1 << 18;

/// The bytes of numbers.
pub(super) fn bytes<const B: usize>(items: impl Iterator<Item = [u8; B]>) -> Vec<u8> {
    items.flatten().collect()
}

/// Writes an array: the number of blocks, the length of a block and of the last one if that is shorter,
/// the compressed length of each, all with 64 bits and encoded apart from the blocks that follow.
pub(super) fn write_array(
    w: &mut impl Write,
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
    let lengths = [blocks.len(), BLOCK, bytes.len() % BLOCK];
    let lengths = lengths.into_iter().chain(blocks.iter().map(Vec::len));
    let header = self::bytes(lengths.map(|n| (n as u64).to_le_bytes()));
    write!(w, "<DataArray type=\"{kind}\" Name=\"{name}\"")?;
    // Some readers take an attribute of one component for one column of a matrix.
    if components > 1 {
        write!(w, " NumberOfComponents=\"{components}\"")?;
    }
    writeln!(w, " format=\"binary\">")?;
    w.write_all(STANDARD.encode(header).as_bytes())?;
    w.write_all(STANDARD.encode(blocks.concat()).as_bytes())?;
    writeln!(w, "\n</DataArray>")
}
