//! Simplices cut where a function changes sign.

use crate::problem::Field;
use crate::real::Point;

/// A part of a simplex, by barycentric coordinates in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SubSimplex {
    corners: [[f64; 4]; 4],
    dimension: usize,
    /// Share of the measure of the whole simplex.
    pub share: f64,
    bisections: usize,
}

/// How often a simplex is bisected, by dimension: parts that the boundary of the set runs through
/// are then about 1e-5, 1/32 and 1/8 of the simplex in size.
const BISECTIONS: [usize; 4] = [0, 16, 10, 9];

impl SubSimplex {
    /// The whole simplex of some dimension.
    pub fn whole(dimension: usize) -> Self {
        let mut corners = [[0.0; 4]; 4];
        for (k, corner) in corners.iter_mut().enumerate() {
            corner[k] = 1.0;
        }
        Self { corners, dimension, share: 1.0, bisections: 0 }
    }

    /// A point of the part in barycentric coordinates of the whole.
    pub fn point(&self, barycentric: &[f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| {
            (0..=self.dimension).map(|i| barycentric[i] * self.corners[i][k]).sum()
        })
    }

    /// Whether the part is the whole simplex.
    pub fn is_whole(&self) -> bool {
        self.bisections == 0
    }

    /// The barycentre, in the space in which the whole has these corners.
    pub fn barycentre<const D: usize>(&self, corners: &[Point<f64, D>; 4]) -> Point<f64, D> {
        let mut middle = [0.0; 4];
        middle[..=self.dimension].fill(1.0 / (self.dimension + 1) as f64);
        in_space(&self.point(&middle), corners)
    }

    /// Calls `visit` with parts that make up this one: those on which the sign of the function
    /// differs between corners and barycentre are bisected, across their longest edge, down to a
    /// fixed size. A change of sign between these points is not detected.
    pub fn split<const D: usize>(
        &self,
        corners: &[Point<f64, D>; 4],
        indicator: &Field<D>,
        visit: &mut dyn FnMut(&Self),
    ) {
        if self.bisections == BISECTIONS[self.dimension] || !self.is_cut(corners, indicator) {
            visit(self);
            return;
        }
        for half in self.halves(corners) {
            half.split(corners, indicator, visit);
        }
    }

    /// Whether the sign of the function differs between corners and barycentre.
    pub fn is_cut<const D: usize>(
        &self,
        corners: &[Point<f64, D>; 4],
        indicator: &Field<D>,
    ) -> bool {
        let inside = indicator(&self.barycentre(corners)) > 0.0;
        let at_corners = self.corners[..=self.dimension].iter();
        at_corners.map(|c| in_space(c, corners)).any(|x| (indicator(&x) > 0.0) != inside)
    }

    /// The two halves on both sides of the middle of the longest edge.
    fn halves<const D: usize>(&self, corners: &[Point<f64, D>; 4]) -> [Self; 2] {
        let points = self.corners.map(|c| in_space(&c, corners));
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
        let middle: [f64; 4] =
            std::array::from_fn(|k| 0.5 * (self.corners[i][k] + self.corners[j][k]));
        [i, j].map(|replaced| {
            let mut half = Self { share: 0.5 * self.share, ..*self };
            half.bisections += 1;
            half.corners[replaced] = middle;
            half
        })
    }
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

    /// Share of the unit simplex in a ball of radius one half around its right-angled corner.
    fn share_in_ball<const D: usize>() -> f64 {
        let mut corners = [Point::<f64, D>::zeros(); 4];
        (0..D).for_each(|k| corners[k + 1][k] = 1.0);
        let ball: Field<D> = std::sync::Arc::new(|x| 0.5 - x.norm());
        let [mut all, mut within] = [0.0; 2];
        SubSimplex::whole(D).split(&corners, &ball, &mut |part| {
            all += part.share;
            within += if ball(&part.barycentre(&corners)) > 0.0 { part.share } else { 0.0 };
        });
        assert_eq!(all, 1.0, "halves make up the whole");
        within
    }

    #[test]
    fn pieces_follow_a_sphere() {
        assert!((share_in_ball::<1>() - 0.5).abs() < 1e-4);
        assert!((share_in_ball::<2>() - PI / 8.0).abs() < 2e-3);
        assert!((share_in_ball::<3>() - PI / 8.0).abs() < 2e-2);
    }
}
