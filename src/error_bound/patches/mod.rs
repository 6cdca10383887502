//! The flux of a conforming linear function: on the cells around each vertex, the smallest that makes
//! normal components single-valued and balances load and multiplier.
//!
//! With `phi` the hat function of the vertex, the part of the flux on its patch has in each cell the
//! integral `int c u phi - int f phi - lambda |K| / |patch|` over the boundary of the cell, on each facet at
//! the vertex jumps that cancel `1/D` of those of `alpha grad u . n`, and no flux through the facets
//! opposite the vertex. The equation of the vertex is the condition of solvability. In the plane the cells
//! around the vertex form a fan, along which balance and jumps determine all fluxes by the first one: see `fan`.
//!
//! Source: P. Destuynder, B. Métivet, Math. Comp. 68 (1999), 1379-1396; D. Braess, J. Schöberl, Math.
//! Comp. 77 (2008), 651-672.

mod data;
mod fan;
#[cfg(test)]
mod tests;

use std::convert::Infallible;
use std::ops::Range;

use data::{CELLS_AT_A_TIME, Corners, Patches};
pub(super) use data::{Corner, around};
use nalgebra::{SMatrix, SVector};

use super::NoBound;
use super::contact::NodeForce;
use crate::arrays::tabulate;
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::memory::in_large_pages;
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::parallel::cells;
use crate::real::{Point, Real, point_f64};

/// Pivots up to this share of the diagonal are zero: in a patch without Dirichlet facets multipliers are
/// determined up to a constant.
const ZERO_PIVOT: f64 = 1e-11;

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The fluxes of a conforming linear function, without those of Neumann data and contact, which are
    /// balanced all the same.
    pub(in crate::error_bound) fn patch_fluxes(
        &self,
        u: &[T],
        of_solver: (&[f64], &ActiveObstacles),
        forces: &[NodeForce],
        neighbours: &Neighbours,
    ) -> Result<Vec<f64>, NoBound> {
        self.fluxes_by_ranges(CELLS_AT_A_TIME, self.patches(u, of_solver, forces, neighbours)?)
    }

    /// The fluxes, with the parts of `length` cells at a time.
    fn fluxes_by_ranges(
        &self,
        length: usize,
        mut patches: Patches<'_, '_, T, D>,
    ) -> Result<Vec<f64>, NoBound> {
        let mut flux = in_large_pages(Vec::with_capacity(self.mesh.n_cells() * (D + 1)));
        let mut corners = None;
        for (cells, mut vertices) in self.ranges_with_vertices(length) {
            patches.keep(cells.clone());
            if D == 2 {
                vertices = patches.add_fans(&vertices);
            }
            if !vertices.is_empty() {
                patches.add_vertices(&vertices, corners.get_or_insert_with(|| self.corners()));
            }
            let start = flux.len();
            flux.resize(cells.end * (D + 1), 0.0);
            let fill = |range: Range<usize>, flux: &mut [f64]| {
                for (k, flux) in range.zip(flux.chunks_exact_mut(D + 1)) {
                    let cell = cells.start + k;
                    flux.copy_from_slice(patches.normals(cell));
                    for own in 0..=D as u8 {
                        for (k, local) in around::<D>(own).enumerate() {
                            flux[local] += patches.get((cell, own), k);
                        }
                    }
                }
                Ok::<(), Infallible>(())
            };
            let Ok(()) = cells::for_each(cells.len(), &|c| c * (D + 1), &mut flux[start..], &fill);
        }
        Ok(flux)
    }
}

/// What is known of the flux through a facet of a cell at the vertex of a patch.
#[derive(Clone, Copy)]
enum FacetOfPatch {
    /// The sum of the fluxes out of both cells; its Lagrange multiplier has this number.
    Interior(usize),
    /// Nothing.
    Free,
    /// The flux.
    Fixed(f64),
}

/// A cell of a patch: the fluxes of smallest norm through its facets at the vertex, as an affine function of
/// their Lagrange multipliers.
struct CellOfPatch {
    facets: [FacetOfPatch; 3],
    /// Minus the derivative of the fluxes with respect to the multipliers.
    slopes: SMatrix<f64, 3, 3>,
    /// The fluxes for multipliers that vanish.
    fluxes: SVector<f64, 3>,
}

