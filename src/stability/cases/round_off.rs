//! Over-penalty and rounding: Poisson on meshes fine enough for it to show, and the limit of large factors, which is
//! the Crouzeix-Raviart scheme.

use crate::error::Error;
use crate::mesh::Mesh;
use crate::nested::Hierarchy;
use crate::real::Precision;
use crate::scenes;
use crate::scenes::{Scene, sines};
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, of, quotient};
use crate::stability::runs::{row_in, solved};
use crate::study::Row;

/// The largest factor between errors of a mesh and of the coarser one.
const HALVING: ExpectedRange = ExpectedRange::at_most(0.3);

const ABOVE_BARRIER: Criterion = Criterion::new(
    "halving-above-barrier",
    &[HALVING],
    "Poisson, over-penalty 1/h^3 in values at vertices: each halving of h multiplies the error by {} at most as long as h is at least 4 (epsilon eta)^(1/6), epsilon half the distance from one to the next number.",
);
const TO_FLOOR: Criterion = Criterion::new(
    "halving-to-floor",
    &[HALVING],
    "Poisson: errors fall like h^2, by {} or better at each halving, down to h = epsilon^(1/4). Conforming elements do so; an over-penalty does not where it is added to the stiffness, and does where the two are kept apart, as they are here.",
);
const LIMIT: Criterion = Criterion::new(
    "limit-of-large-factors",
    &[ExpectedRange::at_most(1.0)],
    "With bounds on facet means or with none, the relative distance in L2 to the Crouzeix-Raviart solution, times eta^(1/2), is at most {} for eta to 1e6: the limit is reached before rounding matters. For larger factors rounding is known to prevail.",
);
pub(crate) const CASE: Case =
    Case { name: "round-off", criteria: &[ABOVE_BARRIER, TO_FLOOR, LIMIT], plan };

/// The largest factor for which the limit is met; rounding dominates for larger factors.
const JUDGED: f64 = 1e6;

fn plan(plan: &mut Plan<'_>) {
    let further = ["wopsip", "wopsip:facet-means"].map(|scheme| Choice::with_eta(scheme, 0));
    let (strings, squares) = (plan.pick_of(7, 10, 15), plan.pick_of(4, 5, 7));
    for choice in plan.compared_and(&further) {
        plan.add(choice, "string f64", move |c, sink| {
            sweep::<1>(c, (strings, Precision::Double), sink)
        });
        plan.add(choice, "string f32", move |c, sink| {
            sweep::<1>(c, (strings.min(12), Precision::Single), sink)
        });
        plan.add(choice, "square f32", move |c, sink| {
            sweep::<2>(c, (squares, Precision::Single), sink)
        });
        plan.add(choice, "square f64", move |c, sink| {
            sweep::<2>(c, (squares, Precision::Double), sink)
        });
    }
    let level = plan.pick(16, 32);
    let exponents: &[i32] = plan.pick(&[2, 6], &[0, 2, 4, 6, 8, 10]);
    let limits: [(_, _, fn() -> Scene<2>); 3] = [
        ("wopsip", "no bounds", sines),
        ("wopsip:facet-means", "no bounds", sines),
        ("wopsip:facet-means", "bounds on facet means", || scenes::radial(1.0)),
    ];
    for (scheme, what, make) in limits {
        for &exponent in exponents {
            plan.add(Choice::with_eta(scheme, exponent), what, move |c, sink| {
                limit(&make(), (c, 10.0_f64.powi(exponent)), level, sink)
            });
        }
    }
}

/// Halves the mesh size from four subdivisions on.
fn sweep<const D: usize>(
    choice: &Choice,
    (finest, precision): (u32, Precision),
    sink: Sink<'_>,
) -> Result<(), Error> {
    let levels: Vec<usize> = (2..=finest).map(|k| 2_usize.pow(k)).collect();
    let error = |row: &Row| row.error.l2;
    let rounding = 0.5 * precision.epsilon();
    let barrier = 4.0 * rounding.powf(1.0 / 6.0);
    let floor = rounding.powf(0.25);
    let scene = sines::<D>();
    let mut coarser: Option<Row> = None;
    for &level in &levels {
        let row = row_in(precision, &scene, choice, level)?;
        let size = 1.0 / level as f64;
        if let Some(before) = &coarser {
            let ratio = quotient(of(&row, error), of(before, error));
            let claim = |criterion| {
                RowBuilder::new(criterion, choice)
                    .on(&scene.name)
                    .precision(precision.name())
                    .level(level)
                    .at("h", size)
                    .quantity("L2 error over that on twice h")
                    .underlying("L2 error", of(&row, error))
                    .detail(figures(&row))
            };
            let has_barrier = choice.scheme() == "wopsip" && choice.options().eta == Some(1.0);
            if has_barrier && 2.0 * size >= barrier {
                sink(claim(&ABOVE_BARRIER).measured(ratio));
            }
            // quadratics reach the floor of rounding with their higher order long before
            let is_judged = size >= floor && !choice.scheme().starts_with("p2");
            sink(claim(&TO_FLOOR).judged_if(is_judged).measured(ratio));
        }
        coarser = Some(row);
    }
    Ok(())
}

fn limit(
    scene: &Scene<2>,
    (choice, eta): (&Choice, f64),
    level: usize,
    sink: Sink<'_>,
) -> Result<(), Error> {
    let means = Choice::of("cr");
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    let (problem, problem_of_means) = (choice.problem(scene), means.problem(scene));
    let ours = solved(&problem, &meshes, choice)?;
    let limit = solved(&problem_of_means, &meshes, &means)?;
    let distance = match (ours.fields(), limit.fields()) {
        (Some(a), Some(b)) => Some(relative_distance(ours.mesh(), &a.u, &b.u)),
        _ => None,
    };
    let claim = RowBuilder::new(&LIMIT, choice)
        .known_to_fail(eta > JUDGED)
        .on(&scene.name)
        .level(level)
        .at("eta", eta)
        .quantity("relative L2 distance to cr, times eta^(1/2)")
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
