//! One test for each error about nodes, elements and groups.

use super::files::{SQUARE, SQUARE_V2};
use super::writer::{FORMS, Form, Sample, interval, square, tetrahedron};
use unilateral::mesh::MeshError;
use unilateral::mesh::gmsh;
use unilateral::mesh::gmsh::{FilePosition, GmshError};

pub fn fail<const D: usize>(bytes: &[u8]) -> GmshError {
    match gmsh::parse::<D>(bytes) {
        Ok(_) => panic!("this must not read"),
        Err(error) => error,
    }
}

/// The message contains every word.
#[track_caller]
pub fn says(error: &GmshError, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
}

/// A text file of the square with one line changed; returns the number of the line, too.
#[track_caller]
pub fn change(text: &str, from: &str, to: &str) -> (String, usize) {
    let lines: Vec<&str> = text.lines().collect();
    let at = lines.iter().position(|line| line.trim_end() == from).expect("the line to change");
    let changed = lines.iter().enumerate().map(|(k, line)| if k == at { to } else { line });
    (changed.collect::<Vec<_>>().join("\n") + "\n", at + 1)
}

pub const FOUR: &str = SQUARE;
pub const TWO: &str = SQUARE_V2;

#[test]
fn unknown_node() {
    let (text, line) = change(TWO, "6 2 2 7 1 2 3 5", "6 2 2 7 1 2 3 77");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::UnknownNode { position: FilePosition::Line(l), element: 6, node: 77 } if l == line)
    );
    says(&error, &[&format!("line {line}"), "element 6", "node 77", "$Nodes"]);
    // of a boundary element, with sparse tags
    let (text, line) = change(FOUR, "5 40 10", "5 40 11");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::UnknownNode { position: FilePosition::Line(l), element: 5, node: 11 } if l == line)
    );
}

#[test]
fn repeated_node() {
    let (text, line) = change(TWO, "4 0 1 0", "3 0 1 0");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::RepeatedNode { position: FilePosition::Line(b), first: FilePosition::Line(a), node: 3 } if b == line && a == line - 1)
    );
    says(&error, &[&format!("line {line}"), "node 3", "distinct"]);
    let mut sample = square();
    sample.nodes[1].0 = 10;
    for form in FORMS {
        assert!(matches!(fail::<2>(&sample.four(form)), GmshError::RepeatedNode { node: 10, .. }));
    }
}

#[test]
fn not_finite() {
    let (text, line) = change(TWO, "3 1 1 0", "3 1 nan 0");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::NotFinite { position: FilePosition::Line(l), node: 3, axis: 'y', .. } if l == line)
    );
    says(&error, &[&format!("line {line}"), "node 3", "y", "NaN", "finite"]);
    let mut sample = square();
    sample.nodes[4].1[2] = f64::NEG_INFINITY;
    for form in FORMS {
        let error = fail::<2>(&sample.two(form));
        assert!(matches!(error, GmshError::NotFinite { node: 900_000, axis: 'z', .. }));
    }
}

#[test]
fn not_flat() {
    let (text, line) = change(TWO, "5 0.5 0.5 0", "5 0.5 0.5 0.25");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::NotFlat { position: FilePosition::Line(l), node: 5, axis: 'z', dimension: 2, .. } if l == line)
    );
    says(&error, &[&format!("line {line}"), "node 5", "0.25", "plane of constant z", "turn"]);
    // a billionth of the extent is rounding
    let lifted = |z: &str| change(TWO, "5 0.5 0.5 0", &format!("5 0.5 0.5 {z}")).0;
    for z in ["1e-2", "-1e-6", "1e-8"] {
        let error = fail::<2>(lifted(z).as_bytes());
        assert!(matches!(error, GmshError::NotFlat { node: 5, .. }), "{z}: {error}");
    }
    assert_eq!(gmsh::parse::<2>(lifted("1e-10").as_bytes()).unwrap().mesh.n_cells(), 4);
    let mut sample = interval();
    sample.nodes[2].1[1] = 1.0;
    let error = fail::<1>(&sample.four(Form::Little));
    assert!(matches!(
        error,
        GmshError::NotFlat {
            position: FilePosition::Byte(_),
            node: 3,
            axis: 'y',
            dimension: 1,
            ..
        }
    ));
    says(&error, &["byte ", "line of constant y and z"]);
}

