//! Problems with several obstacles and gaps: whose the multipliers are, what lies between the nodes, what crosses.

use super::run::{Scratch, data, number, read_json, rows, stderr};
use serde_json::Value;

/// The rows of each series, coarsest first.
fn series(report: &Value, n_levels: usize) -> Vec<Vec<Value>> {
    rows(report).chunks(n_levels).map(<[Value]>::to_vec).collect()
}

/// A contact side whose gap lies below the obstacle is a Neumann side without flux: it has no force, and the bound is
/// the same.
#[test]
fn a_gap_below_the_obstacle_has_no_force() {
    let scratch = Scratch::new("gap-below");
    let options = "--scheme p1,p2,cr,sipg,wopsip,wopsip:facet-means,nipg,ldg --levels 16";
    let found = scratch.report(&format!("{} {options}", data("gap_below_obstacle")));
    let text = std::fs::read_to_string(data("gap_below_obstacle")).unwrap();
    let neumann = text.replace("\"contact\"\ngap = -0.3", "\"neumann\"\nflux = 0.0");
    assert_ne!(neumann, text);
    let free = scratch.report(&format!("{} {options}", scratch.file("free.toml", &neumann)));
    for (row, free) in rows(&found).iter().zip(rows(&free)) {
        let label = &row["label"];
        assert_eq!(row["resultants"]["bottom"], 0.0, "{label}");
        assert_eq!(row["resultants"]["lower"], row["resultant"], "{label}");
        let [total, of_free] = [row, free].map(|row| number(row, &["bound", "total"]));
        println!("{label}: {total:.4e}, Neumann {of_free:.4e}");
        assert!((total / of_free - 1.0).abs() < 0.01, "{label}: {total} {of_free}");
    }
}

/// Where regions meet, each cell is charged what its own obstacle carries: the bound of conforming functions has order
/// one, and with an obstacle in one region alone it falls as with the same one everywhere.
#[test]
fn multipliers_of_regions_are_those_of_their_obstacles() {
    let scratch = Scratch::new("regions");
    let check = |name: &str, schemes: &str, levels: &str, least: f64| {
        let options = format!("{} --scheme {schemes} --levels {levels}", data(name));
        let report = scratch.report(&options);
        for series in series(&report, levels.split(',').count()) {
            for pair in series.windows(2) {
                let [coarse, fine] = [0, 1].map(|k| number(&pair[k], &["bound", "total"]));
                println!("{name}, {}: {coarse:.4e}, {fine:.4e}", pair[0]["label"]);
                assert!(coarse > least * fine, "{name} {}: {coarse} {fine}", pair[0]["label"]);
            }
        }
    };
    check("region_obstacle", "p1,cr", "0,1,2", 1.8);
    check("region_obstacle", "sipg,wopsip,p2,wopsip-p2", "0,1", 1.8);
    check("obstacle_one_region", "p1,cr,sipg,p2", "0,1", 1.3);
    check("obstacle_everywhere", "p1,p2", "0,1", 1.3);
    check("p2_flux_on_obstacle", "p1,p2,sipg-p2", "0,1", 1.3);
}

/// Quadratics with bounds at nodes that touch an obstacle everywhere leave it between the nodes, and the row says so.
/// With bounds on Bernstein coefficients they do not.
#[test]
fn quadratics_between_their_nodes() {
    let scratch = Scratch::new("between-nodes");
    let schemes = "p2,p2:midpoints,sipg-p2,p1,p2:bernstein,sipg-p2:bernstein";
    let options = format!("{} --scheme {schemes} --levels 4", data("contact_everywhere"));
    let report = scratch.report(&options);
    for (k, row) in rows(&report).iter().enumerate() {
        let found = number(row, &["penetration"]);
        println!("{}: {found:.3e} {}", row["label"], row["warnings"]);
        let is_said = row["warnings"].to_string().contains("lies beyond the lower obstacle by");
        let is_beyond = k < 3;
        assert_eq!(is_said, is_beyond, "{}: {}", row["label"], row["warnings"]);
        match is_beyond {
            true => assert!((1e-4..1e-2).contains(&found), "{}: {found}", row["label"]),
            false => assert!(found.abs() < 1e-12, "{}: {found}", row["label"]),
        }
    }
}

