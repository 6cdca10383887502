//! The flux of a conforming linear function: on the cells around each vertex, the smallest that makes
//! normal components single-valued and balances load and multiplier.
//!
//! With `phi` the hat function of the vertex, the part of the flux on its patch has in each cell the
//! integral `int c u phi - int f phi - lambda |K| / |patch|` over the boundary of the cell, on each facet at
//! the vertex jumps that cancel `1/D` of those of `alpha grad u . n`, and no flux through the facets
//! opposite the vertex. The equation of the vertex is the condition of solvability.
//!
//! Source: P. Destuynder, B. Métivet, Math. Comp. 68 (1999), 1379-1396; D. Braess, J. Schöberl, Math.
//! Comp. 77 (2008), 651-672.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::NoBound;
use super::contact::NodeForce;
use crate::assemble::space::Space;
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::parallel::cells;
use crate::real::{Point, Real, point_f64};

/// Pivots up to this share of the diagonal are zero: in a patch without Dirichlet facets multipliers are
/// determined up to a constant.
const ZERO_PIVOT: f64 = 1e-11;

/// What the patches read.
struct Patches<'s, 'a, T: Real, const D: usize> {
    space: &'s Space<'a, T, D>,
    neighbours: Neighbours,
    /// The integrals of `alpha grad u . n` over the facets of each cell.
    normal: Vec<f64>,
    /// What the flux of each vertex of each cell balances there, without obstacles.
    loads: Vec<f64>,
    /// The multiplier of each vertex that belongs to obstacles.
    multipliers: Vec<f64>,
    /// The cells around each vertex with its number there, and where those of each vertex start.
    corners: Vec<(u32, u8)>,
    starts: Vec<usize>,
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The fluxes of a conforming linear function, without those of Neumann data and contact, which are
    /// balanced all the same.
    pub(super) fn patch_fluxes(
        &self,
        u: &[T],
        residual: &[f64],
        forces: &[NodeForce],
    ) -> Result<Vec<f64>, NoBound> {
        let patches = self.patches(u, residual, forces)?;
        let mut flux = patches.normal.clone();
        // parts are added in the order of vertices, so the result does not depend on threads
        let parts = cells::map(self.mesh.vertices().len(), &|vertices: Range<usize>| {
            let mut part = Vec::new();
            let mut patch = Patch::default();
            vertices.for_each(|vertex| patches.add_vertex(vertex, &mut patch, &mut part));
            part
        });
        let mut values = parts.into_iter().flatten();
        for &(cell, own) in &patches.corners {
            for (local, value) in around::<D>(own).zip(&mut values) {
                flux[cell as usize * (D + 1) + local] += value;
            }
        }
        Ok(flux)
    }

    fn patches(
        &self,
        u: &[T],
        residual: &[f64],
        forces: &[NodeForce],
    ) -> Result<Patches<'_, '_, T, D>, NoBound> {
        let load = self.load_by_cell()?;
        let n_cells = self.mesh.n_cells();
        let of_cells = cells::map(n_cells, &|cells: Range<usize>| {
            let mut pairs = Vec::with_capacity(cells.len() * (D + 1));
            for cell in cells {
                let metric = self.metric(cell);
                let values = self.local_values(cell, u);
                let alpha = self.alpha(cell).to_f64();
                let residual = self.cell_residual(cell, u, &load);
                for i in 0..=D {
                    let product =
                        |j: usize| metric.products[i][j].to_f64() * (values[j] - values[0]);
                    let stiffness = alpha * (1..=D).map(product).sum::<f64>();
                    // |F| n = -D |K| grad lambda
                    pairs.push((-(D as f64) * stiffness, residual[i] - stiffness));
                }
            }
            pairs
        });
        let (normal, mut loads): (Vec<f64>, Vec<f64>) = of_cells.into_iter().flatten().unzip();
        let mut multipliers: Vec<f64> = residual.iter().map(|r| -r).collect();
        for (cell, local) in self.facets_of(BoundaryPart::Dirichlet) {
            self.mesh.facet_vertices(cell, local).for_each(|v| multipliers[v as usize] = 0.0);
        }
        for force in forces {
            loads[force.cell * (D + 1) + force.node] -= force.value;
            multipliers[self.dofs.of(force.cell, force.node)] -= force.value;
        }
        let (corners, starts) = self.corners();
        let neighbours = Neighbours::new(self.mesh);
        Ok(Patches { space: self, neighbours, normal, loads, multipliers, corners, starts })
    }

