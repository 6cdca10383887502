//! Problems from TOML files.

use super::scratch::Scratch;
use std::path::Path;
use unilateral::mesh::{BoundaryPart, Mesh};
use unilateral::prelude::*;
use unilateral::problem_file::{
    AnyOwnProblem, Geometry, OwnProblem, ProblemFileError, ProblemFileFault, read,
};

fn example(name: &str) -> AnyOwnProblem {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems");
    read(&folder.join(name)).unwrap()
}

/// Solves a problem on its mesh and one refinement of it with several schemes; the sums of the multipliers
/// of each.
fn solve_all<const D: usize>(own: &OwnProblem<D>) -> Vec<f64> {
    let mesh = own.mesh::<f64>().unwrap().unwrap().mesh;
    let meshes = Hierarchy::refine(&mesh, 1).unwrap();
    let mut forces = Vec::new();
    for name in ["p1", "cr", "sipg", "nipg", "wopsip", "wopsip:facet-means", "p2", "br2"] {
        let scheme: NamedScheme = name.parse().unwrap();
        let mut problem = own.problem.clone();
        problem.constraint_set = scheme.constraint_set();
        let solved = solve(&problem, &meshes, &*scheme.make()).unwrap();
        assert!(solved.converged(), "{}, {name}: {}", own.name, solved.outcome());
        assert!(solved.active() > Some(0), "{}, {name}: no contact", own.name);
        forces.push(solved.multiplier().unwrap().iter().sum());
    }
    forces
}

#[test]
fn the_plate_has_its_materials_on_every_level() {
    let AnyOwnProblem::Two(own) = example("plate.toml") else { panic!("a problem in the plane") };
    assert_eq!(own.name, "plate");
    let mut mesh = own.mesh::<f64>().unwrap().unwrap().mesh;
    let stiff = mesh.regions().iter().position(|names| names == &["inclusion"]).unwrap();
    let cells = |mesh: &Mesh<f64, 2>| -> Vec<bool> {
        (0..mesh.n_cells()).map(|c| mesh.region(c) == stiff).collect()
    };
    let coarse = cells(&mesh);
    assert!(coarse.iter().any(|&c| c) && coarse.iter().any(|&c| !c));
    for level in 1..=4 {
        mesh = mesh.refine().unwrap().0;
        let wrong = cells(&mesh)
            .iter()
            .enumerate()
            .filter(|(c, m)| coarse[c >> (2 * level)] != **m)
            .count();
        assert_eq!(wrong, 0, "level {level}");
    }
    // the region is what the mesh generator meant: an ellipse around (0.8, 0)
    for c in 0..mesh.n_cells() {
        let x = mesh.barycentre(c);
        let r = ((x[0] - 0.8) / 0.7).powi(2) + (x[1] / 0.45).powi(2);
        assert!(mesh.region(c) != stiff || r < 1.0);
        assert!(mesh.region(c) == stiff || r > 0.8);
    }
    solve_all(&own);
}

#[test]
fn the_foot_carries_the_load_of_the_bracket() {
    let AnyOwnProblem::Three(own) = example("bracket.toml") else { panic!("a problem in space") };
    let mesh = own.mesh::<f64>().unwrap().unwrap().mesh;
    assert!(mesh.has_part(BoundaryPart::Contact) && !mesh.has_part(BoundaryPart::Dirichlet));
    // weight, and the traction on the head, whose mean over the head is -2
    let load = -(0.6 * 0.3 + 0.3 * 0.6 * 0.9) - 2.0 * 0.3 * 0.6;
    for force in solve_all(&own) {
        assert!((force + load).abs() < 1e-8 * load.abs(), "{force} {load}");
    }
}

