//! Integrals over simplices that the zero set of a function cuts.
//!
//! A cut simplex is bisected a few times, so that a zero set that meets an edge twice is seen. A second rule leaves out
//! bisections of pieces on which the function is nearly linear. Each piece that is still cut is divided at the zeros on
//! its edges. The facets between the zeros replace the zero set, which is exact for planes. What lies between these
//! facets and a curved zero set changes sides by a rule on the facets: along a direction across a facet, the distance
//! to the zero set times the difference of the integrand there. On a sphere that leaves a wrong volume whose mean
//! thickness is 1e-5 to 1e-3 of `h^2`.

use crate::arrays::{array_of, map_entries};
use crate::mesh::Mesh;
use crate::problem::Field;
use crate::quadrature::{FullySymmetric, Quadrature, Rule, facet_to_cell, vertex_point};
use crate::real::Point;

/// What is called with a point of a rule on a cut cell: in barycentric coordinates, in space, and with
/// its weight.
pub(crate) type Visit<'v, const D: usize> = &'v mut dyn FnMut(&[f64; 4], &Point<D>, f64);

/// A piece of a simplex, by barycentric coordinates in it.
#[derive(Clone, Copy, Debug)]
struct Piece {
    corners: [[f64; 4]; 4],
    /// Share of the measure of the whole simplex.
    share: f64,
    bisections: usize,
}

/// How often a simplex is bisected, by dimension: a zero set that meets a segment twice is seen if
/// the two points lie further apart than the pieces are wide.
const BISECTIONS: [usize; 4] = [0, 3, 4, 3];

/// A function counts as linear on a piece if its values at the middles of edges differ from the means of those at the
/// ends by at most this share of the differences between corners, by dimension. Bisections divide the deviation of the
/// zero set from a plane by four in space, and by sixteen in the plane, where they cost less.
const NEARLY_LINEAR: [f64; 4] = [0.0, 0.0, 0.01, 0.03];

/// Steps after which the search for a zero on a segment ends.
const MOST_STEPS: usize = 100;

/// The largest degree of the rule on pieces. The square of an error of linears has a leading term of degree four.
const MOST_IN_PARTS: usize = 5;

/// The share of the way across a piece by which the two sides of the zero set are told apart.
const BESIDE: f64 = 1e-7;

/// A quadrature rule on simplices of one dimension that the zero set of a function may cut.
pub(crate) struct CutRule {
    dimension: usize,
    whole: Rule,
    piece: Rule,
    /// The rule on facets between zeros.
    facet: Rule,
    /// Whether pieces are bisected also where their zero set is nearly plane.
    bisects_always: bool,
}

impl CutRule {
    /// A rule of this degree; on the pieces of a cut simplex of degree five if that is less.
    pub fn new(dimension: usize, degree: usize) -> Self {
        let in_pieces = degree.min(MOST_IN_PARTS);
        let [whole, piece] = [degree, in_pieces].map(|degree| rule(dimension, degree));
        let facet = rule(dimension.saturating_sub(1), in_pieces);
        Self { dimension, whole, piece, facet, bisects_always: true }
    }

    /// The rule without bisection of pieces on which the function is nearly linear, for integrands that are smooth on
    /// both sides of the zero set. The rule has a tenth of the points.
    #[must_use]
    pub fn without_needless_bisections(self) -> Self {
        // on the line bisections cost little
        Self { bisects_always: self.dimension == 1, ..self }
    }

    /// Whether the zero set of a function cuts a cell, as far as [`CutRule::visit_if_cut`] sees.
    pub fn cuts<const D: usize>(&self, mesh: &Mesh<D>, cell: usize, level: &Field<D>) -> bool {
        self.is_cut(&self.whole(), &mesh.corners(cell), level)
    }

    /// Visits the points of the rule on a cell if it is cut, and returns whether it is: in barycentric
    /// coordinates, in space, and with their weights.
    pub fn visit_if_cut<const D: usize>(
        &self,
        mesh: &Mesh<D>,
        cell: usize,
        level: &Field<D>,
        visit: Visit<'_, D>,
    ) -> bool {
        let corners = mesh.corners(cell);
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
        corners: &[Point<D>; 4],
        level: &Field<D>,
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        self.visit_piece(&self.whole(), corners, level, visit);
    }

    /// Whether the function is positive on a simplex, as far as its values at corners, middles of edges and barycentre
    /// tell; `None` if its zero set cuts the simplex.
    pub fn sign_of_uncut<const D: usize>(
        &self,
        corners: &[Point<D>; 4],
        level: &Field<D>,
    ) -> Option<bool> {
        let is_cut = self.is_cut(&self.whole(), corners, level);
        (!is_cut).then(|| level(&corners[0]) > 0.0)
    }

    /// Calls `visit` with the points of the rule on a simplex that is not cut, and with their weights.
    pub fn visit_whole(&self, visit: &mut dyn FnMut(&[f64; 4], f64)) {
        self.whole.iter().for_each(|(point, weight)| visit(point, weight));
    }

