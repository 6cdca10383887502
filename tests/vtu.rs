//! Files of fields, read back by an independent reader of the format.

use std::path::PathBuf;
use unilateral::mesh::{BoundaryPart, Mesh};
use unilateral::real::{Point, Real};
use unilateral::scenes::BoxDomain;
use unilateral::study::{CellFields, write_vtu};
use vtkio::model::{Attribute, CellType, DataSet, UnstructuredGridPiece};

/// Where a test writes; kept if `UNILATERAL_KEEP` names a directory, to look at it with other tools.
fn path(name: &str) -> PathBuf {
    std::env::var_os("UNILATERAL_KEEP")
        .map_or_else(std::env::temp_dir, PathBuf::from)
        .join(format!("unilateral-{}-{name}.vtu", std::process::id()))
}

fn read(path: &PathBuf) -> UnstructuredGridPiece {
    let DataSet::UnstructuredGrid { pieces, .. } = vtkio::Vtk::import(path).unwrap().data else {
        panic!("an unstructured grid");
    };
    assert_eq!(pieces.len(), 1);
    pieces[0].load_piece_data(None).unwrap()
}

fn field(attributes: &[Attribute], name: &str) -> Option<Vec<f64>> {
    attributes.iter().find_map(|a| match a {
        Attribute::DataArray(array) if array.name == name => array.data.cast_into(),
        _ => None,
    })
}

fn cube<const D: usize>(lower: f64, upper: f64) -> BoxDomain<D> {
    BoxDomain {
        lower: Point::repeat(lower),
        upper: Point::repeat(upper),
        sides: [[BoundaryPart::Dirichlet; 2]; D],
    }
}

/// Writes a field that jumps from cell to cell on a box, and reads it back.
fn round_trip<T: Real, const D: usize>(counts: [usize; D], cell_type: CellType) {
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
    let points: Vec<f64> = piece.points.cast_into().unwrap();
    let expected: Vec<f64> = mesh
        .cells()
        .iter()
        .flat_map(|&v| {
            let x = mesh.vertices()[v as usize];
            [0, 1, 2].map(|k| if k < D { x[k].to_f64() } else { 0.0 })
        })
        .collect();
    assert_eq!(points, expected);
    let (connectivity, offsets) = piece.cells.cell_verts.into_xml();
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
    assert_eq!(piece.cells.types, vec![cell_type; cells]);
    assert_eq!(field(&piece.data.point, "u").unwrap(), u);
    assert_eq!(field(&piece.data.point, "obstacle").unwrap(), obstacle);
    assert_eq!(field(&piece.data.cell, "multiplier").unwrap(), multiplier);
    assert_eq!(field(&piece.data.cell, "contact").unwrap(), contact);
    if std::env::var_os("UNILATERAL_KEEP").is_none() {
        std::fs::remove_file(&path).unwrap();
    }
}

#[test]
fn fields_read_back_in_every_dimension() {
    round_trip::<f64, 1>([7], CellType::Line);
    round_trip::<f64, 2>([3, 2], CellType::Triangle);
    round_trip::<f64, 3>([2, 1, 2], CellType::Tetra);
    round_trip::<f32, 2>([3, 3], CellType::Triangle);
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
    assert_eq!((piece.data.point.len(), piece.data.cell.len()), (1, 1));

    let short = CellFields { contact: &[0.0], ..fields };
    let error = write_vtu(&path, &mesh, &short).unwrap_err().to_string();
    assert!(error.ends_with("field contact has 1 values, the mesh needs 2"), "{error}");
    assert!(!path.exists(), "nothing is written");
}
