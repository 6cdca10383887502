//! Rows of reports.

use serde_json::Value;
use unilateral::scenes;

use super::run::{Scratch, number, read_json, rows, stderr, stdout};
use crate::support::keys::ROW_KEYS;

/// Keys of inner objects, and which of their values may be null in a row that converged.
const INNER_KEYS: [(&str, &[&str], bool); 8] = [
    ("parameters", &["sigma", "eta", "rule"], true),
    ("error", &["l2", "h1", "energy", "broken_energy", "max"], true),
    ("order", &["l2", "h1", "energy", "max", "bound", "multiplier_l1", "multiplier_l2"], true),
    ("expected_order", &["l2", "h1"], true),
    ("bound", &BOUND_NUMBERS, true),
    ("iterations", &["outer", "linear", "levels", "systems", "start_cycles", "stages"], false),
    ("certificate", &["feasibility", "multiplier", "complementarity", "residual"], false),
    ("seconds", &["mesh", "assemble", "solve", "total"], false),
];

const BOUND_NUMBERS: [&str; 10] = [
    "total",
    "distance",
    "discrete",
    "mismatch",
    "obstacle",
    "contact",
    "oscillation",
    "algebra",
    "effectivity",
    "effectivity_of_v",
];

/// Every key is there, with a value of its type.
pub fn check_row(row: &Value) {
    let converged = row["status"] == "converged";
    // without an inequality there is no contact
    let of_contact = ["contact_measure", "resultant", "resultants", "penetration"];
    let has_none = of_contact.iter().all(|key| row[key].is_null());
    let has_friction =
        row["scene"].as_str().is_some_and(|name| name.starts_with("friction") || name == "brake");
    for key in ROW_KEYS {
        let value = &row[key];
        let fits = match key {
            "scene" | "scheme" | "constraint" | "label" | "status" => value.is_string(),
            "against" => value.is_string() || value.is_null(),
            "dimension" | "level" | "cells" => value.is_u64(),
            "unknowns" | "nonzeros" => value.is_u64() || !converged,
            "message" => value.is_string() != converged,
            "active" => value.is_u64() || (value.is_null() && !converged),
            "multiplier_l1" | "multiplier_l2" | "contact_area_error" | "free_boundary_distance" => {
                value.is_number() || value.is_null()
            }
            "peak_memory_bytes" => value.is_u64() || value.is_null(),
            "mesh_size" => value.is_f64(),
            "rounding" => value.is_object() || !converged,
            "theta" => value.is_f64() || value.is_null(),
            "objective" => value.is_number() || value.is_null(),
            "energy" => value.is_f64() || !converged,
            "contact_measure" | "resultant" => value.is_f64() || !converged || has_none,
            // friction alone has nothing to penetrate
            "penetration" => value.is_f64() || !converged || has_none || has_friction,
            "resultants" => value.is_object() || !converged || has_none,
            "level_kind" => value.is_string(),
            _ => value.is_object(),
        };
        assert!(row.get(key).is_some() && fits, "{key}: {value}");
    }
    for (outer, keys, may_be_null) in INNER_KEYS {
        for key in keys {
            let value = row[outer].get(key).unwrap_or_else(|| panic!("no {outer}.{key}"));
            let null = value.is_null() && (may_be_null || !converged);
            let fits = match *key {
                "rule" => value.is_string(),
                "stages" => value.as_array().is_some_and(|stages| {
                    let is_run = |run: &Value| run["stage"].is_string() && run["outer"].is_u64();
                    // other solvers than the active set method are one stage, without a name of its own
                    let may_be_empty = !converged || row["solver"] != "active-set";
                    stages.iter().all(is_run) && (may_be_empty || !stages.is_empty())
                }),
                _ => value.is_number(),
            };
            assert!(null || fits, "{outer}.{key}: {value}");
        }
    }
    assert!(row["certificate"].get("algebraic_bound").is_some());
    let bound = &row["bound"];
    assert!(bound["total"].is_number() != bound["reason"].is_string(), "{bound}");
    assert!(bound["total"].is_number() == bound["guaranteed"].is_boolean(), "{bound}");
    if let Some(unproven) = bound["unproven"].as_array() {
        assert_eq!(bound["guaranteed"], unproven.is_empty(), "{bound}");
        let number = |key: &str| bound[key].as_f64().unwrap();
        assert!(number("discrete") <= number("total") + number("distance"), "{bound}");
        let error = row["error"]["broken_energy"].as_f64();
        if let (Some(error), Some(effectivity)) = (error, bound["effectivity"].as_f64()) {
            assert_eq!(number("discrete") / error, effectivity, "{bound}");
        }
    }
}

