//! Vectors along the edges of a simplex: cofactors, products, lengths.

use crate::arrays::array_of;
use crate::real::Point;

/// The factorial of each dimension.
pub(crate) const FACTORIAL: [f64; 4] = [1.0, 1.0, 2.0, 6.0];

/// The gradients of the barycentric coordinates 1 to `D` of a simplex times the determinant of the edges from corner 0
/// to the others, and the determinant.
#[inline(always)]
pub(crate) fn cofactors<const D: usize>([a, b, c]: [[f64; 3]; 3]) -> ([[f64; 3]; 3], f64) {
    let normals = match D {
        1 => [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
        2 => [[b[1], -b[0], 0.0], [-a[1], a[0], 0.0], [0.0; 3]],
        _ => [cross(b, c), cross(c, a), cross(a, b)],
    };
    (normals, dot::<D>(a, normals[0]))
}

/// The scalar product of the first `D` coordinates.
#[inline(always)]
pub(crate) fn dot<const D: usize>(a: [f64; 3], b: [f64; 3]) -> f64 {
    (1..D).fold(a[0] * b[0], |sum, k| sum + a[k] * b[k])
}

/// The vector product.
#[inline(always)]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The coordinates of a vector, with zeros after them.
#[inline(always)]
pub(crate) fn with_zeros<const D: usize>(vector: Point<D>) -> [f64; 3] {
    array_of(|axis| if axis < D { vector[axis] } else { 0.0 })
}

/// A fold over the squares of the lengths of the edges of a simplex, without those at one of its corners.
#[inline(always)]
pub(in crate::mesh) fn fold_edges<const D: usize>(
    corner: impl Fn(usize) -> Point<D>,
    left_out: Option<usize>,
    start: f64,
    choose: impl Fn(f64, f64) -> f64,
) -> f64 {
    let mut chosen = start;
    for i in 0..=D {
        for j in 0..i {
            if left_out != Some(i) && left_out != Some(j) {
                chosen = choose((corner(i) - corner(j)).norm_squared(), chosen);
            }
        }
    }
    chosen
}

/// The length of the longest edge of a simplex, without those at one of its corners.
#[inline(always)]
pub(in crate::mesh) fn longest_edge<const D: usize>(
    corner: impl Fn(usize) -> Point<D>,
    left_out: Option<usize>,
) -> f64 {
    fold_edges(corner, left_out, 0.0, |a, b| if a > b { a } else { b }).sqrt()
}
