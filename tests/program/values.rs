//! Values by name in the reports of the program.

use unilateral::exchange::read_vector;

use super::run::{Scratch, command, number, read_json, rows, stderr, stdout};

fn balance() -> String {
    format!("{}/examples/problems/balance.toml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn values_stand_in_rows_tables_and_columns() {
    let scratch = Scratch::new("values");
    let output = scratch.run(&format!("{} --scheme p1,sipg-p2 --levels 4,8,16", balance()));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = read_json(&scratch.0.join("out/report.json"));
    for row in rows(&report) {
        let forces = ["held", "pressed"].map(|name| number(row, &["values", name]));
        let loads = 8.0 / 3.0 - 0.5 - 2.0 * number(row, &["values", "mean"]);
        assert!((loads + forces[0] + forces[1]).abs() < 1e-8, "{}: {forces:?}", row["label"]);
        assert!(number(row, &["error", "values", "mean"]) < 1e-2);
        assert_eq!(row["values_at"]["lowest"], serde_json::json!([2.0, 1.0]));
    }
    let limit = &report["extrapolated"][0]["values"]["mean"];
    assert!((number(limit, &["value"]) - 1.0 / 3.0).abs() < 1e-4, "{limit}");
    let csv = scratch.read("out/report.csv");
    let header = csv.lines().next().unwrap();
    for column in ["values.mean", "error.values.mean", "values_at.lowest"] {
        assert!(header.split(',').any(|key| key == column), "{column}: {header}");
    }
    let text = stdout(&output);
    assert!(text.contains("balance: values, at the finest level of each scheme"), "{text}");
    let line = text.lines().find(|line| line.starts_with("held") && line.contains("p1")).unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words[..3], ["held", "p1", "16"]);
    assert!((words[3].parse::<f64>().unwrap() + 3.5).abs() < 1e-2, "{line}");
    for file in ["report.html", "report.md", "report.tex"] {
        let text = scratch.read(&format!("out/{file}"));
        assert!(text.contains("balance: values") && text.contains("pressed"), "{file}");
    }
}

/// A Robin side and a tensor: the solution is quadratic, and forces balance the loads.
#[test]
fn an_aquifer_has_its_closed_values() {
    let scratch = Scratch::new("aquifer");
    let file = format!("{}/examples/problems/aquifer.toml", env!("CARGO_MANIFEST_DIR"));
    let report = scratch.report(&format!("{file} --scheme p1,cr,sipg,wopsip,p2 --levels 4,8,16"));
    for row in rows(&report) {
        let [drained, held] = ["drained", "held"].map(|name| number(row, &["values", name]));
        assert!((held - 3.5).abs() < 1e-8, "{}: {held}", row["label"]);
        assert!(row["warnings"].as_array().is_none_or(Vec::is_empty), "{}", row["warnings"]);
        let error = (drained - 4.25).abs();
        assert!(error < if row["label"] == "p2" { 1e-8 } else { 0.2 }, "{}: {error}", row["label"]);
        assert!(row["bound"]["unproven"].as_array().unwrap().len() < 2, "{}", row["bound"]);
    }
    for limit in report["extrapolated"].as_array().unwrap() {
        let [value, expected] = [number(limit, &["values", "drained", "value"]), 4.25];
        assert!((value - expected).abs() < 1e-2, "{limit}");
    }
}

