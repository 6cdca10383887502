//! Rows that are hard to solve, with the work that they may take: counts, which do not depend on the machine.

use super::run::{Scratch, rows};
use serde_json::Value;

/// A row: the options of its request, and at most so many active sets and steps of all stages, iterations of linear
/// solvers, and factorisations, without those of local inequalities; and the stage that ends it.
struct HardRow(&'static str, [u64; 3], &'static str);

const DIRECT: &str = "direct-active-set";
const PRECONDITIONED: &str = "preconditioned-active-set";
const MULTIGRID: &str = "monotone-multigrid";

/// The counts are at most 1.2 times those that were measured, rounded up.
const HARD_ROWS: [HardRow; 26] = [
    // the active set changes in cycles that do not become smaller: patience saves factors of a large matrix
    HardRow("--scene lshape-2d --scheme wopsip:facet-means --levels 128", [39, 48, 0], MULTIGRID),
    HardRow("--scene torsion-2d --scheme wopsip --levels 64", [10, 32, 0], PRECONDITIONED),
    HardRow("--scene ball-2d --scheme wopsip --levels 64", [9, 32, 0], PRECONDITIONED),
    HardRow("--scene cone-2d --scheme wopsip --levels 64", [9, 30, 0], PRECONDITIONED),
    // nine local inequalities, one after the other
    HardRow("--scene lshape-2d --scheme wopsip --levels 128", [57, 172, 0], PRECONDITIONED),
    HardRow("--scene pyramid-full-2d --scheme wopsip --levels 64", [33, 10, 24], DIRECT),
    HardRow("--scene contrast-disc-2d --scheme wopsip --levels 64", [30, 39, 29], DIRECT),
    // factors of a matrix that is not symmetric are dear
    HardRow("--scene contrast-disc-2d --scheme nipg --levels 64", [26, 202, 0], PRECONDITIONED),
    HardRow("--scene radial-3d --scheme wopsip --levels 16", [10, 38, 0], PRECONDITIONED),
    HardRow("--scene ball-3d --scheme wopsip --levels 16", [9, 38, 0], PRECONDITIONED),
    // the prediction cell by cell needs no interior point method here
    HardRow("--scene contrast-disc-2d --scheme wopsip:facet-means --levels 8", [10, 0, 10], DIRECT),
    HardRow("--scene degenerate2-2d --scheme p1 --levels 128", [20, 20, 0], MULTIGRID),
    HardRow("--scene degenerate2-2d --scheme cr --levels 128", [2, 12, 0], PRECONDITIONED),
    HardRow("--scene icelike-1d --scheme p1 --levels 1024", [3, 0, 3], DIRECT),
    HardRow("--scene icelike-1d --scheme wopsip --levels 1024", [3, 0, 3], DIRECT),
    HardRow(
        "--scene spiral-2d --scheme wopsip:facet-means --levels 64",
        [10, 29, 0],
        PRECONDITIONED,
    ),
    HardRow("--scene biactive-half-2d --scheme sipg --levels 64", [51, 99, 0], PRECONDITIONED),
    HardRow(
        "--scene biactive-half-2d --scheme wopsip:facet-means --levels 64",
        [21, 58, 0],
        PRECONDITIONED,
    ),
    HardRow("--scene biactive-half-2d --scheme wopsip-p2 --levels 16", [30, 0, 30], DIRECT),
    HardRow("--scene lshape-2d --scheme sipg-p2 --levels 16", [47, 0, 47], DIRECT),
    HardRow("--scene lshape-2d --scheme wopsip-p2 --levels 16", [48, 0, 48], DIRECT),
    HardRow(
        "--scene radial-2d --scheme sipg --levels 4 --mesh DATA/unstructured_square.msh",
        [6, 14, 0],
        PRECONDITIONED,
    ),
    // bodies that bounds alone hold
    HardRow("DATA/problems/neu2.toml --scheme wopsip --levels 32", [2, 0, 2], DIRECT),
    HardRow("DATA/problems/nearly_balanced_upper.toml --scheme sipg --levels 2", [2, 0, 2], DIRECT),
    HardRow("DATA/problems/neu3.toml --scheme p1 --levels 8", [2, 0, 2], DIRECT),
    HardRow("DATA/problems/neu3.toml --scheme wopsip --levels 8", [2, 0, 0], PRECONDITIONED),
];

impl HardRow {
    /// What is not as it is stated; none if all is.
    fn difference(&self) -> Option<String> {
        let Self(options, limits, last) = self;
        let scratch = Scratch::new("hard-row");
        let data = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");
        let options = options.replace("DATA", data);
        let report = scratch.report(&format!("{options} --no-fields --quiet"));
        let row = &rows(&report)[0];
        let iterations = &row["iterations"];
        let stages = iterations["stages"].as_array().unwrap();
        let has_factors =
            |stage: &&Value| stage["stage"] == DIRECT || stage["stage"] == "interior-point";
        let count = |of: &Value, key: &str| of[key].as_u64().unwrap();
        let factorisations =
            stages.iter().filter(has_factors).map(|stage| count(stage, "outer")).sum();
        let found = [count(iterations, "outer"), count(iterations, "linear"), factorisations];
        let is_within = found.iter().zip(limits).all(|(found, limit)| found <= limit);
        let is_right = is_within
            && row["status"] == "converged"
            && stages.last().is_some_and(|stage| stage["stage"] == *last);
        (!is_right).then(|| format!("{options}: {found:?} for {limits:?}, {last}: {row}"))
    }
}

#[test]
#[ignore = "takes a minute"]
fn hard_rows_take_no_more_work_than_they_did() {
    let different: Vec<String> = HARD_ROWS.iter().filter_map(HardRow::difference).collect();
    assert!(different.is_empty(), "{}", different.join("\n"));
}
