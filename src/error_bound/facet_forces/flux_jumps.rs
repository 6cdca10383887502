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
//! `v`, so that smooth obstacles have none. The unit of distances from the obstacle is `S h / alpha`, `h` the diameter of the
//! cell, `S` per measure: of both sides the smaller one, where a jump that no force takes costs the least. A force that
//! depends on a distance fades to zero between half of a limit and the limit: a threshold would leave it to rounding.

use super::{FacetForce, FluxJump};
use crate::algebra::NO_INDEX;
use crate::arrays::{array_of, map_entries};
use crate::assemble::space::Space;
use crate::error_bound::flux::share_of_one_sign;
use crate::error_bound::quadratics::{densities, vertices_of};
use crate::error_bound::{NoBound, PrimalDualPair};
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbour, Neighbours};
use crate::parallel::cells;
use crate::parallel::vectors::{flags, for_each_chunk_of_groups, indices, largest, positions};
use crate::problem::Datum;
use crate::real::Point;

/// Facets at this distance do not touch: the force costs there about what the flux misses without it.
const TOUCHES: f64 = 0.125;

/// Cells at this distance are not in contact.
const IN_CONTACT: f64 = 1.0 / 32.0;

/// Jumps up to this share of the fluxes on both sides are errors of differences.
const NEGLIGIBLE: f64 = 1e-3;

/// Distances up to this share of the values, and this many units of rounding of data from which a constant was taken, are
/// zero under a force.
const ROUNDING: f64 = 1e-11;
const ROUNDINGS: f64 = 64.0;

/// The step of the normal derivative of an obstacle, as a share of the height of the cell.
const STEP: f64 = 0.05;

/// One up to half of a limit, given the share of the limit that is reached; zero from the limit on.
pub(in crate::error_bound) fn fade(share: f64) -> f64 {
    (2.0 - 2.0 * share).clamp(0.0, 1.0)
}

