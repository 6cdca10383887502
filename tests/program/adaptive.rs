//! The option `--adaptive`.

use serde_json::Value;

use super::run::{Scratch, command, refused, rows, stderr, stdout};

#[test]
fn meshes_follow_the_bound_to_a_goal() {
    let scratch = Scratch::new("adaptive-goal");
    let report = scratch.report("--scene hertz-2d --scheme p1,sipg --adaptive 0.03");
    let request = report["program"]["request"]["adaptive"].as_str().unwrap();
    assert_eq!(request, "theta 0.5 to the bound 0.03, at most 20 steps and 1000000 unknowns");
    for label in ["p1", "sipg"] {
        let of: Vec<&Value> = rows(&report).iter().filter(|row| row["label"] == label).collect();
        let bounds: Vec<f64> =
            of.iter().map(|row| row["bound"]["discrete"].as_f64().unwrap()).collect();
        let (last, before) = bounds.split_last().unwrap();
        assert!(*last <= 0.03 && before.iter().all(|bound| *bound > 0.03), "{bounds:?}");
        assert!(of.iter().enumerate().all(|(step, row)| row["level"] == step));
        assert!(of.iter().all(|row| row["theta"] == 0.5));
        let name = format!("out/hertz-2d-{label}");
        for ending in ["vtu", "svg"] {
            assert!(scratch.0.join(format!("{name}.{ending}")).exists(), "{name}.{ending}");
        }
    }
}

#[test]
fn meshes_follow_the_bound_by_keys() {
    let scratch = Scratch::new("adaptive-keys");
    let keys = "theta=0.7,steps=3,unknowns=1e3";
    let options = format!("--scene signorini-harmonic-3d --scheme p1 --levels 2 --adaptive {keys}");
    let output = scratch.run(&options);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("bound (order)"), "{}", stdout(&output));
    let report = scratch.report(&options);
    let rows = rows(&report);
    assert!(rows.len() > 1 && rows.len() <= 4);
    assert!(rows.iter().all(|row| row["unknowns"].as_u64() <= Some(1000)));
    assert_eq!(report["program"]["request"]["first level"], "2");
    // a goal out of reach ends with a warning
    let report = scratch.report("--scene hertz-2d --scheme p1 --adaptive goal=1e-9,steps=2");
    let last = &report["rows"].as_array().unwrap()[2];
    let warning = last["warnings"][0].as_str().unwrap();
    assert!(warning.contains("above the goal 1e-9: the number of refinements"), "{warning}");
}

#[test]
fn a_problem_of_a_file_is_refined_on_its_mesh() {
    let scratch = Scratch::new("adaptive-own");
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/problems");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|file| file.unwrap().path().display().to_string())
        .filter(|path| path.ends_with(".toml"))
        .collect();
    files.sort();
    let report = scratch.report(&format!("{} --scheme p1,cr --adaptive steps=2", files[0]));
    let rows = rows(&report);
    assert_eq!(rows.len(), 6);
    assert!(rows.chunks(3).all(|steps| {
        let bound = |row: &Value| row["bound"]["discrete"].as_f64().unwrap();
        bound(&steps[2]) < bound(&steps[0])
    }));
}

#[test]
fn wrong_requests_are_refused() {
    let scratch = Scratch::new("adaptive-refused");
    let cases: &[(&str, &[&str])] = &[
        ("--adaptive", &["--adaptive", "value is required"]),
        ("--adaptive 0", &["goal = 0.0", "positive"]),
        ("--adaptive -1", &["goal = -1.0", "positive"]),
        ("--adaptive theta=2", &["theta = 2.0", "(0, 1]"]),
        ("--adaptive theta=much", &["theta takes a number", "much"]),
        ("--adaptive steps=1.5", &["steps takes a whole number", "1.5"]),
        ("--adaptive size=4", &["size=4", "theta=X", "unknowns=N"]),
        ("--adaptive goal=1,tolerance=0.1", &["tolerance=0.1", "goal=X"]),
        ("--adaptive 0.1 --reference 64", &["--adaptive", "--reference", "cannot be used"]),
        ("--adaptive 0.1 --resume", &["--adaptive", "--resume", "cannot be used"]),
        ("--adaptive 0.1 --dump d", &["--adaptive", "--dump", "cannot be used"]),
        ("--adaptive 0.1 --levels 4,8", &["number of levels = 2"]),
        ("--adaptive 0.1 --scene disc-2d", &["bisection does not follow a circle"]),
    ];
    for (options, expected) in cases {
        refused(&scratch, &options.split(' ').collect::<Vec<_>>(), expected);
    }
}

#[test]
fn every_mesh_of_the_sequence_is_drawn() {
    let scratch = Scratch::new("adaptive-pictures");
    let out = scratch.path("pictures");
    let options = "--scene hertz-2d --scheme sipg --level 2 --adaptive steps=2";
    let output =
        command("pictures").args(options.split(' ')).args(["--out", &out]).output().unwrap();
    assert_eq!((output.status.code(), &stderr(&output)[..]), (Some(0), ""));
    for step in 0..=2 {
        let file = scratch.0.join(format!("pictures/hertz-2d-sipg-{step}.svg"));
        let svg = std::fs::read_to_string(&file).unwrap();
        assert!(svg.contains("contact set"), "{}", file.display());
    }
    assert!(!scratch.0.join("pictures/hertz-2d-sipg-3.svg").exists());
}
