//! Runs that would not fit into the memory, and the peak of the process.

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
