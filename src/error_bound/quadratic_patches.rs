//! The flux of a conforming quadratic function: on the cells around each vertex, the smallest that makes
//! normal components single-valued and balances load and multiplier tested with linear functions.
//!
//! With `phi` the hat function of the vertex, the part of the flux has in each cell `K` of the patch the
//! divergence `g(w) = a_K(u, phi w) - l_K(phi w) - int_dK alpha grad u . n phi w` tested with linear `w`, `l_K` load and multiplier;
//! on each facet at the vertex the jumps have the products of minus those of `phi alpha grad u . n` with
//! linear functions; facets opposite the vertex have no flux. In the notation of
//! [`quadratics`](super::quadratics) the unknowns are the `c_Fj` of the facets at the vertex, and
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

use std::convert::Infallible;
use std::ops::Range;

use super::PrimalDualPair;
use super::patches::{around, solve};
use super::quadratics::{
    CellLoads, Products, add, densities, products_on_facet, triple, vertices_of,
};
use super::shared_multipliers::SharedNodes;
use crate::arrays::tabulate;
use crate::assemble::local::StiffnessTable;
use crate::assemble::space::tables::BasisAt;
use crate::assemble::space::{INWARD, Place, Space};
use crate::element::Node;
use crate::measure::Admissible;
use crate::mesh::{BoundaryPart, Neighbour, Neighbours, edge_vertices};
use crate::parallel::cells;
use crate::real::{Point, Real};

/// Numbers for each vertex of a facet at the vertex of a patch, for each of these facets.
type OfFacets = [[f64; 3]; 3];

/// What is known of a cell before its patches are.
#[derive(Clone, Default)]
struct CellData {
    /// By facet the densities of `alpha grad u . n`.
    normal: Products,
    /// The gradient of the admissible function less that of the discrete function, at the vertices.
    difference: [[f64; 3]; 4],
    /// The stiffness term of each unknown.
    stiffness: [f64; 10],
    /// By vertex of the patch the divergence tested with the barycentric coordinates.
    divergence: Products,
}

impl CellData {
    /// The densities of the part of a vertex of a facet, `phi alpha grad u . n`.
    fn part<const D: usize>(&self, facet: usize, vertex: usize) -> [f64; 4] {
        densities::<D>(&products_on_facet::<D>(&self.normal[facet], facet)[vertex], facet)
    }
}

/// Sorts products by the places of their facets. Not in the function that calls it, so that this is
/// compiled once.
fn sort(given: &mut [&(Place, Products)]) {
    given.sort_unstable_by_key(|(place, _)| *place);
}

