//! Curved obstacles, on which an over-penalty with bounds at vertices lifts off in a pattern.

use std::sync::Arc;

use crate::algebra::{Contact, Inequality};
use crate::error::Error;
use crate::inequality::{InequalitySolver, InteriorPoint, Outcome, Solution};
use crate::mesh::Mesh;
use crate::nested::Hierarchy;
use crate::real::Point;
use crate::real::Precision;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::choice::{Choice, Penalty};
use crate::stability::plan::{Plan, Sink};
use crate::stability::row_builder::{RowBuilder, figures, fitted_order, listed, of};
use crate::stability::runs::{row, rows, solved_by, solver};

/// An obstacle touched in a disc around the origin, with its radius.
type Touched = (fn() -> Scene<2>, f64);

const PROBLEMS: [Touched; 2] =
    [(scenes::ball_2d, 0.697_965_148_223_373_6), (scenes::cone::<2>, 0.5)];

/// Levels to which the order of the multiplier is fitted.
const FITTED: [usize; 3] = [16, 32, 64];

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let levels: &[usize] = plan.pick_of(&[8], &[8, 16, 32], &[8, 16, 32, 64]);
    let further = [
        Choice::new("wopsip", Penalty::Eta(1.0)),
        Choice::new("wopsip", Penalty::Eta(100.0)),
        Choice::new("wopsip:facet-means", Penalty::Eta(1.0)),
        Choice::new("wopsip:facet-means", Penalty::Eta(100.0)),
    ];
    let fitted: &[usize] = plan.pick_of(&[4, 8], &FITTED, &FITTED);
    for choice in plan.compared_and(&further) {
        for touched in PROBLEMS {
            plan.add("curved-obstacle", choice, &touched.0().name, move |c, sink| {
                sweep(touched, c, levels, fitted, sink)
            });
        }
    }
}

fn sweep(
    touched: Touched,
    choice: &Choice,
    levels: &[usize],
    fitted: &[usize],
    sink: Sink<'_>,
) -> Result<(), Error> {
    levels.iter().try_for_each(|&level| single(touched, choice, level, sink))?;
    let scene = touched.0();
    let name = scene.name.clone();
    let found = rows::<2>(scene, choice, fitted)?;
    let errors: Vec<(usize, f64)> =
        found.iter().filter_map(|r| Some((r.level, of(r, |r| r.contact.multiplier_l1)?))).collect();
    let order = (errors.len() == fitted.len()).then(|| fitted_order(&errors)).flatten();
    let claim = RowBuilder::new("multiplier-order", choice)
        .on(&name)
        .quantity("order of the multiplier in L1, fitted")
        .detail(format!("L1 error {}", listed(&errors)));
    // the multiplier of the cone is not bounded
    let claim = if name == "ball-2d" { claim.at_least(0.9) } else { claim };
    sink(claim.measured(order));
    Ok(())
}

/// All rows of a level.
fn single(
    (make, radius): Touched,
    choice: &Choice,
    level: usize,
    sink: Sink<'_>,
) -> Result<(), Error> {
    let scene = make();
    let mesh = scene.domain.mesh(level)?;
    let size = scene.domain.length() / level as f64;
    let claim = |name| RowBuilder::new(name, choice).on(&scene.name).level(level).at("h", size);
    let found = row::<2>(make(), choice, level)?;
    sink(
        claim("certificate")
            .quantity("largest violation of the conditions")
            .at_most(1e-9)
            .detail(figures(&found))
            .measured(of(&found, |r| Some(r.certificate.largest()))),
    );
    let strip = 2.0 * size * 2.0 * std::f64::consts::PI * radius;
    sink(
        claim("contact-set")
            .quantity("area of the difference over that of the strip")
            .at_most(1.0)
            .measured(of(&found, |r| r.contact.contact_area_error.map(|a| a / strip))),
    );
    let share = share_inside(&scene, &mesh, choice, radius - 1.5 * size)?;
    sink(
        claim("contact-set")
            .quantity("share of single unknowns in contact, inside")
            .measured(share),
    );
    let mut silent = 0;
    let mut outcomes = Vec::new();
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    let solvers: [Arc<dyn InequalitySolver<f64>>; 2] =
        [Arc::new(solver()), Arc::new(InteriorPoint)];
    for (k, solver) in solvers.into_iter().enumerate() {
        let problem = choice.constrain(scene.problem.clone());
        let solved = solved_by(solver, &problem, &meshes, choice, true)?;
        let largest = solved.certificate().largest();
        let is_wrong = largest.is_nan() || largest > Precision::Double.certificate_limit();
        silent += usize::from(solved.converged() && is_wrong);
        outcomes.push(format!("{} after {}", solved.outcome(), solved.outer().unwrap_or(0)));
        if k == 0 {
            let sets = solved.outer().filter(|_| solved.converged());
            sink(
                claim("iterations")
                    .quantity("linear systems of all methods")
                    .at_most(25.0)
                    .detail(outcomes[0].clone())
                    .measured(sets.map(|n| n as f64)),
            );
        }
    }
    sink(
        claim("no-silent-failure")
            .quantity("wrong iterates returned as converged")
            .at_most(0.0)
            .detail(format!("active set: {}; interior point: {}", outcomes[0], outcomes[1]))
            .measured(Some(silent as f64)),
    );
    Ok(())
}

/// Among the bounded unknowns with nodes within a radius, the share in contact.
fn share_inside(
    scene: &Scene<2>,
    mesh: &Mesh<2>,
    choice: &Choice,
    radius: f64,
) -> Result<Option<f64>, Error> {
    let inequality: Inequality<f64> = choice.inequality(&scene.problem, mesh)?;
    let solution: Solution<f64> = solver().solve(&inequality);
    if solution.outcome != Outcome::Converged {
        return Ok(None);
    }
    let (mut inside, mut touching) = (0_u32, 0_u32);
    for (k, location) in inequality.locations.iter().enumerate() {
        let vertices = location.vertices();
        let sum: Point<2> = vertices.iter().map(|&v| mesh.vertices()[v as usize]).sum();
        if inequality.bounds[k].is_inequality() && (sum / vertices.len() as f64).norm() < radius {
            inside += 1;
            touching += u32::from(solution.contact[k] != Contact::Inactive);
        }
    }
    Ok((inside > 0).then(|| f64::from(touching) / f64::from(inside)))
}
