//! Multipliers of cells moved to facets, around each vertex of facets with a force.
//!
//! Of the multiplier `mu` of a cell, a share `theta` of `phi mu` moves, `phi` the hat function of the vertex. On the
//! facets of a force the flux becomes `alpha grad v . n` on both sides, as far as the force reaches; the rest is carried by a
//! flux `p` of the vertex. With `e` the change on the facets of the force, for all `w` that are constant, for quadratics
//! linear,
//!
//! ```text
//! (div p, w)_K = theta (mu, phi w)_K - int_dK e phi w     in each cell K of the patch
//! ```
//!
//! `p` has equal and opposite normal components on the sides of facets, and `|alpha^-1/2 (p - phi (alpha grad v - q))|` is
//! least. The patches of conforming functions have the forces as given jumps instead.

use super::corners::{Corner, Corners};
use super::patch::Patch;
use super::patch_cells::{CellProblem, PatchCells};
use super::pressing::{Pressing, Tested};
use super::quadratic::quadratic_problem;
use crate::arrays::array_of;
use crate::assemble::space::Space;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::facet_forces::FluxJump;
use crate::error_bound::quadratics::{products_on_facet, vertices_of};
use crate::mesh::{HalfFacet, Neighbours};
use crate::parallel::cells;
use crate::real::Point;

/// The cells around vertices of facets with a force.
struct ForceCells<'c, 'a, const D: usize> {
    space: &'c Space<'a, D>,
    pair: &'c PrimalDualPair<D>,
    pressing: &'c Pressing,
    tested: Tested<'c>,
    /// The changes of the flux on facets of a force, in ascending order of facets.
    changes: &'c [(HalfFacet, [f64; 4])],
}

impl<const D: usize> ForceCells<'_, '_, D> {
    /// The divergence of the flux of a vertex, tested with the barycentric coordinates.
    fn divergence(&self, corner: Corner) -> [f64; 4] {
        let at = (corner.cell(), corner.own());
        let mut tested = self.pressing.moved_at(self.space.mesh, self.tested, at);
        for facet in corner.facets::<D>() {
            let place = self.changes.binary_search_by_key(&(at.0, facet), |(place, _)| *place);
            if let Ok(k) = place {
                let products = products_on_facet::<D>(&self.changes[k].1, facet)[at.1];
                tested.iter_mut().zip(products).for_each(|(sum, product)| *sum -= product);
            }
        }
        tested
    }

    /// `grad v - q / alpha` at the vertices of a cell, in coordinates in which the coefficient has no direction.
    fn differences(&self, cell: usize) -> [Point<D>; 4] {
        let space = self.space;
        let gradients = space.gradients_at_vertices(self.pair, cell);
        let corners = space.isotropic_corners(cell);
        let scale = 1.0 / (D as f64 * space.mesh.geometry(cell).volume * space.alpha(cell));
        let at_vertex = |k: usize| {
            let through = (0..=D).map(|facet| {
                (corners[k] - corners[facet]) * self.pair.flux.density(cell, facet, k)
            });
            space.isotropic_gradient(cell, &gradients[k]) - through.sum::<Point<D>>() * scale
        };
        array_of(|k| if k <= D { at_vertex(k) } else { Point::zeros() })
    }
}

impl<const D: usize> PatchCells<D, 3> for ForceCells<'_, '_, D> {
    const DEGREE: usize = 0;