    fn whole(&self) -> Piece {
        Piece { corners: array_of(vertex_point), share: 1.0, bisections: 0 }
    }

    fn visit_uncut(&self, piece: &Piece, visit: &mut dyn FnMut(&[f64; 4], f64)) {
        let rule = if piece.share == 1.0 { &self.whole } else { &self.piece };
        rule.iter().for_each(|(point, weight)| visit(&piece.point(point), weight * piece.share));
    }

    fn visit_piece<const D: usize>(
        &self,
        piece: &Piece,
        corners: &[Point<D>; 4],
        level: &Field<D>,
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        if !self.is_cut(piece, corners, level) {
            self.visit_uncut(piece, visit);
        } else if piece.bisections < BISECTIONS[self.dimension]
            && (self.bisects_always || !self.is_nearly_linear(piece, corners, level))
        {
            for half in self.halves(piece, corners) {
                self.visit_piece(&half, corners, level, visit);
            }
        } else {
            let sign = |c: &[f64; 4]| if level(&in_space(c, corners)) > 0.0 { 1 } else { -1 };
            self.divide(piece, piece.corners.map(|c| sign(&c)), corners, level, visit);
        }
    }

    /// Whether the sign of the function differs between corners, middles of edges and barycentre of a
    /// piece: a change of sign between these points is not detected.
    fn is_cut<const D: usize>(
        &self,
        piece: &Piece,
        corners: &[Point<D>; 4],
        level: &Field<D>,
    ) -> bool {
        let is_positive = |b: &[f64; 4]| level(&in_space(b, corners)) > 0.0;
        let mut middle = [0.0; 4];
        middle[..=self.dimension].fill(1.0 / (self.dimension + 1) as f64);
        let at_middle = is_positive(&piece.point(&middle));
        let differs = |b: &[f64; 4]| is_positive(b) != at_middle;
        let own = &piece.corners[..=self.dimension];
        own.iter().any(differs)
            || own
                .iter()
                .enumerate()
                .any(|(i, p)| own[..i].iter().any(|q| differs(&between(p, q, 0.5))))
    }

    /// Whether the function is linear on a piece but for [`NEARLY_LINEAR`], as far as its values at corners and middles
    /// of edges tell. Its zero set is then nearly plane.
    fn is_nearly_linear<const D: usize>(
        &self,
        piece: &Piece,
        corners: &[Point<D>; 4],
        level: &Field<D>,
    ) -> bool {
        let own = &piece.corners[..=self.dimension];
        let at = |b: &[f64; 4]| level(&in_space(b, corners));
        let values = piece.corners.map(|c| at(&c));
        let values = &values[..=self.dimension];
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (0..own.len()).all(|i| {
            (0..i).all(|j| {
                let at_middle = at(&between(&own[i], &own[j], 0.5));
                let deviation = (at_middle - 0.5 * (values[i] + values[j])).abs();
                deviation <= NEARLY_LINEAR[self.dimension] * (most - least)
            })
        })
    }

    /// The two halves on both sides of the middle of the longest edge.
    fn halves<const D: usize>(&self, piece: &Piece, corners: &[Point<D>; 4]) -> [Piece; 2] {
        let points = piece.corners.map(|c| in_space(&c, corners));
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
        let middle = between(&piece.corners[i], &piece.corners[j], 0.5);
        map_entries([i, j], |replaced| {
            let mut half = Piece { share: 0.5 * piece.share, ..*piece };
            half.bisections += 1;
            half.corners[replaced] = middle;
            half
        })
    }

    /// The rule on the pieces into which the zeros of the function on the edges of `piece` divide `piece`.
    /// `signs` are the signs of the function at the corners of `piece`, zero at corners that are zeros.
    fn divide<const D: usize>(
        &self,
        piece: &Piece,
        signs: [i8; 4],
        corners: &[Point<D>; 4],
        level: &Field<D>,
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        let own = &signs[..=self.dimension];
        let of_sign = |sign| own.iter().position(|s| *s == sign);
        let (positive, negative) = (of_sign(1), of_sign(-1));
        let (Some(i), Some(j)) = (positive, negative) else {
            let Some(apex) = positive.or(negative) else { return };
            let corner = piece.corners[apex];
            // a point beyond a curved zero set moves back to the side of its piece
            self.visit_uncut(piece, &mut |point, weight| {
                let to = |r: f64| between(point, &corner, r);
                let at = |r: f64| level(&in_space(&to(r), corners));
                let is_beyond = (at(0.0) > 0.0) != positive.is_some();
                let zero = if is_beyond { zero_between(at) } else { None };
                visit(&zero.map_or(*point, |r| to(r + BESIDE)), weight);
            });
            let zeros = own.iter().filter(|s| **s == 0).count();
            if positive.is_some() && zeros == self.dimension {
                self.correct(piece, apex, corners, level, visit);
            }
            return;
        };
        let (from, to) = (piece.corners[j], piece.corners[i]);
        let r = zero_between(|r| level(&in_space(&between(&from, &to, r), corners)));
        let r = r.unwrap_or(0.5);
        for (replaced, share) in [(i, r), (j, 1.0 - r)] {
            let mut divided = Piece { share: share * piece.share, ..*piece };
            let mut signs = signs;
            divided.corners[replaced] = between(&from, &to, r);
            signs[replaced] = 0;
            self.divide(&divided, signs, corners, level, visit);
        }
    }

