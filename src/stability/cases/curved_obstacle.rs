//! Curved obstacles, on which an over-penalty with bounds at vertices lifts off in a pattern.

use std::sync::Arc;

use crate::algebra::Contact;
use crate::error::Error;
use crate::inequality::{InequalitySolver, InteriorPoint, Outcome};
use crate::mesh::Mesh;
use crate::nested::Hierarchy;
use crate::real::Point;
use crate::real::Precision;
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, of};
use crate::stability::runs::{inequality, row, rows, solved_by, solver};

const SILENT: Criterion = Criterion::new(
    "no-silent-failure",
    &[ExpectedRange::at_most(0.0)],
    "No solver returns an iterate as converged that does not satisfy the complementarity conditions to 1e-9: the number of such returns is {}, with the active set method, whatever follows it, and with the interior point method.",
);
const CERTIFICATE: Criterion = Criterion::new(
    "certificate",
    &[ExpectedRange::at_most(1e-9)],
    "The complementarity conditions hold to {} in relative, dimensionless terms.",
);
const CONTACT_SET: Criterion = Criterion::new(
    "contact-set",
    &[ExpectedRange::at_most(1.0)],
    "The contact set, of vertices where some unknown touches, differs from the exact one by an area that, divided by that of a strip of width 2h along the free boundary, is at most {}. The share of single unknowns in contact well inside the exact set is reported beside it: it need not tend to one, and is no measure of contact.",
);
const MULTIPLIER: Criterion = Criterion::new(
    "multiplier-order",
    &[ExpectedRange::at_least(0.9)],
    "The multiplier, gathered over the patches of vertices, converges in L1 with order at least {}, fitted over levels 16, 32 and 64, where it is bounded.",
);
const ITERATIONS: Criterion = Criterion::new(
    "iterations",
    &[ExpectedRange::at_most(25.0)],
    "Started from conforming elements, the active set method and what follows where it stagnates solve at most {} linear systems.",
);
pub(crate) const CASE: Case = Case {
    name: "curved-obstacle",
    criteria: &[SILENT, CERTIFICATE, CONTACT_SET, MULTIPLIER, ITERATIONS],
    plan,
};

/// An obstacle touched in a disc around the origin, with its radius.
type Touched = (fn() -> Scene<2>, f64);

const PROBLEMS: [Touched; 2] =
    [(scenes::ball_2d, 0.697_965_148_223_373_6), (scenes::cone::<2>, 0.5)];

/// Levels to which the order of the multiplier is fitted.
const FITTED: [usize; 3] = [16, 32, 64];

fn plan(plan: &mut Plan<'_>) {
    let levels: &[usize] = plan.pick_of(&[8], &[8, 16, 32], &[8, 16, 32, 64]);
    let further = [
        Choice::with_eta("wopsip", 0),
        Choice::with_eta("wopsip", 2),
        Choice::with_eta("wopsip:facet-means", 0),
        Choice::with_eta("wopsip:facet-means", 2),
    ];
    let fitted: &[usize] = plan.pick_of(&[4, 8], &FITTED, &FITTED);
    for choice in plan.compared_and(&further) {
        for touched in PROBLEMS {
            plan.add(choice, &touched.0().name, move |c, sink| {
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
    let claim = RowBuilder::new(&MULTIPLIER, choice)
        // the multiplier of the cone is not bounded
        .judged_if(scene.name == "ball-2d")
        .on(&scene.name)
        .quantity("order of the multiplier in L1, fitted");
    sink(claim.fitted(&rows(&scene, choice, fitted)?, |r| r.contact.multiplier_l1));
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
    let claim =
        |criterion| RowBuilder::new(criterion, choice).on(&scene.name).level(level).at("h", size);
    let found = row(&scene, choice, level)?;
    sink(
        claim(&CERTIFICATE)
            .quantity("largest violation of the conditions")
            .detail(figures(&found))
            .measured(of(&found, |r| Some(r.certificate.largest()))),
    );
    let strip = 2.0 * size * 2.0 * std::f64::consts::PI * radius;
    sink(
        claim(&CONTACT_SET)
            .quantity("area of the difference over that of the strip")
            .measured(of(&found, |r| r.contact.contact_area_error.map(|a| a / strip))),
    );
    let share = share_inside(&scene, &mesh, choice, radius - 1.5 * size)?;
    sink(
        claim(&CONTACT_SET)
            .judged_if(false)
            .quantity("share of single unknowns in contact, inside")
            .measured(share),
    );
    let mut silent = 0;
    let mut outcomes = Vec::new();
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    let solvers: [Arc<dyn InequalitySolver<f64>>; 2] =
        [Arc::new(solver()), Arc::new(InteriorPoint)];
    for (k, solver) in solvers.into_iter().enumerate() {
        let problem = choice.problem(&scene);
        let solved = solved_by(solver, &problem, &meshes, choice, false)?;
        let largest = solved.certificate().largest();
        let is_wrong = largest.is_nan() || largest > Precision::Double.certificate_limit();
        silent += usize::from(solved.converged() && is_wrong);
        outcomes.push(format!("{} after {}", solved.outcome(), solved.outer().unwrap_or(0)));
        if k == 0 {
            let sets = solved.outer().filter(|_| solved.converged());
            sink(
                claim(&ITERATIONS)
                    .quantity("linear systems of all methods")
                    .detail(outcomes[0].clone())
                    .measured(sets.map(|n| n as f64)),
            );
        }
    }
    sink(
        claim(&SILENT)
            .quantity("wrong iterates returned as converged")
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
    let inequality = inequality(scene, mesh, choice)?;
    let solution = solver().solve(&inequality);
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
