//! Boxes and their Kuhn triangulations.

use std::sync::Arc;

use crate::arrays::array_of;
use crate::mesh::boundary::{BoundaryCondition, BoundaryFacet};
use crate::mesh::error::MeshError;
use crate::mesh::groups::{BoundaryGroup, Groups};
use crate::mesh::simplicial::Mesh;
use crate::mesh::validate::check_size;
use crate::real::Point;

/// The names of the sides `x_k = lower_k` and `x_k = upper_k`, axis after axis: the boundary groups of the
/// meshes of a box.
pub(crate) const SIDES: [&str; 6] = ["left", "right", "bottom", "top", "back", "front"];

/// An axis-parallel box and the boundary condition on each of its sides. The boundary groups of
/// its meshes are called `left` and `right` (first axis), `bottom` and `top` (second), `back` and `front`
/// (third).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BoxDomain<const D: usize> {
    /// Lowest corner.
    pub lower: Point<D>,
    /// Highest corner.
    pub upper: Point<D>,
    /// Condition on the sides `x_k = lower_k` and `x_k = upper_k`, for each axis `k`.
    pub sides: [[BoundaryCondition; 2]; D],
    /// Names of the regions on both sides of the plane that halves the first axis; none for one region
    /// without a name.
    pub halves: Option<[&'static str; 2]>,
}

