//! The free boundary of a discrete solution and its distance from the exact one.

use crate::parallel::cells;
use std::ops::Range;

use super::entity::ContactEntity;
use super::point_grid::PointGrid;
use crate::assemble::cut_simplices::in_space;
use crate::assemble::space::Space;
use crate::problem::ContactSet;
use crate::real::{Point, box_around};

/// A facet of the discrete free boundary is sampled by the points whose barycentric coordinates are
/// multiples of one over this.
const SAMPLES: usize = 4;

impl<const D: usize> Space<'_, D> {
    /// The Hausdorff distance of the two free boundaries within the mesh; none if either is empty. All entities that
    /// meet the exact one are among those `near`.
    pub(super) fn free_boundary_distance(
        &self,
        set: &ContactSet<D>,
        (entities, touching): (&[ContactEntity], &[bool]),
        near: &[ContactEntity],
    ) -> Option<f64> {
        let discrete = self.discrete_free_boundary(entities, touching);
        let exact = self.within_mesh(set, near);
        if discrete.is_empty() || exact.is_empty() {
            return None;
        }
        Some(one_sided(&discrete, &exact).max(one_sided(&exact, &discrete)))
    }

    /// Points on the facets between entities in contact and entities that are not.
    fn discrete_free_boundary(
        &self,
        entities: &[ContactEntity],
        touching: &[bool],
    ) -> Vec<Point<D>> {
        let Some(dimension) = entities.first().map(|c| c.dimension::<D>()) else {
            return Vec::new();
        };
        // whether a vertex belongs to entities that are not, and that are in contact
        let mut belongs = vec![[false; 2]; self.mesh.vertices().len()];
        for (entity, &touches) in entities.iter().zip(touching) {
            let cell = self.mesh.cell(entity.cell);
            let states = entity.corners::<D>().map(|k| cell[k] as usize);
            states.for_each(|v| belongs[v][usize::from(touches)] = true);
        }
        // every facet between such vertices, named by them, in the order of these names
        let mut facets: Vec<([u32; 3], bool)> = Vec::new();
        for (entity, &touches) in entities.iter().zip(touching) {
            let cell = self.mesh.cell(entity.cell);
            for opposite in entity.corners::<D>().filter(|_| dimension > 0) {
                let mut name = [u32::MAX; 3];
                let others = entity.corners::<D>().filter(|&k| k != opposite).map(|k| cell[k]);
                if others.clone().all(|v| belongs[v as usize] == [true; 2]) {
                    name.iter_mut().zip(others).for_each(|(v, other)| *v = other);
                    facets.push((name, touches));
                }
            }
        }
        facets.sort_unstable();
        let lattice = lattice(dimension.saturating_sub(1));
        let mut points = Vec::new();
        // a name that occurs twice in a row with different states
        for pair in facets.windows(2).filter(|p| p[0].0 == p[1].0 && p[0].1 != p[1].1) {
            let mut corners = [Point::zeros(); 4];
            for (corner, &v) in corners.iter_mut().zip(&pair[0].0[..dimension]) {
                *corner = self.mesh.vertices()[v as usize];
            }
            points.extend(lattice.iter().map(|barycentric| in_space(barycentric, &corners)));
        }
        points
    }

    /// The points of the exact free boundary that lie on some entity: a mesh from a file need not
    /// cover the domain of the scene.
    fn within_mesh(&self, set: &ContactSet<D>, entities: &[ContactEntity]) -> Vec<Point<D>> {
        let points = &set.free_boundary;
        let grid = PointGrid::new(points);
        let on_entity = |entity: &ContactEntity, found: &mut Vec<usize>| {
            let corners = self.corner_points(*entity);
            let [low, high] = box_around(&corners[..=entity.dimension::<D>()]);
            let slack = Point::repeat(SLACK * (high - low).norm().max(f64::MIN_POSITIVE));
            grid.visit_within(&(low - slack), &(high + slack), &mut |k, x| {
                if self.covers(*entity, x) {
                    found.push(k);
                }
            });
        };
        let mut found = cells::map(entities.len(), &|range: Range<usize>| {
            let mut found = Vec::new();
            entities[range].iter().for_each(|entity| on_entity(entity, &mut found));
            found
        })
        .concat();
        found.sort_unstable();
        found.dedup();
        found.into_iter().map(|k| points[k]).collect()
    }

    /// Whether a point lies on an entity.
    fn covers(&self, entity: ContactEntity, x: &Point<D>) -> bool {
        let geometry = self.mesh.geometry(entity.cell);
        let cell = self.mesh.cell(entity.cell);
        (0..D + 1).all(|k| {
            // coordinate k vanishes at any other corner of the cell
            let zero = self.mesh.vertices()[cell[usize::from(k == 0)] as usize];
            let coordinate = geometry.gradient(k).dot(&(x - zero));
            coordinate >= -SLACK && (entity.facet != Some(k) || coordinate <= SLACK)
        })
    }
}

/// Points this much outside a simplex, in units of its size, still count as on it.
const SLACK: f64 = 1e-9;

/// The largest distance of a point of the first set from the second.
fn one_sided<const D: usize>(from: &[Point<D>], to: &[Point<D>]) -> f64 {
    let mut to = to.to_vec();
    to.sort_unstable_by(|x, y| x[0].total_cmp(&y[0]));
    // the larger one of a number and the square of the distance of a point
    let larger = |largest: f64, x: &Point<D>| {
        let (before, after) = to.split_at(to.partition_point(|y| y[0] < x[0]));
        let mut least = f64::INFINITY;
        for side in
            [&mut after.iter() as &mut dyn Iterator<Item = &Point<D>>, &mut before.iter().rev()]
        {
            for y in side {
                // the first coordinate alone exceeds the distance known, or the point does not count any more
                if (x[0] - y[0]).powi(2) > least || least <= largest {
                    break;
                }
                least = least.min((x - y).norm_squared());
            }
        }
        least.max(largest)
    };
    let of_chunk = |range: Range<usize>| from[range].iter().fold(0.0, larger);
    cells::map(from.len(), &of_chunk).into_iter().fold(0.0, f64::max).sqrt()
}

/// Barycentric coordinates of evenly spaced points on the simplex of some dimension.
fn lattice(dimension: usize) -> Vec<[f64; 4]> {
    let mut points = vec![([0.0; 4], SAMPLES)];
    for k in 0..dimension {
        let choose = |(point, left): ([f64; 4], usize)| {
            (0..=left).map(move |taken| {
                let mut point = point;
                point[k] = taken as f64 / SAMPLES as f64;
                (point, left - taken)
            })
        };
        points = points.into_iter().flat_map(choose).collect();
    }
    let close = |(mut point, left): ([f64; 4], usize)| {
        point[dimension] = left as f64 / SAMPLES as f64;
        point
    };
    points.into_iter().map(close).collect()
}
