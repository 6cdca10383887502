//! Forces of obstacles on facets: where an obstacle presses along a facet, its multiplier is no function of cells.
//!
//! A membrane pressed onto an obstacle through its boundary, the edge of an obstacle that ends inside the domain, the
//! ridge of an obstacle: there the solution has a kink or a flux of its own, and the multiplier is a force `s` on
//! facets. The jump of `alpha grad v . n` on a facet that touches, `v` the function of a pair,
//!
//! ```text
//! S = sum over both sides of alpha grad v . n           between two cells
//! S = alpha grad v . n - q_N                            on a Neumann facet
//! ```
//!
//! is such a force where it has the sign of the obstacle; in cells that touch everywhere the obstacle takes the place of
//! `v`, so that smooth obstacles have none. The multiplier of the cells around gives no more than it has. Around each
//! vertex a flux carries the exchange, next to `alpha grad v - q`, as in [`patches`](crate::error_bound::patches).

use super::{AskedForce, FacetForce};
use crate::algebra::NO_INDEX;
use crate::arrays::array_of;
use crate::assemble::space::Space;
use crate::error_bound::quadratics::{densities, vertices_of};
use crate::error_bound::{NoBound, PrimalDualPair};
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbour, Neighbours};
use crate::parallel::cells;
use crate::parallel::vectors::{collect, flags, indices, largest, positions};
use crate::problem::Datum;
use crate::quadrature::facet_to_cell;
use crate::real::Point;

/// A facet touches if its distance from the obstacle is at most this share of `S h / alpha`, `h` the diameter of the cell:
/// the force costs then less than what the flux misses without it.
const TOUCHES: f64 = 0.125;

/// A cell is in contact if its distance from the obstacle is at most this share of `S h / alpha`.
const IN_CONTACT: f64 = 1.0 / 32.0;

/// Distances up to this share of the values, and this many units of rounding of data from which a constant was taken, are
/// zero.
const ROUNDING: f64 = 1e-11;
const ROUNDINGS: f64 = 64.0;

/// Forces up to this share of the fluxes on both sides are errors of differences.
const NEGLIGIBLE: f64 = 1e-3;

/// The step of the normal derivative of an obstacle, as a share of the diameter of the cell.
const STEP: f64 = 0.05;

/// How far the function of a pair is from an obstacle in a cell: the largest distances at the nodes of each facet, and at
/// all nodes.
#[derive(Clone, Copy)]
struct Distances {
    on_facets: [f64; 4],
    everywhere: f64,
}

/// Normal fluxes of the function of a pair in a cell, and its distances from obstacles.
#[derive(Clone, Copy)]
struct CellTrace {
    /// By facet its measure times `alpha grad v . n`, at the vertices of the cell.
    normal: [[f64; 4]; 4],
    /// From the lower and the upper obstacle, where there are such.
    distances: [Option<Distances>; 2],
    /// The diameter over the coefficient.
    height: f64,
}

/// A facet by its sides; on the boundary it has one.
type Sides = [Option<HalfFacet>; 2];

