//! Cells that overlap: folds across facets, and parts of a mesh that lie on each other.

mod facet_search;

#[cfg(feature = "problem-files")]
pub(crate) use facet_search::FacetSearch;
pub(super) use facet_search::lie_on_others;

use super::boundary::BoundaryFacet;
use super::error::{MeshError, MeshErrorKind};
use super::facets::{Neighbour, Neighbours, facet_of};
use super::geometry::{CellGeometry, describe_point};
use crate::arrays::map_entries;
use crate::real::Point;

/// Refuses two cells on the same side of the facet that they share. `is_positive` has the sign of the
/// determinant of the edges of each cell; `neighbours` is without boundary conditions.
pub(super) fn check_folds<const D: usize>(
    cells: &[u32],
    neighbours: &Neighbours,
    is_positive: &[bool],
) -> Result<(), MeshError> {
    for (cell, vertices) in cells.chunks_exact(D + 1).enumerate() {
        for local in 0..=D {
            if neighbours.is_unmatched(cell, local) {
                continue;
            }
            let Neighbour::Cell { cell: other, local: there } = neighbours.across(cell, local)
            else {
                continue;
            };
            // the vertices ascend in both cells: the sign of the one opposite the facet alternates
            // with its number
            let alternates = (local + there as usize) % 2 == 1;
            if (is_positive[cell] == is_positive[other as usize]) != alternates {
                let mut vertices = vertices.to_vec();
                vertices.remove(local);
                let message = format!(
                    "cells {cell} and {other} lie on the same side of their common facet {vertices:?}: the mesh folds over there; correct the coordinates or the cells"
                );
                let error = MeshError::new(MeshErrorKind::FoldedCells, message);
                return Err(error.of_cells([cell, other as usize]));
            }
        }
    }
    Ok(())
}

/// Fewest lines along which overlaps are looked for, fewer than the boundary has facets.
const LINES: usize = 8;
/// Most pairs of a line and a facet where there are more lines.
const PAIRS: usize = 1 << 12;
/// The direction of the lines, along no facet of a mesh along the axes or their diagonals.
const DIRECTION: [f64; 3] = [1.0, 0.381_966, 0.236_068];
/// A point lies in a cell if its barycentric coordinates are above this.
const INSIDE: f64 = 1e-6;

/// Refuses a mesh without folds that covers a point twice, where a line meets such a point. The
/// lines pass through boundary facets: through all up to 64, through eight from 512 on, evenly
/// spaced. In one dimension one line meets all points.
///
/// Along a line the number of cells over a point changes at boundary facets only, by one. An overlap
/// that no line meets, or only in a width of a millionth of a cell, is not found.
pub(super) fn check_overlaps<const D: usize>(
    vertices: &[Point<D>],
    cells: &[u32],
    boundary: &[BoundaryFacet],
) -> Result<(), MeshError> {
    let cell = |c: usize| &cells[c * (D + 1)..(c + 1) * (D + 1)];
    let geometry = |c: usize| CellGeometry::new(|k| vertices[cell(c)[k] as usize]);
    let corners = |f: &BoundaryFacet| -> [Point<D>; D] {
        let facet = facet_of::<D>(cell(f.cell as usize), f.local as usize);
        map_entries(facet, |v| sheared(&vertices[v as usize]))
    };
    let facets: Vec<_> = boundary.iter().map(corners).collect();
    let direction = Point::<D>::from_fn(|k, _| DIRECTION[k]);
    let lines = if D > 1 { LINES.max(PAIRS / facets.len().max(1)) } else { 1 };
    let lines = lines.min(facets.len());
    for line in 0..lines {
        let start = facets[line * facets.len() / lines];
        let start = start.iter().fold(Point::zeros(), |s, x| s + x) / D as f64;
        let mut crossings: Vec<(f64, i32)> = Vec::new();
        for (corners, f) in facets.iter().zip(boundary) {
            let Some(place) = crossing(corners, &start) else { continue };
            let inward = geometry(f.cell as usize).gradient(f.local as usize).dot(&direction);
            crossings.push((place, if inward > 0.0 { 1 } else { -1 }));
        }
        sort_by_place(&mut crossings);
        let (mut depth, mut widest) = (0, (0.0, 0.0));
        for pair in crossings.windows(2) {
            depth += pair[0].1;
            let width = pair[1].0 - pair[0].0;
            if depth > 1 && width > widest.1 {
                widest = (0.5 * (pair[0].0 + pair[1].0), width);
            }
        }
        if widest.1 > 0.0 {
            let x =
                Point::from_fn(|k, _| DIRECTION[k] * widest.0 + if k > 0 { start[k] } else { 0.0 });
            let holds = |&c: &usize| {
                let (geometry, corner) = (geometry(c), vertices[cell(c)[0] as usize]);
                let others = (1..=D).map(|k| geometry.gradient(k).dot(&(x - corner)));
                let first = 1.0 - others.clone().sum::<f64>();
                others.chain([first]).all(|b| b > INSIDE)
            };
            let mut found = (0..cells.len() / (D + 1)).filter(holds);
            if let (Some(first), Some(second)) = (found.next(), found.next()) {
                let message = format!(
                    "cells {first} and {second} overlap at {}: bodies of the mesh lie on each other; leave one of them out, or mesh their union",
                    describe_point(&x)
                );
                let error = MeshError::new(MeshErrorKind::OverlappingCells, message);
                return Err(error.of_cells([first, second]));
            }
        }
    }
    Ok(())
}

/// The point under the shear that turns the direction of the lines onto the first axis: along a line
/// the other coordinates are constant.
fn sheared<const D: usize>(x: &Point<D>) -> Point<D> {
    Point::from_fn(|k, _| if k == 0 { x[0] } else { x[k] - DIRECTION[k] * x[0] })
}

/// The first coordinate at which the line through a point crosses a facet, all sheared. The signs by
/// which two facets tell on which side of their common edge the line passes are the same to the last
/// bit.
#[inline(always)]
fn crossing<const D: usize>(corners: &[Point<D>; D], start: &Point<D>) -> Option<f64> {
    let offset = |k: usize, axis: usize| corners[k][axis % D] - start[axis % D];
    let weights = match D {
        1 => [1.0, 0.0, 0.0],
        2 => [-offset(1, 1), offset(0, 1), 0.0],
        _ => {
            let above = (0..D).filter(|&k| offset(k, 1) > 0.0).count();
            if above == 0 || above == D {
                return None;
            }
            let edge = |a, b| offset(a, 1) * offset(b, 2) - offset(a, 2) * offset(b, 1);
            [edge(1, 2), edge(2, 0), edge(0, 1)]
        }
    };
    let weights = &weights[..D];
    let is_crossed = weights.iter().all(|&w| w > 0.0) || weights.iter().all(|&w| w < 0.0);
    is_crossed.then(|| {
        let sum: f64 = weights.iter().sum();
        weights.iter().zip(corners).map(|(w, x)| w * x[0]).sum::<f64>() / sum
    })
}

/// Sorts crossings by their places; not generic, so that the sorting code is compiled once.
fn sort_by_place(crossings: &mut [(f64, i32)]) {
    crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
}
