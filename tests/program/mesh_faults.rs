//! Meshes whose contents are not what a user means, or stand in a file in another way.

use super::run::{Scratch, command, data, refused, rows, stderr};
use super::square::Square;

/// Two bodies on each other: with one interface nothing is said, with an interface each their number.
#[test]
fn bodies_meshed_apart_are_a_warning_that_counts_their_facets() {
    let scratch = Scratch::new("apart");
    let run = |name: &str| {
        let output = scratch.run(&format!("{} --scheme p1 --levels 0 --no-fields", data(name)));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stderr(&output)
    };
    let said = run("unfrag");
    let warnings: Vec<&str> = said.lines().filter(|line| line.contains("warning")).collect();
    let [warning] = warnings[..] else { panic!("{said}") };
    for part in ["unfrag.msh: 180 facets of the boundary lie on others", "BooleanFragments"] {
        assert!(warning.contains(part), "{warning}");
    }
    assert!(!run("frag").contains("lie on others"));
}

/// An interface whose nodes are doubled belongs to the boundary, which no group of the file says.
#[test]
fn an_interface_with_doubled_nodes_is_refused_with_the_reason() {
    let scratch = Scratch::new("glued");
    let reason = "is in no group: it lies on another one, with nodes of its own, as 8 facets do";
    refused(&scratch, &[&data("glued")], &["glued.msh", reason, "Coherence", "slit"]);
}

/// A problem in the plane on a file that has only the boundary: the mesh is at fault, not the data.
#[test]
fn a_surface_in_no_physical_group_is_refused_with_the_reason() {
    let scratch = Scratch::new("outline");
    let mesh = scratch.file("outline.msh", &Square::with(|s| s.elements.truncate(4)));
    let text = "mesh = \"outline.msh\"\n[source]\ndefault = \"x * y\"\n\
        [boundary.dirichlet]\nkind = \"dirichlet\"\n";
    let problem = scratch.file("outline.toml", text);
    let reason = "outline.msh: line 14: the file has lines and no triangles";
    let remedy = "Physical Surface(\"domain\")";
    refused(&scratch, &[&problem], &["outline.toml:1:8: ", reason, remedy]);
    refused(&scratch, &["--mesh", &mesh], &[reason, remedy]);
    let named = ["--scene", "radial-2d", "--mesh", &mesh];
    refused(&scratch, &named, &["dimension 1", "put the domain in a physical group"]);
}

#[test]
fn groups_of_interior_facets_are_refused_as_such() {
    let scratch = Scratch::new("wire");
    let inside = "`wire` lies inside the domain, between two cells";
    refused(&scratch, &[&data("wire")], &["wire.toml:", inside, "the mesh has bore, outer"]);
    let mesh = data("holes").replace(".toml", ".msh");
    refused(
        &scratch,
        &["--scene", "radial-2d", "--mesh", &mesh, "--boundary", "wire=dirichlet"],
        &["wire lies inside the domain, between two cells; the boundary has", "outer"],
    );
}

/// What a mesh leaves out of its file is said once.
#[test]
fn what_is_left_out_of_a_file_is_a_warning() {
    let scratch = Scratch::new("left-out");
    let wall = |s: &mut Square| {
        s.names[0] = "1 1 \"wall\"";
        s.elements.push("9 1 2 1 1 2 5");
    };
    let expected = "some facets of group wall lie inside the domain";
    let mesh = scratch.file("mesh.msh", &Square::with(wall));
    let on = format!("--mesh {mesh} --boundary wall=dirichlet");
    let request = format!("--scene radial-2d {on} --scheme p1 --levels 0");
    let output = scratch.run(&format!("{request} --no-fields"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches(expected).count(), 1, "{}", stderr(&output));
    let mut pictures = command("pictures");
    pictures.args(request.replace("--levels", "--level").split_whitespace());
    let output = pictures.args(["--out", &scratch.path("out")]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains(expected), "{}", stderr(&output));
}

/// Files of version 2.2 with coordinates on geometric entities, and with cells that are listed once for each of
/// their groups.
#[test]
fn nodes_with_parameters_and_cells_in_two_groups_are_read() {
    let scratch = Scratch::new("version-two");
    for name in ["h_par22", "twocellgroups"] {
        let options = "--scheme p1,cr,wopsip --levels 0,1 --no-fields --quiet";
        let report = scratch.report(&format!("{} {options}", data(name)));
        assert_eq!(rows(&report).len(), 6);
        for row in rows(&report) {
            // the load is 8, of which the Dirichlet sides carry a part
            let resultant = row["resultant"].as_f64().unwrap();
            assert!(resultant > 1.0 && resultant < 8.0, "{name}: {row}");
        }
    }
}