impl<const D: usize> BoxDomain<D> {
    /// The box between two corners, with the condition on the sides `x_k = lower_k` and `x_k = upper_k`
    /// for each axis `k`.
    pub fn new(lower: Point<D>, upper: Point<D>, sides: [[BoundaryCondition; 2]; D]) -> Self {
        Self { lower, upper, sides, halves: None }
    }
    /// Names the regions on both sides of the plane that halves the first axis. Meshes then have an even
    /// number of subdivisions along it.
    #[must_use]
    pub fn in_halves(mut self, names: [&'static str; 2]) -> Self {
        self.halves = Some(names);
        self
    }
    /// The box with Dirichlet data on every side.
    pub fn dirichlet(lower: Point<D>, upper: Point<D>) -> Self {
        Self::new(lower, upper, [[BoundaryCondition::Dirichlet; 2]; D])
    }
    /// The cube `(-half, half)^D` with Dirichlet data on every side.
    pub fn centred(half: f64) -> Self {
        Self::dirichlet(Point::repeat(-half), Point::repeat(half))
    }
    /// Sets the condition on one side (`end` 0 for the lower, 1 for the upper one).
    ///
    /// # Panics
    /// If the box has no such axis, or an axis no such end.
    #[must_use]
    pub fn side(mut self, axis: usize, end: usize, condition: BoundaryCondition) -> Self {
        assert!(
            axis < D && end < 2,
            "a box in dimension {D} has no side {end} across axis {axis}: axes count from 0, ends are 0 and 1"
        );
        self.sides[axis][end] = condition;
        self
    }
    /// The box of Signorini scenes: `(-1,1)^(D-1) x (0,1)`, contact where the last coordinate is
    /// zero, Dirichlet data on the other sides.
    pub fn above_contact() -> Self {
        let mut lower = Point::repeat(-1.0);
        lower[D - 1] = 0.0;
        Self::dirichlet(lower, Point::repeat(1.0)).side(D - 1, 0, BoundaryCondition::Contact)
    }
    /// Subdivisions along each axis when the shortest side has `level` of them and all small boxes
    /// are as close to cubes as whole numbers allow.
    pub fn counts(&self, level: usize) -> [usize; D] {
        let side = |k: usize| self.upper[k] - self.lower[k];
        let shortest = (0..D).map(side).fold(f64::INFINITY, f64::min);
        array_of(|k| (side(k) / shortest * level as f64).round() as usize)
    }
}

/// The permutations of the axes in each dimension. Each is a path along edges from the lowest to the highest corner of a
/// box, and the corners of the path are the vertices of one simplex.
const PATHS: [&[[usize; 3]]; 3] = [
    &[[0, 0, 0]],
    &[[0, 1, 0], [1, 0, 0]],
    &[[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]],
];

impl<const D: usize> Mesh<D> {
    /// A box cut into `counts[k]` small boxes along axis `k`, each cut into `D!` simplices around
    /// its diagonal from the lowest to the highest corner (Kuhn).
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` for a count of zero, a box without volume or halves of an odd number of
    /// small boxes, `MeshErrorKind::TooLarge`.
    pub fn kuhn_box(domain: &BoxDomain<D>, counts: [usize; D]) -> Result<Self, MeshError> {
        if counts.contains(&0) {
            let (value, allowed) = (format!("{counts:?}"), "at least one along each axis");
            return Err(MeshError::parameter("subdivisions", value, allowed));
        }
        if domain.halves.is_some() && counts[0] % 2 == 1 {
            let allowed = "even along the first axis, whose halves are regions";
            return Err(MeshError::parameter("subdivisions", counts[0], allowed));
        }
        for k in 0..D {
            let side = domain.upper[k] - domain.lower[k];
            if !(side > 0.0 && side.is_finite()) {
                return Err(MeshError::parameter("side of the box", side, "positive and finite"));
            }
        }
        let paths = PATHS[D - 1];
        let product = |add: usize| {
            counts.iter().try_fold(1_usize, |n, &c| n.checked_mul(c.checked_add(add)?))
        };
        let n_boxes = product(0).and_then(|n| n.checked_mul(paths.len())).unwrap_or(usize::MAX);
        let n_vertices = product(1).unwrap_or(usize::MAX);
        check_size(n_boxes, n_vertices)?;

        let mut strides = [1; D];
        for k in 1..D {
            strides[k] = strides[k - 1] * (counts[k - 1] + 1);
        }
        let coordinate = |k: usize, i: usize| {
            let t = i as f64 / counts[k] as f64;
            domain.lower[k] * (1.0 - t) + domain.upper[k] * t
        };
        let vertices = (0..n_vertices)
            .map(|v| Point::from_fn(|k, _| coordinate(k, v / strides[k] % (counts[k] + 1))))
            .collect();
        let (cells, boundary) = cells_and_boundary(domain, counts, strides, paths);
        let is_supported = boundary.iter().any(|f| f.condition == BoundaryCondition::Dirichlet);
        let side = |k: usize| BoundaryGroup {
            names: vec![SIDES[k].to_owned()],
            condition: Some(domain.sides[k / 2][k % 2]),
        };
        let sides = (0..2 * D).map(side).collect();
        let (regions, cell_regions) = match domain.halves {
            None => (vec![Vec::new()], Vec::new()),
            Some(names) => {
                let n_cells = cells.len() / (D + 1);
                let half =
                    |cell: usize| u16::from(2 * (cell / paths.len() % counts[0]) >= counts[0]);
                (names.map(|name| vec![name.to_owned()]).to_vec(), (0..n_cells).map(half).collect())
            }
        };
        let groups = Arc::new(Groups { regions, boundary: sides, inside: Vec::new() });
        let mesh = Self { cell_regions, ..Self::without_boundary(vertices, cells) };
        Ok(Self { boundary, is_supported, groups, ..mesh })
    }
}

fn cells_and_boundary<const D: usize>(
    domain: &BoxDomain<D>,
    counts: [usize; D],
    strides: [usize; D],
    paths: &[[usize; 3]],
) -> (Vec<u32>, Vec<BoundaryFacet>) {
    let n_boxes: usize = counts.iter().product();
    let mut cells = Vec::with_capacity(n_boxes * paths.len() * (D + 1));
    let mut boundary = Vec::new();
    let mut index = [0; D];
    for _ in 0..n_boxes {
        let lowest: usize = (0..D).map(|k| index[k] * strides[k]).sum();
        for path in paths {
            let cell = (cells.len() / (D + 1)) as u32;
            let mut vertex = lowest;
            cells.push(vertex as u32);
            for &axis in &path[..D] {
                vertex += strides[axis];
                cells.push(vertex as u32);
            }
            // all vertices but the first are on the upper side of the first axis of the path,
            // all but the last on the lower side of the last axis
            let (first, last) = (path[0], path[D - 1]);
            let facet = |local: usize, axis: usize, end: usize| BoundaryFacet {
                cell,
                local: local as u8,
                condition: domain.sides[axis][end],
                group: (2 * axis + end) as u16,
            };
            if index[first] + 1 == counts[first] {
                boundary.push(facet(0, first, 1));
            }
            if index[last] == 0 {
                boundary.push(facet(D, last, 0));
            }
        }
        for k in 0..D {
            index[k] += 1;
            if index[k] < counts[k] {
                break;
            }
            index[k] = 0;
        }
    }
    (cells, boundary)
}
