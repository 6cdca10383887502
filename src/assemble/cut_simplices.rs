//! Integrals over simplices that the zero set of a function cuts.
//!
//! A cut simplex is bisected a few times. In each part that is still cut, the vertices where the
//! function is positive span one face and the others the opposite face: the part is the union of
//! the segments between points of the two, and a rule along each segment is divided at the zero.
//! The zero set is not replaced by a polygon: where it is smooth, the rule keeps its order.

use crate::mesh::Mesh;
use crate::problem::Field;
use crate::quadrature::Rule;
use crate::real::{Point, Real, point_f64};

/// What is called with a point of a rule on a cut cell: in barycentric coordinates, in space, and with
/// its weight.
pub(crate) type Visit<'v, const D: usize> = &'v mut dyn FnMut(&[f64; 4], &Point<f64, D>, f64);

/// A part of a simplex, by barycentric coordinates in it.
#[derive(Clone, Copy, Debug)]
struct Part {
    corners: [[f64; 4]; 4],
    /// Share of the measure of the whole simplex.
    share: f64,
    bisections: usize,
}

/// How often a simplex is bisected, by dimension: a zero set that meets a segment twice is seen if
/// the two points lie further apart than the parts are wide.
const BISECTIONS: [usize; 4] = [0, 3, 4, 3];

/// Steps after which the search for a zero on a segment ends.
const MOST_STEPS: usize = 100;

/// A quadrature rule on simplices of one dimension that the zero set of a function may cut.
pub(crate) struct CutRule {
    dimension: usize,
    /// By dimension, the rule on a face; the last one serves parts that are not cut.
    faces: Vec<Rule>,
    /// The rule along segments.
    segment: Rule,
}

impl CutRule {
    /// A rule that integrates polynomials up to a degree on parts bounded by planes.
    pub fn new(dimension: usize, degree: usize) -> Self {
        let faces = (0..=dimension).map(|d| Rule::new(d, degree)).collect();
        Self { dimension, faces, segment: Rule::new(1, degree + dimension.saturating_sub(1)) }
    }

    /// Visits the points of the rule on a cell if it is cut, and tells whether it is: in barycentric
    /// coordinates, in space, and with their weights.
    pub fn visit_if_cut<T: Real, const D: usize>(
        &self,
        mesh: &Mesh<T, D>,
        cell: usize,
        level: &Field<D>,
        visit: Visit<'_, D>,
    ) -> bool {
        let mut corners = [Point::zeros(); 4];
        for (corner, &v) in corners.iter_mut().zip(mesh.cell(cell)) {
            *corner = point_f64(&mesh.vertices()[v as usize]);
        }
        let is_cut = self.is_cut(&self.whole(), &corners, level);
        if is_cut {
            self.visit(&corners, level, &mut |point, weight| {
                visit(point, &in_space(point, &corners), weight);
            });
        }
        is_cut
    }

    /// Calls `visit` with the points of the rule on a simplex, in barycentric coordinates, and with their
    /// weights, whose sum is one. No point lies on the zero set but for rounding.
    pub fn visit<const D: usize>(
        &self,
        corners: &[Point<f64, D>; 4],
        level: &Field<D>,
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        self.visit_part(&self.whole(), corners, level, visit);
    }

    /// The same on a simplex that is not cut.
    pub fn visit_whole(&self, visit: &mut dyn FnMut(&[f64; 4], f64)) {
        self.faces[self.dimension].iter().for_each(|(point, weight)| visit(point, weight));
    }

    fn whole(&self) -> Part {
        let corners = std::array::from_fn(|i| std::array::from_fn(|k| f64::from(u8::from(i == k))));
        Part { corners, share: 1.0, bisections: 0 }
    }

    fn visit_uncut(&self, part: &Part, visit: &mut dyn FnMut(&[f64; 4], f64)) {
        self.visit_whole(&mut |point, weight| visit(&part.point(point), weight * part.share));
    }

    fn visit_part<const D: usize>(
        &self,
        part: &Part,
        corners: &[Point<f64, D>; 4],
        level: &Field<D>,
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        if !self.is_cut(part, corners, level) {
            self.visit_uncut(part, visit);
        } else if part.bisections < BISECTIONS[self.dimension] {
            for half in self.halves(part, corners) {
                self.visit_part(&half, corners, level, visit);
            }
        } else {
            self.visit_segments(part, corners, level, visit);
        }
    }

