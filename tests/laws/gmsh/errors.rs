//! One test for each error about nodes, elements and groups.

use super::files::{SQUARE, SQUARE_V2};
use super::forms::parse;
use super::writer::{FORMS, Form, Sample, interval, square, tetrahedron};
use unilateral::mesh::MeshErrorKind;
use unilateral::mesh::gmsh::GmshErrorKind::*;
use unilateral::mesh::gmsh::{GmshError, GmshErrorKind, GmshFile};

pub fn fail<const D: usize>(bytes: &[u8]) -> GmshError {
    match GmshFile::parse(bytes).and_then(|file| file.mesh::<D>()) {
        Ok(_) => panic!("this must not read"),
        Err(error) => error,
    }
}

/// The error has this kind and is at this place.
#[track_caller]
pub fn is(error: &GmshError, kind: GmshErrorKind, place: &str) {
    assert_eq!(error.kind, kind, "{error}");
    assert!(error.to_string().starts_with(&format!("{place}: ")), "{error}");
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
    is(&error, Node, &format!("line {line}"));
    says(&error, &[&format!("line {line}"), "element 6", "node 77", "$Nodes"]);
    // of a boundary element, with sparse tags
    let (text, line) = change(FOUR, "5 40 10", "5 40 11");
    let error = fail::<2>(text.as_bytes());
    is(&error, Node, &format!("line {line}"));
    says(&error, &["element 5", "node 11,"]);
}

#[test]
fn repeated_node() {
    let (text, line) = change(TWO, "4 0 1 0", "3 0 1 0");
    let error = fail::<2>(text.as_bytes());
    is(&error, Node, &format!("line {line}"));
    says(
        &error,
        &[&format!("line {line}"), &format!("first: line {}", line - 1), "node 3", "distinct"],
    );
    let mut sample = square();
    sample.nodes[1].0 = 10;
    for form in FORMS {
        let error = fail::<2>(&sample.four(form));
        assert_eq!(error.kind, Node);
        says(&error, &["node 10 "]);
    }
}

#[test]
fn not_finite() {
    let (text, line) = change(TWO, "3 1 1 0", "3 1 nan 0");
    let error = fail::<2>(text.as_bytes());
    is(&error, Node, &format!("line {line}"));
    says(&error, &[&format!("line {line}"), "coordinate y of node 3 is NaN", "finite"]);
    let mut sample = square();
    sample.nodes[4].1[2] = f64::NEG_INFINITY;
    for form in FORMS {
        let error = fail::<2>(&sample.two(form));
        assert_eq!(error.kind, Node);
        says(&error, &["coordinate z of node 900000 is -inf"]);
    }
}

#[test]
fn not_flat() {
    let (text, line) = change(TWO, "5 0.5 0.5 0", "5 0.5 0.5 0.25");
    let error = fail::<2>(text.as_bytes());
    is(&error, NotFlat, &format!("line {line}"));
    says(&error, &[&format!("line {line}"), "node 5 has z = 0.25", "no tetrahedra"]);
    says(&error, &["plane of constant z", "Physical Volume", "turn"]);
    // a billionth of the extent is rounding
    let lifted = |z: &str| change(TWO, "5 0.5 0.5 0", &format!("5 0.5 0.5 {z}")).0;
    for z in ["1e-2", "-1e-6", "1e-8"] {
        let error = fail::<2>(lifted(z).as_bytes());
        assert_eq!(error.kind, NotFlat, "{z}: {error}");
        says(&error, &["node 5 "]);
    }
    assert_eq!(parse::<2>(lifted("1e-10").as_bytes()).mesh.n_cells(), 4);
    let mut sample = interval();
    sample.nodes[2].1[1] = 1.0;
    let error = fail::<1>(&sample.four(Form::Binary));
    assert_eq!(error.kind, NotFlat, "{error}");
    says(&error, &["byte ", "node 3 has y = ", "line of constant y and z"]);
}

