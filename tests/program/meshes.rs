//! Meshes of users, wrong and right.

use serde_json::Value;

use super::run::{Scratch, command, refused, rows, stderr};
use super::square::Square;

#[test]
fn wrong_meshes_are_refused() {
    let scratch = Scratch::new("meshes");
    let sound = Square::sound();
    let without_groups = Square::with(|s| {
        s.names.clear();
        s.elements = vec!["1 1 0 1 2", "5 2 0 1 2 5", "6 2 0 2 3 5", "7 2 0 3 4 5", "8 2 0 4 1 5"];
    });
    let cases: &[(&str, &str, String, &[&str])] = &[
        ("radial-2d", "empty", String::new(), &["not a Gmsh mesh"]),
        ("radial-2d", "prose", "Dear reader,\n".into(), &["not a Gmsh mesh", "$MeshFormat"]),
        ("radial-2d", "half", sound[..sound.len() / 2].into(), &["the end of the file", "line"]),
        (
            "radial-2d",
            "three-quarters",
            sound[..sound.len() * 3 / 4].into(),
            &["the end of the file"],
        ),
        ("radial-2d", "groups", without_groups, &["physical group", "dirichlet"]),
        (
            "radial-2d",
            "wall",
            Square::with(|s| s.names[0] = "1 1 \"wall\""),
            &["boundary group wall", "--boundary wall=dirichlet, wall=neumann or wall=contact"],
        ),
        ("radial-2d", "words", Square::with(|s| s.nodes[0] = "1 zero 0 0"), &["`zero`", "line 1"]),
        ("radial-2d", "nan", Square::with(|s| s.nodes[0] = "1 nan 0 0"), &["NaN", "finite"]),
        (
            "radial-2d",
            "flat",
            Square::with(|s| s.nodes[4] = "5 0.5 0 0"),
            &["degenerate", "element 5"],
        ),
        (
            "radial-2d",
            "twice",
            Square::with(|s| s.elements.push("9 2 2 9 1 5 1 2")),
            &["same vertices", "element 9"],
        ),
        (
            "radial-2d",
            "untagged",
            Square::with(|s| s.elements.retain(|e| !e.starts_with("1 "))),
            &["is in no group", "dirichlet, neumann, contact"],
        ),
        (
            "radial-2d",
            "both",
            Square::with(|s| s.elements.push("9 1 2 3 1 1 2")),
            &["two groups", "dirichlet and neumann", "different boundary conditions"],
        ),
        (
            "radial-2d",
            "range",
            Square::with(|s| s.elements[7] = "8 2 2 9 1 4 1 6"),
            &["element 8", "node 6"],
        ),
        ("radial-2d", "touching", Square::in_contact(), &["radial-2d", "\"contact\""]),
        ("signorini-2d", "free", sound.clone(), &["signorini-2d", "\"contact\""]),
        ("radial-3d", "plane", sound.clone(), &["dimension 2", "radial-3d", "unilateral list"]),
        ("nowhere", "fine", sound.clone(), &["unknown scene \"nowhere\"", "radial-2d"]),
    ];
    for (scene, name, mesh, expected) in cases {
        let path = scratch.file(&format!("{name}.msh"), mesh);
        refused(&scratch, &["--scene", scene, "--mesh", &path], expected);
        let names_file = expected[0].contains("dimension") || expected[0].contains("unknown");
        if !names_file {
            refused(&scratch, &["--scene", scene, "--mesh", &path], &[&format!("{name}.msh")]);
        }
    }
    let missing = scratch.path("missing.msh");
    refused(&scratch, &["--mesh", &missing], &["cannot read", "missing.msh"]);
    let directory = scratch.0.display().to_string();
    refused(&scratch, &["--mesh", &directory], &["cannot read", &directory]);
    let path = scratch.file("sound.msh", &sound);
    refused(
        &scratch,
        &["--scene", "radial-2d", "--mesh", &path, "--levels", "40"],
        &["level = 40"],
    );
}

#[test]
fn meshes_of_gmsh_are_refined_and_choose_their_scenes() {
    let scratch = Scratch::new("refined");
    let sound = scratch.file("sound.msh", &Square::sound());
    let touching = scratch.file("touching.msh", &Square::in_contact());

    let report = scratch.report(&format!("--scene radial-2d --mesh {sound} --levels 0,1 --quiet"));
    let cells: Vec<&Value> = rows(&report).iter().map(|row| &row["cells"]).collect();
    assert_eq!(cells, [4, 16].repeat(4));

    // Without a name, and for all, the scenes are those the mesh fits.
    for (mesh, signorini) in [(&sound, false), (&touching, true)] {
        let report = scratch.report(&format!("--mesh {mesh} --levels 0 --scheme p1 --quiet"));
        let names: Vec<&str> = rows(&report).iter().map(|r| r["scene"].as_str().unwrap()).collect();
        assert_eq!(names.contains(&"radial-2d"), !signorini, "{names:?}");
        assert_eq!(names.contains(&"signorini-2d"), signorini, "{names:?}");
    }
}

/// Work-precision on a mesh has the errors of a comparison on it.
#[test]
fn work_precision_runs_on_refinements_of_a_mesh() {
    let scratch = Scratch::new("work-mesh");
    let mesh = scratch.file("sound.msh", &Square::sound());
    let schemes = "--scheme p1,wopsip:facet-means@factor=10 --levels 0,1";
    let out = scratch.path("work");
    let run = |options: &str| {
        let output = command("work-precision").args(options.split_whitespace()).output().unwrap();
        (output.status.code(), stderr(&output))
    };
    let options =
        format!("--scene radial-2d --mesh {mesh} {schemes} --rounds 2 --quiet --out {out}");
    assert_eq!(run(&options), (Some(0), String::new()));
    let text = std::fs::read_to_string(std::path::Path::new(&out).join("report.json")).unwrap();
    let work: Value = serde_json::from_str(&text).unwrap();
    assert!(work["program"]["request"]["mesh"].is_string(), "{}", work["program"]);
    let compared = scratch.report(&format!("--scene radial-2d --mesh {mesh} {schemes} --quiet"));
    for here in rows(&work) {
        assert!(here["peak_memory_bytes"].as_u64() > Some(0), "{here}");
        assert_eq!(here["runs"].as_array().map(Vec::len), Some(2), "{here}");
        let same = |row: &&Value| ["label", "level"].iter().all(|key| row[key] == here[key]);
        let there = rows(&compared).iter().find(same).unwrap();
        let l2 = |row: &Value| row["error"]["l2"].as_f64().unwrap();
        assert!((l2(here) - l2(there)).abs() <= 1e-12 * l2(there), "{here} {there}");
    }
    assert_eq!(rows(&work).len(), 4);

    let wrong = |options: &str| {
        let (code, message) = run(options);
        assert_eq!(code, Some(2), "{options}: {message}");
        message
    };
    assert!(wrong(&format!("--scene radial-3d --mesh {mesh} --levels 0")).contains("sound.msh"));
    assert!(wrong("--scene radial-2d --contrast 1e4").contains("none of the scenes chosen"));
}
