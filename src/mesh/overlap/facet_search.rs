//! Search for the facets that a point lies in, and for facets of the boundary that lie on each other: between bodies
//! of a domain that were meshed apart, each with nodes of its own, or at a slit.

use crate::arrays::array_of;
use crate::mesh::BoxSearch;
use crate::real::{Point, box_around};

/// Points of facets that lie on each other are nearer than this share of the extent of all facets.
const COINCIDENT: f64 = 1e-8;

/// Facets of a mesh, found by points that lie in them.
pub(crate) struct FacetSearch<const D: usize> {
    corners: Vec<[Point<D>; D]>,
    /// A point lies in a facet if it is nearer to it than this, and its barycentric coordinates are above
    /// minus the share.
    near: f64,
    share: f64,
    boxes: BoxSearch<D>,
}

impl<const D: usize> FacetSearch<D> {
    /// The facets with these corners; points are in a facet up to a share of the extent of all.
    pub fn new(corners: Vec<[Point<D>; D]>, share: f64) -> Self {
        let [lower, upper] = box_around(corners.iter().flatten());
        let near = (share * (upper - lower).norm()).max(f64::MIN_POSITIVE);
        let around = |facet: &[Point<D>; D]| {
            let [low, high] = box_around(facet);
            [low.add_scalar(-near), high.add_scalar(near)]
        };
        let boxes = BoxSearch::new(lower, corners.iter().map(around));
        Self { corners, near, share, boxes }
    }

    /// The facets that a point lies in.
    pub fn containing(&self, x: &Point<D>) -> impl Iterator<Item = usize> {
        self.boxes.candidates(x).filter(|&facet| self.is_in(facet, x))
    }

    fn is_in(&self, facet: usize, x: &Point<D>) -> bool {
        let corners = &self.corners[facet];
        let edges = [1, 2].map(|k| if k < D { corners[k] - corners[0] } else { Point::zeros() });
        let from = x - corners[0];
        let [aa, ab, bb] = [[0, 0], [0, 1], [1, 1]].map(|[i, j]| edges[i].dot(&edges[j]));
        let [ax, bx] = edges.map(|edge| edge.dot(&from));
        let [s, t] = match D {
            1 => [0.0; 2],
            2 => [ax / aa, 0.0],
            _ => [ax * bb - bx * ab, bx * aa - ax * ab].map(|x| x / (aa * bb - ab * ab)),
        };
        let is_inside = [s, t, 1.0 - s - t].iter().all(|&b| b > -self.share);
        is_inside && (from - edges[0] * s - edges[1] * t).norm() <= self.near
    }
}

/// For each facet whether its barycentre lies on another one.
pub(in crate::mesh) fn lie_on_others<const D: usize>(
    vertices: &[Point<D>],
    facets: &[[u32; D]],
) -> Vec<bool> {
    let corners = facets.iter().map(|facet| array_of(|k| vertices[facet[k] as usize]));
    let search = FacetSearch::new(corners.collect(), COINCIDENT);
    let lies_on_other = |facet: usize| {
        let middle = search.corners[facet].iter().sum::<Point<D>>() / D as f64;
        search.containing(&middle).any(|other| other != facet)
    };
    (0..facets.len()).map(lies_on_other).collect()
}
