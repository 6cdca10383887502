//! The end of contact at a vertex and off all vertices.

use crate::mesh::{BoundaryCondition, BoxDomain, Mesh};
use crate::real::Point;
use crate::stability::table::*;

const ORDER: Criterion = Criterion::new(
    "order-with-ends-off-mesh",
    &[ExpectedRange::at_least(0.95)],
    "Signorini with the end of contact at a vertex and off all vertices: the H1 order, fitted over levels of 16 and more, is at least 0.95.",
);
const END: Criterion = Criterion::new(
    "end-of-contact",
    &[ExpectedRange::at_most(1.0)],
    "The distance of the end of contact from the exact one, divided by 2h, is at most 1.",
);
const VALUES: Criterion = Criterion::new(
    "values-on-contact-set",
    &[ExpectedRange::at_most(1.0)],
    "The largest value of the solution on the exact contact set, divided by (2h)^(3/2), which is what the exact solution has 2h from the end, is at most 1.",
);
const JUNCTION: Criterion = Criterion::new(
    "junction-inside-facet",
    &[ExpectedRange::at_least(1.0)],
    "A mesh on which the exact contact condition fails inside a contact facet, because contact and Dirichlet boundary do not meet at a vertex, has its errors withheld with a warning: 1 if so.",
);
pub(crate) const CASE: Case =
    Case { name: "contact-ends", criteria: &[ORDER, END, VALUES, JUNCTION], sweeps };

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let levels = study.effort.pick(&[16, 32][..], &[16, 32, 64, 128]);
    // contact for x at most c
    let problems = [
        ("signorini-2d", 0.0),
        ("signorini-shifted-2d", 0.3),
        ("signorini-irrational-2d", std::f64::consts::SQRT_2 / 10.0),
    ];
    let of = |(scene, end)| Sweep {
        compares: true,
        parameter: "c",
        places: Place::levels(scene, levels).into_iter().map(|place| place.at(end)).collect(),
        columns: vec![
            Column::fitted(&ORDER, "order in H1, fitted", H1.1, |_| Asked::Limit(0)),
            Column::new(&END, "distance of the ends over 2h", |at| {
                let distance = at.of(|row| row.contact.free_boundary_distance)?;
                Some(distance / (2.0 * at.size()))
            }),
            Column::new(&VALUES, "largest value over (2h)^(3/2)", move |at| {
                Some(largest_on_contact(at, end)? / (2.0 * at.size()).powf(1.5))
            }),
        ],
        ..Sweep::default()
    };
    // a mesh that reaches beyond the domain on the left: the corner of the domain, where Dirichlet and contact boundary
    // meet, lies inside a contact facet
    let domain = BoxDomain { lower: Point::<2>::new(-1.1, 0.0), ..BoxDomain::above_contact() };
    let scene = scenes::signorini_2d().domain(Mesh::kuhn_box(&domain, [20, 10])?);
    let junction = Sweep {
        compares: true,
        places: vec![Place::on_mesh(scene, None)],
        columns: vec![Column::new(&JUNCTION, "errors withheld", |at| {
            let row = at.rows().first()?;
            Some(f64::from(u8::from(row.error.h1.is_none() && !row.warnings.is_empty())))
        })],
        ..Sweep::default()
    };
    Ok(problems.into_iter().map(of).chain([junction]).collect())
}

/// The largest size of a solution at the contact boundary up to the end of exact contact, linear between vertices.
fn largest_on_contact(at: &At<'_>, end: f64) -> Option<f64> {
    let (mesh, values) = (at.mesh()?, at.values()?);
    let mut largest = 0.0_f64;
    for facet in mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact) {
        let (cell, local) = (facet.cell as usize, facet.local as usize);
        let [(a, u), (b, v)] = [(local + 1) % 3, (local + 2) % 3]
            .map(|k| (mesh.vertices()[mesh.cell(cell)[k] as usize][0], values[3 * cell + k]));
        let t = (end - a) / (b - a);
        let at_end = (0.0..=1.0).contains(&t).then_some((end, u + t * (v - u)));
        for (x, value) in [(a, u), (b, v)].into_iter().chain(at_end) {
            if x <= end {
                largest = largest.max(value.abs());
            }
        }
    }
    Some(largest)
}
