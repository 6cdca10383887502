//! A file of fields, read back.

use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;
use unilateral::real::Point;

/// A file: its text, and the arrays that follow.
pub struct Grid {
    pub text: String,
    data: Vec<u8>,
}

pub fn read(path: impl AsRef<Path>) -> Grid {
    let bytes = std::fs::read(path).unwrap();
    let start = b"<AppendedData encoding=\"raw\">\n_";
    let at = bytes.windows(start.len()).position(|w| w == start).unwrap() + start.len();
    let text = String::from_utf8(bytes[..at].to_vec()).unwrap();
    assert_eq!(text.matches("<Piece").count(), 1);
    for said in ["\"LittleEndian\"", "header_type=\"UInt64\"", "\"vtkZLibDataCompressor\""] {
        assert!(text.contains(said), "{said}");
    }
    // other readers know numbers only
    for kind in text.split("<DataArray type=\"").skip(1) {
        let kind = kind.split('"').next().unwrap();
        assert!(["Float64", "Int64", "UInt8"].contains(&kind), "{kind}");
    }
    let end = b"\n</AppendedData>\n</VTKFile>\n";
    assert!(bytes.ends_with(end));
    Grid { text, data: bytes[at..bytes.len() - end.len()].to_vec() }
}

/// The numbers of a header or of an array.
fn integers(bytes: &[u8], width: usize) -> Vec<usize> {
    let number = |b: &[u8]| b.iter().rev().fold(0, |n, &byte| n << 8 | usize::from(byte));
    bytes.chunks(width).map(number).collect()
}

/// The array that begins here.
fn decode(data: &[u8]) -> Vec<u8> {
    let blocks = integers(&data[..8], 8)[0];
    let header = integers(&data[..8 * (3 + blocks)], 8);
    let (mut start, mut decoded) = (8 * (3 + blocks), Vec::new());
    for (k, length) in header[3..].iter().enumerate() {
        let before = decoded.len();
        ZlibDecoder::new(&data[start..start + length]).read_to_end(&mut decoded).unwrap();
        start += length;
        let is_last = k + 1 == blocks;
        let expected = if is_last && header[2] > 0 { header[2] } else { header[1] };
        assert_eq!(decoded.len() - before, expected);
    }
    decoded
}

impl Grid {
    /// What stands between two tags.
    pub fn section(&self, name: &str) -> &str {
        let start =
            self.text.find(&format!("<{name}>")).or_else(|| self.text.find(&format!("<{name} ")));
        let end = self.text.find(&format!("</{name}>")).unwrap();
        &self.text[start.unwrap()..end]
    }
    pub fn names(&self, section: &str) -> Vec<&str> {
        let parts = self.section(section).split("Name=\"").skip(1);
        parts.map(|part| part.split('"').next().unwrap()).collect()
    }
    /// Type and bytes of an array.
    pub fn bytes(&self, section: &str, name: &str) -> (&str, Vec<u8>) {
        let (kind, _) = self.array(section, name);
        let tag = self.section(section).split(&format!("Name=\"{name}\"")).nth(1).unwrap();
        let offset = tag.split("offset=\"").nth(1).unwrap().split('"').next().unwrap();
        (kind, decode(&self.data[offset.parse().unwrap()..]))
    }
    /// Type and text of an array.
    pub fn array(&self, section: &str, name: &str) -> (&str, &str) {
        let wanted = format!("Name=\"{name}\"");
        let array = self.section(section).split("<DataArray").find(|a| a.contains(&wanted));
        let array = array.unwrap_or_else(|| panic!("no {name} in {section}"));
        let kind = array.split("type=\"").nth(1).unwrap().split('"').next().unwrap();
        (kind, array.split('>').nth(1).unwrap().split('<').next().unwrap().trim())
    }
    pub fn floats(&self, section: &str, name: &str) -> Vec<f64> {
        let (kind, bytes) = self.bytes(section, name);
        assert_eq!(kind, "Float64", "{name}");
        bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    }
    pub fn integers(&self, section: &str, name: &str) -> Vec<usize> {
        let (kind, bytes) = self.bytes(section, name);
        integers(&bytes, if kind == "UInt8" { 1 } else { 8 })
    }
    /// The points of each cell.
    pub fn cells(&self) -> Vec<Vec<usize>> {
        let corners = self.integers("Cells", "connectivity");
        let mut start = 0;
        let of = |end: usize| corners[std::mem::replace(&mut start, end)..end].to_vec();
        self.integers("Cells", "offsets").into_iter().map(of).collect()
    }
    pub fn points(&self) -> Vec<Point<3>> {
        self.floats("Points", "Points").chunks(3).map(Point::from_column_slice).collect()
    }
    /// The measure of a cell by its vertices: length, area or volume, signed except that of a facet.
    pub fn measure(&self, points: &[Point<3>], cell: &[usize], dimension: usize) -> f64 {
        let edge = |i: usize| points[cell[i]] - points[cell[0]];
        match dimension {
            0 => 1.0,
            1 => edge(1).norm(),
            2 => edge(1).cross(&edge(2)).norm() / 2.0,
            _ => edge(1).cross(&edge(2)).dot(&edge(3)) / 6.0,
        }
    }
}