    /// With the barycentre `m` of the cell, its volume `V` and `n = D + 1`, the products of fluxes are
    /// `((m - a) . (m - b) + sum_k |a_k - m|^2 / (n (n + 1))) / (D^2 alpha V)`, and the mean of `x` with the weight `phi`
    /// is `(n m + a_own) / (n + 1)`.
    fn problem(&self, corner: Corner, _: &[Corner]) -> CellProblem<3> {
        let (cell, d, n) = (corner.cell(), D as f64, (D + 1) as f64);
        let points = self.space.isotropic_corners(cell);
        let middle = points[..=D].iter().sum::<Point<D>>() / n;
        let squares: f64 = points[..=D].iter().map(|x| (x - middle).norm_squared()).sum();
        let weighted = (middle * n + points[corner.own()]) / (n + 1.0);
        let at_middle = self.differences(cell)[..=D].iter().sum::<Point<D>>() / n;
        let mut opposite = [Point::<D>::zeros(); 3];
        opposite.iter_mut().zip(corner.facets::<D>()).for_each(|(point, f)| *point = points[f]);
        let scale = 1.0 / (d * d * self.space.alpha(cell) * self.space.mesh.geometry(cell).volume);
        let products = array_of(|a| {
            array_of(|b| {
                let along = (middle - opposite[a]).dot(&(middle - opposite[b]));
                scale * (along + squares / (n * (n + 1.0)))
            })
        });
        let aims = array_of(|a| (weighted - opposite[a]).dot(&at_middle) / (d * n));
        CellProblem::new(products, &aims, self.divergence(corner).iter().sum(), D)
    }
}

impl<const D: usize> PatchCells<D, 9> for ForceCells<'_, '_, D> {
    const DEGREE: usize = 1;

    fn problem(&self, corner: Corner, _: &[Corner]) -> CellProblem<9> {
        let mut differences = [[0.0; 3]; 4];
        let of_vertices = self.differences(corner.cell());
        for (to, difference) in differences.iter_mut().zip(&of_vertices).take(D + 1) {
            to[..D].copy_from_slice(difference.as_slice());
        }
        quadratic_problem(self.space, corner, &self.divergence(corner), &differences)
    }
}

impl<const D: usize> Space<'_, D> {
    /// Moves multipliers to facets in the flux of a pair, which has no jumps.
    pub(in crate::error_bound) fn move_to_facets(
        &self,
        pair: &mut PrimalDualPair<D>,
        pressing: &Pressing,
        tested: Tested<'_>,
        neighbours: &Neighbours,
    ) {
        let mut changes = Vec::new();
        for FluxJump { force, normal, jump, share, .. } in &pressing.jumps {
            let share = share.min(1.0);
            let n_sides = force.sides().count() as f64;
            for ((cell, local), normal) in force.sides().zip(normal) {
                let mut change = [0.0; 4];
                for j in vertices_of::<D>(local) {
                    let vertex = self.mesh.cell(cell)[j];
                    let place = self.mesh.number_in(force.facet.0, vertex);
                    // what the force has beside the share of the jump goes half to each side
                    let beside = force.densities[place] - share * jump[place];
                    change[j] = share * (normal[j] - pair.flux.density(cell, local, j));
                    change[j] += beside / n_sides;
                }
                changes.push(((cell, local), change));
            }
        }
        for ((cell, local), change) in &changes {
            pair.flux.add_densities(*cell, *local, change);
        }
        changes.sort_unstable_by_key(|(place, _)| *place);
        let changes = &changes[..];
        let of = ForceCells { space: self, pair, pressing, tested, changes };
        let vertices = (&pressing.vertices[..], &pressing.corners);
        let numbers = match pair.flux.degree() {
            0 => fluxes::<D, _, 3>(&of, neighbours, vertices),
            _ => fluxes::<D, _, 9>(&of, neighbours, vertices),
        };
        for (cell, place, number) in numbers {
            pair.flux.of_cell_mut(cell)[place] += number;
        }
    }
}

/// The fluxes of some vertices: cells, places among the numbers of a cell, and what is added there.
fn fluxes<const D: usize, C: PatchCells<D, N>, const N: usize>(
    of: &C,
    neighbours: &Neighbours,
    (vertices, corners): (&[usize], &Corners),
) -> Vec<(usize, usize, f64)> {
    let of_chunks = cells::map(vertices.len(), &|range| {
        let (mut patch, mut numbers) = (Patch::default(), Vec::new());
        for &v in &vertices[range] {
            patch.solve(of, neighbours, corners.at(v), |corner, k, number| {
                let facet = corner.facets::<D>().nth(k / C::PER_FACET);
                let facet = facet.expect("numbers are those of the facets at the vertex");
                numbers.push((corner.cell(), C::place(facet, k % C::PER_FACET), number));
            });
        }
        numbers
    });
    of_chunks.concat()
}
