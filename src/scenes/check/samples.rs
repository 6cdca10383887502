//! Sample points of a domain and its boundary.

use crate::mesh::{BoundaryCondition, BoxDomain, Domain};
use crate::real::Point;

/// Quasi-random points of a box: the additive recurrence `x_n = 1/2 + n theta mod 1`, where
/// `theta_k = 1/phi^k` and `phi` is the positive root of `phi^(D+1) = phi + 1`.
///
/// In one dimension this is the golden ratio; `1, theta_1, ..., theta_D` are independent over the
/// rationals, so the points fill the box evenly and never sit on mesh lines.
fn in_box<const D: usize>(domain: BoxDomain<D>) -> impl Iterator<Item = Point<D>> {
    // The map contracts by a factor of at most 1/(D + 1) at its fixed point.
    let phi = (0..60).fold(2.0_f64, |phi, _| (1.0 + phi).powf(1.0 / (D as f64 + 1.0)));
    (1_u32..).map(move |n| {
        Point::from_fn(|k, _| {
            let theta = phi.powi(-(k as i32 + 1));
            let t = (0.5 + f64::from(n) * theta).fract();
            domain.lower[k] + t * (domain.upper[k] - domain.lower[k])
        })
    })
}

/// The first quasi-random points that lie inside a domain.
pub(super) fn inside<const D: usize>(domain: &Domain<D>, samples: usize) -> Vec<Point<D>> {
    in_box(domain.bounding_box()).filter(|x| domain.depth(x) > 0.0).take(samples).collect()
}

/// Vertices of a uniform lattice of the box around a domain, those inside it and on its boundary,
/// and the origin if it is among them: points of symmetry and of dyadic fractions, where meshes put
/// vertices and scenes their tips.
pub(super) fn lattice<const D: usize>(domain: &Domain<D>) -> impl Iterator<Item = Point<D>> + '_ {
    let per_axis: usize = if D < 3 { 16 } else { 8 };
    let bounds = domain.bounding_box();
    (0..(per_axis + 1).pow(D as u32))
        .map(move |mut code| {
            Point::from_fn(|k, _| {
                let step = code % (per_axis + 1);
                code /= per_axis + 1;
                let t = step as f64 / per_axis as f64;
                (1.0 - t) * bounds.lower[k] + t * bounds.upper[k]
            })
        })
        .chain([Point::zeros()])
        .filter(|x| domain.depth(x) >= 0.0)
}

/// A point of the boundary.
pub(super) struct BoundaryPoint<const D: usize> {
    /// The point.
    pub x: Point<D>,
    /// The outward unit normal there.
    pub normal: Point<D>,
    /// The boundary condition.
    pub condition: BoundaryCondition,
}

impl<const D: usize> BoundaryPoint<D> {
    fn dirichlet(x: Point<D>, normal: Point<D>) -> Self {
        Self { x, normal, condition: BoundaryCondition::Dirichlet }
    }
}

/// Quasi-random points of the boundary: as many on each side, or twice as many on a circle.
pub(super) fn boundary<const D: usize>(
    domain: &Domain<D>,
    samples: usize,
) -> Vec<BoundaryPoint<D>> {
    let around = domain.bounding_box();
    match *domain {
        Domain::Box(ref domain) => on_sides(domain, samples).collect(),
        Domain::LShape { .. } => on_sides(&around, samples)
            .filter(|p| domain.depth(&p.x) >= 0.0)
            .chain(in_box(around.clone()).take(samples).map(beside_quadrant))
            .collect(),
        Domain::Disc { radius } => in_box(around)
            .take(2 * samples)
            .map(|x| BoundaryPoint::dirichlet(x.normalize() * radius, x.normalize()))
            .collect(),
        Domain::Mesh(_) => unreachable!("{NO_MESH}"),
    }
}

/// Why a domain has no samples.
const NO_MESH: &str = "a domain that is a mesh is tested at its barycentres";

/// Points projected onto every side of a box.
fn on_sides<const D: usize>(
    domain: &BoxDomain<D>,
    samples: usize,
) -> impl Iterator<Item = BoundaryPoint<D>> + '_ {
    (0..D).flat_map(|axis| [(axis, 0, -1.0), (axis, 1, 1.0)]).flat_map(move |(axis, end, sign)| {
        let level = if end == 0 { domain.lower[axis] } else { domain.upper[axis] };
        in_box(domain.clone()).take(samples).map(move |mut x| {
            x[axis] = level;
            let normal = Point::from_fn(|k, _| if k == axis { sign } else { 0.0 });
            BoundaryPoint { x, normal, condition: domain.sides[axis][end] }
        })
    })
}

/// A point on the sides that meet in the corner at the origin of the domain without the quadrant
/// `x >= 0`, `y <= 0`.
fn beside_quadrant<const D: usize>(x: Point<D>) -> BoundaryPoint<D> {
    let on = |along: usize, at: f64, across: usize, normal: f64| {
        let axis =
            |axis: usize, size: f64| Point::from_fn(|k, _| if k == axis { size } else { 0.0 });
        BoundaryPoint::dirichlet(axis(along, at), axis(across, normal))
    };
    if x[0] > 0.0 { on(0, x[0], 1, -1.0) } else { on(1, x[0], 0, 1.0) }
}
