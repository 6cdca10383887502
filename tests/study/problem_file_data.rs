//! The data of problems from TOML files: which table gives which datum, and where data need values.

use std::path::Path;

use super::problem_files::{BOX, SIDES, problem};
use crate::support::scratch::Scratch;
use unilateral::mesh::{BoundaryCondition, Mesh};
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::problem_file::read;
use unilateral::scenes::AnyScene;

/// Which data must have values at vertices: those that nodes or gradients read there, and no others.
#[test]
fn data_are_held_against_vertices_where_nodes_read_them() {
    let folder = Scratch::new("problem-vertices");
    let fault = |text: &str| problem(&folder, text).err().map(|error| error.to_string());
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
    let plate = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/plate.msh");
    std::fs::copy(plate, folder.0.join("plate.msh")).unwrap();
    let rest = "[boundary.default]\nkind = \"neumann\"\n";
    let hole = "if((x - 0.8)^2 < 0.01 && y^2 < 0.01, 0, 2)";
    let of_regions = |regions: &str| {
        problem(&folder, &format!("mesh = \"plate.msh\"\n{rest}[coefficient]\n{regions}"))
    };
    let error = of_regions(&format!("default = \"{hole}\"\n")).unwrap_err().to_string();
    assert!(error.contains("coefficient.default is 0 at (0."), "{error}");
    let own = of_regions(&format!("default = \"{hole}\"\ninclusion = 7\n")).unwrap();
    // twice the energy of the first coordinate is the integral of the coefficient
    let mesh = own.domain.mesh(0).unwrap();
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
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/square.msh");
    let of_tables = |more: &str| {
        let mesh = mesh.display().to_string();
        let text = format!("mesh = {mesh:?}\n[boundary.default]\nkind = \"neumann\"\n{more}");
        problem(&folder, &text).map(|_| ()).map_err(|error| error.to_string())
    };
    let dirichlet = "[boundary.dirichlet]\nkind = \"dirichlet\"\n";
    let contact = "[boundary.contact]\nkind = \"contact\"\n";
    for (tables, missing) in [(dirichlet, "contact"), (contact, "dirichlet")] {
        let error = of_tables(tables).unwrap_err();
        let expected = format!("the boundary group `{missing}` of the mesh is missing");
        assert!(error.contains(&expected), "{error}");
    }
    assert_eq!(of_tables(&format!("{dirichlet}{contact}")), Ok(()));
}

/// A default goes to a group by the name that no group with a table has: the bottom alone is a Dirichlet side.
#[test]
fn a_default_is_given_by_a_name_of_no_other_table() {
    let folder = Scratch::new("problem-default-name");
    let nodes = "4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n";
    let names = "4\n1 1 \"wall\"\n1 2 \"left\"\n1 3 \"bottom\"\n1 4 \"others\"\n";
    let elements = "8\n1 1 2 1 1 4 1\n2 1 2 2 1 4 1\n3 1 2 1 2 1 2\n4 1 2 3 2 1 2\n5 1 2 4 3 2 3\n\
                    6 1 2 4 4 3 4\n7 2 2 9 1 1 2 3\n8 2 2 9 1 1 3 4\n";
    let of = |name: &str, text: &str| format!("${name}\n{text}$End{name}\n");
    let mesh = [("MeshFormat", "2.2 0 8\n"), ("PhysicalNames", names), ("Nodes", nodes)];
    let mesh: String = mesh.into_iter().map(|(name, text)| of(name, text)).collect();
    folder.file("wall.msh", &(mesh + &of("Elements", elements)));
    let text = "mesh = \"wall.msh\"\n[boundary.default]\nkind = \"dirichlet\"\n\
                [boundary.left]\nkind = \"neumann\"\nflux = 1\n[boundary.others]\nkind = \"neumann\"\n";
    let scene = problem(&folder, text).unwrap();
    let mesh = scene.domain.mesh(0).unwrap();
    let facets = mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Dirichlet);
    let middles: Vec<Point<2>> =
        facets.map(|f| mesh.facet_barycentre(f.cell as usize, f.local as usize)).collect();
    assert_eq!(middles, [Point::from([0.5, 0.0])]);
}

/// Whole numbers of a file may have another radix.
#[test]
fn numbers_are_those_of_toml() {
    let folder = Scratch::new("problem-radix");
    let text = "box = [[0], [0b11]]\n[boundary.default]\nkind = \"dirichlet\"\n\
                [source]\ndefault = 0x1f\n[reaction]\ndefault = 1_0\n";
    let read = read(Path::new(&folder.file("line.toml", text))).unwrap();
    let AnyScene::One(scene) = read.scene else { panic!("a line") };
    let at = |datum: &Datum<1>| datum.at(&Point::zeros());
    assert_eq!(scene.problem.source.everywhere.as_ref().map(at), Some(31.0));
    assert_eq!(scene.problem.reaction.everywhere.as_ref().map(at), Some(10.0));
    assert_eq!(scene.domain.bounding_box().upper, Point::from([3.0]));
}

