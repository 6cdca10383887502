//! The patch of a vertex: its facet densities are unknowns of a least squares problem with a balance for each cell.

use super::cell_data::CellData;
use crate::arrays::tabulate;
use crate::assemble::space::{Place, Space};
use crate::error_bound::patches::{Corner, around, solve};
use crate::error_bound::quadratics::{Products, densities, triple, vertices_of};
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::real::{Point, Real};

/// Numbers for each vertex of a facet at the vertex of a patch, for each of these facets.
pub(super) type OfFacets = [[f64; 3]; 3];

/// What the patches read.
pub(super) struct Patches<'s, 'a, T: Real, const D: usize> {
    pub space: &'s Space<'a, T, D>,
    pub neighbours: &'s Neighbours,
    pub cells: Vec<CellData>,
    /// The products of Neumann data and contact forces, by facet; sorted.
    pub given: Vec<&'s (Place, Products)>,
    pub corners: Vec<Corner>,
    pub starts: Vec<u32>,
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
pub(super) struct Patch {
    /// By cell the facets at the vertex.
    slots: Vec<[Slot; 3]>,
    /// The upper triangle of the matrix by rows: densities, then a multiplier for each cell.
    matrix: Vec<f64>,
    unknowns: Vec<f64>,
}

impl<T: Real, const D: usize> Patches<'_, '_, T, D> {
    /// Adds the part of a vertex to a list: for each cell around it the densities of the facets there.
    pub fn add_vertex(&self, vertex: usize, patch: &mut Patch, parts: &mut Vec<OfFacets>) {
        let corners = &self.corners[self.starts[vertex] as usize..self.starts[vertex + 1] as usize];
        let Patch { slots, matrix, unknowns } = patch;
        let mut n_free = 0;
        slots.clear();
        for (k, (cell, own)) in corners.iter().map(|corner| corner.pair()).enumerate() {
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
        for (k, (corner, slots)) in corners.iter().zip(&*slots).enumerate() {
            self.add_cell(corner.pair(), slots, n_free + k, (matrix, unknowns));
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
        corners: &[Corner],
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
                let position = corners.binary_search_by_key(&other, |corner| corner.cell());
                let Some(known) = position.ok().filter(|&l| l < slots.len()) else { return free() };
                let own = corners[known].own();
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
        let volume = mesh.geometry(cell as usize).volume.to_f64();
        let alpha = self.space.alpha(cell as usize).to_f64();
        let scale = 1.0 / (alpha * volume * d * d * (d + 1.0) * (d + 2.0));
        let tested = &self.cells[cell as usize].divergence[usize::from(own)];
        let products = divergence_products(&points, tested);
        let differences = &self.cells[cell as usize].difference;
        let targets = target_products::<D>(usize::from(own), differences);
        let mut balance: f64 = tested[..=D].iter().sum();
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

/// The products of `sum_j r_j lambda_j phi_j` in a cell with `lambda_k` times a vector, for each vertex `k`; `tested`
/// is the divergence tested with the barycentric coordinates.
fn divergence_products<const D: usize>(
    points: &[Point<f64, D>; 4],
    tested: &[f64; 4],
) -> [Point<f64, D>; 4] {
    let d = D as f64;
    let sum: Point<f64, D> = points[..=D].iter().sum();
    let total: f64 = tested[..=D].iter().sum();
    tabulate(|k| {
        let mut product = Point::zeros();
        for j in 0..=D {
            let inner = d * ((d + 2.0) * tested[j] - total);
            let weight = if j == k { 2.0 } else { 1.0 } * inner / (d + 3.0);
            product += (sum - points[j] * (d + 2.0) + points[k]) * weight;
        }
        product
    })
}

/// The products of what the part of vertex `own` aims at, its hat function times the difference of gradients, with
/// `lambda_j` times a vector, for each vertex `j` of a cell.
fn target_products<const D: usize>(own: usize, differences: &[[f64; 3]; 4]) -> [Point<f64, D>; 4] {
    let d = D as f64;
    tabulate(|j| {
        let mut target = Point::zeros();
        for (k, difference) in differences.iter().enumerate().take(D + 1) {
            let product = triple(D, [j, own, k]) / d;
            target += Point::from_fn(|axis, _| product * difference[axis]);
        }
        target
    })
}