    /// Whether the sign of the function differs between the corners and the barycentre of a part: a
    /// change of sign between these points is not detected.
    fn is_cut<const D: usize>(
        &self,
        part: &Part,
        corners: &[Point<f64, D>; 4],
        level: &Field<D>,
    ) -> bool {
        let is_positive = |b: &[f64; 4]| level(&in_space(b, corners)) > 0.0;
        let mut middle = [0.0; 4];
        middle[..=self.dimension].fill(1.0 / (self.dimension + 1) as f64);
        let at_middle = is_positive(&part.point(&middle));
        part.corners[..=self.dimension].iter().any(|c| is_positive(c) != at_middle)
    }

    /// The two halves on both sides of the middle of the longest edge.
    fn halves<const D: usize>(&self, part: &Part, corners: &[Point<f64, D>; 4]) -> [Part; 2] {
        let points = part.corners.map(|c| in_space(&c, corners));
        let mut longest = (0, 0, -1.0);
        for i in 0..=self.dimension {
            for j in 0..i {
                let length = (points[i] - points[j]).norm_squared();
                if length > longest.2 {
                    longest = (i, j, length);
                }
            }
        }
        let (i, j, _) = longest;
        let middle = between(&part.corners[i], &part.corners[j], 0.5);
        [i, j].map(|replaced| {
            let mut half = Part { share: 0.5 * part.share, ..*part };
            half.bisections += 1;
            half.corners[replaced] = middle;
            half
        })
    }

    /// The rule on the segments between the face where the function is not positive and the face
    /// where it is. With these faces of dimension `a` and `b` the measure is
    /// `D!/(a! b!) (1 - r)^a r^b dr` along a segment, times the uniform measures of the faces.
    fn visit_segments<const D: usize>(
        &self,
        part: &Part,
        corners: &[Point<f64, D>; 4],
        level: &Field<D>,
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        let mut faces = [[[0.0; 4]; 4]; 2];
        let mut sizes = [0; 2];
        for corner in &part.corners[..=self.dimension] {
            let side = usize::from(level(&in_space(corner, corners)) > 0.0);
            faces[side][sizes[side]] = *corner;
            sizes[side] += 1;
        }
        let [from, to] = faces.map(|corners| Part { corners, ..*part });
        // corners of one sign around a barycentre of the other
        if sizes.contains(&0) {
            self.visit_uncut(part, visit);
            return;
        }
        let [a, b] = sizes.map(|size| size - 1);
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        let scale = part.share * factorial(self.dimension) / (factorial(a) * factorial(b));
        for (p, p_weight) in self.faces[a].iter() {
            for (q, q_weight) in self.faces[b].iter() {
                let (p, q) = (from.point(p), to.point(q));
                let zero = zero_between(|r| level(&in_space(&between(&p, &q, r), corners)));
                let pieces = [(0.0, zero.unwrap_or(1.0)), (zero.unwrap_or(1.0), 1.0)];
                for (start, end) in pieces.into_iter().filter(|(start, end)| end > start) {
                    for (t, weight) in self.segment.iter() {
                        let r = start + (end - start) * t[1];
                        let density = (1.0 - r).powi(a as i32) * r.powi(b as i32);
                        let weight = weight * (end - start) * density * scale;
                        visit(&between(&p, &q, r), weight * p_weight * q_weight);
                    }
                }
            }
        }
    }
}

impl Part {
    /// A point of the part, or of one of its faces, in barycentric coordinates of the whole.
    fn point(&self, barycentric: &[f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| (0..4).map(|i| barycentric[i] * self.corners[i][k]).sum())
    }
}

/// The point `(1 - r) p + r q`.
fn between(p: &[f64; 4], q: &[f64; 4], r: f64) -> [f64; 4] {
    std::array::from_fn(|k| (1.0 - r) * p[k] + r * q[k])
}

