//! The data of cells for patches of linears: a flux has one number on each facet, its integral there.

use std::convert::Infallible;
use std::ops::Range;

use super::corners::Corner;
use super::patch_cells::{CellProblem, PatchCells};
use super::pressing::Pressing;
use crate::arrays::array_of;
use crate::assemble::shared_rows::places::for_each_place;
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::error_bound::NoBound;
use crate::error_bound::contact_forces::NodeForce;
use crate::memory::in_large_pages;
use crate::mesh::{BoundaryCondition, Neighbours};
use crate::parallel::cells;
use crate::real::Point;

/// The cells of a conforming linear function.
pub(super) struct LinearCells<'s, 'a, const D: usize> {
    pub space: &'s Space<'a, D>,
    pub neighbours: &'s Neighbours,
    /// By cell its volume and the integrals of `alpha grad u . n` over its facets.
    cells: Vec<f64>,
    /// By cell for each of its vertices minus the load that the flux of the vertex balances, without multipliers of
    /// obstacles.
    loads: Vec<f64>,
    /// By vertex the multiplier of obstacles, which cells carry by their volume.
    pub multipliers: Vec<f64>,
    /// In which cells multipliers act.
    obstacles: &'s ActiveObstacles,
    /// The forces of obstacles on facets, with the multipliers by cell and vertex.
    pressing: Option<(&'s Pressing, &'s [f64])>,
    /// Of each vertex one of its cells, and how many there are; empty on the line.
    pub one_cell: Vec<(u32, u32)>,
}

/// How many numbers are known of a cell before its patches are.
const fn known_of_cell(dimension: usize) -> usize {
    dimension + 2
}

