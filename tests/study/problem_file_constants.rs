//! Constants of problem files: their values, sweeps, mistakes.

use std::path::Path;

use super::problem_files::{BOX, SIDES};
use crate::support::scratch::Scratch;
use unilateral::in_its_dimension;
use unilateral::prelude::*;
use unilateral::problem_file::{ProblemFileErrorKind, read, read_with};
use unilateral::scenes::AnyScene;

/// The problem of an example for values of its constants.
fn swept(name: &str, constants: &[(&str, &[f64])]) -> Vec<AnyScene> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems").join(name);
    let given = constants.iter().map(|(name, values)| ((*name).to_owned(), values.to_vec()));
    let problems = read_with(&path, &given.collect::<Vec<_>>()).unwrap();
    problems.into_iter().map(|read| read.scene).collect()
}

/// The string touches the ground but for `free = sqrt(2 depth / load)` at each end.
#[test]
fn a_swept_string_has_the_exact_contact_force_for_each_load() {
    let loads = [4.0, 16.0, 64.0];
    let scenes = swept("string.toml", &[("load", &loads), ("length", &[3.0])]);
    assert_eq!(scenes.len(), loads.len());
    for (scene, load) in scenes.into_iter().zip(loads) {
        let AnyScene::One(scene) = scene else { panic!("a problem on a line") };
        assert_eq!(scene.name, format!("string[load={load}]"));
        let free = (0.5 / load).sqrt();
        let expected = [("depth", 0.25), ("free", free), ("length", 3.0), ("load", load)];
        let report = Study::new(scene).scheme(ConformingP1).levels([256]).run().unwrap();
        let row = &report.rows[0];
        let constants: Vec<(&str, f64)> = row.constants.iter().map(|(n, x)| (&n[..], *x)).collect();
        assert_eq!(constants, expected);
        let force = load * (3.0 - 2.0 * free);
        // the contact set is known to a cell at each end
        let cells = 2.0 * load * row.mesh_size;
        assert!((row.resultant.unwrap() - force).abs() < cells, "{:?}", row.resultant);
        assert!(row.error.l2.unwrap() < 1e-3, "{:?}", row.error);
    }
}

#[test]
fn names_of_a_sweep_have_the_constants_with_several_values() {
    let values: [(&str, &[f64]); 3] =
        [("load", &[8.0, 1e21]), ("depth", &[0.25]), ("length", &[2.0, 2.5])];
    let names: Vec<String> = swept("string.toml", &values)
        .into_iter()
        .map(|scene| in_its_dimension!(scene, |scene| scene.name))
        .collect();
    let ends =
        ["load=8,length=2", "load=8,length=2.5", "load=1e21,length=2", "load=1e21,length=2.5"];
    assert_eq!(names, ends.map(|end| format!("string[{end}]")));
}

#[test]
fn constants_are_numbers_of_the_file_before_all_else() {
    let folder = Scratch::new("constants-used");
    let text = format!(
        "box = [[0, 0], [\"2 * w\", \"w\"]]\n[source]\ndefault = \"k * x^2\"\n{SIDES}\n\
         [constants]\nw = 0.5\nk = \"-w^2\"\n"
    );
    let AnyScene::Two(own) = read(Path::new(&folder.file("own.toml", &text))).unwrap().scene else {
        panic!("a problem in the plane")
    };
    assert_eq!(own.domain.bounding_box().upper, Point::from([1.0, 0.5]));
    let source = own.problem.source.everywhere.unwrap();
    assert_eq!(source.at(&Point::from([2.0, 0.0])), -1.0);
    // a number times a power is a polynomial
    assert!(format!("{source:?}").contains("Polynomial"), "{source:?}");
}

/// The constants, values given for them, and where the mistake is, with its words.
type Mistake = (&'static str, &'static [(&'static str, f64)], (usize, usize), &'static str);

#[test]
fn mistakes_in_constants_are_found_where_they_are() {
    let folder = Scratch::new("constants-mistakes");
    let cases: [Mistake; 14] = [
        (
            "a = \"2 * b\"\nb = 1",
            &[],
            (3, 10),
            "`b` is not known here: a constant uses those above",
        ),
        ("a = \"b\"\nb = \"a\"", &[], (3, 6), "`b` is not known here"),
        ("a = \"1 + a\"", &[], (3, 10), "`a` is not known here"),
        ("a = \"x\"", &[], (3, 6), "there is no `x`; there are e, pi"),
        ("a = 1\nb = \"a + c\"", &[], (4, 10), "there is no `c`; there are e, pi, a"),
        ("x = 1", &[], (3, 1), "a constant cannot be called `x`: that is a coordinate"),
        ("nz = 1", &[], (3, 1), "`nz`: that is a coordinate"),
        ("pi = 3", &[], (3, 1), "`pi`: every expression has this number"),
        ("max = 3", &[], (3, 1), "`max`: that is a function"),
        ("\"2a\" = 3", &[], (3, 1), "`2a`: a name has letters, digits and _"),
        ("a = \"1 / 0\"", &[], (3, 5), "the constant `a` is inf: it must be finite"),
        ("a = [1]", &[], (3, 5), "`a` must be a number, or an expression"),
        ("a = 1", &[("b", 2.0)], (2, 1), "there is no constant `b` to set: [constants] has a"),
        ("a = 1\nb = \"1/a\"", &[("a", 0.0)], (4, 5), "the constant `b` is inf"),
    ];
    let check = |text: &str, given: &[(&str, f64)], (line, column), expected: &str| {
        let path = folder.file("wrong.toml", text);
        let given = given.iter().map(|(name, x)| ((*name).to_owned(), vec![*x]));
        let error = read_with(Path::new(&path), &given.collect::<Vec<_>>()).unwrap_err();
        assert_eq!(error.place, Some([line, column]), "{text}: {error}");
        let message = error.to_string();
        assert!(message.contains(expected) && message.contains("wrong.toml"), "{text}: {message}");
        assert!(!message.contains('\n'), "{message}");
        error.kind
    };
    for (constants, given, place, expected) in cases {
        check(&format!("{BOX}[constants]\n{constants}\n{SIDES}"), given, place, expected);
    }
    let text = format!("{BOX}{SIDES}");
    let expected = "there is no constant `b` to set: the file has no [constants]";
    let kind = check(&text, &[("b", 1.0)], (1, 1), expected);
    assert_eq!(kind, ProblemFileErrorKind::Text);
    check(&format!("{BOX}constants = 1\n{SIDES}"), &[], (2, 13), "`constants` must be a table");
}