/// A number and a tensor of two groups of cells are two coefficients, not factors of one.
#[test]
fn numbers_and_tensors_of_a_coefficient_exclude_each_other() {
    let folder = Scratch::new("problem-tensors");
    let plate = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/plate.msh");
    std::fs::copy(plate, folder.0.join("plate.msh")).unwrap();
    let [two, three] = ["[[2, 0], [0, 2]]", "[[3, 0], [0, 3]]"];
    let energies = [("3", "2"), ("3", two), (three, "2"), (three, two)].map(|(default, of_one)| {
        let text = format!(
            "mesh = \"plate.msh\"\n[coefficient]\ndefault = {default}\ninclusion = {of_one}\n\
             [boundary.default]\nkind = \"dirichlet\"\n"
        );
        let own = problem(&folder, &text).unwrap();
        let mesh = own.domain.mesh(0).unwrap();
        let of = Discretisation::new(&ConformingP1, &own.problem, &mesh, Default::default());
        let values: Vec<f64> = mesh.vertices().iter().map(|x| x[0]).collect();
        of.unwrap().energy(&values).unwrap()
    });
    assert!(energies[0] > 1.0);
    for energy in &energies[1..] {
        assert!((energy / energies[0] - 1.0).abs() < 1e-13, "{energies:?}");
    }
}

/// A facet in two groups has a flux or Robin data, not both.
#[test]
fn a_flux_and_robin_data_on_one_facet_are_refused() {
    let folder = Scratch::new("problem-two-groups");
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"left\"\n\
        1 2 \"rest\"\n1 3 \"extra\"\n$EndPhysicalNames\n\
        $Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n\
        $Elements\n7\n1 1 2 1 1 4 1\n2 1 2 3 1 4 1\n3 1 2 2 2 1 2\n4 1 2 2 3 2 3\n\
        5 1 2 2 4 3 4\n6 2 2 4 5 1 2 3\n7 2 2 4 5 1 3 4\n$EndElements\n";
    folder.file("square.msh", mesh);
    let text = "mesh = \"square.msh\"\n[boundary.extra]\nkind = \"neumann\"\nflux = 100\n\
        [boundary.left]\nkind = \"robin\"\ncoefficient = 1\n[boundary.rest]\nkind = \"neumann\"\n";
    let own = problem(&folder, text).unwrap();
    let mesh = own.domain.mesh(0).unwrap();
    let refused = Discretisation::new(&ConformingP1, &own.problem, &mesh, Default::default());
    let message = refused.map(|_| ()).unwrap_err().to_string();
    assert!(message.contains("extra") && message.contains("a flux, Robin data"), "{message}");
}

/// Every kind of datum by region or by side is that of its table.
#[test]
fn tables_of_a_file_become_the_data_of_their_name() {
    let folder = Scratch::new("problem-tables");
    let plate = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/plate.msh");
    std::fs::copy(plate, folder.0.join("plate.msh")).unwrap();
    let with = |more: &str| {
        let text = format!(
            "mesh = \"plate.msh\"\n[source]\ninclusion = 4\nmatrix = 5\n\
            [obstacle]\nlower.inclusion = -8\nlower.matrix = -9\n\
            upper.inclusion = 10\nupper.matrix = 11\n\
            [boundary.bore]\nkind = \"dirichlet\"\nvalue = 0.5\n\
            [boundary.edges]\nkind = \"neumann\"\nflux = 12\n\
            [boundary.ends]\nkind = \"contact\"\ngap = -1\n{more}"
        );
        let own = problem(&folder, &text).unwrap();
        let mesh = own.domain.mesh(0).unwrap();
        (own.problem, mesh)
    };
    let (with_coefficient, mesh) = with("[coefficient]\ninclusion = 2\nmatrix = 3\n");
    let (with_reaction, _) = with("[reaction]\ninclusion = 6\nmatrix = 7\n");
    let mut volumes = [0.0; 2];
    for cell in 0..mesh.n_cells() {
        let is_matrix = mesh.regions()[mesh.region(cell)].contains(&"matrix".to_owned());
        volumes[usize::from(is_matrix)] += mesh.geometry(cell).volume;
    }
    let neumann = mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Neumann);
    let measure = |cell: u32, local: u8| mesh.geometry(cell as usize).facet_measure(local.into());
    let length: f64 = neumann.map(|f| measure(f.cell, f.local)).sum();
    fn of<'a>(problem: &'a Problem<2>, mesh: &'a Mesh<2>) -> Discretisation<'a, 2> {
        Discretisation::new(&ConformingP1, problem, mesh, Default::default()).unwrap()
    }
    // the quadratic and the linear part of the energy of a function, both twice
    let parts = |problem: &Problem<2>, u: fn(&Point<2>) -> f64| {
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
