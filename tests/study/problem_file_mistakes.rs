//! Mistakes in TOML files of problems are found where they are.

use std::path::Path;

use super::problem_files::{BOX, SIDES};
use crate::support::scratch::Scratch;
use unilateral::problem_file::{ProblemFileErrorKind, read};

#[test]
fn mistakes_are_found_where_they_are() {
    let folder = Scratch::new("problem-mistakes");
    let plate = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/plate.msh");
    std::fs::copy(plate, folder.0.join("plate.msh")).unwrap();
    let on_plate = |rest: &str| format!("mesh = \"plate.msh\"\n{rest}");
    let ends = "[boundary.ends]\nkind = \"dirichlet\"\n[boundary.bore]\nkind = \"dirichlet\"\n";
    let all = format!("{ends}[boundary.edges]\nkind = \"neumann\"\n");
    let cases = [
        ("name = ".to_owned(), (1, 8), "value"),
        ("name = 3\nbox = [[0], [1]]".to_owned(), (1, 8), "`name` must be a string, not 3"),
        ("name = \"a\"\n".to_owned(), (1, 1), "`mesh` is missing"),
        (format!("{BOX}mesh = \"a.msh\""), (1, 7), "not both"),
        ("box = [[0, 1], [1]]".to_owned(), (1, 7), "two corners"),
        ("box = [[0], [true]]".to_owned(), (1, 7), "two corners"),
        ("box = [[0], [\"w\"]]".to_owned(), (1, 15), "there is no `w`; there are e, pi"),
        (format!("{BOX}sources = 1\n"), (2, 1), "unknown key `sources`; allowed are name, mesh"),
        (format!("{BOX}source = 1\n"), (2, 10), "`source` must be a table"),
        (
            format!("{BOX}[source]\ndefault = \"2 * w\"\n"),
            (3, 16),
            "there is no `w`; there are x, y, e, pi",
        ),
        (format!("{BOX}[source]\ndefault = \"2 * (x\"\n"), (3, 18), "ends where"),
        (
            format!("{BOX}[source]\ndefault = {{ value = 1, jump = \"x\" }}\n"),
            (3, 24),
            "unknown key `jump`; allowed are value, level",
        ),
        (format!("{BOX}[source]\ndefault = {{ value = 1 }}\n"), (3, 11), "`level` is missing"),
        (format!("{BOX}[source]\ndefault = [1]\n"), (3, 11), "a number, or an expression"),
        (
            format!("{BOX}[source]\ndefault = \"ln(x)\"\n{SIDES}"),
            (3, 11),
            "source.default is NaN at (-0.",
        ),
        (
            format!("{BOX}[obstacle]\nlower.default = \"max(log(x - 2), 1)\"\n{SIDES}"),
            (3, 17),
            "obstacle.lower.default is NaN at (-0.",
        ),
        (
            format!("{BOX}[source]\ndefault = \"min(0/0, 1)\"\n{SIDES}"),
            (3, 11),
            "source.default is NaN",
        ),
        (
            format!("{BOX}{}", SIDES.replacen("x * y", "(0/0)^0", 1)),
            (2, 11),
            "boundary.left.value is NaN",
        ),
        (
            format!("{BOX}[source]\ndefault = {{ value = 1, level = \"log(x)\" }}\n{SIDES}"),
            (3, 32),
            "source.default.level is NaN at (-0.",
        ),
        (format!("{BOX}[coefficient]\ndefault = 0\n{SIDES}"), (3, 11), "finite and positive"),
        (format!("{BOX}[reaction]\ndefault = \"-1\"\n{SIDES}"), (3, 11), "not negative"),
        (format!("{BOX}[obstacle]\ndefault = 1\n"), (3, 1), "allowed are lower, upper"),
        (format!("{BOX}[obstacle]\nlower.default = inf\n{SIDES}"), (3, 17), "must be finite"),
        (format!("{BOX}[boundary.left]\nvalue = 1\n"), (2, 11), "`kind` is missing"),
        (
            format!("{BOX}[boundary.left]\nkind = \"periodic\"\n"),
            (3, 8),
            "\"dirichlet\", \"neumann\", \"robin\", \"friction\" or",
        ),
        (
            format!("{BOX}[boundary.left]\nkind = \"friction\"\n"),
            (2, 11),
            "`threshold` is missing: the largest flux of friction, not negative",
        ),
        (
            format!("{BOX}[boundary.left]\nkind = \"friction\"\nthreshold = 1\nflux = 1\n"),
            (5, 1),
            "allowed are kind, threshold, shape",
        ),
        (
            format!(
                "{BOX}{}",
                SIDES.replacen("dirichlet\"\nvalue = \"x * y\"", "friction\"\nthreshold = -1", 1)
            ),
            (2, 11),
            "boundary.left.threshold is -1",
        ),
        (
            format!("{BOX}[boundary.left]\nkind = \"robin\"\nvalue = 1\n"),
            (2, 11),
            "`coefficient` is missing: `k` of alpha du/dn + k (u - value) = 0, not negative",
        ),
        (
            format!("{BOX}[boundary.left]\nkind = \"robin\"\nflux = 1\n"),
            (4, 1),
            "allowed are kind, value, shape, coefficient",
        ),
        (
            format!(
                "{BOX}{}",
                SIDES.replacen("dirichlet\"", "robin\"\ncoefficient = \"y - 0.5\"", 1)
            ),
            (2, 11),
            "boundary.left.coefficient is -0.",
        ),
        (
            format!("{BOX}[coefficient]\ndefault = [[1, 0]]\n{SIDES}"),
            (3, 11),
            "a symmetric list of rows, each with an entry for each coordinate",
        ),
        (
            format!("{BOX}[coefficient]\ndefault = [[1, \"x\"], [\"y\", 1]]\n{SIDES}"),
            (3, 11),
            "symmetric",
        ),
        (format!("{BOX}[coefficient]\ndefault = [[1, 0], [0, \"w\"]]\n{SIDES}"), (3, 25), "no `w`"),
        (
            format!("{BOX}[coefficient]\ndefault = [[1, \"2 * x\"], [\"2 * x\", 1]]\n{SIDES}"),
            (3, 11),
            "coefficient.default: the least eigenvalue is -",
        ),
        (
            format!("{BOX}[boundary.left]\nkind = \"neumann\"\nvalue = 1\n"),
            (4, 1),
            "allowed are kind, flux",
        ),
        (
            format!("{BOX}[boundary.left]\nkind = \"dirichlet\"\nvalue = \"nx\"\n"),
            (4, 10),
            "no `nx`",
        ),
        (
            format!("{BOX}{SIDES}[boundary.front]\nkind = \"neumann\"\n"),
            (14, 11),
            "no boundary group `front`; it has bottom, left, right, top",
        ),
        (format!("{BOX}[source]\nsteel = 1\n{SIDES}"), (3, 1), "no region `steel`; it has none"),
        (on_plate(ends), (1, 1), "boundary group `edges` of the mesh is missing"),
        (
            on_plate(&format!("{all}[source]\nsteel = 1\n")),
            (9, 1),
            "no region `steel`; it has inclusion, matrix",
        ),
        (format!("{BOX}{SIDES}[exact]\nvalue = 0\n"), (14, 1), "`gradient` is missing"),
        (
            format!("{BOX}{SIDES}[exact]\nvalue = 0\ngradient = [0]\n"),
            (16, 12),
            "for each coordinate",
        ),
        ("box = [[0, 1], [1, 1]]".to_owned(), (1, 7), "the first below the second"),
        ("box = [[0], [inf]]".to_owned(), (1, 7), "the first below the second"),
        (
            // finite at every vertex and barycentre
            format!("{BOX}[coefficient]\ndefault = \"if(abs(x - 0.21) < 0.02, 0, 1)\"\n{SIDES}"),
            (3, 11),
            "coefficient.default is 0 at (0.2",
        ),
        (
            format!("{BOX}{SIDES}[exact]\nvalue = \"ln(x)\"\ngradient = [\"1/x\", 0]\n"),
            (15, 9),
            "exact.value is",
        ),
        (
            format!("{BOX}{SIDES}[exact]\nvalue = \"x*y\"\ngradient = [\"y\", \"-x\"]\n"),
            (16, 12),
            "component 2 of exact.gradient is",
        ),
        (
            format!("{BOX}{SIDES}[exact]\nvalue = \"x\"\ngradient = [\"1.1\", 0]\n"),
            (16, 12),
            "component 1 of exact.gradient is 1.1",
        ),
        (
            format!("{BOX}{SIDES}[exact]\nvalue = \"x\"\ngradient = [\"0.9\", 0]\n"),
            (16, 12),
            "component 1 of exact.gradient is 0.9",
        ),
        (
            // an exact solution does not stand for a value or a flux, but no solution gives a gap
            format!(
                "{BOX}{}[exact]\nvalue = 0\ngradient = [0, 0]\n",
                SIDES.replacen("value = \"x * y\"\n", "", 1)
            ),
            (2, 11),
            "`value` is missing: the exact solution does not stand for data that are left out",
        ),
        (
            format!(
                "{BOX}{}[exact]\nvalue = 0\ngradient = [0, 0]\n",
                SIDES.replace("flux = \"x * ny\"\n", "")
            ),
            (8, 11),
            "`flux` is missing: the exact solution does not stand for data that are left out",
        ),
        (
            // columns are those of characters
            format!("{BOX}[source]\n\"\u{e4}\" = \"2 * w\"\n"),
            (3, 12),
            "there is no `w`",
        ),
        (
            format!("{BOX}{SIDES}shape = \"y\"\n"),
            (14, 9),
            "boundary.bottom.shape: the sides of a box are flat; a curved boundary needs a mesh",
        ),
        (
            on_plate(&all.replace("[boundary.edges]\n", "[boundary.edges]\nshape = \"z\"\n")),
            (7, 10),
            "there is no `z`",
        ),
        (
            on_plate(&all.replacen("bore]\n", "bore]\nshape = \"(x + 1)^2 + y^2 - 0.2\"\n", 1)),
            (5, 9),
            "the shape of boundary group bore: it must be zero at the vertices of the group, but its zero is 4.7e-2 from vertex",
        ),
        (
            on_plate(&all.replacen("bore]\n", "bore]\nshape = 1\n", 1)),
            (5, 9),
            "its zero is not near vertex",
        ),
        (
            on_plate(&format!("{all}[boundary.rim]\nkind = \"neumann\"\nshape = \"x\"\n")),
            (8, 11),
            "the mesh has no boundary group `rim`",
        ),
    ];
    let refused = |path: &str| read(Path::new(path)).unwrap_err();
    for (text, place, words) in cases {
        let path = folder.file("wrong.toml", &text);
        let error = refused(&path);
        let message = error.to_string();
        let (line, column) = place;
        assert_eq!(error.place, Some([line, column]), "{text}\n{message}");
        assert!(message.contains(words) && message.starts_with(&path), "{message}");
    }
    let error = refused(&folder.file("lost.toml", "mesh = \"lost.msh\""));
    let message = error.to_string();
    assert_eq!((error.kind, error.place), (ProblemFileErrorKind::Mesh, Some([1, 8])), "{message}");
    assert!(message.contains("lost.toml:1:8: cannot read"), "{message}");
    assert_eq!(message.matches("lost.msh").count(), 1, "{message}");
    let error = read(&folder.0.join("nothing.toml")).unwrap_err();
    assert_eq!(error.kind, ProblemFileErrorKind::Unreadable);
    let text = format!("{BOX}{SIDES}[boundary.dirichlet]\n");
    let error = refused(&folder.file("two.toml", &text));
    assert_eq!(error.kind, ProblemFileErrorKind::Text);
    assert!(error.place.is_some(), "{error}");
}

