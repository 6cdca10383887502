//! Fields on a mesh as a VTK XML file of an unstructured grid.
//!
//! Every cell has points of its own, so that jumps of discontinuous fields are visible. Arrays
//! follow each other in the file, base64 with a 64-bit length before the data: of the encodings of
//! the format this is the one that is valid XML, that loses no digit and that nearly all readers
//! take.

use crate::error::Error;
use crate::error::write_error;
use crate::instances::compiled;
use crate::mesh::Mesh;
use crate::real::{Real, point_f64};
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use std::fs::File;
use std::io;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Fields on the cells of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct CellFields<'a> {
    /// The solution: `D + 1` values for each cell, one for each of its vertices in order.
    pub u: &'a [f64],
    /// The obstacle, in the order of `u`.
    pub obstacle: Option<&'a [f64]>,
    /// The multiplier: one value for each cell.
    pub multiplier: Option<&'a [f64]>,
    /// Contact: one value for each cell, by convention from 0 (none) to 1 (all of it).
    pub contact: &'a [f64],
}

/// Writes fields to a `.vtu` file: point data `u` and, if there is one, `obstacle`; cell data
/// `multiplier`, if there is one, and `contact`. Points have three coordinates, missing ones zero.
///
/// # Errors
/// [`Error::Write`] if a field has not the length the mesh needs, or the file cannot be written.
pub fn write_vtu<T: Real, const D: usize>(
    path: &Path,
    mesh: &Mesh<T, D>,
    fields: &CellFields,
) -> Result<(), Error> {
    compiled!(
        T, D: fn(&Path, &Mesh<T, D>, &CellFields) -> Result<(), Error>
            = write_cells
    )(path, mesh, fields)
}

fn write_cells<T: Real, const D: usize>(
    path: &Path,
    mesh: &Mesh<T, D>,
    fields: &CellFields,
) -> Result<(), Error> {
    let mut points = Vec::with_capacity(mesh.cells().len());
    for &v in mesh.cells() {
        let x = point_f64(&mesh.vertices()[v as usize]);
        points.push(std::array::from_fn(|k| if k < D { x[k] } else { 0.0 }));
    }
    write_simplices(path, D, &points, fields).map_err(|why| write_error(path, why))
}

/// Writes simplices, each with its own `dimension + 1` points.
fn write_simplices(
    path: &Path,
    dimension: usize,
    points: &[[f64; 3]],
    fields: &CellFields,
) -> io::Result<()> {
    let (n_points, n_cells) = (points.len(), points.len() / (dimension + 1));
    check_length("u", Some(fields.u), n_points)?;
    check_length("obstacle", fields.obstacle, n_points)?;
    check_length("multiplier", fields.multiplier, n_cells)?;
    check_length("contact", Some(fields.contact), n_cells)?;

    let mut w = BufWriter::new(File::create(path)?);
    writeln!(
        w,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n\
         <Piece NumberOfPoints=\"{n_points}\" NumberOfCells=\"{n_cells}\">"
    )?;
    writeln!(w, "<PointData Scalars=\"u\">")?;
    floats(&mut w, "u", fields.u)?;
    if let Some(obstacle) = fields.obstacle {
        floats(&mut w, "obstacle", obstacle)?;
    }
    writeln!(w, "</PointData>\n<CellData Scalars=\"contact\">")?;
    if let Some(multiplier) = fields.multiplier {
        floats(&mut w, "multiplier", multiplier)?;
    }
    floats(&mut w, "contact", fields.contact)?;
    writeln!(w, "</CellData>\n<Points>")?;
    let coordinates = points.as_flattened().iter().map(|x| x.to_le_bytes());
    array(&mut w, "Float64", "Points", 3, coordinates)?;
    writeln!(w, "</Points>\n<Cells>")?;
    let corners = connectivity(dimension, points);
    array(&mut w, "Int64", "connectivity", 1, corners.iter().map(|i| i.to_le_bytes()))?;
    let ends = (0..n_cells).map(|c| (((c + 1) * (dimension + 1)) as i64).to_le_bytes());
    array(&mut w, "Int64", "offsets", 1, ends)?;
    // The format's numbers of line, triangle and tetrahedron.
    let cell_type = [3u8, 5, 10][dimension - 1];
    array(&mut w, "UInt8", "types", 1, std::iter::repeat_n([cell_type], n_cells))?;
    writeln!(w, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")?;
    w.flush()
}

/// The points of every cell. Cells of a mesh list their vertices by number, those of the format
/// counterclockwise, or seen from the fourth: otherwise volumes come out negative and surfaces look
/// inwards. Two points of such a cell are exchanged, in the list and not in the fields.
fn connectivity(dimension: usize, points: &[[f64; 3]]) -> Vec<i64> {
    let mut list: Vec<i64> = (0..points.len() as i64).collect();
    if dimension == 1 {
        return list;
    }
    let corners = dimension + 1;
    for (cell, x) in list.chunks_exact_mut(corners).zip(points.chunks_exact(corners)) {
        let edge = |i: usize| -> [f64; 3] { std::array::from_fn(|k| x[i][k] - x[0][k]) };
        let (a, b) = (edge(1), edge(2));
        let c = if dimension == 3 { edge(3) } else { [0.0, 0.0, 1.0] };
        let volume = c[0] * (a[1] * b[2] - a[2] * b[1])
            + c[1] * (a[2] * b[0] - a[0] * b[2])
            + c[2] * (a[0] * b[1] - a[1] * b[0]);
        if volume < 0.0 {
            cell.swap(corners - 2, corners - 1);
        }
    }
    list
}

/// Refuses a field whose length does not fit the mesh.
fn check_length(name: &str, field: Option<&[f64]>, expected: usize) -> io::Result<()> {
    match field {
        Some(values) if values.len() != expected => Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            format!("field {name} has {} values, the mesh needs {expected}", values.len()),
        )),
        _ => Ok(()),
    }
}