/// What the patches read.
struct Patches<'s, 'a, T: Real, const D: usize> {
    space: &'s Space<'a, T, D>,
    neighbours: &'s Neighbours,
    cells: Vec<CellData>,
    /// The products of Neumann data and contact forces, by facet; sorted.
    given: Vec<&'s (Place, Products)>,
    corners: Vec<(u32, u8)>,
    starts: Vec<usize>,
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
        for (&(cell, own), part) in patches.corners.iter().zip(parts.iter().flatten()) {
            for (facet, part) in around::<D>(own).zip(part) {
                let start = cell as usize * square + facet * (D + 1);
                vertices_of::<D>(facet).zip(part).for_each(|(j, part)| flux[start + j] += part);
            }
        }
        for f in self.mesh.boundary().iter().filter(|f| f.part != BoundaryPart::Dirichlet) {
            let start = f.cell as usize * square + usize::from(f.local) * (D + 1);
            flux[start..=start + D].fill(0.0);
        }
        flux
    }

    fn patch_data(
        &self,
        (u, function): (&[T], &PrimalDualPair),
        neighbours: &Neighbours,
        loads: &mut CellLoads,
    ) -> Vec<CellData> {
        let corners: Vec<BasisAt<f64>> =
            (0..D + 1).map(|k| self.basis_at(&Node::vertex(k).centre(D))).collect();
        let (table, n_cells) = (self.stiffness_table(), self.mesh.n_cells());
        let data = cells::map(n_cells, &|cells: Range<usize>| {
            let in_cell = |cell| self.patch_data_in(cell, (u, function), (&corners, &table));
            cells.map(in_cell).collect::<Vec<_>>()
        });
        let mut data: Vec<CellData> = data.into_iter().flatten().collect();
        if let Some(shared) = loads.shared.as_ref().filter(|s| s.surrounded.contains(&true)) {
            self.divide_multipliers(&data, neighbours, shared, &mut loads.values);
        }
        let loads = &*loads;
        let n = self.per_cell();
        let fill = |cells: Range<usize>, out: &mut [CellData]| {
            for (cell, data) in cells.zip(out) {
                for (i, of_linear) in loads.functionals.iter().enumerate() {
                    let left = data.stiffness[i] - loads.values[cell * n + i];
                    add(&mut data.divergence, |a, j| left * of_linear[a][j]);
                }
                for facet in 0..=D {
                    let products = products_on_facet::<D>(&data.normal[facet], facet);
                    add(&mut data.divergence, |a, j| -products[a][j]);
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c, &mut data, &fill);
        for ((cell, _), products) in &loads.neumann {
            add(&mut data[*cell].divergence, |a, j| products[a][j]);
        }
        data
    }

    /// Divides the multipliers of unknowns amid contact among their cells as the mean of the two fluxes
    /// through each facet balances them, since the function is there as smooth as the obstacle.
    fn divide_multipliers(
        &self,
        data: &[CellData],
        neighbours: &Neighbours,
        shared: &SharedNodes,
        values: &mut [f64],
    ) {
        let n = self.per_cell();
        let is_surrounded = |k: usize| shared.surrounded[shared.numbers[k] as usize];
        let fill = |cells: Range<usize>, out: &mut [f64]| {
            for (cell, out) in cells.zip(out.chunks_exact_mut(n)) {
                if !(0..n).any(|i| is_surrounded(cell * n + i)) {
                    continue;
                }
                let mut balance = data[cell].stiffness;
                for facet in 0..=D {
                    let mut flux = data[cell].normal[facet];
                    if let Neighbour::Cell { cell: other, local } = neighbours.across(cell, facet) {
                        let local = usize::from(local);
                        let across = &data[other as usize].normal[local];
                        let pairs = vertices_of::<D>(facet).zip(vertices_of::<D>(local));
                        pairs.for_each(|(j, there)| flux[j] = 0.5 * (flux[j] - across[there]));
                    }
                    let products = products_on_facet::<D>(&flux, facet);
                    for a in 0..=D {
                        let hat: f64 = products[a].iter().sum();
                        balance[a] -= 2.0 * products[a][a] - hat;
                    }
                    for (balance, &[a, b]) in balance[D + 1..].iter_mut().zip(edge_vertices(D)) {
                        *balance -= 4.0 * products[a][b];
                    }
                }
                for (i, out) in out.iter_mut().enumerate() {
                    if is_surrounded(cell * n + i) {
                        *out = balance[i];
                    }
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(self.mesh.n_cells(), &|c| c * n, values, &fill);
    }

    /// The data of a cell, without divergence.
    fn patch_data_in(
        &self,
        cell: usize,
        (u, function): (&[T], &PrimalDualPair),
        (corners, table): (&[BasisAt<f64>], &StiffnessTable<T>),
    ) -> CellData {
        let n = self.per_cell();
        let metric = self.metric(cell);
        let local = self.local_values(cell, u);
        let alpha = self.alpha(cell);
        let varying = self.varying_in(cell);
        let mut data = CellData::default();
        let admissible = Admissible { bounds: [None, None], ..self.admissible_in(function, cell) };
        for (k, basis) in corners.iter().enumerate() {
            let slope = |m: usize| -> f64 {
                local.iter().zip(&basis.derivatives).take(n).map(|(u, d)| u * d[m]).sum()
            };
            let slopes: [f64; 4] = tabulate(|m| if m <= D { slope(m) } else { 0.0 });
            let vertex = Node::vertex(k).centre(D);
            let (_, mut difference) = admissible.at(&vertex, &Point::zeros());
            for (gradient, slope) in admissible.gradients.iter().zip(&slopes) {
                difference -= gradient * *slope;
            }
            data.difference[k][..D].copy_from_slice(difference.as_slice());
            let coefficient = match varying {
                None => alpha.to_f64(),
                Some(_) => {
                    let inward = |b: f64| b + (1.0 / (D + 1) as f64 - b) * INWARD;
                    let point = Node::vertex(k).centre(D).map(inward);
                    self.alpha_at(cell, &self.cell_point(&point, cell))
                }
            };
            for facet in vertices_of::<D>(k) {
                // |F| n = -D |K| grad lambda
                let products = metric.products[facet].iter().zip(&slopes);
                let sum: f64 = products.map(|(p, slope)| p.to_f64() * slope).sum();
                data.normal[facet][k] = -(D as f64) * coefficient * sum;
            }
        }
        for (i, term) in data.stiffness.iter_mut().enumerate().take(n) {
            for (j, value) in local.iter().enumerate().take(n) {
                let entry = match varying {
                    None => alpha * table.entry::<D>(&metric, i, j),
                    Some((varying, values)) => varying.stiffness::<D>(values, &metric, i, j),
                };
                *term += entry.to_f64() * value;
            }
        }
        data
    }
}

/// The densities of a facet of a patch at its vertices: a sign times unknowns, plus a shift.
#[derive(Clone, Copy, Debug)]
struct Slot {
    /// The first of the unknowns.
    first: usize,
    /// Zero where nothing is unknown.
    sign: f64,
    shift: [f64; 3],
}

/// The arrays of one patch.
#[derive(Default)]
struct Patch {
    /// By cell the facets at the vertex.
    slots: Vec<[Slot; 3]>,
    /// The upper triangle of the matrix by rows: densities, then a multiplier for each cell.
    matrix: Vec<f64>,
    unknowns: Vec<f64>,
}

impl<T: Real, const D: usize> Patches<'_, '_, T, D> {
    /// Adds the part of a vertex to a list: for each cell around it the densities of the facets there.
    fn add_vertex(&self, vertex: usize, patch: &mut Patch, parts: &mut Vec<OfFacets>) {
        let corners = &self.corners[self.starts[vertex]..self.starts[vertex + 1]];
        let Patch { slots, matrix, unknowns } = patch;
        let mut n_free = 0;
        slots.clear();
        for (k, &(cell, own)) in corners.iter().enumerate() {
            let mut of_cell = [Slot { first: 0, sign: 0.0, shift: [0.0; 3] }; 3];
            for (slot, local) in of_cell.iter_mut().zip(around::<D>(own)) {
                *slot = self.slot((cell, own, local), corners, &slots[..k], &mut n_free);
            }
            slots.push(of_cell);
        }
        let n = n_free + corners.len();
        matrix.clear();
        matrix.resize(n * n, 0.0);
        unknowns.clear();
        unknowns.resize(n, 0.0);
        for (k, (&corner, slots)) in corners.iter().zip(&*slots).enumerate() {
            self.add_cell(corner, slots, n_free + k, (matrix, unknowns));
        }
        solve(matrix, unknowns, n_free);
        for slots in slots {
            let density = |slot: &Slot, p: usize| match slot.sign {
                0.0 => slot.shift[p],
                sign => sign * unknowns[slot.first + p] + slot.shift[p],
            };
            let of_facet = |slot: &Slot| tabulate(|p| if p < D { density(slot, p) } else { 0.0 });
            parts.push(slots.each_ref().map(of_facet));
        }
    }

    /// What is known of a facet of a cell: of an interior one the first cell of the patch has the unknowns.
    fn slot(
        &self,
        (cell, own, local): (u32, u8, usize),
        corners: &[(u32, u8)],
        slots: &[[Slot; 3]],
        n_free: &mut usize,
    ) -> Slot {
        let on_facet = |densities: &[f64; 4], local: usize| {
            let mut of_vertices = [0.0; 3];
            let vertices = vertices_of::<D>(local);
            of_vertices.iter_mut().zip(vertices).for_each(|(to, j)| *to = densities[j]);
            of_vertices
        };
        let place = (cell as usize, local);
        let normal = on_facet(&self.cells[place.0].part::<D>(local, usize::from(own)), local);
        let mut free = || {
            *n_free += D;
            Slot { first: *n_free - D, sign: 1.0, shift: [0.0; 3] }
        };
        match self.neighbours.across(place.0, local) {
            Neighbour::Cell { cell: other, local: there } => {
                let there = usize::from(there);
                let position = corners.binary_search_by_key(&other, |&(cell, _)| cell);
                let Some(known) = position.ok().filter(|&l| l < slots.len()) else { return free() };
                let own = corners[known].1;
                let across = self.cells[other as usize].part::<D>(there, usize::from(own));
                let across = on_facet(&across, there);
                let slot = around::<D>(own).position(|local| local == there).unwrap_or(0);
                let first = slots[known][slot].first;
                let shift = tabulate(|p| -normal[p] - across[p]);
                Slot { first, sign: -1.0, shift }
            }
            Neighbour::Boundary(BoundaryPart::Dirichlet) => free(),
            Neighbour::Boundary(_) | Neighbour::Cut => {
                let given = self.given.binary_search_by_key(&place, |(place, _)| *place);
                let given = given.map_or([0.0; 3], |k| {
                    let products = &self.given[k].1[usize::from(own)];
                    on_facet(&densities::<D>(products, local), local)
                });
                let shift = tabulate(|p| given[p] - normal[p]);
                Slot { first: 0, sign: 0.0, shift }
            }
        }
    }

    /// Adds the square of the norm of a cell to the matrix, and its balance in the row of this number.
    fn add_cell(
        &self,
        (cell, own): (u32, u8),
        slots: &[Slot; 3],
        row: usize,
        (matrix, unknowns): (&mut [f64], &mut [f64]),
    ) {
        let (mesh, n, d) = (self.space.mesh, unknowns.len(), D as f64);
        let points = mesh.corners(cell as usize);
        let sum: Point<f64, D> = points[..=D].iter().sum();
        let volume = mesh.geometry(cell as usize).volume.to_f64();
        let alpha = self.space.alpha(cell as usize).to_f64();
        let scale = 1.0 / (alpha * volume * d * d * (d + 1.0) * (d + 2.0));
        let tested = &self.cells[cell as usize].divergence[usize::from(own)];
        let total: f64 = tested[..=D].iter().sum();
        // the products of sum_j r_j lambda_j phi_j with lambda_k times a vector
        let products: [Point<f64, D>; 4] = tabulate(|k| {
            let mut product = Point::zeros();
            for j in 0..=D {
                let inner = d * ((d + 2.0) * tested[j] - total);
                let weight = if j == k { 2.0 } else { 1.0 } * inner / (d + 3.0);
                product += (sum - points[j] * (d + 2.0) + points[k]) * weight;
            }
            product
        });
        // the products of what the part aims at, phi times the difference of gradients, with the same functions
        let differences = &self.cells[cell as usize].difference;
        let targets: [Point<f64, D>; 4] = tabulate(|j| {
            let mut target = Point::zeros();
            for (k, difference) in differences.iter().enumerate().take(D + 1) {
                let product = triple(D, [j, usize::from(own), k]) / d;
                target += Point::from_fn(|axis, _| product * difference[axis]);
            }
            target
        });
        let mut balance = total;
        let densities = || {
            let of_facet =
                |(slot, facet)| vertices_of::<D>(facet).enumerate().map(move |v| (slot, facet, v));
            slots.iter().zip(around::<D>(own)).flat_map(of_facet)
        };
        for (slot, facet, (p, j)) in densities() {
            let along = points[j] - points[facet];
            balance -= slot.shift[p] / d;
            if slot.sign == 0.0 {
                continue;
            }
            let unknown = slot.first + p;
            let mut force = scale * products[j].dot(&along) - targets[j].dot(&along);
            for (other, facet, (q, k)) in densities() {
                let weight = if j == k { 2.0 } else { 1.0 } * scale;
                let product = weight * along.dot(&(points[k] - points[facet]));
                force += product * other.shift[q];
                if other.sign != 0.0 && unknown <= other.first + q {
                    matrix[unknown * n + other.first + q] += slot.sign * other.sign * product;
                }
            }
            unknowns[unknown] -= slot.sign * force;
            matrix[unknown * n + row] += slot.sign / d;
        }
        unknowns[row] += balance;
    }
}
