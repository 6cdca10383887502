//! Bounds that leave no admissible value.

use crate::algebra::Bound;
use crate::error::Error;
use crate::input::excerpt;
use crate::mesh::{BoundaryGroup, Mesh, describe_point};
use crate::real::Point;

/// What a value is that a boundary group imposes.
pub(crate) const DIRICHLET: &str = "Dirichlet value";

/// Two bounds contradict each other if they do so by more than this share of the largest datum: less is
/// rounding in the data.
const RELATIVE_SLACK: f64 = 1e-9;

/// Lower bounds above upper ones, by rounding or in earnest.
///
/// Two values that are equal but for rounding may be zero but for rounding, so that only the size of all data can
/// tell. [`Discretisation::bounds`](crate::assemble::Discretisation::bounds) does on a whole mesh; a
/// [part](crate::mesh::Part) need not have the largest datum.
#[derive(Clone, Debug)]
pub struct Contradictions<const D: usize> {
    found: Vec<Contradiction<D>>,
    /// The names of boundary groups.
    groups: Vec<String>,
    size: f64,
    relative_slack: f64,
}

/// Two values of which the first exceeds the second.
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

impl<const D: usize> Contradictions<D> {
    pub(in crate::assemble) fn new(
        bounds: &[Bound<f64>],
        found: Vec<Contradiction<D>>,
        mesh: &Mesh<D>,
    ) -> Self {
        let name = |group: &BoundaryGroup| group.names.first().map(excerpt).unwrap_or_default();
        let groups = mesh.boundary_groups().iter().filter(|_| !found.is_empty());
        let groups = groups.map(name).collect();
        let mut size = size_of(bounds);
        for contradiction in &found {
            size = size.max(contradiction.lower.abs()).max(contradiction.upper.abs());
        }
        Self { found, groups, size, relative_slack: RELATIVE_SLACK }
    }
    /// The largest absolute value of a bound.
    pub fn size(&self) -> f64 {
        self.size
    }
    /// Refuses a contradiction in an own cell that exceeds rounding of data of a size.
    ///
    /// # Errors
    /// [`Error::EmptyConstraint`].
    pub fn check(&self, size: f64, owns: &dyn Fn(usize) -> bool) -> Result<(), Error> {
        let slack = self.relative_slack * size;
        let mut own = self.found.iter().filter(|found| owns(found.node.cell));
        match own.find(|found| found.lower - found.upper > slack) {
            Some(&Contradiction { node, lower, upper, of, group }) => {
                let BoundedNode { unknown, cell, x } = node;
                let (cell, at) = (cell as u64, describe_point(&x));
                let name = group.and_then(|group| self.groups.get(group));
                let on = |of: &str| match name.filter(|name| of == DIRICHLET && !name.is_empty()) {
                    Some(name) => format!("{of} on `{name}`"),
                    None => of.to_owned(),
                };
                let of = Box::new(of.map(on));
                Err(Error::EmptyConstraint { unknown, cell, at, lower, upper, of })
            }
            None => Ok(()),
        }
    }
}

/// The largest absolute value of bounds.
fn size_of(bounds: &[Bound<f64>]) -> f64 {
    let mut size = 0.0_f64;
    for bound in bounds {
        let [one, other] = match *bound {
            Bound::Free => continue,
            Bound::Fixed(a) | Bound::Lower(a) | Bound::Upper(a) => [a, a],
            Bound::Both(a, b) => [a, b],
        };
        size = size.max(one.abs()).max(other.abs());
    }
    size
}
