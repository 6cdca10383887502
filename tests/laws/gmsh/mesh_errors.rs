//! Sound files that hold no mesh: the error names the elements and nodes of the file.

use super::errors::{FOUR, TWO, change, fail, says};
use std::error::Error;
use unilateral::mesh::gmsh::{GmshError, GmshErrorKind};
use unilateral::mesh::{MeshError, MeshErrorKind};

/// The error of the mesh, with cells and vertices counted from zero.
fn of_mesh(error: &GmshError) -> &MeshError {
    assert_eq!(error.kind, GmshErrorKind::Mesh, "{error}");
    // the message contains that of the mesh
    assert_eq!(format!("{error:?}"), error.to_string());
    error.source().and_then(|source| source.downcast_ref()).expect("an error of a mesh")
}

#[test]
fn a_triangle_without_area() {
    let (text, line) = change(TWO, "6 2 2 7 1 2 3 5", "6 2 2 7 1 2 2 5");
    let error = fail::<2>(text.as_bytes());
    assert_eq!(of_mesh(&error).kind, MeshErrorKind::DegenerateCell, "{error}");
    assert_eq!(of_mesh(&error).cells, [1]);
    says(
        &error,
        &["degenerate", &format!("in the file: element 6 (line {line})"), "nodes 2, 2, 5"],
    );
}

#[test]
fn the_same_triangle_twice_in_a_group() {
    let (text, line) = change(TWO, "6 2 2 7 1 2 3 5", "6 2 2 7 1 2 5 1");
    let error = fail::<2>(text.as_bytes());
    assert_eq!(of_mesh(&error).kind, MeshErrorKind::RepeatedCell, "{error}");
    assert_eq!(of_mesh(&error).cells, [0, 1]);
    says(&error, &[&format!("element 5 (line {})", line - 1), &format!("element 6 (line {line})")]);
}

#[test]
fn three_triangles_on_a_side() {
    // The centre is moved off the diagonal from node 2 to node 4.
    let (text, _) = change(TWO, "5 0.5 0.5 0", "5 0.5 0.25 0");
    let (text, line) = change(&text, "7 2 2 7 1 3 4 5", "7 2 2 7 1 2 4 5");
    let error = fail::<2>(text.as_bytes());
    assert_eq!(of_mesh(&error).kind, MeshErrorKind::FacetOfThreeCells, "{error}");
    says(&error, &[&format!("element 7 (line {line})"), "nodes 2, 5"]);
}

#[test]
fn a_side_in_no_group() {
    let (text, _) = change(TWO, "4 1 2 3 4 4 1", "4 1 2 0 4 4 1");
    let error = fail::<2>(text.as_bytes());
    assert_eq!(of_mesh(&error).kind, MeshErrorKind::UntaggedFacet, "{error}");
    says(&error, &["element 8 (line 28)", "nodes 1, 4", "dirichlet, neumann, contact"]);
}

#[test]
fn a_side_in_two_groups() {
    let (text, _) = change(FOUR, "1 0 0 2 1 0 2 1 1 2 1 -2", "1 0 0 2 1 0 2 2 1 3 2 1 -2");
    let error = fail::<2>(text.as_bytes());
    assert_eq!(of_mesh(&error).kind, MeshErrorKind::FacetWithTwoConditions, "{error}");
    says(&error, &["dirichlet", "contact", "element 2 (line 49)", "nodes 10, 20"]);
}

#[test]
fn a_side_that_is_not_of_the_boundary() {
    let (text, line) = change(TWO, "4 1 2 3 4 4 1", "4 1 2 3 4 4 5");
    let error = fail::<2>(text.as_bytes());
    assert_eq!(of_mesh(&error).kind, MeshErrorKind::NotABoundaryFacet, "{error}");
    says(&error, &["lies between two cells", &format!("element 4 (line {line})"), "nodes 4, 5"]);
}
