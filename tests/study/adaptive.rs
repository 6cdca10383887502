//! Studies on meshes that follow the error bound.

use crate::support::scratch::Scratch;
use unilateral::mesh::BoundaryCondition;
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::{Program, fill_orders};

fn study<'a>(scene: Scene<2>) -> Study<'a, 2> {
    Study::new(scene).scheme(ConformingP1).scheme(Wopsip::default())
}

#[test]
fn a_row_is_a_step_with_the_times_of_all_before() {
    let adaptivity = Adaptivity::default().steps(4);
    let report = study(scenes::hertz_2d()).adaptive(adaptivity).run().unwrap();
    assert_eq!(report.rows.len(), 10);
    for rows in report.rows.chunks(5) {
        assert!(rows.iter().map(|row| row.level).eq(0..5));
        for pair in rows.windows(2) {
            let (before, row) = (&pair[0], &pair[1]);
            assert!(row.converged() && row.theta == Some(0.5) && row.unknowns > before.unknowns);
            let growth = row.unknowns.unwrap() as f64 / before.unknowns.unwrap() as f64;
            let order = |coarse: f64, fine: f64| 2.0 * (coarse / fine).ln() / growth.ln();
            let [h1, bound] = [
                order(before.error.h1.unwrap(), row.error.h1.unwrap()),
                order(before.bound.discrete.unwrap(), row.bound.discrete.unwrap()),
            ];
            assert!((row.order.h1.unwrap() - h1).abs() < 1e-9);
            assert!((row.order.bound.unwrap() - bound).abs() < 1e-9);
            assert_eq!(row.expected_order.h1, None);
            let seconds = row.seconds;
            let sum = seconds.mesh + seconds.assemble + seconds.solve + seconds.bound.unwrap();
            assert!((seconds.total - sum).abs() < 1e-9 * sum);
            assert!(seconds.total > before.seconds.total && seconds.bound > before.seconds.bound);
        }
        assert_eq!(rows[0].order.bound, None);
    }
    assert!(report.extrapolated().is_empty());
    let table = report.details_to_text(100);
    assert!(table.contains(" step ") && table.contains(" total"), "{table}");
    // beside uniform rows of the same scheme
    let uniform = study(scenes::hertz_2d()).levels([4, 8]).run().unwrap().rows;
    for row in &uniform {
        let seconds = row.seconds;
        let sum = seconds.mesh + seconds.assemble + seconds.solve;
        // the bound of a uniform mesh is beside the times of the solution
        assert!(row.theta.is_none() && seconds.bound > Some(0.0));
        assert!((seconds.total - sum).abs() < 1e-9 * sum);
    }
    let mut both = [&report.rows[..], &uniform[..]].concat();
    fill_orders(&mut both);
    assert_eq!(both[..10], report.rows[..]);
    assert_eq!(both[10..], uniform[..]);
}

#[test]
fn the_last_step_has_the_files_of_fields() {
    for all in [false, true] {
        let scratch = Scratch::new(if all { "adaptive-all" } else { "adaptive-last" });
        let mut study = study(scenes::radial(1.0)).fields_to(&scratch.0);
        if all {
            study = study.fields_of_all_levels();
        }
        let report = study.adaptive(Adaptivity::to_bound(0.5)).run().unwrap();
        let mut expected = Vec::new();
        for label in ["p1", "wopsip"] {
            let of_label = || report.rows.iter().filter(|row| row.label == label);
            let (steps, last) = (of_label().count(), of_label().next_back().unwrap());
            assert!(steps > 2 && last.bound.discrete <= Some(0.5) && last.warnings.is_empty());
            expected.push(format!("radial-2d-{label}.vtu"));
            if all {
                expected.push(format!("radial-2d-{label}.pvd"));
                expected.extend((0..steps - 1).map(|k| format!("radial-2d-{label}-{k}.vtu")));
                let list = scratch.read(&format!("radial-2d-{label}.pvd"));
                assert_eq!(list.matches("<DataSet").count(), steps);
            }
            // the nodes of both schemes are those of the file
            let points = format!("NumberOfPoints=\"{}\"", last.unknowns.unwrap());
            let bytes = std::fs::read(scratch.0.join(format!("radial-2d-{label}.vtu"))).unwrap();
            assert!(String::from_utf8_lossy(&bytes).contains(&points), "{label}");
        }
        let mut found: Vec<String> = std::fs::read_dir(&scratch.0)
            .unwrap()
            .map(|file| file.unwrap().file_name().into_string().unwrap())
            .collect();
        found.sort();
        expected.sort();
        assert_eq!(found, expected);
    }
}

#[test]
fn rows_are_in_the_journal_and_the_report_is_read_again() {
    let scratch = Scratch::new("adaptive-journal");
    let journal = Journal::create(&scratch.0, Program::new("mine", "f64", 1, 1)).unwrap();
    let study = study(scenes::torsion_2d(1.0)).adaptive(Adaptivity::default().steps(2));
    let report = study.journal(&journal).run().unwrap();
    let read = Report::read(&scratch.0).unwrap();
    assert!(!read.complete && read.rows == report.rows && read.rows.len() == 6);
    assert!(read.rows[2].order.bound > Some(0.5), "a scene without a solution has a bound");
    report.write(&scratch.0).unwrap();
    assert!(Report::read(&scratch.0).unwrap().rows == report.rows);
    let plot = scratch.read("convergence.svg");
    assert!(plot.contains("number of unknowns") && plot.contains("error bound"));
}

#[test]
fn what_an_adaptive_study_cannot_have_is_refused_before_work() {
    let message = |study: Study<'_, 2>| {
        let message = study.check().unwrap_err().to_string();
        assert_eq!(study.run().unwrap_err().to_string(), message);
        message
    };
    let adaptivity = Adaptivity::default().steps(1);
    let of = |scene| study(scene).adaptive(adaptivity);
    let cases = [
        (of(scenes::radial(1.0)).levels([4, 8]), "number of levels = 2"),
        (of(scenes::radial(1.0)).reference(ConformingP1, 64), "reference = 64"),
        (of(scenes::radial(1.0)).adaptive(adaptivity.theta(2.0)), "theta = 2.0"),
        (of(scenes::disc_2d()), "bisection does not follow a circle"),
        (of(scenes::radial(1.0)).levels([0]), "level = 0"),
    ];
    for (study, expected) in cases {
        let message = message(study);
        assert!(message.contains(expected), "{message}");
    }
    // the first mesh
    let rows = of(scenes::radial(1.0)).levels([8]).run().unwrap().rows;
    assert_eq!(rows[0].cells, 128);
    let mesh = scenes::radial::<2>(1.0).domain.mesh(6).unwrap();
    let own = Problem::new().constant_source(-1.0).obstacle_below(|_| -0.05);
    assert!(mesh.has_condition(BoundaryCondition::Dirichlet));
    let own = Study::<2>::new(Scene::new("own", mesh, own)).scheme(Sipg::default());
    let rows = own.adaptive(adaptivity).run().unwrap().rows;
    assert!(rows[0].cells == 72 && rows[1].bound.total < rows[0].bound.total);
}
