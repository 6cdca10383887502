//! Runs that would not fit into the memory, and the peak of the process.

use unilateral::element::P2;
use unilateral::inequality::{ActiveSet, Outcome};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;
use unilateral::study::peak_memory_bytes;

use crate::support::scratch::Scratch;

/// Level 200 has 4.8e7 tetrahedra, whose factors take more memory than machines have.
fn study<'a>() -> Study<'a, 3> {
    let direct = ActiveSet::default().linear(LinearMethod::Direct);
    Study::new(scenes::radial::<3>(1.0)).scheme(Sipg::default()).solver(direct)
}

#[test]
fn a_level_that_does_not_fit_is_a_row_and_its_mesh_is_not_built() {
    let report = study().levels([2, 200, 3]).run().unwrap();
    let status: Vec<Outcome> = report.rows.iter().map(|row| row.status).collect();
    assert_eq!(status, [Outcome::Converged, Outcome::OutOfMemory, Outcome::Converged]);
    let row = &report.rows[1];
    let message = row.message.as_deref().unwrap();
    assert!(message.starts_with("scheme sipg, level 200: would need about "), "{message}");
    assert!(message.ends_with("are available; choose a lower level"), "{message}");
    let gigabytes = |words: &str| -> f64 {
        let rest = message.split_once(words).unwrap_or_else(|| panic!("{message}")).1;
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    let [needed, available] = ["would need about ", "GB of memory, "].map(gigabytes);
    assert!(needed > 1e3 && available < needed, "{message}");
    assert!((study().levels([200]).memory_bytes().unwrap() / (1e9 * needed) - 1.0).abs() < 1e-3);
    assert_eq!((row.cells, row.unknowns), (48_000_000, None));
    let scratch = Scratch::new("memory");
    report.write(&scratch.0).unwrap();
    assert!(scratch.read("report.md").contains("out-of-memory"));
}

#[test]
fn the_first_mesh_of_a_refinement_is_held_against_the_memory_before_it_is_built() {
    let study = study().levels([200]).adaptive(Adaptivity::default().unknowns(1000));
    let error = study.check().unwrap_err();
    assert!(matches!(error, Error::NotEnoughMemory(_)), "{error}");
    let message = error.to_string();
    assert!(message.starts_with("scheme sipg, level 200: would need about"), "{message}");
    assert!(message.ends_with("choose fewer unknowns"), "{message}");
    assert!(study.keys().is_empty());
}

/// Broken quadratics in space have 500 entries a cell: 4.3e9 at level 113.
#[test]
fn a_matrix_with_too_many_entries_is_refused_before_a_mesh_is_built() {
    let study = |level: usize| {
        let study = Study::<3>::new(scenes::radial(1.0)).scheme(ConformingP1);
        study.scheme(Sipg::default().on(P2)).levels([2, level])
    };
    study(112).check().unwrap();
    let error = study(113).check().unwrap_err();
    assert!(matches!(error, Error::Parameter(_)), "{error}");
    let message = error.to_string();
    assert!(
        message.starts_with("level = 113: the matrix of sipg-p2 there may have 4.3e9 entries"),
        "{message}"
    );
    assert!(message.ends_with("a coarser level, a lower degree or more processes"), "{message}");
}

/// On Linux the peak is the one that the kernel keeps, which never falls.
#[test]
fn the_peak_is_read_and_nothing_is_made_up() {
    let by_kernel = || {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        Some(1024 * line.split_whitespace().next()?.parse::<u64>().ok()?)
    };
    let before = by_kernel();
    let peak = peak_memory_bytes();
    assert!(before <= peak && peak <= by_kernel(), "{peak:?}");
    assert_eq!(peak.is_some(), cfg!(target_os = "linux"));
}