#[test]
fn the_membrane_touches_both_obstacles() {
    let AnyOwnProblem::Two(own) = example("membrane.toml") else {
        panic!("a problem in the plane")
    };
    let mesh = own.mesh::<f64>().unwrap().unwrap().mesh;
    let solved = solve(&own.problem, &mesh, &ConformingP1).unwrap();
    let multiplier = solved.multiplier().unwrap();
    assert!(multiplier.iter().any(|&m| m > 0.0) && multiplier.iter().any(|&m| m < 0.0));
    solve_all(&own);
}

const BOX: &str = "box = [[-1, 0], [1, 1]]\n";
const SIDES: &str = "[boundary.left]\nkind = \"dirichlet\"\nvalue = \"x * y\"\n\
    [boundary.right]\nkind = \"dirichlet\"\nvalue = \"x * y\"\n\
    [boundary.top]\nkind = \"neumann\"\nflux = \"x * ny\"\n\
    [boundary.bottom]\nkind = \"contact\"\ngap = -1\n";

#[test]
fn a_box_has_sides_and_an_exact_solution() {
    let folder = Scratch::new("problem-box");
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("harmonic.toml");
    let exact = "[exact]\nvalue = \"x * y\"\ngradient = [\"y\", \"x\"]\n";
    std::fs::write(&path, format!("{BOX}{SIDES}{exact}[reaction]\ndefault = 0\n")).unwrap();
    let AnyOwnProblem::Two(own) = read(&path).unwrap() else { panic!("a problem in the plane") };
    assert_eq!(own.name, "harmonic");
    let Geometry::Box(domain) = &own.geometry else { panic!("a box") };
    assert_eq!(domain.sides[1], [BoundaryPart::Contact, BoundaryPart::Neumann]);
    let mesh = Mesh::<f64, 2>::kuhn_box(domain, domain.counts(4)).unwrap();
    let solved = solve(&own.problem, &mesh, &ConformingP2).unwrap();
    assert!(
        solved.errors().unwrap().l2.unwrap() > 1e-3,
        "the flux -x on the bottom is held by nothing"
    );
    let flux = "[boundary.bottom]\nkind = \"neumann\"\nflux = \"x * ny\"\n";
    let sides = SIDES.split("[boundary.bottom]").next().unwrap();
    std::fs::write(&path, format!("{BOX}{sides}{flux}{exact}")).unwrap();
    let AnyOwnProblem::Two(own) = read(&path).unwrap() else { panic!("a problem in the plane") };
    let Geometry::Box(domain) = &own.geometry else { panic!("a box") };
    let mesh = Mesh::<f64, 2>::kuhn_box(domain, domain.counts(4)).unwrap();
    let solved = solve(&own.problem, &mesh, &ConformingP2).unwrap();
    assert!(solved.errors().unwrap().l2.unwrap() < 1e-12);
}

#[test]
fn mistakes_are_found_where_they_are() {
    let folder = Scratch::new("problem-mistakes");
    std::fs::create_dir_all(&folder.0).unwrap();
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
        ("box = [[0], [\"1\"]]".to_owned(), (1, 7), "two corners"),
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
            format!("{BOX}[boundary.left]\nkind = \"robin\"\n"),
            (3, 8),
            "\"dirichlet\", \"neumann\" or",
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
    ];
    for (text, place, words) in cases {
        let path = folder.0.join("wrong.toml");
        std::fs::write(&path, &text).unwrap();
        let error = read(&path).unwrap_err();
        let message = error.to_string();
        let ProblemFileError::At { line, column, .. } = error else { panic!("{text}\n{message}") };
        assert_eq!((line, column), place, "{text}\n{message}");
        assert!(
            message.contains(words) && message.starts_with(&path.display().to_string()),
            "{message}"
        );
    }
    std::fs::write(folder.0.join("lost.toml"), "mesh = \"lost.msh\"").unwrap();
    let error = read(&folder.0.join("lost.toml")).unwrap_err();
    let message = error.to_string();
    assert!(matches!(error, ProblemFileError::Mesh { line: 1, column: 8, .. }), "{message}");
    assert!(message.contains("lost.toml:1:8: cannot read"), "{message}");
    assert_eq!(message.matches("lost.msh").count(), 1, "{message}");
    let error = read(&folder.0.join("nothing.toml")).unwrap_err();
    assert!(matches!(error, ProblemFileError::Unreadable { .. }));
    std::fs::write(folder.0.join("two.toml"), format!("{BOX}{SIDES}[boundary.dirichlet]\n"))
        .unwrap();
    let error = read(&folder.0.join("two.toml")).unwrap_err();
    assert!(matches!(error, ProblemFileError::At { fault: ProblemFileFault::Missing { .. }, .. }));
}