/// A field of numbers.
fn floats(w: &mut impl Write, name: &str, values: &[f64]) -> io::Result<()> {
    array(w, "Float64", name, 1, values.iter().map(|x| x.to_le_bytes()))
}

/// One array: its length in bytes and its items, encoded as one stream.
fn array<const BYTES: usize>(
    w: &mut impl Write,
    kind: &str,
    name: &str,
    components: usize,
    items: impl ExactSizeIterator<Item = [u8; BYTES]>,
) -> io::Result<()> {
    write!(w, "<DataArray type=\"{kind}\" Name=\"{name}\"")?;
    // Some readers take an attribute of one component for one column of a matrix.
    if components > 1 {
        write!(w, " NumberOfComponents=\"{components}\"")?;
    }
    writeln!(w, " format=\"binary\">")?;
    let mut encoder = EncoderWriter::new(&mut *w, &STANDARD);
    encoder.write_all(&((items.len() * BYTES) as u64).to_le_bytes())?;
    for item in items {
        encoder.write_all(&item)?;
    }
    encoder.finish()?;
    drop(encoder);
    writeln!(w, "\n</DataArray>")
}

#[cfg(test)]
mod tests {
    use super::{CellFields, write_simplices};

    fn in_temporary_file(
        name: &str,
        f: impl Fn(&std::path::Path) -> std::io::Result<()>,
    ) -> std::io::Result<String> {
        let name = format!("unilateral-{}-{name}.vtu", std::process::id());
        let path = std::env::temp_dir().join(name);
        let text = f(&path).and_then(|()| std::fs::read_to_string(&path));
        let _ = std::fs::remove_file(&path);
        text
    }

    #[test]
    fn a_segment_is_a_line_without_fields_that_are_not_there() {
        let fields =
            CellFields { u: &[1.0, 2.0], obstacle: None, multiplier: None, contact: &[0.0] };
        let points = [[0.0; 3], [1.0, 0.0, 0.0]];
        let text =
            in_temporary_file("line", |path| write_simplices(path, 1, &points, &fields)).unwrap();
        // Length 1 as 64 bits, then the number 3: nine bytes, twelve characters, no padding.
        assert!(text.contains("\nAQAAAAAAAAAD\n"), "{text}");
        // Sixteen bytes of 1.0 and 2.0 after their length.
        assert!(text.contains("\nEAAAAAAAAAAAAAAAAADwPwAAAAAAAABA\n"), "{text}");
        assert!(!text.contains("obstacle") && !text.contains("multiplier"), "{text}");
    }

    #[test]
    fn a_field_of_the_wrong_length_is_refused_by_name_before_anything_is_written() {
        let fields = CellFields {
            u: &[1.0, 2.0],
            obstacle: None,
            multiplier: Some(&[0.0, 0.0]),
            contact: &[0.0],
        };
        let points = [[0.0; 3], [1.0, 0.0, 0.0]];
        let error = in_temporary_file("wrong", |path| write_simplices(path, 1, &points, &fields))
            .unwrap_err();
        assert_eq!(error.to_string(), "field multiplier has 2 values, the mesh needs 1");
    }
}
