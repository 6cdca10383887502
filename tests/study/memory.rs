//! Runs that would not fit into the memory.

use unilateral::element::P2;
use unilateral::inequality::{ActiveSet, Outcome};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;

use crate::support::scratch::Scratch;

/// Level 200 has 4.8e7 tetrahedra, whose factors take more memory than machines have.
fn study<'a>() -> Study<'a, 3> {
    let direct = ActiveSet::default().linear(LinearMethod::Direct);
    Study::new(scenes::radial::<3>(1.0)).scheme(Sipg::default()).solver(direct)
}

#[test]
fn a_level_that_does_not_fit_is_a_row_and_its_mesh_is_not_built() {
    let study = study().levels([2, 200, 3]);
    let error = study.check_memory().unwrap_err();
    let Error::NotEnoughMemory { needed, available, .. } = error else { panic!("{error}") };
    assert!(needed > 1e12 && available < needed, "{needed} {available}");
    let report = study.run().unwrap();
    let status: Vec<Outcome> = report.rows.iter().map(|row| row.status).collect();
    assert_eq!(status, [Outcome::Converged, Outcome::OutOfMemory, Outcome::Converged]);
    let row = &report.rows[1];
    let message = row.message.as_deref().unwrap();
    assert!(message.starts_with("scheme sipg, level 200: would need about "), "{message}");
    assert!(message.ends_with("are available; choose a lower level"), "{message}");
    assert_eq!((row.cells, row.unknowns), (48_000_000, None));
    let scratch = Scratch::new("memory");
    report.write(&scratch.0).unwrap();
    assert!(scratch.read("report.md").contains("out-of-memory"));
}

#[test]
fn the_first_mesh_of_a_refinement_is_held_against_the_memory_before_it_is_built() {
    let study = study().levels([200]).adaptive(Adaptivity::default().unknowns(1000));
    let error = study.check().unwrap_err();
    assert!(matches!(error, Error::NotEnoughMemory { .. }), "{error}");
    let study = self::study().levels([2]).adaptive(Adaptivity::default().unknowns(1_000_000_000));
    study.check().unwrap();
    let message = study.check_memory().unwrap_err().to_string();
    assert!(message.contains("sipg, 1000000000 unknowns: would need about"), "{message}");
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
    assert!(matches!(error, Error::Parameter { parameter: "level", .. }), "{error}");
    let message = error.to_string();
    assert!(
        message.starts_with("level = 113: the matrix of sipg-p2 there may have 4.3e9 entries"),
        "{message}"
    );
    assert!(message.ends_with("a coarser level, a lower degree or more processes"), "{message}");
}
