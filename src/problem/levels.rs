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
    fn extend(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|value| self.add(value));
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

/// The ranges of the data of one body, by rank: the first that has numbers says at which level the body is.
#[derive(Clone, Copy, Debug)]
struct Ranges {
    /// Of Dirichlet values, obstacles and gaps.
    of_values: [Range; 3],
    /// Of source over reaction, and of the values of Robin sides.
    of_quotients: Range,
}

const DIRICHLET: usize = 0;
const OBSTACLES: usize = 1;
const GAPS: usize = 2;

impl Ranges {
    const NONE: Self = Self { of_values: [Range::NONE; 3], of_quotients: Range::NONE };

    /// The middle of the first range; zero if it is no larger than the range of all values, or that of the quotients.
    fn constant(&self) -> f64 {
        let first = self.of_values.into_iter().find(|range| range.has_numbers());
        let range = match first {
            Some(_) => self.of_values.into_iter().fold(Range::NONE, Range::and),
            None => self.of_quotients,
        };
        let level = first.unwrap_or(range);
        // data that are not finite are errors of the assembly
        let is_large = level.middle().abs() > range.length() && range.length().is_finite();
        if level.has_numbers() && is_large { level.middle() } else { 0.0 }
    }
}

impl BodyConstants {
    /// The constants of a problem on a mesh; zero on a part of a mesh, which does not know the bodies of the whole.
    ///
    /// # Errors
    /// Those of [`DataOnMesh::new`].
    pub fn of<const D: usize>(problem: &Problem<D>, mesh: &Mesh<D>) -> Result<Self, Error> {
        let has_level = problem.has_dirichlet_data()
            || problem.robin.is_given()
            || problem.is_constrained()
            || problem.reaction.is_given() && problem.source.is_given();
        if mesh.is_part() || !has_level {
            return Ok(Self::default());
        }
        let data = DataOnMesh::new(problem, mesh)?;
        let (bodies, body_of) = bodies(mesh);
        let mut ranges = vec![Ranges::NONE; bodies];
        for facet in mesh.boundary() {
            let (cell, group) = (facet.cell as usize, usize::from(facet.group));
            let of_body = &mut ranges[body_of[cell] as usize];
            for v in mesh.facet_vertices(cell, usize::from(facet.local)) {
                let x = &mesh.vertices()[v as usize];
                let in_cell = |datum: &Datum<D>| datum.in_cell(mesh, cell, x);
                match facet.condition {
                    BoundaryCondition::Dirichlet => of_body.of_values[DIRICHLET]
                        .add(data.dirichlet.of(group).map_or(0.0, |u| u.at(x))),
                    BoundaryCondition::Contact => {
                        of_body.of_values[GAPS].extend(data.gap.of(group).map(in_cell))
                    }
                    BoundaryCondition::Neumann => of_body
                        .of_quotients
                        .extend(data.robin.of(group).map(|side| in_cell(&side.value))),
                }
            }
        }
        // Dirichlet values that reach zero decide without the data in cells
        let is_decided =
            |of: &Ranges| of.of_values[DIRICHLET].has_numbers() && of.constant() == 0.0;
        if ranges.iter().all(is_decided) {
            return Ok(Self::default());
        }
        for cell in 0..mesh.n_cells() {
            let (region, of_body) = (mesh.region(cell), &mut ranges[body_of[cell] as usize]);
            let at = |datum: &Datum<D>, x: &Point<D>| datum.in_cell(mesh, cell, x);
            let vertices = || mesh.cell(cell).iter().map(|&v| mesh.vertices()[v as usize]);
            for bound in [data.lower.of(region), data.upper.of(region)].into_iter().flatten() {
                of_body.of_values[OBSTACLES].extend(vertices().map(|x| at(bound, &x)));
            }
            let Some(reaction) = data.reaction.of(region) else { continue };
            for x in vertices().chain([mesh.barycentre(cell)]) {
                let reaction = at(reaction, &x);
                if reaction > 0.0 {
                    let source = data.source.of(region).map_or(0.0, |f| at(f, &x));
                    of_body.of_quotients.add(source / reaction);
                }
            }
        }
        Ok(Self::new(ranges.iter().map(Ranges::constant).collect(), body_of))
    }
}