#[test]
fn the_report_has_every_key_and_file() {
    let scratch = Scratch::new("report");
    let output = scratch.run("--levels 4,8");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let progress = stderr(&output);
    assert_eq!(progress.lines().count(), 2 * 4 * 2, "a line for each row: {progress}");
    assert!(progress.starts_with("hill-2d, p1, active-set, level 4: converged, "), "{progress}");
    let tables = stdout(&output);
    assert!(tables.contains("hill-2d") && tables.contains("signorini-halves-2d"), "{tables}");
    assert!(tables.contains("seconds") && tables.contains(&scratch.path("out")), "{tables}");

    let report = read_json(&scratch.0.join("out/report.json"));
    for key in ["name", "version", "threads", "precision", "repeat", "target_cpu"] {
        assert!(report["program"].get(key).is_some_and(|v| !v.is_null()), "program.{key}");
    }
    assert_eq!(report["complete"], true);
    assert_eq!(rows(&report).len(), 2 * 4 * 2);
    rows(&report).iter().for_each(check_row);
    rows(&report).iter().for_each(|row| assert_eq!(row["level_kind"], "subdivisions"));

    let csv = scratch.read("out/report.csv");
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let inner = |outer| INNER_KEYS.iter().find(|(name, ..)| *name == outer);
    for key in ROW_KEYS {
        match inner(key) {
            // null without an iterate
            None if key == "rounding" => {
                let names = ["rounding.error.l2", "rounding.energy", "rounding.force"];
                assert!(names.iter().all(|name| header.contains(name)), "{header:?}");
            }
            None => assert!(header.contains(&key), "{key}"),
            Some((_, keys, _)) => keys.iter().for_each(|k| {
                assert!(header.contains(&&*format!("{key}.{k}")), "{key}.{k}");
            }),
        }
    }
    assert_eq!(csv.lines().count(), 1 + rows(&report).len());

    let endings = ["json", "jsonl", "csv", "md", "tex", "html"];
    let mut files: Vec<String> = endings.map(|ending| format!("report.{ending}")).into();
    files.extend([".lock", "request.json"].map(str::to_owned));
    files.extend(["convergence", "work_precision"].map(|plot| format!("{plot}.svg")));
    for scene in ["hill-2d", "signorini-halves-2d"] {
        for ending in ["vtu", "svg"] {
            let labels = ["p1", "sipg", "wopsip", "wopsip-facet-means"];
            files.extend(labels.map(|label| format!("{scene}-{label}.{ending}")));
        }
    }
    let mut found: Vec<String> = std::fs::read_dir(scratch.0.join("out"))
        .unwrap()
        .map(|f| f.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    found.sort();
    assert_eq!(found, files);
}

/// Removes what may differ from run to run.
pub fn without_times(mut report: Value) -> Value {
    report["program"]["threads"] = Value::Null;
    for row in report["rows"].as_array_mut().unwrap() {
        row["seconds"] = Value::Null;
        row["peak_memory_bytes"] = Value::Null;
    }
    report
}

#[test]
fn runs_have_the_same_bits_on_any_number_of_threads() {
    let scratch = Scratch::new("threads");
    let report = |threads| {
        let schemes = "p1,cr,sipg,nipg,ldg,br2,wopsip,wopsip:facet-means,p2,sipg-p2,wopsip-p2";
        let options =
            format!("--scheme {schemes} --levels 16 --quiet --no-fields --threads {threads}");
        without_times(scratch.report(&options))
    };
    assert_eq!(report(1), report(3));
}

/// A solve with a tolerance ends earlier, with the error of one to rounding. Rows say the tolerance, and a report without
/// it is one of another request.
#[test]
fn solves_end_at_a_tolerance() {
    let scratch = Scratch::new("tolerance");
    let options = "--scene hill-2d --scheme sipg --linear iterative --levels 64 --no-fields";
    let whole = rows(&scratch.report(options))[0].clone();
    let early = rows(&scratch.report(&format!("{options} --tolerance 0.1")))[0].clone();
    assert!(whole.get("tolerance").is_none());
    assert_eq!((&early["status"], &early["tolerance"]), (&"converged".into(), &0.1.into()));
    assert!(number(&early, &["iterations", "linear"]) < number(&whole, &["iterations", "linear"]));
    for (keys, most) in [(["error", "h1"], 1.02), (["bound", "discrete"], 1.15)] {
        let [of_early, of_whole] = [&early, &whole].map(|row| number(row, &keys));
        assert!(of_early < most * of_whole, "{keys:?}: {of_early} {of_whole}");
    }
    let resumed = scratch.run(&format!("{options} --resume"));
    assert_eq!(resumed.status.code(), Some(2));
    assert!(stderr(&resumed).contains("tolerance 0.1"), "{}", stderr(&resumed));
    let timed = scratch.report(
        "--rounds 2 --tolerance 0.1 --scene hill-2d --scheme sipg --linear iterative --levels 64",
    );
    let timed = &rows(&timed)[0];
    assert_eq!(
        (&timed["tolerance"], &timed["iterations"]),
        (&early["tolerance"], &early["iterations"])
    );
}

/// The history is that of one more solve: all else is as without it. A report without it is one of another request.
#[test]
fn histories_are_in_rows_and_drawn() {
    let scratch = Scratch::new("history");
    let out = |file: &str| scratch.0.join("out").join(file);
    let options =
        "--scene radial-2d --scheme p1,sipg --solver all --levels 4,8 --quiet --no-fields";
    let mut with = scratch.report(&format!("{options} --history"));
    for row in rows(&with) {
        let history = row["history"].as_array().unwrap();
        assert_eq!(Some(history.len() as u64), row["iterations"]["outer"].as_u64());
        let last = history.last().and_then(Value::as_array).unwrap();
        assert_eq!((last.len(), &last[0]), (3, &row["iterations"]["systems"]));
        assert!(last[1].as_f64() > Some(0.0) && last[2].as_f64() <= Some(1e-9), "{last:?}");
    }
    let plot = std::fs::read_to_string(out("radial-2d-history.svg")).unwrap();
    let names =
        ["linear systems", "time of the solve in s", "p1, proximal", "sipg, interior-point"];
    names.iter().for_each(|name| assert!(plot.contains(name), "{name}: {plot}"));
    let page = std::fs::read_to_string(out("report.html")).unwrap();
    assert!(page.contains("radial-2d-history.svg"));
    let header = std::fs::read_to_string(out("report.csv")).unwrap();
    assert!(header.lines().next().unwrap().split(',').any(|key| key == "history"));

    let resumed = scratch.run(&format!("{options} --resume"));
    assert_eq!(resumed.status.code(), Some(2), "{}", stderr(&resumed));
    assert!(stderr(&resumed).contains("history after every outer step"), "{}", stderr(&resumed));
    let without = scratch.report(options);
    assert!(!out("radial-2d-history.svg").exists());
    for row in with["rows"].as_array_mut().unwrap() {
        row.as_object_mut().unwrap().remove("history").unwrap();
    }
    let same = |report: Value| without_times(report)["rows"].clone();
    assert_eq!(same(with), same(without));
}

/// Two schemes on all scenes; the file of figures has all schemes, and checks the keys of every row.
#[test]
fn every_scene_runs() {
    let scratch = Scratch::new("all");
    let report = scratch.report("--scene all --scheme p1,wopsip --levels 4 --quiet");
    assert_eq!(rows(&report).len(), 2 * scenes::catalogue().len());
    for dimension in 1..=3 {
        assert!(rows(&report).iter().any(|row| row["dimension"] == dimension));
    }
    rows(&report).iter().for_each(check_row);
}

#[test]
fn a_row_that_does_not_converge_is_told_and_the_others_are_complete() {
    let scratch = Scratch::new("stubborn");
    let output = scratch.run("--scene radial-2d --scheme sipg,p1 --sigma 1 --levels 4,8");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let tables = stdout(&output);
    assert!(
        tables.contains("not-coercive") && tables.contains("sipg@sigma=1: the penalty of"),
        "{tables}"
    );
    let report = read_json(&scratch.0.join("out/report.json"));
    rows(&report).iter().for_each(check_row);
    let (bad, good) = rows(&report).split_at(2);
    for row in bad {
        assert_eq!(row["status"], "not-coercive");
        assert!(row["objective"].is_null() && row["active"].is_null());
        let inner = [("error", "l2"), ("order", "l2"), ("certificate", "residual")];
        for (outer, key) in inner.into_iter().chain([("iterations", "outer")]) {
            assert!(row[outer][key].is_null(), "{outer}.{key}");
        }
        assert_eq!(row["parameters"]["sigma"], 1.0);
        assert!(!row["warnings"].as_array().unwrap().is_empty());
    }
    for row in good {
        assert_eq!(row["status"], "converged");
        assert!(row["error"]["l2"].is_f64());
    }
    assert!(good[1]["order"]["l2"].is_f64());
}