/// A point of `(0, 1)` where a function changes its sign, to rounding; none if its sign is the same
/// at both ends. By the Illinois variant of false position, M. Dowell, P. Jarratt, BIT 11 (1971),
/// 168-174, which also ends at a jump.
fn zero_between(function: impl Fn(f64) -> f64) -> Option<f64> {
    let ([mut a, mut b], [mut at_a, mut at_b]) = ([0.0, 1.0], [function(0.0), function(1.0)]);
    if (at_a > 0.0) == (at_b > 0.0) {
        return None;
    }
    let mut replaced_last = None;
    for step in 0..MOST_STEPS {
        if b - a <= 2.0 * f64::EPSILON {
            break;
        }
        // every third step halves: a zero of high order would be approached slowly
        let secant = (a * at_b - b * at_a) / (at_b - at_a);
        let x = if step % 3 < 2 && a < secant && secant < b { secant } else { 0.5 * (a + b) };
        let at_x = function(x);
        let replaces_b = (at_x > 0.0) == (at_b > 0.0);
        let is_repeated = replaced_last.replace(replaces_b) == Some(replaces_b);
        let kept = if is_repeated { 0.5 } else { 1.0 };
        if replaces_b {
            (b, at_b, at_a) = (x, at_x, kept * at_a);
        } else {
            (a, at_a, at_b) = (x, at_x, kept * at_b);
        }
    }
    Some(0.5 * (a + b))
}

/// The point with these barycentric coordinates in a simplex with these corners; corners beyond its
/// dimension have coordinate zero.
pub(crate) fn in_space<const D: usize>(
    barycentric: &[f64; 4],
    corners: &[Point<f64, D>; 4],
) -> Point<f64, D> {
    corners.iter().zip(barycentric).fold(Point::zeros(), |x, (corner, &b)| x + corner * b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;
    use std::sync::Arc;

    /// The unit simplex.
    fn corners<const D: usize>() -> [Point<f64, D>; 4] {
        let mut corners = [Point::<f64, D>::zeros(); 4];
        (0..D).for_each(|k| corners[k + 1][k] = 1.0);
        corners
    }

    /// The mean over the unit simplex of a function where the level is positive, zero elsewhere.
    fn mean<const D: usize>(
        degree: usize,
        level: &Field<D>,
        value: impl Fn(&Point<f64, D>) -> f64,
    ) -> f64 {
        let [mut all, mut within] = [0.0; 2];
        CutRule::new(D, degree).visit(&corners(), level, &mut |point, weight| {
            let x = in_space(point, &corners());
            all += weight;
            within += if level(&x) > 0.0 { weight * value(&x) } else { 0.0 };
        });
        assert!((all - 1.0_f64).abs() < 1e-13, "the weights sum to one");
        within
    }

    #[test]
    fn a_sphere_is_resolved() {
        fn share<const D: usize>() -> f64 {
            mean::<D>(5, &(Arc::new(|x: &Point<f64, D>| 0.5 - x.norm()) as Field<D>), |_| 1.0)
        }
        assert!((share::<1>() - 0.5).abs() < 1e-15);
        assert!((share::<2>() - PI / 8.0).abs() < 1e-7, "{:e}", share::<2>() - PI / 8.0);
        assert!((share::<3>() - PI / 8.0).abs() < 1e-5, "{:e}", share::<3>() - PI / 8.0);
    }

    #[test]
    fn polynomials_between_planes_are_exact() {
        fn cubed<const D: usize>() -> f64 {
            let level: Field<D> = Arc::new(|x| x[0] - 0.3);
            mean::<D>(3, &level, |x| (x[0] - 0.3).powi(3))
        }
        // int_0.3^1 (x - 0.3)^3 D (1 - x)^(D - 1)
        let exact = |d: usize| {
            let beta = [0.0, 1.0 / 4.0, 1.0 / 20.0, 1.0 / 60.0][d];
            d as f64 * beta * 0.7_f64.powi(3 + d as i32)
        };
        assert!((cubed::<1>() - exact(1)).abs() < 1e-14);
        assert!((cubed::<2>() - exact(2)).abs() < 1e-14);
        assert!((cubed::<3>() - exact(3)).abs() < 1e-14);
    }

    #[test]
    fn zeros_are_found_at_jumps_too_and_in_pairs() {
        let jump: Field<1> = Arc::new(|x| if x[0] < 0.123 { -1.0 } else { 1.0 });
        assert!((mean(1, &jump, |_| 1.0) - 0.877).abs() < 1e-14);
        let flat: Field<1> = Arc::new(|x| (x[0] - 0.3).powi(5));
        assert!((mean(1, &flat, |_| 1.0) - 0.7).abs() < 1e-14);
        let pair: Field<1> = Arc::new(|x| (x[0] - 0.6) * (x[0] - 0.3));
        assert!((mean(1, &pair, |_| 1.0) - 0.7).abs() < 1e-14);
    }
}
