//! The end of contact at a vertex and off all vertices.

use crate::error::Error;
use crate::mesh::{BoundaryCondition, BoxDomain, Mesh};
use crate::nested::Hierarchy;
use crate::real::{Point, Precision};
use crate::scenes;
use crate::scenes::Scene;
use crate::stability::case::Case;
use crate::stability::choice::Choice;
use crate::stability::criterion::Criterion;
use crate::stability::plan::{Plan, Sink};
use crate::stability::row::ExpectedRange;
use crate::stability::row_builder::{RowBuilder, figures, of};
use crate::stability::runs::{rows, solved, study};

const ORDER: Criterion = Criterion::new(
    "order-with-ends-off-mesh",
    &[ExpectedRange::at_least(0.95)],
    "Signorini with the end of contact at a vertex and off all vertices: the H1 order, fitted over levels of 16 and more, is at least {}.",
);
const END: Criterion = Criterion::new(
    "end-of-contact",
    &[ExpectedRange::at_most(1.0)],
    "The distance of the end of contact from the exact one, divided by 2h, is at most {}.",
);
const VALUES: Criterion = Criterion::new(
    "values-on-contact-set",
    &[ExpectedRange::at_most(1.0)],
    "The largest value of the solution on the exact contact set, divided by (2h)^(3/2), which is what the exact solution has 2h from the end, is at most {}.",
);
const JUNCTION: Criterion = Criterion::new(
    "junction-inside-facet",
    &[ExpectedRange::at_least(1.0)],
    "A mesh on which the exact contact condition fails inside a contact facet, because contact and Dirichlet boundary do not meet at a vertex, is refused or its errors withheld with a warning: {} if so.",
);
pub(crate) const CASE: Case =
    Case { name: "contact-ends", criteria: &[ORDER, END, VALUES, JUNCTION], plan };

/// A Signorini problem with contact for `x <= c`, and `c`.
type Ended = (fn() -> Scene<2>, f64);

const PROBLEMS: [Ended; 3] = [
    (scenes::signorini_2d, 0.0),
    (scenes::signorini_shifted_2d, 0.3),
    (scenes::signorini_irrational_2d, std::f64::consts::SQRT_2 / 10.0),
];

fn plan(plan: &mut Plan<'_>) {
    let levels: &[usize] = plan.pick_of(&[4, 8], &[16, 32], &[16, 32, 64, 128]);
    for choice in plan.compared() {
        for ended in PROBLEMS {
            plan.add(choice, &ended.0().name, move |c, sink| sweep(ended, c, levels, sink));
        }
        plan.add(choice, "junction inside a facet", junction);
    }
}

fn sweep(
    (make, end): Ended,
    choice: &Choice,
    levels: &[usize],
    sink: Sink<'_>,
) -> Result<(), Error> {
    let scene = make();
    let found = rows(&scene, choice, levels)?;
    let claim = |criterion| RowBuilder::new(criterion, choice).on(&scene.name).at("c", end);
    sink(claim(&ORDER).quantity("order in H1, fitted").fitted(&found, |r| r.error.h1));
    for row in &found {
        let size = 1.0 / row.level as f64;
        let claim = |criterion| claim(criterion).level(row.level);
        let distance = of(row, |r| r.contact.free_boundary_distance);
        sink(
            claim(&END)
                .quantity("distance of the ends over 2h")
                .detail(figures(row))
                .measured(distance.map(|d| d / (2.0 * size))),
        );
        let largest = largest_on_contact(&scene, choice, row.level, end)?;
        sink(
            claim(&VALUES)
                .quantity("largest value over (2h)^(3/2)")
                .detail(largest.map_or(String::new(), |u| format!("value {u:.2e}")))
                .measured(largest.map(|u| u / (2.0 * size).powf(1.5))),
        );
    }
    Ok(())
}

/// The largest size of a solution at the contact boundary up to the end of exact contact, linear
/// between vertices.
fn largest_on_contact(
    scene: &Scene<2>,
    choice: &Choice,
    level: usize,
    end: f64,
) -> Result<Option<f64>, Error> {
    let meshes = Hierarchy::of_domain(&scene.domain, level)?;
    let mesh = meshes.finest();
    let problem = choice.problem(scene);
    let found = solved(&problem, &meshes, choice)?;
    let Some(fields) = found.fields() else { return Ok(None) };
    let mut largest = 0.0_f64;
    for facet in mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact) {
        let (cell, local) = (facet.cell as usize, facet.local as usize);
        let ends: Vec<(f64, f64)> = (0..3)
            .filter(|&k| k != local)
            .map(|k| (mesh.vertices()[mesh.cell(cell)[k] as usize][0], fields.u[3 * cell + k]))
            .collect();
        let ([(a, u), (b, v)], t) =
            ([ends[0], ends[1]], (end - ends[0].0) / (ends[1].0 - ends[0].0));
        let at_end = (0.0..=1.0).contains(&t).then_some((end, u + t * (v - u)));
        for (x, value) in [(a, u), (b, v)].into_iter().chain(at_end) {
            if x <= end {
                largest = largest.max(value.abs());
            }
        }
    }
    Ok(Some(largest))
}

/// A mesh that reaches beyond the domain on the left: the corner of the domain, where Dirichlet and
/// contact boundary meet, lies inside a contact facet.
fn junction(choice: &Choice, sink: Sink<'_>) -> Result<(), Error> {
    let lower = Point::<2>::new(-1.1, 0.0);
    let domain = BoxDomain { lower, ..BoxDomain::above_contact() };
    let mesh: Mesh<2> = Mesh::kuhn_box(&domain, [20, 10])?;
    let scene = scenes::signorini_2d().domain(mesh);
    let (told, how) = match study(Precision::Double, &scene, choice).levels([0]).run() {
        Err(why) => (true, why.to_string()),
        Ok(report) => {
            let row = &report.rows[0];
            (row.error.h1.is_none() && !row.warnings.is_empty(), row.warnings.join("; "))
        }
    };
    sink(
        RowBuilder::new(&JUNCTION, choice)
            .on("signorini-2d")
            .quantity("refused, or errors withheld")
            .detail(how)
            .answered(told),
    );
    Ok(())
}
