//! The free boundary of a discrete solution and its distance from the exact one.

use std::ops::Range;

use super::entity::ContactEntity;
use crate::assemble::space::Space;
use crate::parallel::cells;
use crate::problem::ContactSet;
use crate::real::{Point, box_around};

/// Points this much outside a simplex, in units of its size, still count as on it.
const SLACK: f64 = 1e-9;

impl<const D: usize> Space<'_, D> {
    /// The Hausdorff distance of the two free boundaries within the mesh; none if either is empty. That of the discrete
    /// solution is taken at vertices: those of entities that are in contact and of others.
    pub(super) fn free_boundary_distance(
        &self,
        set: &ContactSet<D>,
        entities: &[ContactEntity],
        touching: &[bool],
    ) -> Option<f64> {
        let mut belongs = vec![[false; 2]; self.mesh.vertices().len()];
        for (entity, &touches) in entities.iter().zip(touching) {
            let cell = self.mesh.cell(entity.cell);
            let vertices = entity.corners::<D>().map(|k| cell[k] as usize);
            vertices.for_each(|v| belongs[v][usize::from(touches)] = true);
        }
        let vertices = self.mesh.vertices().iter().zip(belongs);
        let discrete = vertices.filter(|(_, belongs)| *belongs == [true; 2]).map(|(x, _)| *x);
        let discrete = sorted(discrete.collect());
        let exact = self.within_mesh(&sorted(set.free_boundary.clone()), entities);
        if discrete.is_empty() || exact.is_empty() {
            return None;
        }
        Some(one_sided(&discrete, &exact).max(one_sided(&exact, &discrete)))
    }

    /// Those of some sorted points that lie on some entity: a mesh from a file need not cover the domain of the scene.
    fn within_mesh(&self, points: &[Point<D>], entities: &[ContactEntity]) -> Vec<Point<D>> {
        let on_entities = |range: Range<usize>| {
            let mut found = Vec::new();
            for &entity in &entities[range] {
                let corners = self.corner_points(entity);
                let [low, high] = box_around(&corners[..=entity.dimension::<D>()]);
                let slack = SLACK * (high - low).norm().max(f64::MIN_POSITIVE);
                let first = points.partition_point(|x| x[0] < low[0] - slack);
                let near = points[first..].iter().take_while(|x| x[0] <= high[0] + slack);
                let is_near = |x: &Point<D>| {
                    (1..D).all(|k| x[k] >= low[k] - slack && x[k] <= high[k] + slack)
                };
                let within = near.enumerate().filter(|(_, x)| is_near(x) && self.covers(entity, x));
                found.extend(within.map(|(k, _)| first + k));
            }
            found
        };
        let mut found = cells::map(entities.len(), &on_entities).concat();
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

/// Points in the order of their first coordinates.
fn sorted<const D: usize>(mut points: Vec<Point<D>>) -> Vec<Point<D>> {
    points.sort_unstable_by(|x, y| x[0].total_cmp(&y[0]));
    points
}

/// The largest distance of a point of the first set from the second, which is sorted.
fn one_sided<const D: usize>(from: &[Point<D>], to: &[Point<D>]) -> f64 {
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