    /// Assigns the region between the facet opposite the corner `apex` and the zero set to the side of the
    /// zero set on which the region lies: by pairs of points on both sides, with the distance from the
    /// facet to the zero set as the weight of one point and its negative as that of the other.
    fn correct<const D: usize>(
        &self,
        piece: &Piece,
        apex: usize,
        corners: &[Point<D>; 4],
        level: &Field<D>,
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        if self.dimension < 2 {
            return;
        }
        for (point, weight) in self.facet.iter() {
            let on_facet = piece.point(&facet_to_cell(point, apex));
            // twice as far on the side of the corner and beyond
            let end = |r: f64| between(&on_facet, &piece.corners[apex], r);
            let along = |r: f64| level(&in_space(&end(2.0 * r - 1.0), corners));
            let Some(zero) = zero_between(along) else { continue };
            let distance = 2.0 * zero - 1.0;
            // a facet moved by the whole way to the corner sweeps D times the piece
            let weight = weight * distance * self.dimension as f64 * piece.share;
            visit(&end(distance - BESIDE), weight);
            visit(&end(distance + BESIDE), -weight);
        }
    }
}

impl Piece {
    /// A point of the piece, or of one of its faces, in barycentric coordinates of the whole.
    fn point(&self, barycentric: &[f64; 4]) -> [f64; 4] {
        array_of(|k| (0..4).map(|i| barycentric[i] * self.corners[i][k]).sum())
    }
}

/// The point `(1 - r) p + r q`.
fn between(p: &[f64; 4], q: &[f64; 4], r: f64) -> [f64; 4] {
    array_of(|k| (1.0 - r) * p[k] + r * q[k])
}

/// The rule with fewest points of this degree.
fn rule(dimension: usize, degree: usize) -> Rule {
    FullySymmetric.rule(dimension, degree).unwrap_or_else(|_| Rule::new(dimension, degree))
}

/// A point of `(0, 1)` where a function changes its sign, to rounding, from whichever side; none if its sign is
/// the same at both ends. By inverse quadratic interpolation where the last three points admit it, else by
/// bisection, so that it ends at a jump too: T. R. Chandrupatla, Adv. Eng. Softw. 28 (1997), 145-149.
fn zero_between(function: impl Fn(f64) -> f64) -> Option<f64> {
    // `a` is the last point, `b` the last one on the other side of the zero
    let ([mut a, mut b], [mut at_a, mut at_b]) = ([1.0, 0.0], [function(1.0), function(0.0)]);
    if (at_a > 0.0) == (at_b > 0.0) {
        return None;
    }
    let mut share = 0.5;
    for _ in 0..MOST_STEPS {
        let x = a + share * (b - a);
        let at_x = function(x);
        // `c` is the point that `x` makes idle
        let (mut c, mut at_c) = (a, at_a);
        if (at_x > 0.0) != (at_a > 0.0) {
            std::mem::swap(&mut b, &mut c);
            std::mem::swap(&mut at_b, &mut at_c);
        }
        (a, at_a) = (x, at_x);
        let (nearest, at_nearest) = if at_a.abs() < at_b.abs() { (a, at_a) } else { (b, at_b) };
        let least = f64::EPSILON * (1.0 + 2.0 * nearest) / (b - a).abs();
        if at_nearest == 0.0 || least > 0.5 {
            return Some(nearest);
        }
        let (position, height) = ((a - b) / (c - b), (at_a - at_b) / (at_c - at_b));
        let is_monotone =
            height * height < position && (1.0 - height) * (1.0 - height) < 1.0 - position;
        share = if is_monotone {
            let of_b = at_a / (at_b - at_a) * at_c / (at_b - at_c);
            let of_c = at_a / (at_c - at_a) * at_b / (at_c - at_b);
            of_b + (c - a) / (b - a) * of_c
        } else {
            0.5
        };
        share = share.clamp(least, 1.0 - least);
    }
    Some(a)
}

/// The point with these barycentric coordinates in a simplex with these corners; corners beyond its
/// dimension have coordinate zero.
pub(crate) fn in_space<const D: usize>(
    barycentric: &[f64; 4],
    corners: &[Point<D>; 4],
) -> Point<D> {
    corners.iter().zip(barycentric).fold(Point::zeros(), |x, (corner, &b)| x + corner * b)
}
