//! Integrals over simplices that the zero sets of functions cut.
//!
//! A cut simplex is bisected a few times, so that a zero set that meets an edge twice is seen. Each piece that is still
//! cut is divided at the zeros on its edges, and planes between these zeros replace the zero set. Between planes the
//! rule is exact. A curved zero set leaves a layer between it and the planes, on a sphere of a mean thickness of about
//! 1/400 of `h^2` over the radius in the plane and 1/60 in space, `h` the shortest side of a cell.

use crate::arrays::{array_of, map_entries};
use crate::mesh::Mesh;
use crate::problem::Field;
use crate::quadrature::{FullySymmetric, Quadrature, Rule, vertex_point};
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

/// Steps after which the search for a zero on a segment ends.
const MOST_STEPS: usize = 60;

/// How far from the end of a segment of length one a function is asked whether it vanishes at the end only.
const BESIDE: f64 = 1.0 / (1 << 26) as f64;

/// The largest degree of the rule on pieces. The square of an error of linears has a leading term of degree four.
const MOST_IN_PIECES: usize = 5;

/// A quadrature rule on simplices of one dimension that the zero sets of functions may cut.
pub(crate) struct CutRule {
    dimension: usize,
    whole: Rule,
    piece: Rule,
}

impl CutRule {
    /// A rule of this degree; on the pieces of a cut simplex of degree five if that is less.
    pub fn new(dimension: usize, degree: usize) -> Self {
        let [whole, piece] =
            [degree, degree.min(MOST_IN_PIECES)].map(|degree| rule(dimension, degree));
        Self { dimension, whole, piece }
    }

    /// Visits the points of the rule on a cell if one of these functions cuts it, and returns whether it is: in
    /// barycentric coordinates, in space, and with their weights.
    pub fn visit_if_cut<const D: usize>(
        &self,
        mesh: &Mesh<D>,
        cell: usize,
        levels: &[Field<D>],
        visit: Visit<'_, D>,
    ) -> bool {
        let corners = mesh.corners(cell);
        let is_cut = levels.iter().any(|level| self.is_cut(&self.all(), &corners, level));
        if is_cut {
            self.visit(&corners, levels, &mut |point, weight| {
                visit(point, &in_space(point, &corners), weight);
            });
        }
        is_cut
    }

    /// Calls `visit` with the points of the rule on a simplex, in barycentric coordinates, and with their
    /// weights, whose sum is one.
    pub fn visit<const D: usize>(
        &self,
        corners: &[Point<D>; 4],
        levels: &[Field<D>],
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        self.visit_piece(&self.all(), corners, levels, visit);
    }

    fn all(&self) -> Piece {
        Piece { corners: array_of(vertex_point), share: 1.0, bisections: 0 }
    }

    /// Visits a piece: divided along the first function, then along the others.
    fn visit_piece<const D: usize>(
        &self,
        piece: &Piece,
        corners: &[Point<D>; 4],
        levels: &[Field<D>],
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        let Some((level, others)) = levels.split_first() else {
            let rule = if piece.share == 1.0 { &self.whole } else { &self.piece };
            return rule.iter().for_each(|(point, weight)| {
                visit(&piece.point(point), weight * piece.share);
            });
        };
        if !self.is_cut(piece, corners, level) {
            self.visit_piece(piece, corners, others, visit);
        } else if piece.bisections < BISECTIONS[self.dimension] {
            for half in self.halves(piece, corners) {
                self.visit_piece(&half, corners, levels, visit);
            }
        } else {
            let sign = |c: [f64; 4]| if level(&in_space(&c, corners)) > 0.0 { 1 } else { -1 };
            self.divide(piece, piece.corners.map(sign), corners, levels, visit);
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

    /// The rule on the pieces into which the zeros of the first function on the edges of `piece` divide `piece`.
    /// `signs` are the signs of the function at the corners of `piece`, zero at corners that are zeros.
    fn divide<const D: usize>(
        &self,
        piece: &Piece,
        signs: [i8; 4],
        corners: &[Point<D>; 4],
        levels: &[Field<D>],
        visit: &mut dyn FnMut(&[f64; 4], f64),
    ) {
        let of_sign = |sign| signs[..=self.dimension].iter().position(|s| *s == sign);
        let (Some(i), Some(j)) = (of_sign(1), of_sign(-1)) else {
            return self.visit_piece(piece, corners, &levels[1..], visit);
        };
        let (from, to) = (piece.corners[j], piece.corners[i]);
        let r = zero_between(|r| levels[0](&in_space(&between(&from, &to, r), corners)));
        for (replaced, share) in [(i, r), (j, 1.0 - r)] {
            let mut divided = Piece { share: share * piece.share, ..*piece };
            let mut signs = signs;
            divided.corners[replaced] = between(&from, &to, r);
            signs[replaced] = 0;
            self.divide(&divided, signs, corners, levels, visit);
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

/// A point of `[0, 1]` between an end at which a function is positive and one at which it is not, where that changes, to
/// rounding, at jumps too: by the method of C. J. F. Ridders, IEEE Trans. Circuits Syst. 26 (1979), 979-980, and by halves
/// where the function vanishes on one side, or squares of its values are no numbers. An end where the function vanishes,
/// but not beside it, is that point.
fn zero_between(function: impl Fn(f64) -> f64) -> f64 {
    let [mut low, mut high] = [0.0, 1.0].map(|r| (r, function(r)));
    for ((end, value), beside) in [(low, BESIDE), (high, 1.0 - BESIDE)] {
        if value == 0.0 && function(beside) != 0.0 {
            return end;
        }
    }
    let mut zero = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let middle = 0.5 * (low.0 + high.0);
        let at_middle = function(middle);
        let scale = (at_middle * at_middle - low.1 * high.1).sqrt();
        let step = (middle - low.0) * (low.1 - high.1).signum() * at_middle / scale;
        let is_between = low.1 * high.1 < 0.0 && step.is_finite();
        let before = std::mem::replace(&mut zero, if is_between { middle + step } else { middle });
        let at_zero = function(zero);
        for (r, value) in [(middle, at_middle), (zero, at_zero)] {
            match (value > 0.0) == (low.1 > 0.0) {
                true if r > low.0 => low = (r, value),
                false if r < high.0 => high = (r, value),
                _ => {}
            }
        }
        if is_between && at_zero == 0.0 || (zero - before).abs() <= f64::EPSILON {
            break;
        }
    }
    zero
}

/// The point with these barycentric coordinates in a simplex with these corners; corners beyond its
/// dimension have coordinate zero.
pub(crate) fn in_space<const D: usize>(
    barycentric: &[f64; 4],
    corners: &[Point<D>; 4],
) -> Point<D> {
    corners.iter().zip(barycentric).fold(Point::zeros(), |x, (corner, &b)| x + corner * b)
}
