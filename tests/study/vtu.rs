//! Files of fields, read back.

use std::path::PathBuf;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use unilateral::mesh::{BoxDomain, Mesh};
use unilateral::paraview::{CellFields, write_vtu};
use unilateral::real::{Point, Real};

/// Where a test writes; kept if `UNILATERAL_KEEP` names a directory, to look at it with other tools.
fn path(name: &str) -> PathBuf {
    std::env::var_os("UNILATERAL_KEEP")
        .map_or_else(std::env::temp_dir, PathBuf::from)
        .join(format!("unilateral-{}-{name}.vtu", std::process::id()))
}

/// The arrays of a file, by name, as bytes; with those of points and cells apart.
struct Piece {
    text: String,
}

fn read(path: &PathBuf) -> Piece {
    let text = std::fs::read_to_string(path).unwrap();
    assert_eq!(text.matches("<Piece").count(), 1);
    assert!(
        text.contains("byte_order=\"LittleEndian\"") && text.contains("header_type=\"UInt64\"")
    );
    Piece { text }
}

impl Piece {
    /// What stands between two tags.
    fn section(&self, name: &str) -> &str {
        let start = self.text.find(&format!("<{name}")).unwrap();
        let end = self.text.find(&format!("</{name}>")).unwrap();
        &self.text[start..end]
    }
    /// Type and bytes of an array of a section, if it is there.
    fn bytes(&self, section: &str, name: &str) -> Option<(String, Vec<u8>)> {
        let arrays = self.section(section).split("<DataArray").skip(1);
        let wanted = format!("Name=\"{name}\"");
        let array = arrays.into_iter().find(|a| name.is_empty() || a.contains(&wanted))?;
        let kind = array.split("type=\"").nth(1)?.split('"').next()?.to_owned();
        let data = array.split('>').nth(1)?.split('<').next()?.trim();
        let decoded = STANDARD.decode(data).unwrap();
        let (length, bytes) = decoded.split_at(8);
        assert_eq!(u64::from_le_bytes(length.try_into().unwrap()) as usize, bytes.len());
        Some((kind, bytes.to_vec()))
    }
    fn floats(&self, section: &str, name: &str) -> Option<Vec<f64>> {
        let (kind, bytes) = self.bytes(section, name)?;
        assert_eq!(kind, "Float64");
        Some(bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect())
    }
    fn integers(&self, name: &str) -> Vec<u64> {
        let (kind, bytes) = self.bytes("Cells", name).unwrap();
        let width = match &kind[..] {
            "UInt8" => 1,
            "Int32" | "UInt32" => 4,
            "Int64" | "UInt64" => 8,
            other => panic!("{other}"),
        };
        let number = |b: &[u8]| b.iter().rev().fold(0, |n, &byte| n << 8 | u64::from(byte));
        bytes.chunks(width).map(number).collect()
    }
    fn count(&self, section: &str) -> usize {
        self.section(section).matches("<DataArray").count()
    }
}

fn cube<const D: usize>(lower: f64, upper: f64) -> BoxDomain<D> {
    BoxDomain::dirichlet(Point::repeat(lower), Point::repeat(upper))
}

/// Writes a field that jumps from cell to cell on a box, and reads it back.
fn round_trip<T: Real, const D: usize>(counts: [usize; D], cell_type: u64) {
    let domain = cube::<D>(-1.0, 0.5);
    let mesh = Mesh::<T, D>::kuhn_box(&domain, counts).unwrap();
    let (cells, corners) = (mesh.n_cells(), D + 1);
    let u: Vec<f64> = (0..cells * corners).map(|i| (i as f64).sqrt() - 1e-17).collect();
    let obstacle: Vec<f64> = u.iter().map(|u| -u / 3.0).collect();
    let multiplier: Vec<f64> = (0..cells).map(|c| 1.0 / (1.0 + c as f64)).collect();
    let contact: Vec<f64> = (0..cells).map(|c| (c % 2) as f64).collect();
    let fields = CellFields {
        u: &u,
        obstacle: Some(&obstacle),
        multiplier: Some(&multiplier),
        contact: &contact,
    };
    let path = path(&format!("{D}d-{}", T::NAME));
    write_vtu(&path, &mesh, &fields).unwrap();

    let piece = read(&path);
    let points = piece.floats("Points", "").unwrap();
    let expected: Vec<f64> = mesh
        .cells()
        .iter()
        .flat_map(|&v| {
            let x = mesh.vertices()[v as usize];
            [0, 1, 2].map(|k| if k < D { x[k].to_f64() } else { 0.0 })
        })
        .collect();
    assert_eq!(points, expected);
    let (connectivity, offsets) = (piece.integers("connectivity"), piece.integers("offsets"));
    for (c, cell) in connectivity.chunks(corners).enumerate() {
        let mut sorted = cell.to_vec();
        sorted.sort_unstable();
        let own: Vec<_> = (c * corners..(c + 1) * corners).map(|i| i as u64).collect();
        assert_eq!(sorted, own, "every cell has points of its own");
        let x = |i: usize| Point::<f64, 3>::from_column_slice(&points[3 * cell[i] as usize..][..3]);
        let edge = |i: usize| x(i) - x(0);
        let volume = match D {
            1 => edge(1).x,
            2 => edge(1).cross(&edge(2)).z,
            _ => edge(1).cross(&edge(2)).dot(&edge(3)),
        };
        assert!(volume > 0.0, "cell {c} is inside out");
    }
    assert_eq!(offsets, (1..=cells).map(|c| (c * corners) as u64).collect::<Vec<_>>());
    assert_eq!(piece.integers("types"), vec![cell_type; cells]);
    assert_eq!(piece.floats("PointData", "u").unwrap(), u);
    assert_eq!(piece.floats("PointData", "obstacle").unwrap(), obstacle);
    assert_eq!(piece.floats("CellData", "multiplier").unwrap(), multiplier);
    assert_eq!(piece.floats("CellData", "contact").unwrap(), contact);
    if std::env::var_os("UNILATERAL_KEEP").is_none() {
        std::fs::remove_file(&path).unwrap();
    }
}

#[test]
fn fields_read_back_in_every_dimension() {
    round_trip::<f64, 1>([7], 3);
    round_trip::<f64, 2>([3, 2], 5);
    round_trip::<f64, 3>([2, 1, 2], 10);
    round_trip::<f32, 2>([3, 3], 5);
}

#[test]
fn fields_that_are_not_there_are_not_written() {
    let domain = cube::<2>(0.0, 1.0);
    let mesh = Mesh::<f64, 2>::kuhn_box(&domain, [1, 1]).unwrap();
    let path = path("absent");
    let fields = CellFields { u: &[1.0; 6], obstacle: None, multiplier: None, contact: &[0.0; 2] };
    write_vtu(&path, &mesh, &fields).unwrap();
    let piece = read(&path);
    std::fs::remove_file(&path).unwrap();
    assert_eq!((piece.count("PointData"), piece.count("CellData")), (1, 1));

    let short = CellFields { contact: &[0.0], ..fields };
    let error = write_vtu(&path, &mesh, &short).unwrap_err().to_string();
    assert!(error.ends_with("field contact has 1 values, the mesh needs 2"), "{error}");
    assert!(!path.exists(), "nothing is written");
}
