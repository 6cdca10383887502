//! Series of a report: one scheme on uniform and on adaptive meshes.

use crate::rows::row;
use crate::support::scratch::Scratch;
use unilateral::plot;
use unilateral::prelude::*;
use unilateral::study::{Meshes, Program, Series, fill_orders};

/// The reports of a scheme on uniform and on adaptive meshes, and that of all their rows.
fn reports() -> [Report; 3] {
    let study = || Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1);
    let uniform = study().levels([16, 4, 8, 32]).run().unwrap();
    let adaptive = study().adaptive(Adaptivity::default().steps(4)).run().unwrap();
    let mut both = uniform.clone();
    both.rows.extend(adaptive.rows.clone());
    [uniform, adaptive, both]
}

#[test]
fn uniform_and_adaptive_meshes_are_two_series() {
    let [uniform, adaptive, mut both] = reports();
    let series = both.series();
    let of = |s: &Series<'_>| (s.name.clone(), s.rows.iter().map(|r| r.level).collect::<Vec<_>>());
    let [first, second] = &series[..] else { panic!("{series:?}") };
    assert_eq!(of(first), ("p1, uniform".to_owned(), vec![4, 8, 16, 32]));
    assert_eq!(of(second), ("p1, adaptive".to_owned(), vec![0, 1, 2, 3, 4]));
    assert_eq!(first.variant.meshes, Meshes::Uniform);
    assert!(second.variant.meshes.is_adaptive() && second.variant.label == "p1");
    assert_eq!(uniform.series()[0].name, "p1", "alone it is called by its label");

    // orders, limits and verdicts are those of the two reports
    let orders = |report: &Report| report.rows.iter().map(|r| r.order).collect::<Vec<_>>();
    let alone = [orders(&uniform), orders(&adaptive)].concat();
    fill_orders(&mut both.rows);
    assert_eq!(orders(&both), alone);
    assert!(both.rows[3].order.h1.is_some() && both.rows[6].order.bound.is_some());
    assert_eq!(both.extrapolated(), uniform.extrapolated());
    let observed = [uniform.observed_orders(), adaptive.observed_orders()].concat();
    assert_eq!(both.observed_orders(), observed);
    assert_eq!(both.assert_orders(0.1), uniform.assert_orders(0.1));
}

#[test]
fn tables_of_a_report_with_both_are_those_of_each() {
    let [uniform, adaptive, both] = reports();
    let titled = |report: &Report, meshes: &str| {
        let title = format!("radial-2d, {meshes} meshes: ");
        report.details_to_text(100).replace("radial-2d: ", &title)
    };
    let expected = titled(&uniform, "uniform") + "\n" + &titled(&adaptive, "adaptive");
    let text = both.details_to_text(100);
    // a longer title may break the line elsewhere
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(words(&text), words(&expected), "{text}");
    let heads = text.lines().filter(|line| line.starts_with("scheme"));
    let levels: Vec<&str> = heads.filter_map(|line| line.split_whitespace().nth(1)).collect();
    assert!(levels.contains(&"n") && levels.contains(&"step"), "{text}");
    let markdown = both.to_markdown();
    for kind in ["uniform", "adaptive"] {
        assert!(markdown.contains(&format!("radial-2d, {kind} meshes")), "{markdown}");
    }
}

#[test]
fn plots_and_files_of_a_report_with_both_tell_them_apart() {
    let [.., both] = reports();
    for figure in [plot::convergence(&both.rows), plot::work_precision(&both.rows)] {
        let svg = figure.to_svg();
        assert!(svg.contains("p1, uniform") && svg.contains("p1, adaptive"), "{svg}");
    }
    // errors and bounds over unknowns, which both kinds of meshes have
    assert!(plot::convergence(&both.rows).to_svg().contains("number of unknowns"));
    let scratch = Scratch::new("series");
    both.write(&scratch.0).unwrap();
    let page = scratch.read("report.html");
    assert!(page.contains("p1, uniform") && page.contains("p1, adaptive"));
    for kind in ["uniform", "adaptive"] {
        assert!(page.contains(&format!("<caption>radial-2d, {kind} meshes, ")), "{page}");
    }
    let field = scratch.0.join("radial-2d-p1.vtu");
    std::fs::write(&field, "").unwrap();
    both.remove_files(&scratch.0);
    assert!(!field.exists());
}

/// Steps that mark other shares of the bound do not continue each other.
#[test]
fn each_share_of_marked_cells_is_a_series() {
    let mut rows = [0.5, 0.3].map(|theta| [0, 1].map(|step| (theta, step))).concat();
    let step = |(theta, step): (f64, usize)| {
        let mut row = row("radial-2d", "p1", 8 << step);
        (row.level, row.theta) = (step, Some(theta));
        row
    };
    rows.swap(1, 2);
    let mut rows: Vec<_> = rows.into_iter().map(step).collect();
    fill_orders(&mut rows);
    let has_order: Vec<bool> = rows.iter().map(|row| row.order.h1.is_some()).collect();
    assert_eq!(has_order, [false, false, true, true]);
    let report = crate::rows::report(rows);
    let names: Vec<String> = report.series().into_iter().map(|series| series.name).collect();
    assert_eq!(names, ["p1, theta 0.5", "p1, theta 0.3"]);
}

/// The orders of an adaptive series are fitted over the last half of its steps: those before may be coarse.
#[test]
fn rates_are_those_of_the_last_half_of_the_steps() {
    let mut rows: Vec<_> = (0..6).map(|step| row("a", "p1", step)).collect();
    for (step, row) in rows.iter_mut().enumerate() {
        row.level_kind = Some("steps".into());
        row.theta = Some(0.5);
        let unknowns = 100 << (2 * step);
        row.unknowns = Some(unknowns);
        // no order over the first half, then one half in unknowns, one in the mesh size
        row.bound.discrete = Some(if step < 3 { 1.0 } else { 40.0 / (unknowns as f64).sqrt() });
        row.seconds.total = (step + 1) as f64;
    }
    let text = Report::new(Program::new("test", "f64", 1, 1), rows).details_to_text(200);
    assert!(text.contains("p1: order bound 1.00"), "{text}");
    assert!(text.contains("from step 3 on") && text.contains("take 6.0 times the last"), "{text}");
}
