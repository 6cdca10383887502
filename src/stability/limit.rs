//! The limit of large factors is the Crouzeix-Raviart scheme.

use super::choice::{Choice, Penalty};
use super::plan::{Plan, Sink};
use super::row_builder::RowBuilder;
use super::runs::{sines, solved};
use crate::error::Error;
use crate::mesh::Mesh;
use crate::nested::Hierarchy;
use crate::scenes;
use crate::scenes::Scene;

/// The largest factor for which the criterion is met; rounding dominates for larger factors.
const JUDGED: f64 = 1e6;

pub(crate) fn plan(plan: &mut Plan<'_>) {
    let level = plan.pick(16, 32);
    let exponents: &[i32] = plan.pick(&[2, 6], &[0, 2, 4, 6, 8, 10]);
    for scheme in ["wopsip", "wopsip:facet-means"] {
        for &exponent in exponents {
            let choice = Choice::new(scheme, Penalty::Eta(10.0_f64.powi(exponent)));
            plan.add("round-off", choice, "no bounds", move |c, sink| {
                compare(&sines(), c, level, sink)
            });
        }
    }
    for &exponent in exponents {
        let choice = Choice::new("wopsip:facet-means", Penalty::Eta(10.0_f64.powi(exponent)));
        plan.add("round-off", choice, "bounds on facet means", move |c, sink| {
            compare(&scenes::radial::<2>(1.0), c, level, sink)
        });
    }
}

fn compare(scene: &Scene<2>, choice: &Choice, level: usize, sink: Sink<'_>) -> Result<(), Error> {
    let Penalty::Eta(eta) = choice.penalty else { unreachable!("planned with a factor") };
    let means = Choice::default("cr");
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    let problem = choice.constrain(scene.problem.clone());
    let ours = solved(&problem, &meshes, choice, true)?;
    let problem_of_means = means.constrain(scene.problem.clone());
    let limit = solved(&problem_of_means, &meshes, &means, true)?;
    let distance = match (ours.fields(), limit.fields()) {
        (Some(a), Some(b)) => Some(relative_distance(ours.mesh(), &a.u, &b.u)),
        _ => None,
    };
    let claim = RowBuilder::new("limit-of-large-factors", choice)
        .on(&scene.name)
        .level(level)
        .at("eta", eta)
        .quantity("relative L2 distance to cr, times eta^(1/2)")
        .at_most(1.0)
        .known_to_fail(eta > JUDGED)
        .detail(distance.map_or(ours.outcome().name().to_owned(), |d| format!("distance {d:.2e}")));
    sink(claim.measured(distance.map(|d| d * eta.sqrt())));
    Ok(())
}

/// The distance of two broken linear functions in L2 over the norm of the second, both by values at
/// the vertices of cells: `int_K v^2 = |K| / ((D+1)(D+2)) (sum v_i^2 + (sum v_i)^2)`.
fn relative_distance<const D: usize>(mesh: &Mesh<D>, a: &[f64], b: &[f64]) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    for c in 0..mesh.n_cells() {
        let volume = mesh.geometry(c).volume;
        let here = c * (D + 1)..(c + 1) * (D + 1);
        let square = |values: &mut dyn Iterator<Item = f64>| {
            let (mut squares, mut sum) = (0.0, 0.0);
            values.for_each(|v| {
                squares += v * v;
                sum += v;
            });
            volume * (squares + sum * sum)
        };
        above += square(&mut a[here.clone()].iter().zip(&b[here.clone()]).map(|(a, b)| a - b));
        below += square(&mut b[here].iter().copied());
    }
    (above / below).sqrt()
}