/// Gmsh saves elements of physical groups only: of a domain in none its boundary is left.
#[test]
fn a_domain_in_no_physical_group() {
    let mut outline = square();
    outline.blocks.retain(|block| block.dimension < 2);
    for bytes in FORMS.map(|form| outline.four(form)) {
        let error = fail::<1>(&bytes);
        assert_eq!(error.kind, NotFlat);
        says(&error, &["has lines and no triangles", "if they bound the domain"]);
        says(&error, &["Physical Surface(\"domain\") = {1};", "saves only elements of groups"]);
        says(&fail::<2>(&bytes), &["has dimension 1", "dimension 2 was asked", "physical group"]);
    }
    let mut surface = tetrahedron();
    surface.blocks.retain(|block| block.dimension < 3);
    says(&fail::<2>(&surface.two(Form::Text)), &["no tetrahedra", "Physical Volume(\"domain\")"]);
}

#[test]
fn no_cells() {
    let mut sample = interval();
    sample.blocks.truncate(2);
    for form in FORMS {
        let error = GmshFile::parse(sample.two(form)).unwrap_err();
        assert_eq!(error.kind, NoCells);
        says(&error, &["mesh before saving", "physical group"]);
    }
}

#[test]
fn wrong_dimension() {
    let error = fail::<2>(&tetrahedron().four(Form::Binary));
    assert_eq!(error.kind, WrongDimension);
    says(&error, &["has dimension 3", "dimension 2 was asked", "ask for the dimension it has"]);
    let error = fail::<3>(TWO.as_bytes());
    assert_eq!(error.kind, WrongDimension);
    says(&error, &["has dimension 2", "dimension 3 was asked", "physical group"]);
}

#[test]
fn unknown_element_type() {
    let (text, line) = change(TWO, "6 2 2 7 1 2 3 5", "6 212 2 7 1 2 3 5");
    let error = fail::<2>(text.as_bytes());
    is(&error, Unsupported, &format!("line {line}"));
    says(&error, &[&format!("line {line}"), "212", "triangles"]);
    let (text, line) = change(FOUR, "2 1 2 4", "2 1 34 4");
    let error = fail::<2>(text.as_bytes());
    is(&error, Unsupported, &format!("line {line}"));
    says(&error, &["type 34 "]);
}

#[test]
fn not_simplicial() {
    let (text, line) = change(TWO, "6 2 2 7 1 2 3 5", "6 3 2 7 1 1 2 3 4");
    let error = fail::<2>(text.as_bytes());
    is(&error, Unsupported, &format!("line {line}"));
    says(&error, &[&format!("line {line}"), "elements of type 3 are not read"]);
    says(&error, &["ElementOrder", "Recombine"]);
    for element_type in [3, 5, 6, 7, 12] {
        let mut sample = tetrahedron();
        sample.blocks[2].element_type = element_type;
        for bytes in FORMS.map(|f| sample.four(f)).into_iter().chain(FORMS.map(|f| sample.two(f))) {
            let error = fail::<3>(&bytes);
            assert_eq!(error.kind, Unsupported, "{error}");
            says(&error, &[&format!("elements of type {element_type} are not read")]);
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
        for bytes in [sample.four(Form::Text), sample.two(Form::Binary)] {
            let error = match GmshFile::parse(&bytes[..]).unwrap().dimension() {
                1 => fail::<1>(&bytes),
                2 => fail::<2>(&bytes),
                _ => fail::<3>(&bytes),
            };
            assert_eq!(error.kind, Groups);
            says(&error, &[entity, "dirichlet", "neumann", "contact"]);
        }
    }
}

#[test]
fn a_group_of_undecided_condition() {
    let undecided =
        |text: &str| parse::<2>(text.as_bytes()).mesh.check_boundary_conditions().unwrap_err();
    let error = undecided(&change(TWO, "1 2 \"neumann\"", "1 2 \"outer wall\"").0);
    assert_eq!(error.kind, MeshErrorKind::UndecidedGroup, "{error}");
    assert!(error.to_string().contains("on boundary group outer wall: "), "{error}");
    assert!(error.to_string().contains("dirichlet_on, neumann_on, signorini_on"), "{error}");
    // a group without a name is called by its number
    let error = undecided(&change(TWO, "3 1 2 2 3 3 4", "3 1 2 6 3 3 4").0);
    assert_eq!(error.kind, MeshErrorKind::UndecidedGroup, "{error}");
    assert!(error.to_string().contains("on boundary group 6: "), "{error}");
}