impl<const D: usize> Space<'_, D> {
    /// The forces that the function of a pair asks for on facets at a vertex of cells that press, in ascending order.
    pub(in crate::error_bound) fn asked_forces(
        &self,
        function: &PrimalDualPair<D>,
        neighbours: &Neighbours,
        presses: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<Vec<AskedForce>, NoBound> {
        let n_cells = self.mesh.n_cells();
        let is_near = flags(self.mesh.vertices().len(), |set| {
            cells::map(n_cells, &|cells| {
                let pressing = cells.filter(|&cell| presses(cell));
                pressing.flat_map(|cell| self.mesh.cell(cell)).for_each(|&v| set(v as usize));
            });
        });
        let near =
            indices(n_cells, |cell| self.mesh.cell(cell).iter().any(|&v| is_near[v as usize]));
        let places = positions(n_cells, &near);
        let traces = collect(near.len(), |k| self.cell_trace(function, near[k] as usize));
        let rounding = self.rounding_of(function);
        let forces = cells::map(near.len(), &|range| {
            let mut forces = Vec::new();
            for (cell, local) in range.flat_map(|k| (0..=D).map(move |f| (k, f))) {
                let cell = near[cell] as usize;
                let other = match neighbours.across(cell, local) {
                    Neighbour::Cell { cell: other, local } if other as usize > cell => {
                        Some((other as usize, usize::from(local)))
                    }
                    Neighbour::Boundary(BoundaryCondition::Neumann) => None,
                    _ => continue,
                };
                let sides = [Some((cell, local)), other];
                if sides.iter().flatten().all(|(cell, _)| places[*cell] != NO_INDEX) {
                    let trace = |cell: usize| &traces[places[cell] as usize];
                    forces.extend(self.asked_force((cell, local), sides, &trace, rounding)?);
                }
            }
            Ok(forces)
        });
        Ok(forces.into_iter().collect::<Result<Vec<_>, NoBound>>()?.concat())
    }

    /// Sets the values of a function to those of the obstacle at nodes of facets with a force, where they are equal but
    /// for rounding: else the force would count times rounding.
    pub(in crate::error_bound) fn touch_under(
        &self,
        forces: &[AskedForce],
        function: &mut PrimalDualPair<D>,
    ) {
        let rounding = self.rounding_of(function);
        for AskedForce { force, .. } in forces {
            let is_upper = force.densities.iter().sum::<f64>() < 0.0;
            for side in force.sides() {
                let obstacles = [&self.data.lower, &self.data.upper][usize::from(is_upper)];
                let Some(obstacle) = obstacles.of(self.mesh.region(side.0)) else { continue };
                let corners = self.mesh.corners(side.0);
                let nodes: Vec<_> = self.pair_nodes_on(function, side).collect();
                for ([a, b], node) in nodes {
                    let at = self.at(obstacle, side.0, &((corners[a] + corners[b]) * 0.5));
                    let value = &mut function.function[node];
                    if (*value - at).abs() <= rounding {
                        *value = at;
                    }
                }
            }
        }
    }

    /// The force on a facet: asked for by the function and, with the obstacle in its place in cells in contact, still.
    fn asked_force<'t>(
        &self,
        facet: HalfFacet,
        sides: Sides,
        trace: &dyn Fn(usize) -> &'t CellTrace,
        rounding: f64,
    ) -> Result<Option<AskedForce>, NoBound> {
        let mut normal = sides.map(|side| side.map_or([0.0; 4], |(c, f)| trace(c).normal[f]));
        let (mut densities, mut size) = self.sum_of_sides(facet, sides, &normal)?;
        let upper = usize::from(densities.iter().sum::<f64>() < 0.0);
        let sign = [1.0, -1.0][upper];
        let is_force = |densities: &[f64; 4], size: f64| {
            let all: f64 = densities.iter().sum();
            sign * all > NEGLIGIBLE * size
                && vertices_of::<D>(facet.1).all(|j| sign * densities[j] >= 0.0)
        };
        if !is_force(&densities, size) {
            return Ok(None);
        }
        let measure = self.facet_measure(facet);
        // whether a distance is at most a share of the height that belongs to these densities
        let is_within = |cell: usize, distance: f64, share: f64, densities: &[f64; 4]| {
            let mean = sign * densities.iter().sum::<f64>() / D as f64;
            distance <= share * mean / measure * trace(cell).height + rounding
        };
        for (side, normal) in sides.iter().zip(&mut normal) {
            let Some((cell, local)) = *side else { continue };
            let obstacles = [&self.data.lower, &self.data.upper][upper];
            let found = trace(cell).distances[upper].zip(obstacles.of(self.mesh.region(cell)));
            if let Some((distances, obstacle)) = found
                && is_within(cell, distances.everywhere, IN_CONTACT, &densities)
            {
                *normal = self.obstacle_flux(obstacle, (cell, local));
            }
        }
        (densities, size) = self.sum_of_sides(facet, sides, &normal)?;
        let touches = sides.iter().flatten().any(|(cell, local)| {
            trace(*cell).distances[upper].is_some_and(|distances| {
                is_within(*cell, distances.on_facets[*local], TOUCHES, &densities)
            })
        });
        let force = FacetForce { facet, other: sides[1], densities };
        let is_asked = is_force(&densities, size) && touches;
        Ok(is_asked.then_some(AskedForce { force, normal, share: 1.0 }))
    }

    /// The sum of the fluxes from the sides of a facet, on the boundary less the Neumann datum, at the vertices of the
    /// first cell, and the sum of their sizes.
    fn sum_of_sides(
        &self,
        facet: HalfFacet,
        sides: Sides,
        normal: &[[f64; 4]; 2],
    ) -> Result<([f64; 4], f64), NoBound> {
        let (mut densities, mut size) = ([0.0; 4], 0.0);
        for (side, normal) in sides.iter().zip(normal) {
            let Some((cell, _)) = *side else { continue };
            for j in vertices_of::<D>(facet.1) {
                let vertex = self.mesh.cell(facet.0)[j];
                let there = self.mesh.cell(cell).iter().position(|&v| v == vertex);
                let flux = normal[there.expect("both cells of a facet have its vertices")];
                densities[j] += flux;
                size += flux.abs();
            }
        }
        if sides[1].is_none() && self.problem.has_neumann_data() {
            let of_datum = self.neumann_densities(facet, self.degree)?;
            for j in vertices_of::<D>(facet.1) {
                densities[j] -= of_datum[j];
                size += of_datum[j].abs();
            }
        }
        Ok((densities, size))
    }

    /// The measure of a Neumann facet times the datum there, at the vertices of the cell: by its mean or, for quadratics,
    /// by its linear part.
    fn neumann_densities(&self, facet: HalfFacet, degree: usize) -> Result<[f64; 4], NoBound> {
        let (group, measure) = (self.group_of(facet), self.facet_measure(facet));
        let mut moments = [0.0; 4];
        for (point, weight) in self.facet_rule.iter() {
            let flux = weight * measure * self.neumann_at(facet, group, point)?;
            let point = facet_to_cell(point, facet.1);
            moments.iter_mut().zip(&point).for_each(|(moment, b)| *moment += flux * b);
        }
        Ok(match degree {
            1 => [moments.iter().sum(); 4],
            _ => densities::<D>(&moments, facet.1),
        })
    }

    /// Whether the function of a pair touches the lower obstacle or the upper one everywhere in a cell.
    pub(in crate::error_bound) fn is_in_contact(
        &self,
        function: &PrimalDualPair<D>,
        cell: usize,
        (side, rounding): (usize, f64),
    ) -> bool {
        self.distances(function, cell, side).is_some_and(|found| found.everywhere <= rounding)
    }

    /// Distances of the function of a pair from obstacles up to this number are zero.
    pub(in crate::error_bound) fn rounding_of(&self, function: &PrimalDualPair<D>) -> f64 {
        let of_values = ROUNDING * largest(function.function.len(), |i| function.function[i].abs());
        of_values.max(ROUNDINGS * self.body_constants.rounding())
    }

    /// Normal fluxes and distances in a cell.
    fn cell_trace(&self, function: &PrimalDualPair<D>, cell: usize) -> CellTrace {
        let (geometry, alpha) = (self.mesh.geometry(cell), self.alpha(cell));
        let gradients = self.gradients_at_vertices(function, cell);
        // |F| n = -D |K| grad lambda
        let scale = -(D as f64) * geometry.volume * alpha;
        let mut normal = [[0.0; 4]; 4];
        for (local, normal) in normal.iter_mut().enumerate().take(D + 1) {
            let along = geometry.gradient(local) * scale;
            *normal = gradients.map(|gradient| gradient.dot(&along));
        }
        let distances = array_of(|side| self.distances(function, cell, side));
        CellTrace { normal, distances, height: self.mesh.cell_diameter(cell) / alpha }
    }

    /// How far the function of a pair is from the lower obstacle or the upper one in a cell.
    fn distances(
        &self,
        function: &PrimalDualPair<D>,
        cell: usize,
        side: usize,
    ) -> Option<Distances> {
        let region = self.mesh.region(cell);
        let obstacle = [&self.data.lower, &self.data.upper][side].of(region)?;
        let corners = self.mesh.corners(cell);
        let mut distances = Distances { on_facets: [0.0; 4], everywhere: 0.0 };
        for ([a, b], node) in self.pair_nodes(function, cell) {
            let x = (corners[a] + corners[b]) * 0.5;
            let distance = (function.function[node] - self.at(obstacle, cell, &x)).abs();
            distances.everywhere = distances.everywhere.max(distance);
            for (local, most) in distances.on_facets.iter_mut().enumerate().take(D + 1) {
                if local != a && local != b {
                    *most = most.max(distance);
                }
            }
        }
        Some(distances)
    }

    /// The measure of a facet times `alpha grad psi . n` of an obstacle, at the vertices of the cell; one number for all
    /// beside linears. By differences inside the cell, at points between vertices and the middle of the facet.
    fn obstacle_flux(&self, obstacle: &Datum<D>, (cell, local): HalfFacet) -> [f64; 4] {
        let geometry = self.mesh.geometry(cell);
        let normal = geometry.normal(local);
        let scale = self.alpha(cell) * geometry.facet_measure(local);
        let corners = self.mesh.corners(cell);
        let middle = vertices_of::<D>(local).map(|j| corners[j]).sum::<Point<D>>() / D as f64;
        let step = STEP * self.mesh.cell_diameter(cell);
        let slope = |x: &Point<D>| {
            let at = |steps: f64| self.at(obstacle, cell, &(x - normal * (steps * step)));
            scale * (3.0 * at(0.0) - 4.0 * at(1.0) + at(2.0)) / (2.0 * step)
        };
        if self.degree == 1 {
            return [slope(&middle); 4];
        }
        let halfway: [f64; 4] = array_of(|j| match j <= D && j != local {
            true => slope(&((corners[j] + middle) * 0.5)),
            false => 0.0,
        });
        let mean = halfway.iter().sum::<f64>() / D as f64;
        halfway.map(|value| mean + 2.0 * (value - mean))
    }
}
