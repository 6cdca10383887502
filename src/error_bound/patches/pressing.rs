//! Which forces on facets the multipliers around their vertices have.

use super::corners::Corners;
use crate::assemble::space::Space;
use crate::error_bound::facet_forces::{AskedForce, FacetForce};
use crate::error_bound::{NoBound, PrimalDualPair};
use crate::mesh::{HalfFacet, Mesh, Neighbours};

/// Where the multiplier of cells that are not in contact is more than this many times what facets ask for, it is a function
/// there; where all multipliers are as much less, what is asked for is an error of the discrete solution.
const MOST: f64 = 2.0;

/// The products `(mu, phi lambda_j)` of the multiplier of a cell with the hat function of one of its vertices and all
/// barycentric coordinates, by cell and vertex. For linears their sum alone counts.
pub(in crate::error_bound) type Tested<'t> = &'t (dyn Fn(usize, usize) -> [f64; 4] + Sync);

/// The forces on facets, and what moves of the multipliers around them.
pub(in crate::error_bound) struct Pressing {
    /// The forces, facets in ascending order.
    pub forces: Vec<AskedForce>,
    pub(super) corners: Corners,
    /// The vertices of facets with a force.
    pub(super) vertices: Vec<usize>,
    /// By vertex the share of the multiplier that moves.
    shares: Vec<f64>,
}

impl Pressing {
    /// What moves of the multiplier of a cell at one of its vertices.
    pub fn moved_at<const D: usize>(
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

    /// The force on a facet, by its first side.
    pub fn on_facet(&self, facet: HalfFacet) -> Option<&FacetForce> {
        let place = self.forces.binary_search_by_key(&facet, |asked| asked.force.facet);
        place.ok().map(|k| &self.forces[k].force)
    }
}

impl<const D: usize> Space<'_, D> {
    /// The forces on facets that the function of a pair asks for, as far as the multipliers around their vertices have
    /// them: all of what presses in cells that are not in contact everywhere, and of the others what is asked for. None
    /// if nothing presses on facets, and on a part of a mesh. The function takes them.
    pub(in crate::error_bound) fn pressing(
        &self,
        function: &mut PrimalDualPair<D>,
        (tested, presses): (Tested<'_>, &(dyn Fn(usize) -> bool + Sync)),
        neighbours: &Neighbours,
    ) -> Result<Option<Pressing>, NoBound> {
        if self.mesh.is_part() {
            return Ok(None);
        }
        let mut forces = self.asked_forces(function, neighbours, presses)?;
        if forces.is_empty() {
            return Ok(None);
        }
        let corners = self.corners();
        let asked = self.forces_at_vertices(&forces);
        let rounding = self.rounding_of(function);
        // the balance of a patch with a Dirichlet facet has no condition
        let is_free = self.dirichlet_groups();
        let mut there = vec![0.0; asked.len()];
        let mut ratios = vec![f64::INFINITY; asked.len()];
        for v in (0..asked.len()).filter(|&v| asked[v] != 0.0) {
            let (mut all, mut open) = (0.0, 0.0);
            for corner in corners.at(v) {
                let of_cell: f64 = tested(corner.cell(), corner.own()).iter().sum();
                let side = (usize::from(asked[v] < 0.0), rounding);
                all += of_cell;
                open +=
                    if self.is_in_contact(function, corner.cell(), side) { 0.0 } else { of_cell };
            }
            there[v] = all;
            let (open, all) = (open / asked[v], all / asked[v]);
            ratios[v] = match is_free[v] {
                _ if open > MOST || is_free[v].is_none() && all < 1.0 / MOST => 0.0,
                Some(_) => f64::INFINITY,
                None => open.max(1.0).min(all),
            };
        }
        forces.retain_mut(|AskedForce { force, share, .. }| {
            let (cell, local) = force.facet;
            let of_vertices = self.mesh.facet_vertices(cell, local).map(|v| ratios[v as usize]);
            let least = of_vertices.fold(f64::INFINITY, f64::min);
            *share = if least.is_finite() { least } else { 1.0 };
            force.densities = force.densities.map(|density| *share * density);
            *share > 0.0
        });
        if forces.is_empty() {
            return Ok(None);
        }
        let given = self.forces_at_vertices(&forces);
        let share = |(given, there): (&f64, &f64)| match *given == 0.0 || *there == 0.0 {
            true => 0.0,
            false => (given / there).clamp(0.0, 1.0),
        };
        let shares = given.iter().zip(&there).map(share).collect();
        self.touch_under(&forces, function);
        function.forces = forces.iter().map(|asked| asked.force).collect();
        let vertices = (0..given.len()).filter(|&v| given[v] != 0.0).collect();
        Ok(Some(Pressing { forces, corners, vertices, shares }))
    }

    /// By vertex the integral of forces times its hat function.
    fn forces_at_vertices(&self, forces: &[AskedForce]) -> Vec<f64> {
        let mut sums = vec![0.0; self.mesh.vertices().len()];
        for AskedForce { force, .. } in forces {
            for (v, moment) in self.mesh.cell(force.facet.0).iter().zip(force.moments::<D>()) {
                sums[*v as usize] += moment;
            }
        }
        sums
    }
}