impl<const D: usize> Space<'_, D> {
    /// The cells of a conforming linear function.
    pub(super) fn linear_cells<'s>(
        &'s self,
        u: &[f64],
        (residual, obstacles): (&[f64], &'s ActiveObstacles),
        (forces, pressing): (&[NodeForce], Option<(&'s Pressing, &'s [f64])>),
        neighbours: &'s Neighbours,
    ) -> Result<LinearCells<'s, 's, D>, NoBound> {
        let mut loads = self.load_by_cell()?.into_owned();
        let n_cells = self.mesh.n_cells();
        let stride = known_of_cell(D);
        let mut data = in_large_pages(vec![0.0; n_cells * stride]);
        let fill = |cells: Range<usize>, out: &mut [f64]| {
            for (cell, data) in cells.zip(out.chunks_exact_mut(stride)) {
                let (volume, products) = self.shape(cell, 1.0);
                let values = self.local_values(cell, u);
                let alpha = self.alpha(cell);
                data[0] = volume;
                for i in 0..=D {
                    let product = |j: usize| products[i][j] * (values[j] - values[0]);
                    // |F| n = -D |K| grad lambda
                    data[1 + i] = -(D as f64) * alpha * (1..=D).map(product).sum::<f64>();
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c * stride, &mut data, &fill);
        // without sources the list is empty
        loads.resize(n_cells * (D + 1), 0.0);
        if self.reaction.is_some() {
            let subtract = |cells: Range<usize>, out: &mut [f64]| {
                for (cell, loads) in cells.zip(out.chunks_exact_mut(D + 1)) {
                    let values = self.local_values(cell, u);
                    let volume = data[cell * stride];
                    let of_cell = self.reaction_less_load(cell, volume, &values, &[]);
                    loads.iter_mut().zip(of_cell).for_each(|(load, reaction)| *load -= reaction);
                }
                Ok::<(), Infallible>(())
            };
            let Ok(()) = cells::for_each(n_cells, &|c| c * (D + 1), &mut loads, &subtract);
        }
        for force in forces {
            loads[force.cell * (D + 1) + force.node] += force.value;
        }
        let on_facets = pressing.iter().flat_map(|(p, _)| &p.jumps).map(|jump| &jump.force);
        for force in on_facets.filter(|force| force.other.is_none()) {
            let of_cell = &mut loads[force.facet.0 * (D + 1)..];
            of_cell.iter_mut().zip(force.moments::<D>()).for_each(|(load, moment)| *load += moment);
        }
        let mut multipliers = self.multipliers_of_obstacles(residual, forces);
        for (cell, local) in self.facets_of(BoundaryCondition::Dirichlet) {
            self.mesh.facet_vertices(cell, local).for_each(|v| multipliers[v as usize] = 0.0);
        }
        let mut one_cell = vec![(0, 0); if D > 1 { self.mesh.vertices().len() } else { 0 }];
        if D > 1 {
            // unknowns are the values at vertices
            let Ok(()) = for_each_place::<D, _, _>(&self.dofs, &mut one_cell, |one, (cell, _)| {
                *one = (cell as u32, one.1 + 1);
                Ok::<(), Infallible>(())
            });
        }
        let cells = data;
        Ok(LinearCells {
            space: self,
            neighbours,
            cells,
            loads,
            multipliers,
            obstacles,
            pressing,
            one_cell,
        })
    }
}

impl<const D: usize> LinearCells<'_, '_, D> {
    pub fn volume(&self, cell: usize) -> f64 {
        self.cells[cell * known_of_cell(D)]
    }

    /// The integrals of `alpha grad u . n` over the facets of a cell.
    pub fn integrals(&self, cell: usize) -> &[f64] {
        &self.cells[cell * known_of_cell(D) + 1..][..D + 1]
    }

    /// The number of a vertex in one of its cells.
    #[inline(always)]
    pub fn number_in(&self, cell: usize, vertex: u32) -> u8 {
        // a search that ends early has branches that slow the loop over patches
        let numbers = self.space.mesh.cell(cell).iter().zip(0_u8..);
        let number = |found, (&v, k): (&u32, u8)| if v == vertex { k } else { found };
        let found = numbers.fold(u8::MAX, number);
        debug_assert_ne!(found, u8::MAX, "the cell has the vertex");
        found
    }

    /// The load that the flux of a vertex balances in a cell, with a multiplier per volume.
    pub fn load(&self, corner: Corner, pressure: f64) -> f64 {
        let own = -self.loads[corner.cell() * (D + 1) + corner.own()];
        own - pressure * self.carried(corner) + self.moved(corner)
    }

    /// What has moved to facets of the multiplier of a cell at a vertex.
    #[inline(always)]
    fn moved(&self, corner: Corner) -> f64 {
        let Some((pressing, multipliers)) = self.pressing else { return 0.0 };
        let tested = |cell: usize, own: usize| [multipliers[cell * (D + 1) + own], 0.0, 0.0, 0.0];
        pressing.moved_at(self.space.mesh, &tested, (corner.cell(), corner.own()))[0]
    }

    /// The integral of `alpha grad u . n` over a facet of a cell; from the first side of a facet with a force between two
    /// cells, less the force.
    #[inline(always)]
    pub fn through(&self, cell: usize, local: usize) -> f64 {
        let force = self.pressing.and_then(|(p, _)| p.on_facet((cell, local)));
        let force = force.filter(|force| force.other.is_some());
        let less = force.map_or(0.0, |force| force.moments::<D>().iter().sum());
        self.integrals(cell)[local] - less
    }

    /// The volume over which a cell carries a share of the multiplier of one of its vertices: its own, or none where
    /// another obstacle than that of the cell gives the active bound.
    pub fn carried(&self, corner: Corner) -> f64 {
        match self.obstacles.act_in(corner.cell(), corner.own()) {
            true => self.volume(corner.cell()),
            false => 0.0,
        }
    }
}

impl<const D: usize> PatchCells<D, 3> for LinearCells<'_, '_, D> {
    const DEGREE: usize = 0;

    fn normals(&self, cell: usize, numbers: &mut [f64]) {
        numbers.copy_from_slice(self.integrals(cell));
    }

    fn normal(&self, corner: Corner, facet: usize) -> [f64; 3] {
        [self.through(corner.cell(), facet) / D as f64, 0.0, 0.0]
    }

    /// Fluxes with the sum zero are constants along the facet opposite the vertex: their products are
    /// `D^2 alpha |K| grad_a . grad_b`, the gradients within the facet of its barycentric coordinates. Orthogonal to
    /// them are `x` less the barycentre and the constant across the facet.
    fn problem(&self, corner: Corner, corners: &[Corner]) -> CellProblem<3> {
        let (cell, own, d) = (corner.cell(), corner.own(), D as f64);
        let (_, products) = self.space.shape(cell, 1.0);
        let vertex = self.space.mesh.cell(cell)[own] as usize;
        let carried: f64 = corners.iter().map(|corner| self.carried(*corner)).sum();
        let mean = self.load(corner, self.multipliers[vertex] / carried) / (d + 1.0);
        let across = products[own].map(|product| -product / products[own][own]);
        let scale = d * d * self.space.alpha(cell) * self.volume(cell);
        let points = self.space.isotropic_corners(cell);
        let mut facet = [Point::zeros(); 3];
        facet.iter_mut().zip(corner.facets::<D>()).for_each(|(corner, a)| *corner = points[a]);
        let within = products_within(&facet);
        let mut problem = CellProblem { slopes: [[0.0; 3]; 3], numbers: [0.0; 3] };
        for (k, a) in corner.facets::<D>().enumerate() {
            problem.numbers[k] = mean * (1.0 + across[a]);
            problem.slopes[k] = within[k].map(|product| scale * product);
        }
        problem
    }
}

/// The products of the gradients of barycentric coordinates of a facet with these corners, within the facet: from its
/// edges, so that nothing cancels in stretched cells. A point has no gradient.
fn products_within<const D: usize>(corners: &[Point<D>; 3]) -> [[f64; 3]; 3] {
    // opposite each corner, in the sense of rotation
    let edges: [Point<D>; 3] = match D {
        2 => [corners[1] - corners[0], corners[0] - corners[1], Point::zeros()],
        3 => array_of(|k| corners[(k + 2) % 3] - corners[(k + 1) % 3]),
        _ => return [[0.0; 3]; 3],
    };
    let minor = |i: usize, j: usize| edges[0][i] * edges[1][j] - edges[0][j] * edges[1][i];
    let scale = match D {
        2 => edges[0].norm_squared().powi(2),
        _ => minor(0, 1).powi(2) + minor(1, 2).powi(2) + minor(2, 0).powi(2),
    };
    array_of(|a| array_of(|b| edges[a].dot(&edges[b]) / scale))
}