/// The arrays of one patch.
#[derive(Default)]
struct Patch {
    cells: Vec<CellOfPatch>,
    /// The upper triangle of the matrix of the multipliers by rows.
    matrix: Vec<f64>,
    /// What the fluxes of two cells have too much, then the multipliers.
    multipliers: Vec<f64>,
    /// The sums of the two fluxes; less the first of them once it is known.
    sums: Vec<f64>,
}

impl<T: Real, const D: usize> Patches<'_, '_, T, D> {
    /// Sets the parts of those of these vertices of the plane whose cells form one fan, and returns the others.
    fn add_fans(&self, vertices: &[u32]) -> Vec<u32> {
        let others = cells::map(vertices.len(), &|range: Range<usize>| {
            let mut fan = Vec::new();
            let is_other = |&&v: &&u32| !self.add_fan(v as usize, &mut fan);
            vertices[range].iter().filter(is_other).copied().collect::<Vec<_>>()
        });
        others.concat()
    }

    /// Sets the parts of these vertices, given the cells around every vertex.
    fn add_vertices(&self, vertices: &[u32], (corners, starts): &Corners) {
        cells::map(vertices.len(), &|range: Range<usize>| {
            let mut patch = Patch::default();
            for vertex in vertices[range].iter().map(|&v| v as usize) {
                let around = starts[vertex] as usize..starts[vertex + 1] as usize;
                self.add_vertex(vertex, &corners[around], &mut patch);
            }
        });
    }

    /// Sets the part of a vertex: for each cell around it the fluxes through the facets there.
    ///
    /// The fluxes of each cell are eliminated: the multipliers of the facets between cells remain.
    fn add_vertex(&self, vertex: usize, corners: &[Corner], patch: &mut Patch) {
        let carried = |corner: &Corner| self.carried(corner.cell() as usize, corner.own());
        let total: f64 = corners.iter().map(carried).sum();
        let pressure = self.multipliers[vertex] / total;
        let Patch { cells, matrix, multipliers, sums } = patch;
        cells.clear();
        multipliers.clear();
        for (k, (cell, own)) in corners.iter().map(|corner| corner.pair()).enumerate() {
            let mut facets = [FacetOfPatch::Fixed(0.0); 3];
            for (slot, local) in facets.iter_mut().zip(around::<D>(own)) {
                *slot = self.facet_of_patch((cell, local), k, corners, (cells, multipliers));
            }
            let load = self.load(cell as usize, own, pressure);
            cells.push(self.cell_of_patch((cell, own), facets, load));
        }
        let n = multipliers.len();
        sums.clear();
        sums.extend(multipliers.iter().map(|excess| -excess));
        matrix.clear();
        matrix.resize(n * n, 0.0);
        for CellOfPatch { facets, slopes, fluxes } in &*cells {
            for (a, facet) in facets.iter().enumerate() {
                let &FacetOfPatch::Interior(i) = facet else { continue };
                multipliers[i] += fluxes[a];
                for (b, other) in facets.iter().enumerate() {
                    if let &FacetOfPatch::Interior(j) = other
                        && i <= j
                    {
                        matrix[i * n + j] += slopes[(a, b)];
                    }
                }
            }
        }
        solve(matrix, multipliers, n);
        // the second cell of a facet takes the rest of the sum: sides agree to rounding
        let mut n_known = 0;
        for (corner, of) in corners.iter().zip(&*cells) {
            let multiplier = |a: usize| match of.facets[a] {
                FacetOfPatch::Interior(i) => multipliers[i],
                _ => 0.0,
            };
            let fluxes = of.fluxes - of.slopes * SVector::from_fn(|a, _| multiplier(a));
            for (k, (facet, &flux)) in of.facets[..D].iter().zip(fluxes.iter()).enumerate() {
                let flux = match *facet {
                    FacetOfPatch::Interior(i) if i < n_known => sums[i],
                    FacetOfPatch::Interior(i) => {
                        n_known += 1;
                        sums[i] -= flux;
                        flux
                    }
                    _ => flux,
                };
                self.set((corner.cell() as usize, corner.own()), k, flux);
            }
        }
    }

