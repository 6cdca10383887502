//! Functions that are zero on boundary groups, and points where they are.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use crate::real::Point;

/// A function that is zero on a curve in the plane or on a surface in space, where its gradient is not.
pub(crate) type Shape<const D: usize> = Arc<dyn Fn(&Point<D>) -> f64 + Send + Sync>;

/// Most steps of Newton's method.
const STEPS: usize = 32;
/// The last step is below this share of a length; what it leaves is of the order of the square.
const LAST_STEP: f64 = 1e-8;
/// The step of central differences, as a share of a length: the cube root of rounding.
const DIFFERENCE: f64 = 6e-6;
/// The sine of the angle below which two zeros count as tangential.
const TANGENTIAL: f64 = 1e-6;

/// The shapes of the boundary groups of a mesh.
#[derive(Clone, Default)]
pub(in crate::mesh) struct Shapes<const D: usize> {
    /// By the names of groups.
    pub named: Vec<(String, Shape<D>)>,
    /// On a part in space the edges, by ascending vertices, in facets of cells that the part does not have, with the
    /// groups of these facets.
    pub cut_edges: BTreeSet<([u32; 2], u16)>,
}

impl<const D: usize> fmt::Debug for Shapes<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.named.iter().map(|(name, _)| name)).finish()
    }
}

impl<const D: usize> Shapes<D> {
    /// The shapes of a mesh whose vertices have these numbers; `u32::MAX` for vertices that it does not have.
    pub fn renumbered(&self, numbers: &[u32]) -> Self {
        let edge = |&(edge, group): &([u32; 2], u16)| (edge.map(|v| numbers[v as usize]), group);
        let edges = self.cut_edges.iter().map(edge).filter(|(edge, _)| !edge.contains(&u32::MAX));
        let cut_edges = edges.map(|([a, b], group)| (ascending(a, b), group)).collect();
        Self { named: self.named.clone(), cut_edges }
    }
    /// The shapes of a group with these names.
    pub fn of<'s>(&'s self, names: &'s [String]) -> impl Iterator<Item = &'s Shape<D>> {
        self.named.iter().filter(|(name, _)| names.contains(name)).map(|(_, shape)| shape)
    }
}

pub(super) fn ascending(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The common zero of shapes near a point, by Newton's method with steps of a length: from one shape to the next along
/// the gradient, less its components along those of the shapes before.
pub(super) fn to_zero<const D: usize>(
    shapes: &[&Shape<D>],
    start: &Point<D>,
    length: f64,
) -> Option<Point<D>> {
    let mut x = *start;
    let last_step = LAST_STEP * above_rounding(length, start);
    for _ in 0..STEPS {
        let mut farthest = 0.0_f64;
        let mut before = [Point::<D>::zeros(); D];
        for (shape, k) in shapes.iter().zip(0..) {
            let (value, gradient) = (shape(&x), gradient(shape, &x, length));
            let distance = value.abs() / gradient.norm();
            if !distance.is_finite() {
                return None;
            }
            farthest = farthest.max(distance);
            let along = before.iter().fold(gradient, |g, n| g - n * n.dot(&g));
            if k < D && along.norm() > TANGENTIAL * gradient.norm() {
                before[k] = along.normalize();
                x -= along * (value / along.norm_squared());
            }
        }
        if farthest <= last_step {
            return Some(x);
        }
    }
    None
}

/// A length, or a thousandth of the coordinates of a point: differences over less see their rounding.
fn above_rounding<const D: usize>(length: f64, x: &Point<D>) -> f64 {
    length.max(1e-3 * x.amax())
}

/// The gradient of a shape, by central differences with steps for a length.
fn gradient<const D: usize>(shape: &Shape<D>, x: &Point<D>, length: f64) -> Point<D> {
    let step = DIFFERENCE * above_rounding(length, x);
    Point::from_fn(|k, _| {
        let [mut low, mut high] = [*x; 2];
        low[k] -= step;
        high[k] += step;
        (shape(&high) - shape(&low)) / (high[k] - low[k])
    })
}

/// The unit normal of the zero of a shape at a point, along the gradient.
pub(crate) fn normal_of<const D: usize>(shape: &Shape<D>, x: &Point<D>, length: f64) -> Point<D> {
    gradient(shape, x, length).normalize()
}