/// Which data must have values at vertices: those that nodes or gradients read there, and no others.
#[test]
fn data_are_held_against_vertices_where_nodes_read_them() {
    let folder = Scratch::new("problem-vertices");
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("vertices.toml");
    let fault = |text: &str| {
        std::fs::write(&path, text).unwrap();
        read(&path).err().map(|error| error.to_string())
    };
    // not a number on the line x = 0 alone, which has vertices and no point of a rule
    let hole = "\"if(x == 0, 0/0, -1)\"";
    let in_domain = |table: &str| format!("{BOX}{table}\n{SIDES}");
    let on_side = |kind: &str, name: &str| {
        let sides = SIDES.split("[boundary.bottom]").next().unwrap();
        format!("{BOX}{sides}[boundary.bottom]\nkind = \"{kind}\"\n{name} = {hole}\n")
    };
    let exact = |value: &str, slope: &str| {
        format!("{BOX}{SIDES}[exact]\nvalue = {value}\ngradient = [{slope}, 0]\n")
    };
    for (datum, text) in [
        ("obstacle.lower.default", in_domain(&format!("[obstacle]\nlower.default = {hole}"))),
        ("obstacle.upper.default", in_domain(&format!("[obstacle]\nupper.default = {hole}"))),
        (
            "source.default.level",
            in_domain(&format!("[source]\ndefault = {{ value = 1, level = {hole} }}")),
        ),
        ("boundary.bottom.value", on_side("dirichlet", "value")),
        ("boundary.bottom.gap", on_side("contact", "gap")),
        ("exact.value", exact(hole, "0")),
    ] {
        let message = fault(&text).unwrap_or_else(|| panic!("{datum} has no fault"));
        assert!(message.contains(&format!("{datum} is NaN at (0.000000, ")), "{message}");
    }
    for text in [
        in_domain(&format!("[source]\ndefault = {hole}")),
        in_domain(&format!("[reaction]\ndefault = {}", hole.replace("-1", "1"))),
        in_domain(&format!("[coefficient]\ndefault = {}", hole.replace("-1", "1"))),
        on_side("neumann", "flux"),
        exact("1", &hole.replace("-1", "0")),
    ] {
        assert_eq!(fault(&text), None, "{text}");
    }
}

/// A datum for the rest holds where no region is named, and is not asked elsewhere.
#[test]
fn a_default_is_not_asked_in_named_regions() {
    let folder = Scratch::new("problem-default");
    std::fs::create_dir_all(&folder.0).unwrap();
    let plate = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/plate.msh");
    std::fs::copy(plate, folder.0.join("plate.msh")).unwrap();
    let path = folder.0.join("default.toml");
    let rest = "[boundary.default]\nkind = \"neumann\"\n";
    let hole = "if((x - 0.8)^2 < 0.01 && y^2 < 0.01, 0, 2)";
    let problem = |regions: &str| {
        let text = format!("mesh = \"plate.msh\"\n{rest}[coefficient]\n{regions}");
        std::fs::write(&path, text).unwrap();
        read(&path).map_err(|error| error.to_string())
    };
    let error = problem(&format!("default = \"{hole}\"\n")).unwrap_err();
    assert!(error.contains("coefficient.default is 0 at (0."), "{error}");
    let AnyOwnProblem::Two(own) =
        problem(&format!("default = \"{hole}\"\ninclusion = 7\n")).unwrap()
    else {
        panic!("in the plane")
    };
    // twice the energy of the first coordinate is the integral of the coefficient
    let mesh = own.mesh::<f64>().unwrap().unwrap().mesh;
    let of = Discretisation::new(&ConformingP1, &own.problem, &mesh, Default::default()).unwrap();
    let slope: Vec<f64> = mesh.vertices().iter().map(|x| x[0]).collect();
    let stiff = |c: &usize| mesh.regions()[mesh.region(*c)].contains(&"inclusion".to_owned());
    let volume =
        |cells: Vec<usize>| -> f64 { cells.into_iter().map(|c| mesh.geometry(c).volume).sum() };
    let (inside, outside) = (0..mesh.n_cells()).partition(stiff);
    let expected = 7.0 * volume(inside) + 2.0 * volume(outside);
    assert!((2.0 * of.energy(&slope).unwrap() / expected - 1.0).abs() < 1e-12);
}

