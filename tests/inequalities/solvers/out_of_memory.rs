//! Factors that do not fit into memory.

use super::cold;
use crate::problems::*;
use std::process::Command;
use unilateral::algebra::{Bound, SparseMatrix};
use unilateral::inequality::Outcome;

/// A positive definite matrix with random couplings, whose factors are nearly dense in any order.
fn expander(n: usize) -> SparseMatrix<f64> {
    let mut random = Random::new(3);
    let mut rows: Vec<Vec<usize>> = (0..n).map(|i| vec![i]).collect();
    for i in 0..n {
        for _ in 0..3 {
            let j = (random.unit() * n as f64) as usize % n;
            rows[i].push(j);
            rows[j].push(i);
        }
    }
    let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
    for (i, row) in rows.iter_mut().enumerate() {
        row.sort_unstable();
        row.dedup();
        for &j in row.iter() {
            matrix.columns.push(j as u32);
            matrix.values.push(if i == j { row.len() as f64 } else { -1.0 });
        }
        matrix.row_starts.push(matrix.columns.len() as u32);
    }
    matrix
}

/// The test starts itself in a process that may have 400 MB.
#[test]
#[cfg(target_os = "linux")]
fn factors_that_do_not_fit_have_an_outcome() {
    const VARIABLE: &str = "UNILATERAL_TEST_IN_LITTLE_MEMORY";
    if std::env::var_os(VARIABLE).is_some() {
        let n = 40_000;
        let problem = inequality(expander(n), &vec![-1.0; n], vec![Bound::Lower(-0.5); n]);
        let solution = cold(&problem);
        assert_eq!(solution.outcome, Outcome::OutOfMemory);
        assert!(solution.values.iter().all(|u| u.is_finite()));
        return;
    }
    let name = "solvers::out_of_memory::factors_that_do_not_fit_have_an_outcome";
    let output = Command::new("sh")
        .args(["-c", "ulimit -v 400000 && exec \"$0\" \"$@\""])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", name, "--test-threads", "1"])
        .env(VARIABLE, "1")
        .output()
        .unwrap();
    let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success() && out.contains("1 passed"), "{out}{err}");
}
