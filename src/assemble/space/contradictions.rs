//! Bounds that leave no admissible value.

use std::ops::Range;

use super::{Space, checks};
use crate::algebra::Bound;
use crate::error::Error;
use crate::input::excerpt;
use crate::mesh::{BoundaryCondition, Mesh, describe_point};
use crate::parallel::cells;
use crate::problem::Datum;
use crate::real::Point;

/// What a value is that a boundary group imposes.
pub(crate) const DIRICHLET: &str = "Dirichlet value";

/// Two bounds contradict each other if they do so by more than this share of the largest datum: less is
/// rounding in the data.
const RELATIVE_SLACK: f64 = 1e-9;

/// Which share of the size of a function with the load counts as the largest datum: beside such a function a solution
/// of one solve, which is a datum of the next, vanishes but for a thousand roundings.
const SHARE_OF_LOAD: f64 = 1e3 * f64::EPSILON / RELATIVE_SLACK;

/// Two values of which the first exceeds the second, by rounding or in earnest.
///
/// Two values that are equal but for rounding may be zero but for rounding, so that the [size](Space::size_of_data) of
/// all data decides, which a [part](crate::mesh::Part) of a mesh need not have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contradiction<const D: usize> {
    pub node: BoundedNode<D>,
    pub lower: f64,
    pub upper: f64,
    /// What the two are, and the group of a Dirichlet value.
    pub of: [&'static str; 2],
    pub group: Option<usize>,
}

/// A node at which bounds are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundedNode<const D: usize> {
    pub unknown: usize,
    /// The cell by which the node is visited.
    pub cell: usize,
    pub x: Point<D>,
}

impl<const D: usize> BoundedNode<D> {
    /// Notes two values of which the first must not exceed the second.
    pub fn compare(
        self,
        (of, group): ([&'static str; 2], Option<usize>),
        [lower, upper]: [f64; 2],
        found: &mut Vec<Contradiction<D>>,
    ) {
        if lower > upper {
            found.push(Contradiction { node: self, lower, upper, of, group });
        }
    }
}

/// Data less a constant contradict each other by more than this many units of rounding of the constant: as much as
/// computed data have.
const ROUNDINGS_OF_CONSTANTS: f64 = 1e4;

impl<const D: usize> Space<'_, D> {
    /// Notes lower bounds above upper ones at the points of the rules for data in cells and on contact facets.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub(super) fn compare_between_nodes(
        &self,
        found: &mut Vec<Contradiction<D>>,
    ) -> Result<(), Error> {
        let data = &self.data;
        if !data.upper.is_given() {
            return Ok(());
        }
        let in_cells = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            let mut found = Vec::new();
            for cell in cells {
                let region = self.mesh.region(cell);
                let both = data.lower.of(region).zip(data.upper.of(region));
                let Some((lower, upper)) = both else { continue };
                for point in &self.cell_rule.points {
                    let x = self.cell_point(point, cell);
                    self.compare_at(
                        (cell, x),
                        [("obstacle", lower), ("obstacle", upper)],
                        &mut found,
                    )?;
                }
            }
            Ok::<_, Error>(found)
        });
        for of_chunk in in_cells {
            found.append(&mut of_chunk?);
        }
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            let upper = data.upper.of(self.mesh.region(cell));
            let Some((gap, upper)) = data.gap.of(group).zip(upper) else { continue };
            for (point, _) in self.facet_rule.iter() {
                let x = self.facet_point(point, cell, local);
                self.compare_at((cell, x), [("gap", gap), ("obstacle", upper)], found)?;
            }
        }
        Ok(())
    }

    /// Compares a lower and an upper bound, each with its name, at a point of a cell.
    fn compare_at(
        &self,
        (cell, x): (usize, Point<D>),
        bounds: [(&'static str, &Datum<D>); 2],
        found: &mut Vec<Contradiction<D>>,
    ) -> Result<(), Error> {
        let at = |(name, bound)| checks::finite(self.at(bound, cell, &x), name, &x, cell);
        let [lower, upper] = bounds.map(at);
        let node = BoundedNode { unknown: self.dofs.of(cell, 0), cell, x };
        node.compare((["lower bound", "upper bound"], None), [lower?, upper?], found);
        Ok(())
    }

    /// The largest absolute value of bounds, of those that contradict each other, and of a share of what the load does.
    pub fn size_of_data(&self, bounds: &[Bound<f64>], found: &[Contradiction<D>]) -> f64 {
        let of_load = SHARE_OF_LOAD * if found.is_empty() { 0.0 } else { self.size_of_load() };
        let of_found =
            found.iter().fold(of_load, |most, c| most.max(c.lower.abs()).max(c.upper.abs()));
        let largest = bounds.iter().fold(of_found, |most, bound| match *bound {
            Bound::Free => most,
            Bound::Fixed(a) | Bound::Lower(a) | Bound::Upper(a) => most.max(a.abs()),
            Bound::Both(a, b) => most.max(a.abs()).max(b.abs()),
        });
        // what was a number and is the difference from a constant has more rounding
        largest + ROUNDINGS_OF_CONSTANTS * self.body_constants.rounding() / RELATIVE_SLACK
    }
}

/// Refuses a contradiction in an own cell that exceeds rounding of data of which the largest is `size`.
pub(crate) fn refuse<const D: usize>(
    found: &[Contradiction<D>],
    size: f64,
    mesh: &Mesh<D>,
    owns: &dyn Fn(usize) -> bool,
) -> Result<(), Error> {
    let is_one =
        |c: &&Contradiction<D>| owns(c.node.cell) && c.lower - c.upper > RELATIVE_SLACK * size;
    let Some(&Contradiction { node, lower, upper, of, group }) = found.iter().find(is_one) else {
        return Ok(());
    };
    let BoundedNode { cell, x, .. } = node;
    let name = group.and_then(|group| mesh.boundary_groups()[group].names.first());
    let on = |of: &str| match name {
        Some(name) if of == DIRICHLET => format!("{of} on `{}`", excerpt(name)),
        _ => of.to_owned(),
    };
    let (cell, at, of) = (cell as u64, describe_point(&x), Box::new(of.map(on)));
    Err(Error::EmptyConstraint { cell, at, lower, upper, of })
}
