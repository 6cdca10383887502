//! Inequalities as files, and vectors of other programs judged.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use unilateral::exchange::read_vector;
use unilateral::prelude::*;

use super::run::{Scratch, command, rows, stderr, stdout};

fn judge(folder: &Path, vector: &str, options: &[&str]) -> Output {
    command("judge").arg(folder).arg(folder.join(vector)).args(options).output().unwrap()
}

/// The values of a scheme on a scene.
fn solution(scheme: &dyn Scheme<2>, level: usize) -> Vec<f64> {
    let scene = scenes::radial::<2>(1.0);
    let meshes = Hierarchy::of_domain(&scene.domain, level).unwrap();
    solve(&scene.problem, &meshes, scheme).unwrap().values().to_vec()
}

#[test]
fn a_vector_that_comes_back_has_the_row_of_the_run() {
    let scratch = Scratch::new("dump");
    let dump = scratch.path("dump");
    let schemes: [(&str, &dyn Scheme<2>); 2] = [
        ("p1", &ConformingP1),
        ("wopsip@factor=10", &Wopsip { eta: Eta::Dimensionless(10.0), ..Wopsip::default() }),
    ];
    let report = scratch.report(&format!(
        "--scene radial-2d --scheme p1,wopsip@factor=10 --levels 8 --quiet --dump {dump}"
    ));
    for ((label, scheme), expected) in schemes.into_iter().zip(rows(&report)) {
        let name = format!("radial-2d-{}-8", label.replace(['@', '='], "-"));
        let folder = Path::new(&dump).join(name);
        let values = solution(scheme, 8);
        let n = values.len();
        let load = read_vector(folder.join("load.npy")).unwrap();
        let [lower, upper] =
            ["lower.npy", "upper.npy"].map(|name| read_vector(folder.join(name)).unwrap());
        assert_eq!([load.len(), lower.len(), upper.len()], [n; 3]);
        // NumPy has the data begin at a multiple of 64
        let length = fs::metadata(folder.join("load.npy")).unwrap().len();
        assert_eq!((length - 8 * n as u64) % 64, 0);
        assert!(upper.contains(&f64::INFINITY));
        // the load of the assembled matrix, weak Dirichlet data included
        let scene = scenes::radial::<2>(1.0);
        let meshes = Hierarchy::of_domain(&scene.domain, 8).unwrap();
        let of = Discretisation::new(scheme, &scene.problem, meshes.finest(), Default::default());
        let of = of.unwrap();
        let largest = load.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
        let is_close = |(a, b): (&f64, f64)| (a - b).abs() <= 1e-13 * largest;
        assert!(load.iter().zip(of.load().unwrap()).all(is_close), "{label}");
        let within = |(x, (l, u)): (&f64, (&f64, &f64))| *x >= l - 1e-9 && *x <= u + 1e-9;
        assert!(values.iter().zip(lower.iter().zip(&upper)).all(within));
        let matrix = fs::read_to_string(folder.join("matrix.mtx")).unwrap();
        let size = format!("{n} {n} {}", expected["nonzeros"]);
        assert_eq!(matrix.lines().nth(1), Some(&size[..]));
        assert_eq!(matrix.lines().count(), 2 + expected["nonzeros"].as_u64().unwrap() as usize);
        let places = fs::read_to_string(folder.join("places.csv")).unwrap();
        assert!(places.starts_with("unknown,cell,x,y,vertices\n"), "{places}");
        assert_eq!(places.lines().count(), n + 1);

        let text: Vec<String> = values.iter().map(|x| format!("{x:e}")).collect();
        fs::write(folder.join("u.txt"), text.join("\n")).unwrap();
        let output = judge(&folder, "u.txt", &["--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let judged: Value = serde_json::from_str(&stdout(&output)).unwrap();
        let row = &rows(&judged)[0];
        for (outer, inner) in [("error", "l2"), ("error", "energy"), ("error", "max")] {
            let [a, b] = [row, expected].map(|r| r[outer][inner].as_f64().unwrap());
            assert!((a / b - 1.0).abs() < 1e-9, "{label} {outer}.{inner}: {a} and {b}");
        }
        for key in ["energy", "resultant", "contact_measure"] {
            let [a, b] = [row, expected].map(|r| r[key].as_f64().unwrap());
            assert!((a / b - 1.0).abs() < 1e-9, "{label} {key}: {a} and {b}");
        }
        assert_eq!(row["active"], expected["active"]);
        assert_eq!([&row["label"], &row["solver"]], [label, "none"]);
        assert!(row["iterations"]["outer"].is_null());
        let output = judge(&folder, "u.txt", &[]);
        assert!(stdout(&output).contains("certificate: feasibility"), "{}", stdout(&output));

        for wrong in [values.iter().map(|x| x + 1e-3).collect(), vec![0.0; n]] {
            let wrong: Vec<String> = wrong.iter().map(|x: &f64| format!("{x:e}")).collect();
            fs::write(folder.join("wrong.txt"), wrong.join(" ")).unwrap();
            let output = judge(&folder, "wrong.txt", &[]);
            assert_eq!(output.status.code(), Some(1));
            let words = "not-a-solution: the values do not satisfy the inequality";
            assert!(stdout(&output).contains(words), "{}", stdout(&output));
        }
        let mut infinite = text;
        infinite[2] = "nan".to_owned();
        fs::write(folder.join("nan.txt"), infinite.join(" ")).unwrap();
        let output = judge(&folder, "nan.txt", &[]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("NaN at position 2"), "{}", stderr(&output));
        fs::write(folder.join("short.txt"), "1 2 3").unwrap();
        let output = judge(&folder, "short.txt", &[]);
        assert_eq!(output.status.code(), Some(2));
        let message = format!("number of values = 3: {} has {n} unknowns", scheme.name());
        assert!(stderr(&output).contains(&message), "{}", stderr(&output));
        let output = judge(&folder, "nowhere.npy", &[]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("cannot read"), "{}", stderr(&output));
    }
}

/// The Python program of the examples, with the active set method and with Clarabel.
#[test]
#[ignore = "needs Python with SciPy and Clarabel"]
fn needs_scipy() {
    let scratch = Scratch::new("scipy");
    let dump = scratch.path("dump");
    let scenes = "radial-2d,signorini-2d,friction-2d";
    scratch.report(&format!("--scene {scenes} --scheme p1,sipg --levels 16 --quiet --dump {dump}"));
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/solve_elsewhere.py");
    let python = std::env::var("UNILATERAL_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let labels = |scene: &str| ["p1", "sipg"].map(|scheme| format!("{scene}-{scheme}-16"));
    for name in scenes.split(',').flat_map(labels) {
        let folder = Path::new(&dump).join(&name);
        for solver in ["active-set", "clarabel"] {
            let run = Command::new(&python).arg(script).arg(&folder).arg(solver).output().unwrap();
            assert!(run.status.success(), "{name}, {solver}: {}", stderr(&run));
            let output = judge(&folder, "u.npy", &["--json"]);
            let judged: Value = serde_json::from_str(&stdout(&output)).unwrap();
            let certificate = &rows(&judged)[0]["certificate"];
            println!("{name}, {solver}: {certificate}");
            let keys = ["feasibility", "multiplier", "complementarity", "residual"];
            // the interior point method has a tolerance of 1e-11 on the energy, a square
            let limit = if solver == "clarabel" { 1e-5 } else { 1e-10 };
            assert!(keys.iter().all(|key| certificate[key].as_f64().unwrap() < limit), "{name}");
        }
    }
}

#[test]
fn a_problem_that_changed_since_the_dump_is_noticed() {
    let scratch = Scratch::new("changed");
    let text = "box = [[0], [1]]\n[boundary.left]\nkind = \"dirichlet\"\n[boundary.right]\n\
        kind = \"dirichlet\"\n[obstacle]\nlower.default = -0.1\n[source]\ndefault = -4\n";
    let path = scratch.file("rod.toml", text);
    let dump = scratch.path("dump");
    scratch.report(&format!("{path} --scheme p1 --levels 8 --dump {dump}"));
    let folder = Path::new(&dump).join("rod-p1-8");
    fs::write(folder.join("u.txt"), "0 0 0 0 0 0 0 0 0").unwrap();
    // the values violate nothing but the residual
    assert_eq!(judge(&folder, "u.txt", &[]).status.code(), Some(1));
    fs::remove_file(&path).unwrap();
    assert_eq!(judge(&folder, "u.txt", &[]).status.code(), Some(2));
    scratch.file("rod.toml", &text.replace("-4", "-5"));
    let output = judge(&folder, "u.txt", &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("is not what it was"), "{}", stderr(&output));
}

/// Errors against a reference are those of the run.
#[test]
fn a_vector_is_judged_against_the_reference_of_its_run() {
    let scratch = Scratch::new("dump-reference");
    let dump = scratch.path("dump");
    let options = "--scene radial-2d --scheme p1 --levels 4,8 --quiet --reference cr@level=32";
    let report = scratch.report(&format!("{options} --dump {dump}"));
    let folder = Path::new(&dump).join("radial-2d-p1-8");
    let text: Vec<String> = solution(&ConformingP1, 8).iter().map(|x| format!("{x:e}")).collect();
    fs::write(folder.join("u.txt"), text.join(" ")).unwrap();
    let output = judge(&folder, "u.txt", &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let judged: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let (judged, row) = (&rows(&judged)[0], &rows(&report)[1]);
    assert_eq!(judged["against"], "cr at level 32");
    let [a, b] = [judged, row].map(|r| r["error"]["h1"].as_f64().unwrap());
    assert!((a / b - 1.0).abs() < 1e-9, "{a} and {b}");
}
