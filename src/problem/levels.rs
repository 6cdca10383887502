//! The level of the data of each body: which constant is taken off.

use super::body_constants::{BodyConstants, bodies};
use super::on_mesh::DataOnMesh;
use super::{Datum, Problem};
use crate::error::Error;
use crate::mesh::{BoundaryCondition, Mesh};
use crate::real::Point;

/// The least and the largest of some numbers.
#[derive(Clone, Copy, Debug)]
struct Range {
    least: f64,
    most: f64,
}

impl Range {
    const NONE: Self = Self { least: f64::INFINITY, most: f64::NEG_INFINITY };

    fn add(&mut self, value: f64) {
        (self.least, self.most) = (self.least.min(value), self.most.max(value));
    }
    /// The range of the numbers of both.
    fn and(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), most: self.most.max(other.most) }
    }
    fn middle(self) -> f64 {
        0.5 * self.least + 0.5 * self.most
    }
    fn has_numbers(self) -> bool {
        self.least <= self.most
    }
    fn length(self) -> f64 {
        self.most - self.least
    }
}

impl BodyConstants {
    /// The constants of a problem on a mesh; zero on a part of a mesh, which does not know the bodies of the whole.
    ///
    /// # Errors
    /// Those of [`DataOnMesh::new`].
    pub fn of<const D: usize>(problem: &Problem<D>, mesh: &Mesh<D>) -> Result<Self, Error> {
        let has_level = problem.has_dirichlet_data()
            || problem.is_constrained()
            || problem.reaction.is_given() && problem.source.is_given();
        if mesh.is_part() || !has_level {
            return Ok(Self::default());
        }
        let data = DataOnMesh::new(problem, mesh)?;
        let (bodies, body_of) = bodies(mesh);
        let mut values = vec![0.0; bodies];
        let dirichlet = of_dirichlet(&data, mesh, (bodies, &body_of));
        // a range of Dirichlet values that reaches zero decides without the other data
        if dirichlet.iter().all(|range| range.has_numbers() && is_small(*range, *range)) {
            return Ok(Self::default());
        }
        let obstacles = of_obstacles(&data, mesh, (bodies, &body_of));
        let gaps = of_gaps(&data, mesh, (bodies, &body_of));
        let quotients = of_quotients(&data, mesh, (bodies, &body_of));
        for (body, value) in values.iter_mut().enumerate() {
            let bounds = [dirichlet[body], obstacles[body], gaps[body]];
            let first = bounds.into_iter().find(|range| range.has_numbers());
            let range = match first {
                Some(_) => bounds.into_iter().fold(Range::NONE, Range::and),
                None => quotients[body],
            };
            let level = first.unwrap_or(range);
            if level.has_numbers() && !is_small(level, range) {
                *value = level.middle();
            }
        }
        Ok(Self::new(values, body_of))
    }
}

/// Whether the middle of data is zero, or no larger than a range; data that are not finite are errors of the assembly.
fn is_small(of: Range, range: Range) -> bool {
    // false for numbers that are not finite
    let is_large = of.middle().abs() > range.length() && range.length().is_finite();
    !is_large
}

/// The values at the vertices of facets of a condition, by body.
fn on_facets<const D: usize>(
    mesh: &Mesh<D>,
    condition: BoundaryCondition,
    (bodies, body_of): (usize, &[u32]),
    value: impl Fn(usize, usize, &Point<D>) -> Option<f64>,
) -> Vec<Range> {
    let mut ranges = vec![Range::NONE; bodies];
    for facet in mesh.boundary().iter().filter(|facet| facet.condition == condition) {
        let (cell, group) = (facet.cell as usize, usize::from(facet.group));
        for v in mesh.facet_vertices(cell, usize::from(facet.local)) {
            if let Some(value) = value(group, cell, &mesh.vertices()[v as usize]) {
                ranges[body_of[cell] as usize].add(value);
            }
        }
    }
    ranges
}

fn of_dirichlet<const D: usize>(
    data: &DataOnMesh<D>,
    mesh: &Mesh<D>,
    bodies: (usize, &[u32]),
) -> Vec<Range> {
    on_facets(mesh, BoundaryCondition::Dirichlet, bodies, |group, _, x| {
        Some(data.dirichlet.of(group).map_or(0.0, |u| u.at(x)))
    })
}

fn of_gaps<const D: usize>(
    data: &DataOnMesh<D>,
    mesh: &Mesh<D>,
    bodies: (usize, &[u32]),
) -> Vec<Range> {
    on_facets(mesh, BoundaryCondition::Contact, bodies, |group, cell, x| {
        data.gap.of(group).map(|gap| gap.in_cell(mesh, cell, x))
    })
}

fn of_obstacles<const D: usize>(
    data: &DataOnMesh<D>,
    mesh: &Mesh<D>,
    (bodies, body_of): (usize, &[u32]),
) -> Vec<Range> {
    let mut ranges = vec![Range::NONE; bodies];
    for cell in 0..mesh.n_cells() {
        let region = mesh.region(cell);
        let range = &mut ranges[body_of[cell] as usize];
        for bound in [&data.lower, &data.upper].into_iter().filter_map(|bound| bound.of(region)) {
            match bound.constant() {
                Some(constant) => range.add(constant),
                None => mesh.cell(cell).iter().for_each(|&v| {
                    range.add(bound.in_cell(mesh, cell, &mesh.vertices()[v as usize]));
                }),
            }
        }
    }
    ranges
}

fn of_quotients<const D: usize>(
    data: &DataOnMesh<D>,
    mesh: &Mesh<D>,
    (bodies, body_of): (usize, &[u32]),
) -> Vec<Range> {
    let mut ranges = vec![Range::NONE; bodies];
    for cell in 0..mesh.n_cells() {
        let region = mesh.region(cell);
        let Some(reaction) = data.reaction.of(region) else { continue };
        let vertices = mesh.cell(cell).iter().map(|&v| mesh.vertices()[v as usize]);
        for x in vertices.chain([mesh.barycentre(cell)]) {
            let at = |datum: &Datum<D>| datum.in_cell(mesh, cell, &x);
            let (source, reaction) = (data.source.of(region).map_or(0.0, at), at(reaction));
            if reaction > 0.0 {
                ranges[body_of[cell] as usize].add(source / reaction);
            }
        }
    }
    ranges
}