/// Each key of `[values]`: names that the mesh does not have, points outside, other types.
#[test]
fn mistakes_in_values_are_found_where_they_are() {
    let folder = Scratch::new("values-mistakes");
    for (value, column, expected) in [
        ("3", 5, "`a` must be a table, not 3"),
        ("{}", 5, "`a` must be a table with one key of at, mean, largest, smallest, integral"),
        ("{ mean = \"default\", at = [0, 0] }", 5, "`a` must be a table with one key"),
        ("{ median = \"default\" }", 7, "unknown key `median`; allowed are at, mean"),
        ("{ at = [0] }", 12, "`at` must be a list of two numbers, not [0]"),
        ("{ at = [0, true] }", 12, "a list of two numbers"),
        ("{ at = [0, \"w\"] }", 17, "there is no `w`; there are e, pi"),
        ("{ at = [0, 2] }", 12, "values.a: the point (0.000000, 2.000000) lies outside of"),
        ("{ mean = \"steel\" }", 14, "values.a: the mesh has no region `steel`; it has none"),
        ("{ largest = \"steel\" }", 17, "the mesh has no region `steel`"),
        ("{ smallest = 1 }", 18, "`smallest` must be a string, not 1"),
        ("{ integral = \"lid\" }", 18, "the mesh has no boundary group `lid`; it has bottom, left"),
        (
            "{ reaction = \"top\" }",
            18,
            "the mesh has no dirichlet or robin boundary group `top`; it has left",
        ),
        (
            "{ force = \"left\" }",
            15,
            "the mesh has no contact or friction boundary group `left`; it has bottom",
        ),
    ] {
        let text = format!("{BOX}[values]\na = {value}\n{SIDES}");
        let error = read(Path::new(&folder.file("values.toml", &text))).unwrap_err();
        assert_eq!(error.place, Some([3, column]), "{value}: {error}");
        let message = error.to_string();
        assert!(
            message.contains(expected) && message.contains("values.toml"),
            "{value}: {message}"
        );
    }
}