impl<const D: usize> Space<'_, D> {
    /// The jumps of the normal flux of a function, facets in ascending order: on facets that touch an obstacle and whose
    /// cells have a vertex in common with a cell that has a multiplier, which `presses` tells.
    pub(in crate::error_bound) fn flux_jumps(
        &self,
        function: &PrimalDualPair<D>,
        neighbours: &Neighbours,
        presses: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<Vec<FluxJump>, NoBound> {
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
        // by facet one normal flux for linears, one at each vertex of the cell for quadratics
        let per_facet = if function.degree == 1 { 1 } else { D + 1 };
        let stride = (D + 1) * per_facet;
        let mut fluxes = vec![0.0; near.len() * stride];
        for_each_chunk_of_groups(&mut fluxes, stride, |range, fluxes| {
            let cells = &near[range.start / stride..];
            for (&cell, fluxes) in cells.iter().zip(fluxes.chunks_exact_mut(stride)) {
                self.normal_fluxes(function, cell as usize, fluxes);
            }
        });
        let normal_flux = |(cell, local): HalfFacet| {
            let of_facet = &fluxes[places[cell] as usize * stride + local * per_facet..];
            array_of(|j| if j <= D { of_facet[j % per_facet] } else { 0.0 })
        };
        let jumps = cells::map(near.len(), &|range| {
            let mut jumps = Vec::new();
            for (cell, local) in range.flat_map(|k| (0..=D).map(move |f| (k, f))) {
                let cell = near[cell] as usize;
                let other = match neighbours.across(cell, local) {
                    Neighbour::Cell { cell: other, local } if other as usize > cell => {
                        Some((other as usize, usize::from(local)))
                    }
                    Neighbour::Boundary(BoundaryCondition::Neumann)
                        if self.is_loaded_alone((cell, local)) =>
                    {
                        None
                    }
                    _ => continue,
                };
                let sides = [Some((cell, local)), other];
                if sides.iter().flatten().all(|(cell, _)| places[*cell] != NO_INDEX) {
                    let normal = sides.map(|side| side.map_or([0.0; 4], &normal_flux));
                    jumps.extend(self.flux_jump(function, sides, normal)?);
                }
            }
            Ok(jumps)
        });
        Ok(jumps.into_iter().collect::<Result<Vec<_>, NoBound>>()?.concat())
    }

    /// The jump on a facet, from its sides and the normal fluxes of the function there; none where the facet touches no
    /// obstacle, and where the jump has the sign of none.
    fn flux_jump(
        &self,
        function: &PrimalDualPair<D>,
        sides: [Option<HalfFacet>; 2],
        mut normal: [[f64; 4]; 2],
    ) -> Result<Option<FluxJump>, NoBound> {
        let Some(facet) = sides[0] else { return Ok(None) };
        let (jump, size) = self.sum_of_sides(facet, sides, &normal)?;
        let sum: f64 = jump.iter().sum();
        let (upper, sign) = if sum < 0.0 { (1, -1.0) } else { (0, 1.0) };
        let obstacles = [&self.data.lower, &self.data.upper][upper];
        let obstacles = sides.map(|side| obstacles.of(self.mesh.region(side?.0)));
        if sign * sum <= NEGLIGIBLE * size || obstacles.iter().all(Option::is_none) {
            return Ok(None);
        }
        let of_side =
            |(cell, _): &HalfFacet| self.mesh.cell_diameter(*cell) / self.mean_coefficient(*cell);
        let least = sides.iter().flatten().map(of_side).fold(f64::INFINITY, f64::min);
        let per_sum = least / (D as f64 * self.facet_measure(facet));
        let unit = per_sum * sign * sum;
        let mut distance = f64::INFINITY;
        for (k, (side, obstacle)) in sides.iter().zip(obstacles).enumerate() {
            let Some((side, obstacle)) = side.zip(obstacle) else { continue };
            let (on_facet, in_cell) = self.distances(function, side, obstacle);
            distance = distance.min(on_facet);
            let in_contact = fade(in_cell / (IN_CONTACT * unit));
            if in_contact > 0.0 {
                let of_obstacle = self.obstacle_flux(obstacle, side);
                let blend = |(flux, there): (&mut f64, f64)| *flux += in_contact * (there - *flux);
                normal[k].iter_mut().zip(of_obstacle).for_each(blend);
            }
        }
        let (jump, size) = self.sum_of_sides(facet, sides, &normal)?;
        let sum = sign * jump.iter().sum::<f64>();
        if sum <= NEGLIGIBLE * size {
            return Ok(None);
        }
        let unit = per_sum * sum;
        let mut share = fade(distance / (TOUCHES * unit));
        share *= (sum / (NEGLIGIBLE * size) - 1.0).min(1.0);
        // the force has one sign at all points; a jump that has not is none
        let (mean, mut values) = (sign * sum / D as f64, [0.0; 3]);
        values.iter_mut().zip(vertices_of::<D>(facet.1)).for_each(|(value, j)| *value = jump[j]);
        let of_one_sign = share_of_one_sign(mean, &values[..D]);
        share *= (2.0 * of_one_sign - 1.0).max(0.0);
        let mut densities = [0.0; 4];
        for j in vertices_of::<D>(facet.1) {
            let limited = mean + of_one_sign * (jump[j] - mean);
            // what is limited is zero but for rounding
            densities[j] = sign * share * (sign * limited).max(0.0);
        }
        let force = FacetForce { facet, other: sides[1], densities };
        Ok((share > 0.0).then_some(FluxJump { force, normal, jump, unit, share }))
    }

    /// The sum of the fluxes from the sides of a facet, on the boundary less the Neumann datum, at the vertices of the
    /// first cell, and the sum of their sizes.
    fn sum_of_sides(
        &self,
        facet: HalfFacet,
        sides: [Option<HalfFacet>; 2],
        normal: &[[f64; 4]; 2],
    ) -> Result<([f64; 4], f64), NoBound> {
        let (mut sums, mut size) = ([0.0; 4], 0.0);
        for (side, normal) in sides.iter().zip(normal) {
            let Some((cell, _)) = *side else { continue };
            for j in vertices_of::<D>(facet.1) {
                let vertex = self.mesh.cell(facet.0)[j];
                let flux = normal[self.mesh.number_in(cell, vertex)];
                sums[j] += flux;
                size += flux.abs();
            }
        }
        if sides[1].is_none() && self.problem.has_neumann_data() {
            let products = self.neumann_products_on(facet, self.group_of(facet), None)?;
            let moments = map_entries(products, |row| row.iter().sum());
            // by its mean or, for quadratics, by its linear part
            let of_datum = match self.degree {
                1 => [moments.iter().sum(); 4],
                _ => densities::<D>(&moments, facet.1),
            };
            for j in vertices_of::<D>(facet.1) {
                sums[j] -= of_datum[j];
                size += of_datum[j].abs();
            }
        }
        Ok((sums, size))
    }

    /// By facet of a cell its measure times `alpha grad v . n`, once or at the vertices of the cell.
    fn normal_fluxes(&self, function: &PrimalDualPair<D>, cell: usize, fluxes: &mut [f64]) {
        let geometry = self.mesh.geometry(cell);
        let gradients = self.gradients_at_vertices(function, cell);
        // |F| n = -D |K| grad lambda
        let scale = -(D as f64) * geometry.volume * self.alpha(cell);
        let per_facet = fluxes.len() / (D + 1);
        for (local, fluxes) in fluxes.chunks_exact_mut(per_facet).enumerate() {
            let along = self.tensor_times(cell, geometry.gradient(local)) * scale;
            fluxes.iter_mut().zip(&gradients).for_each(|(flux, g)| *flux = g.dot(&along));
        }
    }

    /// The largest distances of the function of a pair from an obstacle at the nodes of a facet and of its cell.
    pub(in crate::error_bound) fn distances(
        &self,
        function: &PrimalDualPair<D>,
        (cell, local): HalfFacet,
        obstacle: &Datum<D>,
    ) -> (f64, f64) {
        let corners = self.mesh.corners(cell);
        let (mut on_facet, mut in_cell) = (0.0_f64, 0.0_f64);
        for ([a, b], node) in self.pair_nodes(function, cell) {
            let x = (corners[a] + corners[b]) * 0.5;
            let distance = (function.function[node] - self.at(obstacle, cell, &x)).abs();
            in_cell = in_cell.max(distance);
            if local != a && local != b {
                on_facet = on_facet.max(distance);
            }
        }
        (on_facet, in_cell)
    }

    /// The measure of a facet times `alpha grad psi . n` of an obstacle, at the vertices of the cell; one number for all
    /// beside linears. By differences inside the cell, at points between vertices and the middle of the facet.
    fn obstacle_flux(&self, obstacle: &Datum<D>, (cell, local): HalfFacet) -> [f64; 4] {
        if obstacle.constant().is_some() {
            return [0.0; 4];
        }
        let geometry = self.mesh.geometry(cell);
        let normal = geometry.normal(local);
        // along `T n`, which leaves the cell as `n` does
        let conormal = self.tensor_times(cell, &normal);
        let scale = self.alpha(cell) * geometry.facet_measure(local);
        let corners = self.mesh.corners(cell);
        let middle = vertices_of::<D>(local).map(|j| corners[j]).sum::<Point<D>>() / D as f64;
        let step = STEP / (geometry.gradient(local).norm() * self.normal_component((cell, local)));
        let slope = |x: &Point<D>| {
            let at = |steps: f64| self.at(obstacle, cell, &(x - conormal * (steps * step)));
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

    /// Sets the values of the function of a pair to those of the obstacle at nodes of facets with a force, where they are
    /// equal but for rounding, and no Dirichlet datum holds: else the force would count times rounding.
    pub(in crate::error_bound) fn touch_under(
        &self,
        function: &mut PrimalDualPair<D>,
        has_dirichlet_datum: impl Fn(usize) -> bool,
    ) {
        let of_values = ROUNDING * largest(function.function.len(), |i| function.function[i].abs());
        let n_vertices = self.mesh.vertices().len();
        for force in &function.forces {
            let upper = usize::from(force.densities.iter().sum::<f64>() < 0.0);
            for (cell, local) in force.sides() {
                let obstacles = [&self.data.lower, &self.data.upper][upper];
                let Some(obstacle) = obstacles.of(self.mesh.region(cell)) else { continue };
                let rounding = of_values + ROUNDINGS * obstacle.rounding();
                let corners = self.mesh.corners(cell);
                let nodes: Vec<_> = self.pair_nodes_on(function, (cell, local)).collect();
                for ([a, b], node) in nodes {
                    let at = self.at(obstacle, cell, &((corners[a] + corners[b]) * 0.5));
                    let value = &mut function.function[node];
                    let is_fixed = node < n_vertices && has_dirichlet_datum(node);
                    if !is_fixed && (*value - at).abs() <= rounding {
                        *value = at;
                    }
                }
            }
        }
    }
}