/// Groups whose names fix a kind take no default of another kind: they are missing.
#[test]
fn a_default_is_not_given_to_groups_of_another_kind() {
    let folder = Scratch::new("problem-default-kind");
    std::fs::create_dir_all(&folder.0).unwrap();
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/square.msh");
    let path = folder.0.join("default.toml");
    let problem = |more: &str| {
        let mesh = mesh.display().to_string();
        let text = format!("mesh = {mesh:?}\n[boundary.default]\nkind = \"neumann\"\n{more}");
        std::fs::write(&path, text).unwrap();
        read(&path).map(|_| ()).map_err(|error| error.to_string())
    };
    let dirichlet = "[boundary.dirichlet]\nkind = \"dirichlet\"\n";
    let contact = "[boundary.contact]\nkind = \"contact\"\n";
    for (tables, missing) in [(dirichlet, "contact"), (contact, "dirichlet")] {
        let error = problem(tables).unwrap_err();
        let expected = format!("the boundary group `{missing}` of the mesh is missing");
        assert!(error.contains(&expected), "{error}");
    }
    assert_eq!(problem(&format!("{dirichlet}{contact}")), Ok(()));
}

/// Every kind of datum by region or by side is that of its table.
#[test]
fn tables_of_a_file_become_the_data_of_their_name() {
    let folder = Scratch::new("problem-tables");
    std::fs::create_dir_all(&folder.0).unwrap();
    let plate = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/plate.msh");
    std::fs::copy(plate, folder.0.join("plate.msh")).unwrap();
    let path = folder.0.join("tables.toml");
    let problem = |more: &str| {
        let text = format!(
            "mesh = \"plate.msh\"\n[source]\ninclusion = 4\nmatrix = 5\n\
            [obstacle]\nlower.inclusion = -8\nlower.matrix = -9\n\
            upper.inclusion = 10\nupper.matrix = 11\n\
            [boundary.bore]\nkind = \"dirichlet\"\nvalue = 0.5\n\
            [boundary.edges]\nkind = \"neumann\"\nflux = 12\n\
            [boundary.ends]\nkind = \"contact\"\ngap = -1\n{more}"
        );
        std::fs::write(&path, text).unwrap();
        let AnyOwnProblem::Two(own) = read(&path).unwrap() else { panic!("in the plane") };
        let mesh = own.mesh::<f64>().unwrap().unwrap().mesh;
        (own.problem, mesh)
    };
    let (with_coefficient, mesh) = problem("[coefficient]\ninclusion = 2\nmatrix = 3\n");
    let (with_reaction, _) = problem("[reaction]\ninclusion = 6\nmatrix = 7\n");
    let mut volumes = [0.0; 2];
    for cell in 0..mesh.n_cells() {
        let is_matrix = mesh.regions()[mesh.region(cell)].contains(&"matrix".to_owned());
        volumes[usize::from(is_matrix)] += mesh.geometry(cell).volume;
    }
    let neumann = mesh.boundary().iter().filter(|f| f.part == BoundaryPart::Neumann);
    let measure = |cell: u32, local: u8| mesh.geometry(cell as usize).facet_measure(local.into());
    let length: f64 = neumann.map(|f| measure(f.cell, f.local)).sum();
    fn of<'a>(problem: &'a Problem<2>, mesh: &'a Mesh<f64, 2>) -> Discretisation<'a, f64, 2> {
        Discretisation::new(&ConformingP1, problem, mesh, Default::default()).unwrap()
    }
    // the quadratic and the linear part of the energy of a function, both twice
    let parts = |problem: &Problem<2>, u: fn(&Point<f64, 2>) -> f64| {
        let values: Vec<f64> = mesh.vertices().iter().map(u).collect();
        let opposite: Vec<f64> = values.iter().map(|u| -u).collect();
        let [one, other] = [values, opposite].map(|u| of(problem, &mesh).energy(&u).unwrap());
        [one + other, other - one]
    };
    let [coefficient, _] = parts(&with_coefficient, |x| x[0]);
    let [reaction, load] = parts(&with_reaction, |_| 1.0);
    for (found, expected) in [
        (coefficient, 2.0 * volumes[0] + 3.0 * volumes[1]),
        (reaction, 6.0 * volumes[0] + 7.0 * volumes[1]),
        (load, 2.0 * (4.0 * volumes[0] + 5.0 * volumes[1] + 12.0 * length)),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
    let bounds = of(&with_reaction, &mesh).bounds().unwrap();
    let mut bounds: Vec<String> = bounds.iter().map(|bound| format!("{bound:?}")).collect();
    bounds.sort();
    bounds.dedup();
    // where the regions meet the inner ones, on the ends above the gap
    let expected = ["Both(-1.0, 11.0)", "Both(-8.0, 10.0)", "Both(-9.0, 11.0)", "Fixed(0.5)"];
    assert_eq!(bounds, expected);
}

/// What a condition leaves out need not have a value.
#[test]
fn branches_that_are_not_taken_do_not_count() {
    let folder = Scratch::new("problem-branches");
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("branches.toml");
    let load = "[source]\ndefault = \"if(x > 0 && log(x) < 0, -sqrt(x), -8)\"\n";
    std::fs::write(&path, format!("{BOX}{load}{SIDES}")).unwrap();
    let AnyOwnProblem::Two(own) = read(&path).unwrap() else { panic!("a problem in the plane") };
    let at = |x: f64| own.problem.source.as_ref().unwrap().at(&Point::from([x, 0.5]));
    assert_eq!([at(-0.5), at(0.25)], [-8.0, -0.5]);
}

#[test]
fn bounds_on_constant_data_are_guaranteed() {
    let folder = Scratch::new("problem-constants");
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("constants.toml");
    let data = "[coefficient]\ndefault = 2\n[source]\ndefault = -8\n[reaction]\ndefault = 1\n\
        [obstacle]\nlower.default = -0.1\n";
    let sides = |flux: &str| {
        format!(
            "[boundary.left]\nkind = \"dirichlet\"\n[boundary.right]\nkind = \"dirichlet\"\nvalue = 0\n\
            [boundary.top]\nkind = \"neumann\"\n[boundary.bottom]\nkind = \"neumann\"\nflux = {flux}\n"
        )
    };
    for (flux, is_guaranteed) in
        [("1", true), ("\"1\"", true), ("\"2 * pi - 1\"", true), ("\"1 + sin(x)\"", false)]
    {
        std::fs::write(&path, format!("{BOX}{data}{}", sides(flux))).unwrap();
        let AnyOwnProblem::Two(own) = read(&path).unwrap() else { panic!("in the plane") };
        let Geometry::Box(domain) = &own.geometry else { panic!("a box") };
        let mesh = Mesh::<f64, 2>::kuhn_box(domain, domain.counts(4)).unwrap();
        let solved = solve(&own.problem, &mesh, &ConformingP1).unwrap();
        assert!(solved.active() > Some(0));
        assert_eq!(solved.bound().unwrap().is_guaranteed(), is_guaranteed, "{flux}");
    }
}

/// What is not proven for linears and quadratics with one datum of a file replaced.
#[test]
fn bounds_on_polynomial_data_are_guaranteed() {
    use unilateral::error_bound::Unproven::{self, Boundary, Obstacle, Quadrature};
    let folder = Scratch::new("problem-polynomials");
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("polynomials.toml");
    let base = [
        ("coefficient", "2"),
        ("source", "\"-8 - 3 * x * y^2\""),
        ("reaction", "\"1 + (x + y)^2\""),
        ("lower", "\"0.1 * x - 0.3\""),
        ("value", "\"0.1 - y / 2\""),
        ("flux", "\"nx + x^2 * ny\""),
    ];
    let unproven = |datum: &str, other: &str| -> [Vec<Unproven>; 2] {
        let of = |name: &str| match name == datum {
            true => other,
            false => base.iter().find(|(known, _)| *known == name).unwrap().1,
        };
        let [coefficient, source, reaction, lower, value, flux] = base.map(|(name, _)| of(name));
        let text = format!(
            "{BOX}[coefficient]\ndefault = {coefficient}\n[source]\ndefault = {source}\n\
            [reaction]\ndefault = {reaction}\n[obstacle]\nlower.default = {lower}\n\
            [boundary.left]\nkind = \"dirichlet\"\nvalue = {value}\n\
            [boundary.right]\nkind = \"neumann\"\nflux = {flux}\n\
            [boundary.top]\nkind = \"neumann\"\n[boundary.bottom]\nkind = \"neumann\"\n"
        );
        std::fs::write(&path, text).unwrap();
        let AnyOwnProblem::Two(own) = read(&path).unwrap() else { panic!("in the plane") };
        let Geometry::Box(domain) = &own.geometry else { panic!("a box") };
        let mesh = Mesh::<f64, 2>::kuhn_box(domain, domain.counts(4)).unwrap();
        [&ConformingP1 as &dyn AnyScheme<f64, 2>, &ConformingP2]
            .map(|scheme| solve(&own.problem, &mesh, scheme).unwrap().bound().unwrap().unproven)
    };
    for (datum, other, [of_linears, of_quadratics]) in [
        ("none", "", [vec![], vec![]]),
        ("source", "\"x^12\"", [vec![], vec![]]),
        ("source", "\"x^13\"", [vec![Quadrature], vec![Quadrature]]),
        ("source", "\"abs(x)\"", [vec![Quadrature], vec![Quadrature]]),
        ("coefficient", "\"1 + x^2\"", [vec![Quadrature], vec![Quadrature]]),
        ("reaction", "\"x^3 + 1\"", [vec![Quadrature], vec![Quadrature]]),
        ("lower", "\"-x^2 - 0.5\"", [vec![Obstacle], vec![]]),
        ("lower", "\"x^3 - 0.5\"", [vec![Obstacle], vec![Obstacle]]),
        ("lower", "\"-cosh(x)\"", [vec![Quadrature, Obstacle], vec![Quadrature, Obstacle]]),
        ("value", "\"y^2\"", [vec![Boundary], vec![]]),
        ("value", "\"sin(y)\"", [vec![Boundary], vec![Boundary]]),
        ("flux", "\"y^12\"", [vec![], vec![]]),
        ("flux", "\"exp(y)\"", [vec![Quadrature], vec![Quadrature]]),
    ] {
        assert_eq!(unproven(datum, other), [of_linears, of_quadratics], "{datum} = {other}");
    }
}

/// A file whose exact solution does not solve its problem says so, and what is not fulfilled.
#[test]
fn stated_solutions_are_held_against_the_data() {
    let folder = Scratch::new("problem-exact");
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("exact.toml");
    let base = [
        ("source", "if(x < 0.5, -4, 0)"),
        ("lower", "if(x < 0.5, x^2, x - 0.25) - 1"),
        ("value", "if(x < 0.5, x^2, x - 0.25)"),
        ("flux", "2"),
        ("gap", "-1"),
    ];
    // two is the coefficient of x^2 and of its continuation by a line
    let warnings = |datum: &str, other: &str| -> Vec<String> {
        let of = |(name, own): (&str, &'static str)| match name == datum {
            true => other.to_owned(),
            false => own.to_owned(),
        };
        let [source, lower, value, flux, gap] = base.map(of);
        let text = format!(
            "{BOX}[coefficient]\ndefault = 2\n[source]\ndefault = \"{source}\"\n\
            [obstacle]\nlower.default = \"{lower}\"\n\
            [boundary.left]\nkind = \"dirichlet\"\nvalue = \"{value}\"\n\
            [boundary.right]\nkind = \"neumann\"\nflux = \"{flux}\"\n\
            [boundary.top]\nkind = \"contact\"\ngap = \"{gap}\"\n\
            [boundary.bottom]\nkind = \"neumann\"\nflux = 0\n\
            [exact]\nvalue = \"if(x < 0.5, x^2, x - 0.25)\"\n\
            gradient = [\"if(x < 0.5, 2 * x, 1)\", \"0\"]\n"
        );
        std::fs::write(&path, text).unwrap();
        let AnyOwnProblem::Two(own) = read(&path).unwrap() else { panic!("in the plane") };
        let Geometry::Box(domain) = own.geometry else { panic!("a box") };
        let scene = scenes::Scene::new(own.name, domain, own.problem);
        let study = Study::<f64, 2>::new(scene).scheme(ConformingP1).levels([8]);
        study.run().unwrap().rows.remove(0).warnings
    };
    let doubt = "the stated solution does not solve this problem: not fulfilled: ";
    let found = warnings("none", "");
    assert!(!found.iter().any(|w| w.contains(doubt)), "{found:?}");
    for (datum, other, condition) in [
        ("source", "if(x < 0.5, -3.999, 0)", "-div(alpha grad u) + c u = f off contact"),
        ("lower", "0.9 * x", "solution above the lower obstacle"),
        ("value", "0.001", "Dirichlet data equal to the solution"),
        ("flux", "2.001", "Neumann data equal to the flux of the solution"),
        ("gap", "0.5", "u >= g on the contact part"),
    ] {
        let found = warnings(datum, other);
        let expected = format!("{doubt}{condition}; at [");
        assert!(found.iter().any(|w| w.starts_with(&expected)), "{datum}: {found:?}");
    }
}

#[test]
fn a_source_that_jumps_says_where() {
    let folder = Scratch::new("problem-jump");
    std::fs::create_dir_all(&folder.0).unwrap();
    let path = folder.0.join("jump.toml");
    let ends = "[boundary.left]\nkind = \"dirichlet\"\n[boundary.right]\nkind = \"dirichlet\"\n";
    let load = "[source]\ndefault = { value = \"if(x < 0.3, 1, -1)\", level = \"x - 0.3\" }\n";
    std::fs::write(&path, format!("box = [[0], [1]]\n{ends}{load}")).unwrap();
    let AnyOwnProblem::One(own) = read(&path).unwrap() else { panic!("a problem on an interval") };
    let Geometry::Box(domain) = &own.geometry else { panic!("a box") };
    let mesh = Mesh::<f64, 1>::kuhn_box(domain, [7]).unwrap();
    let of = Discretisation::new(&ConformingP1, &own.problem, &mesh, Default::default()).unwrap();
    // hat functions sum to one: the integral of the load
    let total: f64 = of.load().unwrap().iter().sum();
    assert!((total - (0.3 - 0.7)).abs() < 1e-12, "{total}");
}
