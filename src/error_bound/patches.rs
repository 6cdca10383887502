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

use super::NoBound;
use super::contact::NodeForce;
use crate::assemble::space::Space;
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::parallel::cells;
use crate::real::{Point, Real, point_f64};

/// Pivots up to this share of the diagonal are zero: in a patch without Dirichlet facets the balance of
/// one cell follows from those of the others.
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
        for (facet, value) in parts.into_iter().flatten() {
            flux[facet] += value;
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
        let (n_cells, n_vertices) = (self.mesh.n_cells(), self.mesh.vertices().len());
        let mut normal = vec![0.0; n_cells * (D + 1)];
        let mut loads = normal.clone();
        for cell in 0..n_cells {
            let metric = self.metric(cell);
            let values = self.local_values(cell, u);
            let alpha = self.alpha(cell).to_f64();
            let residual = self.cell_residual(cell, u, &load);
            for i in 0..=D {
                let product = |j: usize| metric.products[i][j].to_f64() * (values[j] - values[0]);
                let stiffness = alpha * (1..=D).map(product).sum::<f64>();
                // |F| n = -D |K| grad lambda
                normal[cell * (D + 1) + i] = -(D as f64) * stiffness;
                loads[cell * (D + 1) + i] = residual[i] - stiffness;
            }
        }
        let mut multipliers: Vec<f64> = residual.iter().map(|r| -r).collect();
        for (cell, local) in self.facets_of(BoundaryPart::Dirichlet) {
            self.mesh.facet_vertices(cell, local).for_each(|v| multipliers[v as usize] = 0.0);
        }
        for force in forces {
            loads[force.cell * (D + 1) + force.node] -= force.value;
            multipliers[self.dofs.of(force.cell, force.node)] -= force.value;
        }
        let mut starts = vec![0; n_vertices + 1];
        self.mesh.cells().iter().for_each(|&v| starts[v as usize + 1] += 1);
        (0..n_vertices).for_each(|v| starts[v + 1] += starts[v]);
        let mut next = starts.clone();
        let mut corners = vec![(0, 0); self.mesh.cells().len()];
        for (k, &v) in self.mesh.cells().iter().enumerate() {
            corners[next[v as usize]] = ((k / (D + 1)) as u32, (k % (D + 1)) as u8);
            next[v as usize] += 1;
        }
        let neighbours = Neighbours::new(self.mesh);
        Ok(Patches { space: self, neighbours, normal, loads, multipliers, corners, starts })
    }
}

/// The arrays of one patch.
#[derive(Default)]
struct Patch {
    /// For each cell and each of its facets the unknown with its sign, if there is one.
    unknowns: Vec<[Option<(usize, f64)>; 4]>,
    /// For each cell the known part of the fluxes through its facets.
    known: Vec<[f64; 4]>,
    /// The matrix of the norm on the unknowns, then its Cholesky factor; by rows.
    norm: Vec<f64>,
    /// Minus the derivative of the norm at the known part, then the solution.
    force: Vec<f64>,
    /// By cell, the balance as a functional of the unknowns, then times the inverse of the factor.
    balances: Vec<f64>,
    /// The Schur complement of the norm.
    schur: Vec<f64>,
    /// What is left to balance in each cell.
    rest: Vec<f64>,
}

impl<T: Real, const D: usize> Patches<'_, '_, T, D> {
    /// Adds the part of a vertex to a list of facets and fluxes.
    fn add_vertex(&self, vertex: usize, patch: &mut Patch, part: &mut Vec<(usize, f64)>) {
        let corners = &self.corners[self.starts[vertex]..self.starts[vertex + 1]];
        let n_cells = corners.len();
        let degree = D as f64;
        let position = |cell: u32| corners.binary_search_by_key(&cell, |&(c, _)| c).ok();
        patch.unknowns.clear();
        patch.unknowns.resize(n_cells, [None; 4]);
        patch.known.clear();
        patch.known.resize(n_cells, [0.0; 4]);
        let mut n = 0;
        for (k, &(cell, own)) in corners.iter().enumerate() {
            for local in (0..=D).filter(|&local| local != usize::from(own)) {
                let normal = self.normal[cell as usize * (D + 1) + local];
                match self.neighbours.across(cell as usize, local) {
                    Neighbour::Cell { cell: other, local: there } => {
                        let Some(l) = position(other).filter(|&l| l > k) else { continue };
                        let there = usize::from(there);
                        let jump = normal + self.normal[other as usize * (D + 1) + there];
                        patch.unknowns[k][local] = Some((n, 1.0));
                        patch.unknowns[l][there] = Some((n, -1.0));
                        patch.known[k][local] = -0.5 * jump / degree;
                        patch.known[l][there] = -0.5 * jump / degree;
                        n += 1;
                    }
                    Neighbour::Boundary(BoundaryPart::Dirichlet) => {
                        patch.unknowns[k][local] = Some((n, 1.0));
                        n += 1;
                    }
                    Neighbour::Boundary(_) => patch.known[k][local] = -normal / degree,
                }
            }
        }
        self.fill(vertex, corners, n, patch);
        patch.solve(n, n_cells);
        for (k, &(cell, own)) in corners.iter().enumerate() {
            for local in (0..=D).filter(|&local| local != usize::from(own)) {
                let unknown = patch.unknowns[k][local];
                let value = unknown.map_or(0.0, |(i, sign)| sign * patch.force[i]);
                part.push((cell as usize * (D + 1) + local, patch.known[k][local] + value));
            }
        }
    }

