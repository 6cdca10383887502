//! An algebraic inequality as files.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use super::npy::array;
use super::npz::archive;
use crate::algebra::{Bound, DofLocation, Inequality, SparseMatrix};
use crate::error::{Error, write_error};
use crate::files::replace;
use crate::instances::compiled;
use crate::mesh::Mesh;

/// Writes the inequality "find `u` within the bounds with `(A u - b) . (v - u) >= 0` for all `v` within the
/// bounds" to a directory, which is made if need be:
///
/// * `matrix.mtx`: `A` in Matrix Market format, all entries, numbered from one;
/// * `load.npy`, `lower.npy`, `upper.npy`: `b` and the bounds, infinite where there is none, equal for
///   Dirichlet values;
/// * `kinks.npy`, where there is friction: rows of unknown, place, slope below and slope above the place of a convex
///   function that is added to the energy;
/// * `inequality.npz`: all of these, of which `scipy.sparse.load_npz` reads the matrix and `numpy.load` the
///   arrays `load`, `lower`, `upper`; absent where it would have more than 4 GiB;
/// * `places.csv`: for each unknown the cell that owns it, if one does, and its place: coordinates of the
///   barycentre of the vertices around its node, and these vertices.
///
/// # Errors
/// [`Error::Write`].
///
/// # Panics
/// If a location of the inequality names a vertex that the mesh does not have.
pub fn write_inequality<const D: usize>(
    directory: impl AsRef<Path>,
    inequality: &Inequality<f64>,
    mesh: &Mesh<D>,
) -> Result<(), Error> {
    compiled!(
        const D: fn(&Path, &Inequality<f64>, &Mesh<D>) -> Result<(), Error>
            = write_files
    )(directory.as_ref(), inequality, mesh)
}

fn write_files<const D: usize>(
    directory: &Path,
    inequality: &Inequality<f64>,
    mesh: &Mesh<D>,
) -> Result<(), Error> {
    write_files_with(directory, inequality, &|file| write_places(file, &inequality.locations, mesh))
}

/// As [`write_files`], compiled once for all dimensions.
fn write_files_with(
    directory: &Path,
    inequality: &Inequality<f64>,
    write_places: &dyn Fn(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), Error> {
    fs::create_dir_all(directory).map_err(|e| write_error(directory, e))?;
    let Inequality { matrix, bounds, .. } = inequality;
    let mut load = inequality.assembled_load();
    if !inequality.kinks.is_empty() {
        inequality.add_slopes(load.to_mut());
    }
    let mut intervals: Vec<[f64; 2]> = bounds.iter().map(Bound::interval).collect();
    let mut kinks: Vec<f64> = Vec::new();
    for kink in &inequality.kinks {
        intervals[kink.unknown as usize] = kink.own.interval();
        kinks.extend([f64::from(kink.unknown), kink.place, -kink.slope, kink.slope]);
    }
    let text = |name: &str, write: &dyn Fn(&mut dyn Write) -> std::io::Result<()>| {
        replace(&directory.join(name), |draft| {
            let mut file = BufWriter::new(File::create(draft)?);
            write(&mut file).and_then(|()| file.flush())
        })
    };
    text("matrix.mtx", &|file| write_matrix(file, matrix))?;
    text("places.csv", write_places)?;
    let ends = |side: usize| numbers(&mut intervals.iter().map(|interval| interval[side]));
    let mut vectors = vec![
        ("load.npy", numbers(&mut load.iter().copied())),
        ("lower.npy", ends(0)),
        ("upper.npy", ends(1)),
    ];
    let of_friction = directory.join("kinks.npy");
    if kinks.is_empty() && of_friction.exists() {
        fs::remove_file(&of_friction).map_err(|e| write_error(&of_friction, e))?;
    }
    if !kinks.is_empty() {
        let bytes = kinks.iter().flat_map(|number| number.to_le_bytes());
        vectors.push(("kinks.npy", array("<f8", &[kinks.len() / 4, 4], bytes)));
    }
    for (name, bytes) in &vectors {
        replace(&directory.join(name), |draft| fs::write(draft, bytes))?;
    }
    let n = matrix.size() as i64;
    let mut files = vec![
        ("format.npy", array("|S3", &[], b"csr".iter().copied())),
        ("shape.npy", array("<i8", &[2], [n, n].into_iter().flat_map(i64::to_le_bytes))),
        ("indptr.npy", indices(&matrix.row_starts)),
        ("indices.npy", indices(&matrix.columns)),
        ("data.npy", numbers(&mut matrix.values.iter().copied())),
    ];
    files.extend(vectors);
    let path = directory.join("inequality.npz");
    match archive(&files) {
        Some(bytes) => replace(&path, |draft| fs::write(draft, bytes)).map(|_| ()),
        // the other files have all numbers; an archive of an earlier inequality must not stay
        None if path.exists() => fs::remove_file(&path).map_err(|e| write_error(&path, e)),
        None => Ok(()),
    }
}

fn numbers(values: &mut dyn ExactSizeIterator<Item = f64>) -> Vec<u8> {
    array("<f8", &[values.len()], values.flat_map(f64::to_le_bytes))
}

fn indices(values: &[u32]) -> Vec<u8> {
    array("<i8", &[values.len()], values.iter().flat_map(|&i| i64::from(i).to_le_bytes()))
}

fn write_matrix(file: &mut dyn Write, matrix: &SparseMatrix<f64>) -> std::io::Result<()> {
    let n = matrix.size();
    writeln!(file, "%%MatrixMarket matrix coordinate real general")?;
    writeln!(file, "{n} {n} {}", matrix.nonzeros())?;
    for i in 0..n {
        let (columns, values) = matrix.row(i);
        for (j, a) in columns.iter().zip(values) {
            writeln!(file, "{} {} {:e}", i + 1, j + 1, a)?;
        }
    }
    Ok(())
}

fn write_places<const D: usize>(
    file: &mut dyn Write,
    locations: &[DofLocation],
    mesh: &Mesh<D>,
) -> std::io::Result<()> {
    let axes = &["x", "y", "z"][..D];
    writeln!(file, "unknown,cell,{},vertices", axes.join(","))?;
    for (unknown, location) in locations.iter().enumerate() {
        let vertices = location.vertices();
        let cell = location.cell().map_or_else(String::new, |cell| cell.to_string());
        write!(file, "{unknown},{cell}")?;
        for k in 0..D {
            let sum: f64 = vertices.iter().map(|&v| mesh.vertices()[v as usize][k]).sum();
            write!(file, ",{:?}", sum / vertices.len() as f64)?;
        }
        let names: Vec<String> = vertices.iter().map(u32::to_string).collect();
        writeln!(file, ",{}", names.join(" "))?;
    }
    Ok(())
}