/// An exact solution is held against Robin data too.
#[test]
fn a_solution_that_breaks_a_robin_condition_is_named() {
    let scratch = Scratch::new("wrong-robin");
    let file = format!("{}/examples/problems/aquifer.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(file).unwrap().replace("304 + y / 4", "305 + y / 4");
    let file = scratch.file("wrong.toml", &text);
    let report = scratch.report(&format!("{file} --scheme p1 --levels 4"));
    let warnings = rows(&report)[0]["warnings"].to_string();
    assert!(warnings.contains("not fulfilled: the Robin condition"), "{warnings}");
}

/// Friction that sticks at one side and slips at the other; its dump is judged.
#[test]
fn a_brake_has_its_forces_and_its_dump_is_a_solution() {
    let scratch = Scratch::new("brake");
    let file = format!("{}/examples/problems/brake.toml", env!("CARGO_MANIFEST_DIR"));
    let dump = scratch.path("dump");
    let report = scratch
        .report(&format!("{file} --scheme p1,cr,sipg,wopsip,p2 --levels 4,8,16 --dump {dump}"));
    for row in rows(&report) {
        assert!(row["warnings"].as_array().is_none_or(Vec::is_empty), "{}", row["warnings"]);
        let [stuck, slipping] = ["stuck", "slipping"].map(|name| number(row, &["values", name]));
        assert!((stuck + 1.5).abs() < 1e-7 && (slipping + 0.5).abs() < 1e-7, "{}", row["values"]);
        assert!((number(row, &["resultants", "left"]) - stuck).abs() < 1e-9);
        assert!((number(row, &["values", "slip"]) - 0.5).abs() < 0.05, "{}", row["values"]);
    }
    let folder = format!("{dump}/brake-p1-4");
    let u = by_relaxation(&folder);
    let judged = |u: &[f64]| {
        let text: Vec<String> = u.iter().map(|u| format!("{u:e}")).collect();
        std::fs::write(format!("{folder}/u.txt"), text.join("\n")).unwrap();
        let output = command("judge").arg(&folder).arg(format!("{folder}/u.txt")).output().unwrap();
        (output.status.code(), stdout(&output))
    };
    let (code, text) = judged(&u);
    assert_eq!(code, Some(0), "{text}");
    // shifted up, the left end slips against its force
    let (code, text) = judged(&u.iter().map(|u| u + 1e-3).collect::<Vec<_>>());
    assert!(code == Some(1) && text.contains("not-a-solution"), "{text}");
}

/// The solution of an inequality with friction in the files of a folder, by the relaxation of one unknown after the other.
fn by_relaxation(folder: &str) -> Vec<f64> {
    let bytes = std::fs::read(format!("{folder}/kinks.npy")).unwrap();
    let header = String::from_utf8_lossy(&bytes);
    let end = bytes.iter().position(|b| *b == b'\n').unwrap() + 1;
    assert!(header.contains(", 4)"), "{header}");
    let numbers: Vec<f64> =
        bytes[end..].chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let [load, lower, upper] =
        ["load", "lower", "upper"].map(|name| read_vector(format!("{folder}/{name}.npy")).unwrap());
    let text = std::fs::read_to_string(format!("{folder}/matrix.mtx")).unwrap();
    let mut matrix = vec![vec![0.0; load.len()]; load.len()];
    for line in text.lines().skip(2) {
        let mut words = line.split(' ');
        let [i, j] = [0; 2].map(|_| words.next().unwrap().parse::<usize>().unwrap() - 1);
        matrix[i][j] = words.next().unwrap().parse::<f64>().unwrap();
    }
    let mut slopes = vec![[0.0, 0.0, 0.0]; load.len()];
    for kink in numbers.chunks_exact(4) {
        slopes[kink[0] as usize] = [kink[1], kink[2], kink[3]];
    }
    let mut u = vec![0.0; load.len()];
    for _ in 0..20_000 {
        for i in 0..u.len() {
            let product: f64 = matrix[i].iter().zip(&u).map(|(a, u)| a * u).sum();
            let [place, below, above] = slopes[i];
            let force = load[i] - product + matrix[i][i] * (u[i] - place);
            let free = place + (force - force.clamp(below, above)) / matrix[i][i];
            u[i] = free.clamp(lower[i], upper[i]);
        }
    }
    u
}

/// Friction, obstacles and contact at one unknown, against relaxation, with forces that balance.
#[test]
fn friction_beside_obstacles_and_contact_is_what_relaxation_finds() {
    let scratch = Scratch::new("kinks-and-bounds");
    let text = "name = \"both\"\nbox = [[0, 0], [1, 1]]\n[source]\ndefault = \"-6 + 12 * x\"\n\
        [obstacle]\nlower.default = -0.1\nupper.default = \"0.06 + 0.05 * y\"\n\
        [boundary.left]\nkind = \"friction\"\nthreshold = \"0.6 * y\"\n\
        [boundary.right]\nkind = \"friction\"\nthreshold = 0.4\n\
        [boundary.bottom]\nkind = \"contact\"\ngap = -0.02\n\
        [boundary.top]\nkind = \"neumann\"\nflux = -0.3\n";
    let file = scratch.file("both.toml", text);
    let dump = scratch.path("dump");
    let report =
        scratch.report(&format!("{file} --scheme p1,sipg,wopsip --levels 3 --dump {dump}"));
    for row in rows(&report) {
        let folder = format!("{dump}/both-{}-3", row["label"].as_str().unwrap());
        let u = by_relaxation(&folder);
        let text: Vec<String> = u.iter().map(|u| format!("{u:e}")).collect();
        std::fs::write(format!("{folder}/u.txt"), text.join("\n")).unwrap();
        let mut judge = command("judge");
        judge.args([&folder, &format!("{folder}/u.txt")]).arg("--json");
        let output = judge.output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
        let judged: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        let judged = &rows(&judged)[0];
        for key in ["energy", "resultant", "contact_measure"] {
            let [a, b] = [row, judged].map(|row| number(row, &[key]));
            assert!((a - b).abs() < 1e-7, "{} {key}: {a} {b}", row["label"]);
        }
        let names = ["left", "right", "bottom", "lower", "upper"];
        let forces = names.map(|name| number(row, &["resultants", name]));
        let sum: f64 = forces.iter().sum();
        assert!((sum - 0.3).abs() < 1e-8, "{}: {forces:?}", row["label"]);
        assert!(forces[0].abs() < 0.3 + 1e-9 && forces[1].abs() < 0.4 + 1e-9, "{forces:?}");
        assert!(forces[3] > 0.1 && forces[4] < -0.1, "{forces:?}");
        assert!(number(row, &["bound", "total"]) < 1.0, "{}", row["bound"]);
    }
}

/// Problems that ask for no values have none of their keys.
#[test]
fn rows_without_values_have_no_keys_of_them() {
    let scratch = Scratch::new("no-values");
    let report = scratch.report("--scene radial-1d --scheme p1 --levels 4,8,16 --no-fields");
    let row = rows(&report)[0].as_object().unwrap();
    for key in ["values", "values_at", "constants"] {
        assert!(!row.contains_key(key), "{key}");
    }
    assert!(row["error"].get("values").is_none());
    assert!(report["extrapolated"][0].get("values").is_none());
}
