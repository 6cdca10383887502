//! Problems from TOML files.

use crate::support::scratch::Scratch;
use std::path::Path;
use unilateral::mesh::{BoundaryCondition, Domain, Mesh};
use unilateral::prelude::*;
use unilateral::problem_file::{ProblemFileError, read};
use unilateral::scenes::AnyScene;

/// A problem in the plane, of a file with this text.
pub fn problem(folder: &Scratch, text: &str) -> Result<Scene<2>, ProblemFileError> {
    match read(Path::new(&folder.file("plane.toml", text)))?.scene {
        AnyScene::Two(own) => Ok(own),
        _ => panic!("a problem in the plane"),
    }
}

fn example(name: &str) -> AnyScene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems");
    read(&folder.join(name)).unwrap().scene
}

/// Solves a problem on its mesh and one refinement of it with several schemes; the sums of the multipliers
/// of each.
fn solve_all<const D: usize>(own: &Scene<D>) -> Vec<f64> {
    let mesh = own.domain.mesh(0).unwrap();
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
    let AnyScene::Two(own) = example("plate.toml") else { panic!("a problem in the plane") };
    assert_eq!(own.name, "plate");
    let mut mesh = own.domain.mesh(0).unwrap();
    let stiff = mesh.regions().iter().position(|names| names == &["inclusion"]).unwrap();
    let cells = |mesh: &Mesh<2>| -> Vec<bool> {
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
    let AnyScene::Three(own) = example("bracket.toml") else { panic!("a problem in space") };
    let mesh = own.domain.mesh(0).unwrap();
    assert!(
        mesh.has_condition(BoundaryCondition::Contact)
            && !mesh.has_condition(BoundaryCondition::Dirichlet)
    );
    // weight, and the traction on the head, whose mean over the head is -2
    let load = -(0.6 * 0.3 + 0.3 * 0.6 * 0.9) - 2.0 * 0.3 * 0.6;
    for force in solve_all(&own) {
        assert!((force + load).abs() < 1e-8 * load.abs(), "{force} {load}");
    }
}

#[test]
fn the_membrane_touches_both_obstacles() {
    let AnyScene::Two(own) = example("membrane.toml") else { panic!("a problem in the plane") };
    let mesh = own.domain.mesh(0).unwrap();
    let solved = solve(&own.problem, &mesh, &ConformingP1).unwrap();
    let multiplier = solved.multiplier().unwrap();
    assert!(multiplier.iter().any(|&m| m > 0.0) && multiplier.iter().any(|&m| m < 0.0));
    solve_all(&own);
}

pub const BOX: &str = "box = [[-1, 0], [1, 1]]\n";
pub const SIDES: &str = "[boundary.left]\nkind = \"dirichlet\"\nvalue = \"x * y\"\n\
    [boundary.right]\nkind = \"dirichlet\"\nvalue = \"x * y\"\n\
    [boundary.top]\nkind = \"neumann\"\nflux = \"x * ny\"\n\
    [boundary.bottom]\nkind = \"contact\"\ngap = -1\n";

#[test]
fn a_box_has_sides_and_an_exact_solution() {
    let folder = Scratch::new("problem-box");
    let exact = "[exact]\nvalue = \"x * y\"\ngradient = [\"y\", \"x\"]\n";
    let text = format!("{BOX}{SIDES}{exact}[reaction]\ndefault = 0\n");
    let own = problem(&folder, &text).unwrap();
    assert_eq!(own.name, "plane", "the name of the file");
    let Domain::Box(domain) = &own.domain else { panic!("a box") };
    assert_eq!(domain.sides[1], [BoundaryCondition::Contact, BoundaryCondition::Neumann]);
    let mesh = own.domain.mesh(4).unwrap();
    let solved = solve(&own.problem, &mesh, &ConformingP2).unwrap();
    assert!(
        solved.errors().unwrap().l2.unwrap() > 1e-3,
        "the flux -x on the bottom is held by nothing"
    );
    let flux = "[boundary.bottom]\nkind = \"neumann\"\nflux = \"x * ny\"\n";
    let sides = SIDES.split("[boundary.bottom]").next().unwrap();
    let own = problem(&folder, &format!("{BOX}{sides}{flux}{exact}")).unwrap();
    let mesh = own.domain.mesh(4).unwrap();
    let solved = solve(&own.problem, &mesh, &ConformingP2).unwrap();
    assert!(solved.errors().unwrap().l2.unwrap() < 1e-12);
}

/// What a condition leaves out need not have a value.
#[test]
fn branches_that_are_not_taken_do_not_count() {
    let folder = Scratch::new("problem-branches");
    let load = "[source]\ndefault = \"if(x > 0 && log(x) < 0, -sqrt(x), -8)\"\n";
    let own = problem(&folder, &format!("{BOX}{load}{SIDES}")).unwrap();
    let at = |x: f64| own.problem.source.everywhere.as_ref().unwrap().at(&Point::from([x, 0.5]));
    assert_eq!([at(-0.5), at(0.25)], [-8.0, -0.5]);
}

#[test]
fn bounds_on_constant_data_are_guaranteed() {
    let folder = Scratch::new("problem-constants");
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
        let own = problem(&folder, &format!("{BOX}{data}{}", sides(flux))).unwrap();
        let mesh = own.domain.mesh(4).unwrap();
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
        let own = problem(&folder, &text).unwrap();
        let mesh = own.domain.mesh(4).unwrap();
        [&ConformingP1 as &dyn Scheme<2>, &ConformingP2]
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
        let own = problem(&folder, &text).unwrap();
        let study = Study::<2>::new(own).scheme(ConformingP1).levels([8]);
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
        ("gap", "0.5", "u >= g on the contact boundary"),
    ] {
        let found = warnings(datum, other);
        let expected = format!("{doubt}{condition}; at [");
        assert!(found.iter().any(|w| w.starts_with(&expected)), "{datum}: {found:?}");
    }
}

#[test]
fn a_source_that_jumps_says_where() {
    let folder = Scratch::new("problem-jump");
    let ends = "[boundary.left]\nkind = \"dirichlet\"\n[boundary.right]\nkind = \"dirichlet\"\n";
    let load = "[source]\ndefault = { value = \"if(x < 0.3, 1, -1)\", level = \"x - 0.3\" }\n";
    let path = folder.file("jump.toml", &format!("box = [[0], [1]]\n{ends}{load}"));
    let own = read(Path::new(&path)).unwrap().scene;
    let AnyScene::One(own) = own else { panic!("a problem on an interval") };
    assert!(matches!(own.domain, Domain::Box(_)));
    let mesh = own.domain.mesh(7).unwrap();
    let of = Discretisation::new(&ConformingP1, &own.problem, &mesh, Default::default()).unwrap();
    // hat functions sum to one: the integral of the load
    let total: f64 = of.load().unwrap().iter().sum();
    assert!((total - (0.3 - 0.7)).abs() < 1e-12, "{total}");
}
