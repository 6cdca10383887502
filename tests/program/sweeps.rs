//! Constants of a problem file that the command line sets: one value, or a sweep.

use std::path::Path;

use serde_json::Value;
use unilateral::prelude::*;
use unilateral::problem_file::read_with;
use unilateral::scenes::AnyScene;

use super::run::{Scratch, command, number, read_json, refused, rows, stderr, stdout};

fn string() -> String {
    format!("{}/examples/problems/string.toml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn a_sweep_names_rows_files_and_dumps_by_its_values() {
    let scratch = Scratch::new("sweep");
    let dump = scratch.path("dump");
    let options = "--set load=4,16 --set depth=0.5 --scheme p1 --levels 8,16";
    let report = scratch.report(&format!("{} {options} --dump {dump}", string()));
    let names: Vec<&str> = rows(&report).iter().map(|r| r["scene"].as_str().unwrap()).collect();
    assert_eq!(names, ["string[load=4]", "string[load=4]", "string[load=16]", "string[load=16]"]);
    for (row, load) in rows(&report).iter().zip([4.0_f64, 4.0, 16.0, 16.0]) {
        assert_eq!(number(row, &["constants", "load"]), load);
        assert_eq!(number(row, &["constants", "free"]), 1.0 / load.sqrt());
    }
    assert_eq!(report["program"]["request"]["constant depth"], "0.5");
    for file in ["string-load-4--p1.svg", "string-load-4--p1.vtu", "string-load-16--p1.vtu"] {
        assert!(scratch.0.join("out").join(file).exists(), "{file}");
    }
    let csv = scratch.read("out/report.csv");
    assert!(csv.lines().next().unwrap().contains("constants.depth,constants.free"), "{csv}");
    for file in ["report.md", "report.html"] {
        let text = scratch.read(&format!("out/{file}"));
        assert!(text.contains("depth = 0.5, free = 0.25, length = 2, load = 16"), "{file}");
    }
    // the folder of a value is judged by the problem of this value
    let given = [("depth".to_owned(), vec![0.5]), ("load".to_owned(), vec![16.0])];
    let own = read_with(Path::new(&string()), &given).unwrap().remove(0).scene;
    let AnyScene::One(own) = own else { panic!("a problem on a line") };
    let meshes = Hierarchy::of_domain(&own.domain, 8).unwrap();
    let values = solve(&own.problem, &meshes, &ConformingP1).unwrap().values().to_vec();
    let text: Vec<String> = values.iter().map(|x| format!("{x:e}")).collect();
    let vector = scratch.file("u.txt", &text.join(" "));
    let judge = |load: usize| {
        let folder = Path::new(&dump).join(format!("string-load-{load}--p1-8"));
        command("judge").arg(folder).args([&vector, "--json"]).output().unwrap()
    };
    let (own, other) = (judge(16), judge(4));
    assert_eq!([own.status.code(), other.status.code()], [Some(0), Some(1)], "{}", stderr(&own));
    let judged: Value = serde_json::from_str(&stdout(&own)).unwrap();
    assert_eq!(rows(&judged)[0]["constants"], rows(&report)[2]["constants"]);
    assert_eq!(rows(&judged)[0]["scene"], "string[load=16]");
}

#[test]
fn a_sweep_goes_on_and_takes_further_values() {
    let scratch = Scratch::new("sweep-resumed");
    let options = format!("{} --scheme p1 --levels 8 --quiet --no-fields", string());
    scratch.report(&format!("{options} --set load=4,8"));
    let report = scratch.report(&format!("{options} --set load=4,8,16 --resume"));
    let loads: Vec<f64> =
        rows(&report).iter().map(|row| number(row, &["constants", "load"])).collect();
    assert_eq!(loads, [4.0, 8.0, 16.0]);
    // one value has no place in names: it is in the request
    let other = scratch.run(&format!("{options} --set load=4 --resume"));
    assert_eq!(other.status.code(), Some(2));
    assert!(stderr(&other).contains("this run has constant load 4"), "{}", stderr(&other));
}

#[test]
fn pictures_and_work_know_the_values() {
    let scratch = Scratch::new("sweep-pictures");
    let out = scratch.path("pictures");
    let options = ["--set", "load=4,16", "--scheme", "p1", "--level", "8", "--out"];
    let output = command("pictures").arg(string()).args(options).arg(&out).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let names: Vec<String> = stdout(&output)
        .lines()
        .map(|line| Path::new(line).file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(names, ["string-load-4--p1-8.svg", "string-load-16--p1-8.svg"]);
    let picture = scratch.read(&format!("pictures/{}", names[1]));
    assert!(picture.contains("string[load=16]: p1, level 8"));

    let out = scratch.path("work");
    let options = ["--set", "load=4,16", "--scheme", "p1", "--levels", "8,16", "--rounds", "1"];
    let output = command("work-precision")
        .arg(string())
        .args(options)
        .args(["--subject", "p1", "--quiet", "--out", &out])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = read_json(&scratch.0.join("work/report.json"));
    let scenes: Vec<&str> = rows(&report).iter().map(|r| r["scene"].as_str().unwrap()).collect();
    assert_eq!(scenes.len(), 4);
    assert!(scenes.contains(&"string[load=4]") && scenes.contains(&"string[load=16]"));
}

#[test]
fn wrong_constants_are_refused() {
    let scratch = Scratch::new("sweep-refused");
    let string = string();
    let form = "expected NAME=X[,X...]";
    for (options, expected) in [
        (
            &["--set", "strike=1"][..],
            &["string.toml", "no constant `strike`", "has length, load"][..],
        ),
        (&["--set", "load"], &["--set", form]),
        (&["--set", "load=a"], &["load=a", form]),
        (&["--set", "load=inf"], &["load=inf", form]),
        (&["--set", "load=1,1.0"], &["--set", "1 stands twice"]),
        (&["--set", "load=1", "--set", "load=2"], &["--set load: twice", "load=1,2"]),
        (&["--set", "load=0"], &["string.toml:9:8", "the constant `free` is inf"]),
    ] {
        refused(&scratch, &[&[&string[..]], options].concat(), expected);
    }
    refused(&scratch, &["--scene", "radial-1d", "--set", "load=1"], &["PROBLEM.toml"]);
}