    /// What is known of the flux through a facet of cell `k` of a patch. The first cell of an interior facet
    /// adds its multiplier, with minus the sum of the two fluxes.
    fn facet_of_patch(
        &self,
        (cell, local): (u32, usize),
        k: usize,
        corners: &[Corner],
        (cells, multipliers): (&[CellOfPatch], &mut Vec<f64>),
    ) -> FacetOfPatch {
        let normal = self.normals(cell as usize)[local];
        match self.neighbours.across(cell as usize, local) {
            Neighbour::Cell { cell: other, local: there } => {
                let there = usize::from(there);
                let position = corners.binary_search_by_key(&other, |corner| corner.cell());
                match position.ok().filter(|&l| l < k) {
                    Some(l) => {
                        let slot = around::<D>(corners[l].own()).position(|local| local == there);
                        slot.map_or(FacetOfPatch::Free, |slot| cells[l].facets[slot])
                    }
                    None => {
                        let jump = normal + self.normals(other as usize)[there];
                        multipliers.push(jump / D as f64);
                        FacetOfPatch::Interior(multipliers.len() - 1)
                    }
                }
            }
            Neighbour::Boundary(BoundaryPart::Dirichlet) => FacetOfPatch::Free,
            Neighbour::Boundary(_) | Neighbour::Cut => FacetOfPatch::Fixed(-normal / D as f64),
        }
    }

    /// Minimises the norm of the fluxes of a cell whose sum is `load`.
    fn cell_of_patch(
        &self,
        (cell, own): (u32, u8),
        facets: [FacetOfPatch; 3],
        load: f64,
    ) -> CellOfPatch {
        let is_free = |facet: &FacetOfPatch| !matches!(facet, FacetOfPatch::Fixed(_));
        match D == 3 && facets.iter().all(is_free) {
            true => self.free_cell_of_patch((cell, own), facets, load),
            false => self.any_cell_of_patch((cell, own), facets, load),
        }
    }

    /// A cell in which fluxes may be fixed.
    fn any_cell_of_patch(
        &self,
        (cell, own): (u32, u8),
        facets: [FacetOfPatch; 3],
        load: f64,
    ) -> CellOfPatch {
        let mesh = self.space.mesh;
        let products = facet_products::<D>(
            mesh.cell(cell as usize).iter().map(|&v| point_f64(&mesh.vertices()[v as usize])),
            self.volume(cell as usize) * self.space.alpha(cell as usize).to_f64(),
        );
        let mut locals = [0; 3];
        locals.iter_mut().zip(around::<D>(own)).for_each(|(to, local)| *to = local);
        let fixed = facets.map(|facet| match facet {
            FacetOfPatch::Fixed(flux) => Some(flux),
            _ => None,
        });
        // fixed facets, and those that a dimension does not have, leave the identity
        let mut norm = SMatrix::<f64, 3, 3>::identity();
        let mut force = SVector::<f64, 3>::zeros();
        let mut rest = load;
        for a in 0..3 {
            rest -= fixed[a].unwrap_or(0.0);
            for b in 0..3 {
                let product = products[locals[a]][locals[b]];
                match (fixed[a], fixed[b]) {
                    (None, None) => norm[(a, b)] = product,
                    (None, Some(flux)) => force[a] -= product * flux,
                    _ => {}
                }
            }
        }
        let is_free = SVector::<f64, 3>::from_fn(|a, _| f64::from(u8::from(fixed[a].is_none())));
        let free = SMatrix::from_diagonal(&is_free);
        let inverse = free * norm.try_inverse().unwrap_or_default() * free;
        // the flux that a unit of the balance adds
        let unit = inverse * is_free;
        let sum = unit.sum();
        let (slopes, unit) = match sum > 0.0 {
            true => (inverse - unit * unit.transpose() / sum, unit / sum),
            false => (inverse, unit),
        };
        let known = SVector::from_fn(|a, _| fixed[a].unwrap_or(0.0));
        CellOfPatch { facets, slopes, fluxes: slopes * force + unit * rest + known }
    }

