//! How far the solver reaches: every scene with every scheme, penalty and place of the constraint.

use std::collections::BTreeMap;

use unilateral::constraint::constraint_set_by_name;
use unilateral::in_its_dimension;
use unilateral::prelude::*;
use unilateral::scenes::{Parameters, Scene, catalogue};
use unilateral::scheme::{SCHEMES, SchemeOptions, scheme_by_name};
use unilateral::study::Row;

/// Over-penalties from almost none to where rounding rules.
const ETAS: [f64; 5] = [1e-2, 1.0, 10.0, 1e4, 1e8];

/// More steps than this are named, like failures.
const MANY: usize = 25;

/// A scheme by name, its penalty if not the default, and a placement.
type Choice = (&'static str, Option<f64>, &'static str);

fn choices() -> Vec<Choice> {
    let mut choices = Vec::new();
    for &(name, _) in SCHEMES {
        let placements: &[_] = match name {
            "p1" | "cr" => &["vertices"],
            "p2" => &["nodes", "midpoints", "bernstein"],
            name if name.ends_with("-p2") => &["nodes", "midpoints", "bernstein"],
            _ => &["vertices", "facet-means"],
        };
        for placement in placements {
            choices.push((name, None, *placement));
            if name.starts_with("wopsip") {
                choices.extend(ETAS.map(|eta| (name, Some(eta), *placement)));
            }
        }
    }
    choices
}

/// The rows of a scene under a choice, none where the scheme does not fit the scene.
fn rows<const D: usize>(scene: Scene<D>, choice: Choice, levels: &[usize]) -> Vec<Row> {
    let (name, eta, placement) = choice;
    let set = constraint_set_by_name(placement).unwrap();
    let options = SchemeOptions { eta, ..SchemeOptions::default() };
    let scheme = scheme_by_name::<D>(name, &options).unwrap();
    let study = Study::<D>::new(scene).boxed_scheme_on(scheme, set);
    let study = study.levels(levels.iter().copied());
    study.run().map(|report| report.rows).unwrap_or_default()
}

/// Three small levels of each dimension, or those that a variable of the environment names.
fn levels(dimension: usize) -> Vec<usize> {
    if let Ok(asked) = std::env::var("LEVELS") {
        return asked.split(',').filter_map(|level| level.parse().ok()).collect();
    }
    match dimension {
        1 => vec![8, 32, 128],
        2 => vec![8, 16, 32],
        _ => vec![1, 2, 4],
    }
}

/// Whether a variable of the environment names this, or is absent.
fn is_asked(variable: &str, name: &str) -> bool {
    std::env::var(variable).map_or(true, |asked| asked.split(',').any(|asked| asked == name))
}

#[test]
#[ignore = "takes minutes: prints how many runs converge, and their systems"]
fn reach() {
    let mut summary = BTreeMap::<(usize, String), Vec<Row>>::new();
    for entry in catalogue().iter().filter(|entry| is_asked("SCENES", &entry.name)) {
        let choices = choices();
        let chosen = choices.iter().filter(|choice| is_asked("SCHEMES", choice.0));
        for (k, &choice) in chosen.enumerate() {
            let levels = levels(entry.dimension);
            let scene = entry.make(&Parameters::default()).unwrap();
            let found = in_its_dimension!(scene, |scene| rows(scene, choice, &levels));
            let eta = choice.1.map_or("default".into(), |eta| format!("{eta:e}"));
            let label = format!("{} | {} | {eta}", choice.0, choice.2);
            for row in &found {
                let is_good = row.converged() && row.certificate.largest() <= 1e-8;
                if !is_good || row.iterations.outer.unwrap_or(0) > MANY {
                    println!(
                        "| {} | {label} | {} | {} | {} | {:.1e} |",
                        row.scene,
                        row.level,
                        row.status,
                        row.iterations.outer.unwrap_or(0),
                        row.certificate.largest()
                    );
                }
            }
            summary.entry((k, label)).or_default().extend(found);
        }
    }
    let mut uncertified = 0;
    println!("\n| scheme | bounds on | eta | runs | converged | most steps | mean steps |");
    println!("|---|---|---|---|---|---|---|");
    for ((_, label), rows) in &summary {
        let steps = || rows.iter().map(|row| row.iterations.outer.unwrap_or(0));
        let converged = rows.iter().filter(|row| row.converged());
        uncertified += converged.clone().filter(|row| row.certificate.largest() > 1e-8).count();
        println!(
            "| {label} | {} | {} | {} | {:.1} |",
            rows.len(),
            converged.count(),
            steps().max().unwrap_or(0),
            steps().sum::<usize>() as f64 / rows.len().max(1) as f64
        );
    }
    assert_eq!(uncertified, 0);
}
