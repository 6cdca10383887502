//! Which forces on facets the multipliers around their vertices have.

use super::corners::Corners;
use crate::assemble::space::Space;
use crate::error_bound::facet_forces::{FacetForce, FluxJump, fade};
use crate::error_bound::{NoBound, PrimalDualPair};
use crate::mesh::{HalfFacet, Mesh, Neighbours};

/// Where the multiplier of cells that are not in contact is more than this many times what jumps, it is a function there;
/// where all multipliers are as much less, the jump is an error of the discrete solution. Both fade.
const MOST: f64 = 2.0;

/// Cells at this distance from the obstacle, in the largest unit of the jumps at a vertex, do not touch; nearer ones in part.
const OPEN: f64 = 1e-3;

/// The products `(mu, phi lambda_j)` of the multiplier of a cell with the hat function of one of its vertices and all
/// barycentric coordinates, by cell and vertex. For linears their sum alone counts.
pub(in crate::error_bound) type Tested<'t> = &'t (dyn Fn(usize, usize) -> [f64; 4] + Sync);

/// The forces on facets, and what moves of the multipliers around them.
pub(in crate::error_bound) struct Pressing {
    /// The jumps with their forces, facets in ascending order.
    pub(super) jumps: Vec<FluxJump>,
    pub(super) corners: Corners,
    /// The vertices of facets with a force.
    pub(super) vertices: Vec<usize>,
    /// By vertex the share of the multiplier that moves.
    shares: Vec<f64>,
}

impl Pressing {
    /// The force on a facet, by its first side.
    pub(super) fn on_facet(&self, facet: HalfFacet) -> Option<&FacetForce> {
        let place = self.jumps.binary_search_by_key(&facet, |jump| jump.force.facet);
        place.ok().map(|k| &self.jumps[k].force)
    }

    /// What moves of the multiplier of a cell at one of its vertices.
    pub(super) fn moved_at<const D: usize>(
        &self,
        mesh: &Mesh<D>,
        tested: Tested<'_>,
        (cell, own): (usize, usize),
    ) -> [f64; 4] {
        let share = self.shares[mesh.cell(cell)[own] as usize];
        match share == 0.0 {
            true => [0.0; 4],
            false => tested(cell, own).map(|product| share * product),
        }
    }

    /// By cell what has moved of the products of its multiplier with barycentric coordinates.
    pub fn moved_by_cell<const D: usize>(
        &self,
        mesh: &Mesh<D>,
        tested: Tested<'_>,
    ) -> Vec<[f64; 4]> {
        let mut moved = vec![[0.0; 4]; mesh.n_cells()];
        for corner in self.vertices.iter().flat_map(|&v| self.corners.at(v)) {
            let of_corner = self.moved_at(mesh, tested, (corner.cell(), corner.own()));
            let of_cell = &mut moved[corner.cell()];
            of_cell.iter_mut().zip(of_corner).for_each(|(sum, moved)| *sum += moved);
        }
        moved
    }
}

impl<const D: usize> Space<'_, D> {
    /// The forces on facets where the normal flux of the function of a pair jumps, as far as multipliers around the
    /// vertices of the facets have them: all multipliers of cells that do not touch everywhere, and of those of the others as
    /// much as the flux jumps. None if the flux does not jump, and on a part of a mesh. The pair gets the forces.
    pub(in crate::error_bound) fn pressing(
        &self,
        function: &mut PrimalDualPair<D>,
        (tested, presses): (Tested<'_>, &(dyn Fn(usize) -> bool + Sync)),
        neighbours: &Neighbours,
    ) -> Result<Option<Pressing>, NoBound> {
        if self.mesh.is_part() {
            return Ok(None);
        }
        let mut jumps = self.flux_jumps(function, neighbours, presses)?;
        if jumps.is_empty() {
            return Ok(None);
        }
        let corners = self.corners();
        let (of_jumps, units) = (self.forces_at_vertices(&jumps), self.units(&jumps));
        // the balance of a patch with a Dirichlet facet has no condition
        let has_dirichlet_facet = self.dirichlet_groups();
        let mut all_there = vec![0.0; of_jumps.len()];
        let mut ratios = vec![f64::INFINITY; of_jumps.len()];
        let mut factors = vec![1.0; of_jumps.len()];
        for v in (0..of_jumps.len()).filter(|&v| of_jumps[v] != 0.0) {
            let obstacles = [&self.data.lower, &self.data.upper][usize::from(of_jumps[v] < 0.0)];
            let (mut all, mut open) = (0.0, 0.0);
            for corner in corners.at(v) {
                let (cell, own) = (corner.cell(), corner.own());
                let of_cell: f64 = tested(cell, own).iter().sum();
                let obstacle = obstacles.of(self.mesh.region(cell));
                let open_share = obstacle.map_or(1.0, |obstacle| {
                    let (_, distance) = self.distances(function, (cell, own), obstacle);
                    (distance / (OPEN * units[v])).min(1.0)
                });
                all += of_cell;
                open += open_share * of_cell;
            }
            all_there[v] = all;
            let (open, all) = (open / of_jumps[v], all / of_jumps[v]);
            factors[v] = fade(open / (2.0 * MOST));
            if has_dirichlet_facet[v].is_none() {
                factors[v] *= (2.0 * (MOST * all - 1.0)).clamp(0.0, 1.0);
                ratios[v] = open.max(1.0).min(all);
            }
        }
        jumps.retain_mut(|FluxJump { force, share, .. }| {
            let vertices = || self.mesh.facet_vertices(force.facet.0, force.facet.1);
            let least =
                |of: &[f64]| vertices().map(|v| of[v as usize]).fold(f64::INFINITY, f64::min);
            let ratio = least(&ratios);
            let factor = least(&factors) * if ratio.is_finite() { ratio } else { 1.0 };
            *share *= factor;
            force.densities = force.densities.map(|density| factor * density);
            *share > 0.0
        });
        if jumps.is_empty() {
            return Ok(None);
        }
        let given = self.forces_at_vertices(&jumps);
        let share = |(given, there): (&f64, &f64)| match *given == 0.0 || *there == 0.0 {
            true => 0.0,
            false => (given / there).clamp(0.0, 1.0),
        };
        let shares = given.iter().zip(&all_there).map(share).collect();
        let vertices = (0..given.len()).filter(|&v| given[v] != 0.0).collect();
        function.forces = jumps.iter().map(|jump| jump.force).collect();
        self.touch_under(function, |v| has_dirichlet_facet[v].is_some());
        Ok(Some(Pressing { jumps, corners, vertices, shares }))
    }

    /// By vertex the integral of forces times its hat function.
    fn forces_at_vertices(&self, jumps: &[FluxJump]) -> Vec<f64> {
        let mut sums = vec![0.0; self.mesh.vertices().len()];
        for FluxJump { force, .. } in jumps {
            for (v, moment) in self.mesh.cell(force.facet.0).iter().zip(force.moments::<D>()) {
                sums[*v as usize] += moment;
            }
        }
        sums
    }

    /// By vertex the largest unit of the jumps on its facets.
    fn units(&self, jumps: &[FluxJump]) -> Vec<f64> {
        let mut units = vec![0.0_f64; self.mesh.vertices().len()];
        for FluxJump { force, unit, .. } in jumps {
            for v in self.mesh.facet_vertices(force.facet.0, force.facet.1) {
                units[v as usize] = units[v as usize].max(*unit);
            }
        }
        units
    }
}