#[test]
fn no_cells() {
    let mut sample = interval();
    sample.blocks.truncate(2);
    for form in FORMS {
        let bytes = sample.two(form);
        assert!(matches!(gmsh::dimension(&bytes), Err(GmshError::NoCells)));
        let error = fail::<1>(&bytes);
        assert!(matches!(error, GmshError::NoCells));
        says(&error, &["mesh before saving", "physical group"]);
    }
}

#[test]
fn wrong_dimension() {
    let error = fail::<2>(&tetrahedron().four(Form::Big));
    assert!(matches!(error, GmshError::WrongDimension { asked: 2, found: 3, .. }));
    says(&error, &["dimension 3", "dimension 2", "ask for the dimension it has"]);
    let error = fail::<3>(TWO.as_bytes());
    assert!(matches!(error, GmshError::WrongDimension { asked: 3, found: 2, .. }));
    says(&error, &["dimension 2", "dimension 3", "physical group"]);
}

#[test]
fn unknown_element_type() {
    let (text, line) = change(TWO, "6 2 2 7 1 2 3 5", "6 212 2 7 1 2 3 5");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::UnknownElementType { position: FilePosition::Line(l), element_type: 212 } if l == line)
    );
    says(&error, &[&format!("line {line}"), "212", "triangles"]);
    let (text, line) = change(FOUR, "2 1 2 4", "2 1 34 4");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::UnknownElementType { position: FilePosition::Line(l), element_type: 34 } if l == line)
    );
}

#[test]
fn not_simplicial() {
    let (text, line) = change(TWO, "6 2 2 7 1 2 3 5", "6 3 2 7 1 1 2 3 4");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::NotSimplicial { position: FilePosition::Line(l), element: 6, element_type: 3, name: "quadrilateral" } if l == line)
    );
    says(
        &error,
        &[&format!("line {line}"), "element 6", "quadrilateral", "triangulate", "Recombine"],
    );
    for (element_type, shape) in
        [(3, "quadrilateral"), (5, "hexahedron"), (6, "prism"), (7, "pyramid"), (12, "hexahedron")]
    {
        let mut sample = tetrahedron();
        sample.blocks[2].element_type = element_type;
        for bytes in FORMS.map(|f| sample.four(f)).into_iter().chain(FORMS.map(|f| sample.two(f))) {
            let error = fail::<3>(&bytes);
            assert!(
                matches!(error, GmshError::NotSimplicial { element: 5, name, .. } if name == shape),
                "{error}"
            );
        }
    }
}

#[test]
fn no_physical_groups() {
    for (sample, entity) in [
        (interval(), "Physical Point"),
        (square(), "Physical Curve"),
        (tetrahedron(), "Physical Surface"),
    ] {
        let mut sample = Sample { names: Vec::new(), ..sample };
        sample.blocks.iter_mut().for_each(|block| block.groups.clear());
        for bytes in [sample.four(Form::Text), sample.two(Form::Big)] {
            let error = match gmsh::dimension(&bytes).unwrap() {
                1 => fail::<1>(&bytes),
                2 => fail::<2>(&bytes),
                _ => fail::<3>(&bytes),
            };
            assert!(matches!(error, GmshError::NoPhysicalGroups { .. }));
            says(&error, &[entity, "dirichlet", "neumann", "contact"]);
        }
    }
}

#[test]
fn a_group_of_undecided_part() {
    let undecided = |text: &str| {
        let read = gmsh::parse::<2>(text.as_bytes()).unwrap();
        read.mesh.check_boundary_parts().unwrap_err()
    };
    let error = undecided(&change(TWO, "1 2 \"neumann\"", "1 2 \"outer wall\"").0);
    assert!(matches!(&error, MeshError::UndecidedGroup { group, .. } if group == "outer wall"));
    assert!(error.to_string().contains("dirichlet_on, neumann_on, signorini_on"), "{error}");
    // a group without a name is called by its number
    let error = undecided(&change(TWO, "3 1 2 2 3 3 4", "3 1 2 6 3 3 4").0);
    assert!(matches!(&error, MeshError::UndecidedGroup { group, .. } if group == "6"));
    let error = undecided(&change(FOUR, "1 1 \"dirichlet\"", "1 1 \"Dirichlet\"").0);
    assert!(error.to_string().ends_with("; write dirichlet"), "{error}");
}