    /// A cell in space whose three facets at the vertex have fluxes that are not fixed, in closed form.
    ///
    /// With `a_F` opposite the facet `F` and `V` the volume, fluxes `f_F` have in the cell the vector field
    /// `(x sum f_F - sum f_F a_F) / (3 V)`. A sum of zero leaves the constant field with `v = sum f_F a_F` along the
    /// facet of the three points `a_F`, and `f_F = grad lambda_F . v` with barycentric coordinates of this facet:
    /// the slopes are `9 alpha V` times the products of these gradients. With a sum of one the norm is least where
    /// `sum f_F a_F` is the point of the plane of the facet that is nearest to the barycentre of the cell.
    fn free_cell_of_patch(
        &self,
        (cell, own): (u32, u8),
        facets: [FacetOfPatch; 3],
        load: f64,
    ) -> CellOfPatch {
        let corners = self.space.mesh.corners(cell as usize);
        let mut others = [Point::<f64, D>::zeros(); 3];
        others.iter_mut().zip(around::<D>(own)).for_each(|(to, k)| *to = corners[k]);
        let [a, b, c] = others;
        let (one, two, from) = (a - c, b - c, corners[usize::from(own)] - c);
        let (g11, g12, g22) = (one.norm_squared(), one.dot(&two), two.norm_squared());
        let scale = 1.0 / (g11 * g22 - g12 * g12);
        let (aa, ab, bb) = (g22 * scale, -g12 * scale, g11 * scale);
        let (ac, bc) = (-aa - ab, -ab - bb);
        let factor = 9.0 * self.volume(cell as usize) * self.space.alpha(cell as usize).to_f64();
        let slopes = SMatrix::<f64, 3, 3>::new(aa, ab, ac, ab, bb, bc, ac, bc, -ac - bc) * factor;
        // two barycentric coordinates of the point of the plane nearest to the vertex
        let (along_one, along_two) = (one.dot(&from), two.dot(&from));
        let (of_a, of_b) = (aa * along_one + ab * along_two, ab * along_one + bb * along_two);
        let unit = SVector::<f64, 3>::new(1.0 + of_a, 1.0 + of_b, 2.0 - of_a - of_b) * 0.25;
        CellOfPatch { facets, slopes, fluxes: unit * load }
    }
}

/// The products in L2, over a coefficient, of the functions of Raviart and Thomas in a cell that have the
/// flux one through a facet each: `(x - a_F) / (D |K|)`.
fn facet_products<const D: usize>(
    corners: impl Iterator<Item = Point<f64, D>>,
    volume_by_coefficient: f64,
) -> [[f64; 4]; 4] {
    let mut points = [Point::<f64, D>::zeros(); 4];
    points.iter_mut().zip(corners).for_each(|(to, from)| *to = from);
    let middle = points.iter().sum::<Point<f64, D>>() / (D + 1) as f64;
    let from_middle = points.map(|p| p - middle);
    let squares: f64 = from_middle.iter().take(D + 1).map(|p| p.norm_squared()).sum();
    let variance = squares / ((D + 1) * (D + 2)) as f64;
    let scale = 1.0 / ((D * D) as f64 * volume_by_coefficient);
    tabulate(|a| tabulate(|b| scale * (from_middle[a].dot(&from_middle[b]) + variance)))
}

/// Solves with a symmetric matrix, given by the upper triangle of its rows, by elimination in place. It is
/// positive semidefinite in the first `n_positive` unknowns; what remains for the others once these are
/// eliminated is negative semidefinite. Where a pivot is zero but for rounding, the unknown is zero.
pub(in crate::error_bound) fn solve(a: &mut [f64], x: &mut [f64], n_positive: usize) {
    let n = x.len();
    for k in 0..n {
        if k == 0 || k == n_positive {
            // the lower triangle is free: its first column keeps the diagonal
            (k.max(1)..n).for_each(|i| a[i * n] = a[i * n + i].abs());
        }
        let (above, below) = a.split_at_mut((k + 1) * n);
        let row = &mut above[k * n..];
        if row[k].abs() <= ZERO_PIVOT * row[0].abs() {
            row[k] = 0.0;
            continue;
        }
        for (i, lower) in (k + 1..).zip(below.chunks_exact_mut(n)) {
            let factor = row[i] / row[k];
            // patches are sparse
            if factor != 0.0 {
                x[i] -= factor * x[k];
                lower[i..].iter_mut().zip(&row[i..]).for_each(|(to, from)| *to -= factor * from);
            }
        }
    }
    for (k, row) in a.chunks_exact(n.max(1)).enumerate().rev() {
        let sum: f64 = row[k + 1..].iter().zip(&x[k + 1..]).map(|(a, x)| a * x).sum();
        x[k] = if row[k] != 0.0 { (x[k] - sum) / row[k] } else { 0.0 };
    }
}
