//! The same small meshes in every form of the format.

use super::files::{INTERVAL, SQUARE, SQUARE_V2, TETRAHEDRON};
use super::writer::{FORMS, Sample, interval, square, tetrahedron};
use unilateral::mesh::gmsh::{GmshFile, GmshMesh};
use unilateral::mesh::{BoundaryCondition, Mesh};

pub fn parse<const D: usize>(bytes: &[u8]) -> GmshMesh<D> {
    GmshFile::parse(bytes).and_then(|file| file.mesh()).unwrap_or_else(|e| panic!("{e}"))
}

/// Volume by determinants, independent of the crate's geometry.
pub fn volume<const D: usize>(mesh: &Mesh<D>) -> f64 {
    let x = mesh.vertices();
    let of_cell = |c: usize| {
        let cell = mesh.cell(c);
        let e: Vec<_> = cell[1..].iter().map(|&v| x[v as usize] - x[cell[0] as usize]).collect();
        match D {
            1 => e[0][0].abs(),
            2 => (e[0][0] * e[1][1] - e[0][1] * e[1][0]).abs() / 2.0,
            _ => {
                let minor = |i: usize, j: usize| e[1][i] * e[2][j] - e[1][j] * e[2][i];
                (e[0][0] * minor(1, 2) - e[0][1] * minor(0, 2) + e[0][2] * minor(0, 1)).abs() / 6.0
            }
        }
    };
    (0..mesh.n_cells()).map(of_cell).sum()
}

/// Number of facets with each condition: dirichlet, neumann, contact.
pub fn conditions<const D: usize>(mesh: &Mesh<D>) -> [usize; 3] {
    [BoundaryCondition::Dirichlet, BoundaryCondition::Neumann, BoundaryCondition::Contact]
        .map(|condition| mesh.boundary().iter().filter(|f| f.condition == condition).count())
}

/// Every form of a sample reads to the same mesh.
fn all_forms<const D: usize>(sample: &Sample) -> Mesh<D> {
    let first = parse::<D>(&sample.four(FORMS[0])).mesh;
    for form in FORMS {
        for bytes in [sample.four(form), sample.two(form)] {
            assert_eq!(GmshFile::parse(&bytes[..]).unwrap().dimension(), D);
            let read = parse::<D>(&bytes);
            assert!(read.warnings.is_empty());
            assert_eq!(read.mesh.vertices(), first.vertices(), "{form:?}");
            assert_eq!(read.mesh.cells(), first.cells(), "{form:?}");
            assert_eq!(read.mesh.boundary(), first.boundary(), "{form:?}");
        }
    }
    first
}

#[test]
fn interval_in_all_forms() {
    let mesh = all_forms::<1>(&interval());
    assert_eq!((mesh.n_cells(), conditions(&mesh)), (3, [1, 1, 0]));
    assert!((volume(&mesh) - 2.0).abs() < 1e-15);
}

#[test]
fn square_in_all_forms() {
    let mesh = all_forms::<2>(&square());
    assert_eq!((mesh.n_cells(), conditions(&mesh)), (4, [1, 2, 1]));
    assert!((volume(&mesh) - 1.0).abs() < 1e-15);
}

#[test]
fn tetrahedron_in_all_forms() {
    let mesh = all_forms::<3>(&tetrahedron());
    assert_eq!((mesh.n_cells(), conditions(&mesh)), (1, [3, 0, 1]));
    assert!((volume(&mesh) - 1.0 / 6.0).abs() < 1e-15);
}

#[test]
fn parametric_nodes_are_read_by_their_position() {
    let plain = parse::<2>(&square().four(FORMS[0])).mesh;
    let sample = Sample { parametric: true, ..square() };
    for form in FORMS {
        assert_eq!(parse::<2>(&sample.four(form)).mesh.vertices(), plain.vertices());
        assert_eq!(parse::<2>(&sample.two(form)).mesh.vertices(), plain.vertices());
    }
    let file = include_bytes!("../../data/problems/h_par22.msh");
    assert_eq!(parse::<2>(file).mesh.vertices().len(), 31);
}

/// Version 2.2 lists a cell once for each of its groups, wherever in the file; version 4.1 lists it once.
#[test]
fn a_cell_in_two_groups_is_one_cell() {
    let read = parse::<2>(include_bytes!("../../data/problems/twocellgroups.msh"));
    let mesh = &read.mesh;
    let names = |cell: usize| mesh.regions()[mesh.region(cell)].join(" ");
    let cells = |expected: &str| (0..mesh.n_cells()).filter(|&c| names(c) == expected).count();
    assert_eq!(["soft sub", "soft", "stiff"].map(cells), [16, 0, 16], "{:?}", mesh.regions());
    assert!(read.element_tags.iter().all(|&tag| tag <= 48));
}

#[test]
fn files_made_by_hand() {
    let square = parse::<2>(SQUARE.as_bytes()).mesh;
    assert_eq!((square.n_cells(), conditions(&square), volume(&square)), (4, [1, 2, 1], 1.0));
    // The last cell of this one is listed for two groups.
    let again = parse::<2>(SQUARE_V2.as_bytes()).mesh;
    assert_eq!(again.vertices(), square.vertices());
    assert_eq!((again.cells(), again.boundary()), (square.cells(), square.boundary()));
    let interval = parse::<1>(INTERVAL.as_bytes()).mesh;
    assert_eq!((interval.n_cells(), conditions(&interval), volume(&interval)), (3, [1, 1, 0], 2.0));
    let body = parse::<3>(TETRAHEDRON.as_bytes()).mesh;
    assert_eq!((body.n_cells(), conditions(&body)), (1, [3, 0, 1]));
}

#[test]
fn lines_may_end_as_on_windows() {
    let text = SQUARE.replace('\n', "\r\n");
    assert_eq!(parse::<2>(text.as_bytes()).mesh.n_cells(), 4);
    // and an editor may have put a byte order mark in front, and left out the last end of a line
    let text = format!("\u{feff}{}", text.trim_end());
    assert_eq!(parse::<2>(text.as_bytes()).mesh.n_cells(), 4);
}

#[test]
fn elements_of_order_two_are_read_as_straight_with_a_warning() {
    let mut sample = square();
    sample.nodes.push((50, [0.5, -0.1, 0.0]));
    for block in &mut sample.blocks {
        block.element_type = if block.dimension == 1 { 8 } else { 9 };
        let extra = if block.dimension == 1 { 1 } else { 3 };
        for element in &mut block.elements {
            element.1.extend(std::iter::repeat_n(50, extra));
        }
    }
    let straight = parse::<2>(&square().four(FORMS[0])).mesh;
    for form in FORMS {
        let read = parse::<2>(&sample.four(form));
        assert_eq!(read.mesh.vertices(), straight.vertices());
        assert_eq!(read.mesh.cells(), straight.cells());
        let expected = ["8 elements of order two are read as straight ones by their corner nodes"];
        assert_eq!(read.warnings, expected);
    }
}

#[test]
fn a_plane_off_the_origin_is_flat_up_to_rounding() {
    let mut sample = square();
    for (k, node) in sample.nodes.iter_mut().enumerate() {
        node.1[2] = -3.0 + 1e-16 * k as f64;
    }
    assert_eq!(parse::<2>(&sample.four(FORMS[0])).mesh.n_cells(), 4);
    // A node that no cell uses may be anywhere.
    sample.nodes.push((7, [0.0, 0.0, 100.0]));
    assert_eq!(parse::<2>(&sample.two(FORMS[1])).mesh.vertices().len(), 5);
}
