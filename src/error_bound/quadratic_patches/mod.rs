//! The flux of a conforming quadratic function: on the cells around each vertex, the smallest that makes
//! normal components single-valued and balances load and multiplier tested with linear functions.
//!
//! With `phi` the hat function of the vertex, the part of the flux has in each cell `K` of the patch the divergence
//! `g(w) = a_K(u, phi w) - l_K(phi w) - int_dK alpha grad u . n phi w` tested with linear `w`, `l_K` load and
//! multiplier; on each facet at the vertex the jumps have the products of minus those of `phi alpha grad u . n` with
//! linear functions; facets opposite the vertex have no flux. In the notation of [`quadratics`](super::quadratics) the
//! unknowns are the `c_Fj` of the facets at the vertex, and
//!
//! ```text
//! q = sum c_Fj lambda_j (a_j - a_F) / (D |K|) + sum_j r_j lambda_j phi_j
//! ```
//!
//! with numbers `r_j` that the divergence tells. One condition for each cell is left, the mean of the
//! divergence; the equation of the vertex is the condition of solvability.
//!
//! Source: D. Braess, J. Schöberl, Math. Comp. 77 (2008), 651-672; D. Braess, V. Pillwein, J. Schöberl, Comput.
//! Methods Appl. Mech. Engrg. 198 (2009), 1189-1197.
//!
//! | file | content |
//! |---|---|
//! | `mod` | the flux: parts of all vertices added up |
//! | `cell_data` | what is known of a cell before its patches are |
//! | `patch` | the part of a vertex |

mod cell_data;
mod patch;

use std::ops::Range;

use super::PrimalDualPair;
use super::patches::around;
use super::quadratics::{CellLoads, Products, vertices_of};
use crate::assemble::space::{Place, Space};
use crate::mesh::{BoundaryPart, Neighbours};
use crate::parallel::cells;
use crate::real::Real;
use patch::{OfFacets, Patch, Patches};

/// Sorts products by the places of their facets. Not in the function that calls it, so that this is
/// compiled once.
fn sort(given: &mut [&(Place, Products)]) {
    given.sort_unstable_by_key(|(place, _)| *place);
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The densities `c_Fj` of a conforming quadratic function, without those of Neumann data and contact.
    pub(super) fn quadratic_patch_fluxes(
        &self,
        (u, function): (&[T], &PrimalDualPair),
        neighbours: &Neighbours,
        loads: &mut CellLoads,
    ) -> Vec<f64> {
        let (corners, starts) = self.corners();
        let cells = self.patch_data((u, function), neighbours, loads);
        let mut given: Vec<_> = loads.neumann.iter().chain(&loads.contact).collect();
        sort(&mut given);
        let patches = Patches { space: self, neighbours, cells, given, corners, starts };
        let square = (D + 1) * (D + 1);
        let mut flux = Vec::with_capacity(self.mesh.n_cells() * square);
        for cell in &patches.cells {
            cell.normal[..=D].iter().for_each(|normal| flux.extend_from_slice(&normal[..=D]));
        }
        // parts are added in the order of vertices, so the result does not depend on threads
        let parts = cells::map(self.mesh.vertices().len(), &|vertices: Range<usize>| {
            let mut parts: Vec<OfFacets> = Vec::new();
            let mut patch = Patch::default();
            vertices.for_each(|vertex| patches.add_vertex(vertex, &mut patch, &mut parts));
            parts
        });
        for (corner, part) in patches.corners.iter().zip(parts.iter().flatten()) {
            for (facet, part) in around::<D>(corner.own()).zip(part) {
                let start = corner.cell() as usize * square + facet * (D + 1);
                vertices_of::<D>(facet).zip(part).for_each(|(j, part)| flux[start + j] += part);
            }
        }
        for f in self.mesh.boundary().iter().filter(|f| f.part != BoundaryPart::Dirichlet) {
            let start = f.cell as usize * square + usize::from(f.local) * (D + 1);
            flux[start..=start + D].fill(0.0);
        }
        flux
    }
}