    /// The cells around each vertex with its number there, and where those of each vertex start.
    pub(super) fn corners(&self) -> (Vec<(u32, u8)>, Vec<usize>) {
        let n_vertices = self.mesh.vertices().len();
        let mut starts = vec![0; n_vertices + 1];
        self.mesh.cells().iter().for_each(|&v| starts[v as usize + 1] += 1);
        (0..n_vertices).for_each(|v| starts[v + 1] += starts[v]);
        let mut next = starts.clone();
        let mut corners = vec![(0, 0); self.mesh.cells().len()];
        for (k, &v) in self.mesh.cells().iter().enumerate() {
            corners[next[v as usize]] = ((k / (D + 1)) as u32, (k % (D + 1)) as u8);
            next[v as usize] += 1;
        }
        (corners, starts)
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
    /// Adds the part of a vertex to a list: for each cell around it the fluxes through the facets there.
    ///
    /// The fluxes of each cell are eliminated: the multipliers of the facets between cells remain.
    fn add_vertex(&self, vertex: usize, patch: &mut Patch, part: &mut Vec<f64>) {
        let corners = &self.corners[self.starts[vertex]..self.starts[vertex + 1]];
        let Patch { cells, matrix, multipliers, sums } = patch;
        let volume = |cell: u32| self.space.metric(cell as usize).volume.to_f64();
        let total: f64 = corners.iter().map(|&(cell, _)| volume(cell)).sum();
        cells.clear();
        multipliers.clear();
        for (k, &(cell, own)) in corners.iter().enumerate() {
            let mut facets = [FacetOfPatch::Fixed(0.0); 3];
            for (slot, local) in facets.iter_mut().zip(around::<D>(own)) {
                *slot = self.facet_of_patch((cell, local), k, corners, (cells, multipliers));
            }
            let volume = volume(cell);
            let pressed = self.multipliers[vertex] * volume / total;
            let load = self.loads[cell as usize * (D + 1) + usize::from(own)] - pressed;
            cells.push(self.cell_of_patch((cell, own), volume, facets, load));
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
        for of in &*cells {
            let multiplier = |a: usize| match of.facets[a] {
                FacetOfPatch::Interior(i) => multipliers[i],
                _ => 0.0,
            };
            let fluxes = of.fluxes - of.slopes * SVector::from_fn(|a, _| multiplier(a));
            for (facet, &flux) in of.facets[..D].iter().zip(fluxes.iter()) {
                part.push(match *facet {
                    FacetOfPatch::Interior(i) if i < n_known => sums[i],
                    FacetOfPatch::Interior(i) => {
                        n_known += 1;
                        sums[i] -= flux;
                        flux
                    }
                    _ => flux,
                });
            }
        }
    }

    /// What is known of the flux through a facet of cell `k` of a patch. The first cell of an interior facet
    /// adds its multiplier, with minus the sum of the two fluxes.
    fn facet_of_patch(
        &self,
        (cell, local): (u32, usize),
        k: usize,
        corners: &[(u32, u8)],
        (cells, multipliers): (&[CellOfPatch], &mut Vec<f64>),
    ) -> FacetOfPatch {
        let normal = self.normal[cell as usize * (D + 1) + local];
        match self.neighbours.across(cell as usize, local) {
            Neighbour::Cell { cell: other, local: there } => {
                let there = usize::from(there);
                let position = corners.binary_search_by_key(&other, |&(cell, _)| cell);
                match position.ok().filter(|&l| l < k) {
                    Some(l) => {
                        let slot = around::<D>(corners[l].1).position(|local| local == there);
                        slot.map_or(FacetOfPatch::Free, |slot| cells[l].facets[slot])
                    }
                    None => {
                        let jump = normal + self.normal[other as usize * (D + 1) + there];
                        multipliers.push(jump / D as f64);
                        FacetOfPatch::Interior(multipliers.len() - 1)
                    }
                }
            }
            Neighbour::Boundary(BoundaryPart::Dirichlet) => FacetOfPatch::Free,
            Neighbour::Boundary(_) => FacetOfPatch::Fixed(-normal / D as f64),
        }
    }

    /// Minimises the norm of the fluxes of a cell whose sum is `load`.
    fn cell_of_patch(
        &self,
        (cell, own): (u32, u8),
        volume: f64,
        facets: [FacetOfPatch; 3],
        load: f64,
    ) -> CellOfPatch {
        let mesh = self.space.mesh;
        let products = facet_products::<D>(
            mesh.cell(cell as usize).iter().map(|&v| point_f64(&mesh.vertices()[v as usize])),
            volume * self.space.alpha(cell as usize).to_f64(),
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
}

/// The facets of a cell at one of its vertices.
pub(super) fn around<const D: usize>(vertex: u8) -> impl Iterator<Item = usize> {
    (0..=D).filter(move |&local| local != usize::from(vertex))
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
    std::array::from_fn(|a| {
        std::array::from_fn(|b| scale * (from_middle[a].dot(&from_middle[b]) + variance))
    })
}

/// Solves with a symmetric matrix, given by the upper triangle of its rows, by elimination in place. It is
/// positive semidefinite in the first `n_positive` unknowns; what remains for the others once these are
/// eliminated is negative semidefinite. Where a pivot is zero but for rounding, the unknown is zero.
pub(super) fn solve(a: &mut [f64], x: &mut [f64], n_positive: usize) {
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