    /// Norm and balances of a patch.
    fn fill(&self, vertex: usize, corners: &[(u32, u8)], n: usize, patch: &mut Patch) {
        let mesh = self.space.mesh;
        patch.norm.clear();
        patch.norm.resize(n * n, 0.0);
        patch.force.clear();
        patch.force.resize(n, 0.0);
        patch.balances.clear();
        patch.balances.resize(corners.len() * n, 0.0);
        patch.rest.clear();
        let volume = |cell: u32| self.space.metric(cell as usize).volume.to_f64();
        let total: f64 = corners.iter().map(|&(cell, _)| volume(cell)).sum();
        for (k, &(cell, own)) in corners.iter().enumerate() {
            let volume = volume(cell);
            let products = facet_products::<D>(
                mesh.cell(cell as usize).iter().map(|&v| point_f64(&mesh.vertices()[v as usize])),
                volume * self.space.alpha(cell as usize).to_f64(),
            );
            let (unknowns, known) = (&patch.unknowns[k], &patch.known[k]);
            for (a, row) in products.iter().enumerate().take(D + 1) {
                let Some((i, sign)) = unknowns[a] else { continue };
                patch.balances[k * n + i] += sign;
                for (b, &product) in row.iter().enumerate().take(D + 1) {
                    patch.force[i] -= sign * product * known[b];
                    if let Some((j, other)) = unknowns[b] {
                        patch.norm[i * n + j] += sign * other * product;
                    }
                }
            }
            let load = self.loads[cell as usize * (D + 1) + usize::from(own)];
            let pressed = self.multipliers[vertex] * volume / total;
            patch.rest.push(load - pressed - known.iter().sum::<f64>());
        }
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
    std::array::from_fn(|a| {
        std::array::from_fn(|b| scale * (from_middle[a].dot(&from_middle[b]) + variance))
    })
}

impl Patch {
    /// Minimises the norm under the balances: `norm x = force + balances^T y`, `balances x = rest`. The
    /// solution takes the place of `force`.
    fn solve(&mut self, n: usize, n_cells: usize) {
        factor(&mut self.norm, n);
        // x = inv(L^T) (inv(L) force + W^T y) with W = balances inv(L^T)
        forward(&self.norm, n, &mut self.force);
        for row in self.balances.chunks_exact_mut(n.max(1)) {
            forward(&self.norm, n, row);
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let rows = |k: usize| k * n..(k + 1) * n;
        self.schur.clear();
        for k in 0..n_cells {
            for l in 0..n_cells {
                self.schur.push(dot(&self.balances[rows(k)], &self.balances[rows(l)]));
            }
            self.rest[k] -= dot(&self.balances[rows(k)], &self.force);
        }
        factor(&mut self.schur, n_cells);
        forward(&self.schur, n_cells, &mut self.rest);
        backward(&self.schur, n_cells, &mut self.rest);
        for (k, &y) in self.rest.iter().enumerate() {
            let row = &self.balances[k * n..(k + 1) * n];
            self.force.iter_mut().zip(row).for_each(|(x, w)| *x += y * w);
        }
        backward(&self.norm, n, &mut self.force);
    }
}

/// The Cholesky factor of a matrix by rows, in place of its lower triangle; a pivot that is zero but for
/// rounding has the number zero on the diagonal, and its unknown is zero.
fn factor(a: &mut [f64], n: usize) {
    for i in 0..n {
        let size = a[i * n + i];
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| a[i * n + k] * a[j * n + k]).sum();
            let value = a[i * n + j] - sum;
            let pivot = a[j * n + j];
            a[i * n + j] = match i == j {
                true if value > ZERO_PIVOT * size => value.sqrt(),
                false if pivot > 0.0 => value / pivot,
                _ => 0.0,
            };
        }
    }
}

/// Solves with the lower triangle.
fn forward(a: &[f64], n: usize, x: &mut [f64]) {
    for i in 0..n {
        let sum: f64 = (0..i).map(|k| a[i * n + k] * x[k]).sum();
        let pivot = a[i * n + i];
        x[i] = if pivot > 0.0 { (x[i] - sum) / pivot } else { 0.0 };
    }
}

/// Solves with the transpose of the lower triangle.
fn backward(a: &[f64], n: usize, x: &mut [f64]) {
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| a[k * n + i] * x[k]).sum();
        let pivot = a[i * n + i];
        x[i] = if pivot > 0.0 { (x[i] - sum) / pivot } else { 0.0 };
    }
}
