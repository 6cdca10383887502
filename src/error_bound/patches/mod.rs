//! The flux of a conforming function: `alpha grad u` in each cell and a flux around each vertex, the smallest that makes
//! normal components single-valued and balances load and multiplier.
//!
//! Let `phi` be the hat function of a vertex, its patch the cells around it, and `g = alpha grad u . n`. Its flux `p`
//! has for all `w` that are constant, for quadratics linear,
//!
//! ```text
//! (div p, w)_K = a_K(u, phi w) - l_K(phi w) - int_dK g phi w     in each cell K of the patch
//! int_F p.n w = - int_F g phi w, both summed over the two sides  on each facet F at the vertex
//! p.n = 0                                                        on the facets opposite the vertex
//! ```
//!
//! `l_K` load and multiplier of the cell. Among these `|alpha^-1/2 (p - phi alpha grad (v - u))|` is least, `v` the
//! admissible function; of linears `v` is `u` but for few values, and counts as `u`. The equation of the vertex is the
//! condition of solvability.
//!
//! `p` has in each cell numbers on the facets at the vertex ([`Flux`]): one on each for linears, one for each vertex of
//! a facet for quadratics, whose numbers inside the cell follow from the first line. What is left of that line is one
//! condition, with `w = 1`.
//!
//! Sources: P. Destuynder, B. Métivet, Math. Comp. 68 (1999), 1379-1396; D. Braess, J. Schöberl, Math. Comp. 77 (2008),
//! 651-672; D. Braess, V. Pillwein, J. Schöberl, Comput. Methods Appl. Mech. Engrg. 198 (2009), 1189-1197.
//!
//! | file | content |
//! |---|---|
//! | `mod` | the flux: that of all vertices added up |
//! | `patch` | the flux of a vertex, by least squares |
//! | `fan` | the flux of a vertex of linears in the plane, where all numbers follow from one |
//! | `link` | the flux of a vertex of linears in space, where all numbers follow from one for each edge |
//! | `patch_cells` | what patches ask of cells |
//! | `linear`, `quadratic` | the cells of linears and quadratics |
//! | `pressing`, `forces` | which forces facets have; a flux that carries multipliers of cells to facets |
//! | `corners`, `corner_fluxes` | the cells around each vertex, and the numbers there |

mod corner_fluxes;
mod corners;
mod fan;
mod forces;
mod linear;
mod link;
mod patch;
mod patch_cells;
mod pressing;
mod quadratic;

use std::convert::Infallible;
use std::ops::Range;

use corner_fluxes::CornerFluxes;
use corners::Corner;
use linear::LinearCells;
use link::Link;
use patch::Patch;
use patch_cells::PatchCells;
use pressing::Pressing;
use quadratic::KnownOfCell;

use super::NoBound;
use super::contact_forces::NodeForce;
use super::flux::Flux;
use super::quadratics::CellLoads;
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::mesh::{BoundaryCondition, Neighbours};
use crate::parallel::cells;

impl<const D: usize> Space<'_, D> {
    /// The flux of a conforming linear function, without that of Neumann data and contact, which are balanced all the
    /// same.
    pub(super) fn flux_of_linears(
        &self,
        u: &[f64],
        of_solver: (&[f64], &ActiveObstacles),
        forces: (&[NodeForce], Option<(&Pressing, &[f64])>),
        neighbours: &Neighbours,
    ) -> Result<Flux<D>, NoBound> {
        let cells = self.linear_cells(u, of_solver, forces, neighbours)?;
        let linear = (D > 1).then_some(&cells);
        Ok(self.flux_of_patches(&cells, linear, neighbours))
    }

    /// The flux of a conforming quadratic function, without that of Neumann data and contact, and without its numbers
    /// inside cells.
    pub(super) fn flux_of_quadratics(
        &self,
        known: Vec<KnownOfCell>,
        neighbours: &Neighbours,
        loads: &CellLoads,
        pressing: Option<&Pressing>,
    ) -> Flux<D> {
        self.flux_of_patches(&self.quadratic_cells(known, loads, pressing), None, neighbours)
    }

    /// The flux, from the fluxes of vertices; in the plane and in space most patches of linears need no least squares on
    /// facets.
    fn flux_of_patches<C: PatchCells<D, N>, const N: usize>(
        &self,
        of: &C,
        linear: Option<&LinearCells<'_, '_, D>>,
        neighbours: &Neighbours,
    ) -> Flux<D> {
        let n_cells = self.mesh.n_cells();
        let of_vertices = CornerFluxes::new(D * C::PER_FACET, D + 1, n_cells);
        let mut vertices: Vec<u32> = (0..self.mesh.vertices().len() as u32).collect();
        // fans and links know no tensors
        if let Some(of) = linear.filter(|_| !self.has_tensor()) {
            vertices = of.set_directly(&vertices, &of_vertices);
        }
        if !vertices.is_empty() {
            let corners = self.corners();
            cells::map(vertices.len(), &|range: Range<usize>| {
                let mut patch = Patch::default();
                for &v in &vertices[range] {
                    patch.solve(of, neighbours, corners.at(v as usize), |corner, k, number| {
                        of_vertices.set(corner, k, number);
                    });
                }
            });
        }
        let mut flux = Flux::zero(C::DEGREE, n_cells);
        let per_cell = flux.per_cell();
        let fill = |cells: Range<usize>, out: &mut [f64]| {
            for (cell, out) in cells.zip(out.chunks_exact_mut(per_cell)) {
                of.normals(cell, out);
                for corner in (0..=D).map(|own| Corner::new(cell, own)) {
                    for (f, facet) in corner.facets::<D>().enumerate() {
                        for p in 0..C::PER_FACET {
                            let number = of_vertices.get(corner, f * C::PER_FACET + p);
                            out[C::place(facet, p)] += number;
                        }
                    }
                }
            }
            Ok::<(), Infallible>(())
        };
        let numbers = flux.of_cells_mut(0..n_cells);
        let Ok(()) = cells::for_each(n_cells, &|c| c * per_cell, numbers, &fill);
        for f in self.mesh.boundary().iter().filter(|f| f.condition != BoundaryCondition::Dirichlet)
        {
            flux.set_zero_on(f.cell as usize, f.local.into());
        }
        flux
    }
}

impl<const D: usize> LinearCells<'_, '_, D> {
    /// Sets the fluxes of those of these vertices whose cells form one fan or whose link is a sphere or a disc, and
    /// returns the others.
    fn set_directly(&self, vertices: &[u32], fluxes: &CornerFluxes) -> Vec<u32> {
        let others = cells::map(vertices.len(), &|range: Range<usize>| {
            // a link is large
            let (mut fan, mut link) = (Vec::new(), (D > 2).then(Link::default));
            let set = |corner: Corner, k: usize, number: f64| fluxes.set(corner, k, number);
            let is_other = |&v: &u32| match &mut link {
                None => !self.set_fan(v as usize, &mut fan, set),
                Some(link) => !self.set_link(v as usize, link, set),
            };
            vertices[range].iter().copied().filter(is_other).collect::<Vec<_>>()
        });
        others.concat()
    }
}