/// Dirichlet values that touch the obstacle in the middle of an edge lie below it in a Bernstein coefficient. The problem is
/// solved, and the row says so; where they touch it at a vertex there is nothing to say.
#[test]
fn data_may_touch_the_obstacle_within_an_edge() {
    let scratch = Scratch::new("touching-data");
    let schemes = "p2:bernstein,sipg-p2:bernstein,p2";
    let options = format!("{} --scheme {schemes} --levels 2,3", data("touching_data"));
    for row in rows(&scratch.report(&options)) {
        let what = format!("{} {}: {}", row["label"], row["level"], row["warnings"]);
        assert_eq!(row["status"], "converged", "{what}");
        let is_said =
            row["warnings"].to_string().contains("by 2.8e-2 in the Bernstein coefficient");
        assert_eq!(is_said, row["constraint"] == "bernstein" && row["level"] == 3, "{what}");
    }
    // values that vanish but for rounding, beside an obstacle of zero
    let scratch = Scratch::new("vanishing-data");
    let report =
        scratch.report("--scene lshape-2d --scheme p2:bernstein,sipg-p2:bernstein --levels 8");
    rows(&report).iter().for_each(|row| assert_eq!(row["warnings"].to_string(), "[]"));
}

/// Obstacles that cross at a point at which a mesh has nodes or integrates data leave its rows without a solution; points
/// that see nothing claim nothing.
#[test]
fn obstacles_that_cross_are_found_before_a_matrix() {
    let schemes = "p1,p2,cr,sipg,wopsip:facet-means";
    let scratch = Scratch::new("cross");
    let output = scratch.run(&format!("{} --scheme {schemes} --levels 1,2,8,17", data("cross")));
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let report = read_json(&scratch.0.join("out/report.json"));
    assert_eq!(rows(&report).len(), 5 * 4);
    for row in rows(&report) {
        let key = (&row["label"], &row["level"]);
        let crosses = row["level"] == 17;
        assert_eq!(row["status"] == "infeasible", crosses, "{key:?}: {row}");
        let message = row["message"].as_str().unwrap_or_default();
        assert_eq!(
            message.contains("the lower bound, -0.1, exceeds"),
            crosses,
            "{key:?} {message}"
        );
        assert_eq!(row["energy"].is_null(), crosses, "{key:?}");
    }
    let scratch = Scratch::new("cross-adaptive");
    let options = format!("{} --scheme p1,sipg --levels 17 --adaptive steps=2", data("cross"));
    assert_eq!(scratch.run(&options).status.code(), Some(1));
    let report = read_json(&scratch.0.join("out/report.json"));
    let of_row =
        |row: &Value| [&row["label"], &row["status"]].map(|text| text.as_str().unwrap().to_owned());
    let found: Vec<[String; 2]> = rows(&report).iter().map(of_row).collect();
    assert_eq!(found, [["p1", "infeasible"], ["sipg", "infeasible"]]);
}

/// Bounds that cross by little, and a gap that does within a contact side.
#[test]
fn bounds_cross_by_little_and_on_a_contact_side() {
    let scratch = Scratch::new("cross-little");
    let sides: String = ["left", "right", "top"]
        .map(|side| format!("[boundary.{side}]\nkind = \"dirichlet\"\n"))
        .concat();
    for (k, (lower, gap)) in
        [("0.1 + 1e-7", "-1"), ("-1", "if(abs(x - 0.2372) < 1e-2, 0.5, -1)"), ("-1", "0.09")]
            .into_iter()
            .enumerate()
    {
        let text = format!(
            "box = [[0,0],[1,1]]\n[obstacle]\nlower.default = {lower:?}\nupper.default = 0.1\n{sides}\
             [boundary.bottom]\nkind = \"contact\"\ngap = {gap:?}\n"
        );
        let path = scratch.file(&format!("cross{k}.toml"), &text);
        scratch.run(&format!("{path} --scheme p1 --levels 1"));
        let row = rows(&read_json(&scratch.0.join("out/report.json")))[0].clone();
        let message = row["message"].as_str().unwrap_or_default();
        let is_found = message.contains("the lower bound") && message.contains("exceeds");
        assert_eq!(is_found, k < 2, "{lower}, {gap}: {} {message}", row["status"]);
    }
}
