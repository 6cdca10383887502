//! The data of cells for patches of quadratics: a flux has one number for each vertex of a facet.
//!
//! Each vertex contributes a flux `p` on its patch. In a cell of the patch
//!
//! ```text
//! p = sum c_Fj lambda_j (a_j - a_F) / (D |K|) + sum_j r_j lambda_j phi_j
//! ```
//!
//! with the first sum over the facets `F` at the vertex, in the notation of
//! [`quadratics`](crate::error_bound::quadratics). The divergence, tested with linear functions, determines the `r_j`.

use std::convert::Infallible;
use std::ops::Range;

use super::corners::Corner;
use super::patch_cells::{CellProblem, PatchCells};
use super::pressing::Pressing;
use crate::arrays::array_of;
use crate::assemble::space::tables::BasisAt;
use crate::assemble::space::{INWARD, Space};
use crate::assemble::stiffness::{Local, StiffnessTable};
use crate::element::Node;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::quadratics::{
    CellLoads, Products, add, densities, products_on_facet, triple, vertices_of,
};
use crate::mesh::HalfFacet;
use crate::parallel::cells;
use crate::real::Point;

/// The data of a cell that do not depend on its patches.
#[derive(Clone, Default)]
pub(in crate::error_bound) struct KnownOfCell {
    /// By facet the densities of `alpha grad u . n`.
    normal: Products,
    /// The gradient of the admissible function less that of the discrete function, at the vertices, in coordinates in
    /// which the coefficient has no direction.
    difference: [[f64; 3]; 4],
    /// The stiffness term of each unknown.
    stiffness: [f64; 10],
    /// By vertex of the patch the divergence tested with the barycentric coordinates.
    divergence: Products,
}

/// The cells of a conforming quadratic function.
pub(super) struct QuadraticCells<'s, 'a, const D: usize> {
    space: &'s Space<'a, D>,
    cells: Vec<KnownOfCell>,
    /// The products of Neumann data and contact forces, by facet; sorted.
    given: Vec<&'s (HalfFacet, Products)>,
    /// The forces of obstacles on facets.
    pressing: Option<&'s Pressing>,
}

/// Sorts products by the places of their facets. Not in the function that calls it, so that this is compiled once.
fn sort(given: &mut [&(HalfFacet, Products)]) {
    given.sort_unstable_by_key(|(place, _)| *place);
}

/// The numbers of a facet, of numbers for all vertices of the cell.
pub(super) fn on_facet<const D: usize>(densities: &[f64; 4], facet: usize) -> [f64; 3] {
    let mut numbers = [0.0; 3];
    numbers.iter_mut().zip(vertices_of::<D>(facet)).for_each(|(to, j)| *to = densities[j]);
    numbers
}

impl<const D: usize> Space<'_, D> {
    /// What is known of the cells of a conforming quadratic function, without divergences.
    pub(in crate::error_bound) fn known_cells(
        &self,
        u: &[f64],
        function: &PrimalDualPair<D>,
    ) -> Vec<KnownOfCell> {
        let corners: Vec<BasisAt> =
            (0..D + 1).map(|k| self.basis_at(&Node::vertex(k).centre(D))).collect();
        let table = self.stiffness_table();
        let data = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            let in_cell = |cell| self.known_of_cell(cell, (u, function), (&corners, &table));
            cells.map(in_cell).collect::<Vec<_>>()
        });
        data.into_iter().flatten().collect()
    }

    /// The cells of a conforming quadratic function, with the forces of obstacles on facets if there are any.
    pub(super) fn quadratic_cells<'s>(
        &'s self,
        mut data: Vec<KnownOfCell>,
        loads: &'s CellLoads,
        pressing: Option<&'s Pressing>,
    ) -> QuadraticCells<'s, 's, D> {
        let (n_cells, n) = (self.mesh.n_cells(), self.per_cell());
        let tested = |cell: usize, own: usize| loads.multiplier_at(cell, own);
        let fill = |cells: Range<usize>, out: &mut [KnownOfCell]| {
            for (cell, data) in cells.zip(out) {
                for (i, of_linear) in loads.functionals.iter().enumerate() {
                    let left = data.stiffness[i] - loads.values[cell * n + i];
                    add(&mut data.divergence, |a, j| left * of_linear[a][j]);
                }
                for facet in 0..=D {
                    let products = products_on_facet::<D>(&data.normal[facet], facet);
                    add(&mut data.divergence, |a, j| -products[a][j]);
                }
                if let Some(pressing) = pressing {
                    for (own, divergence) in data.divergence.iter_mut().enumerate().take(D + 1) {
                        let moved = pressing.moved_at(self.mesh, &tested, (cell, own));
                        divergence.iter_mut().zip(moved).for_each(|(sum, moved)| *sum += moved);
                    }
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c, &mut data, &fill);
        for ((cell, _), products) in &loads.neumann {
            add(&mut data[*cell].divergence, |a, j| products[a][j]);
        }
        let mut given: Vec<_> = loads.neumann.iter().chain(&loads.contact).collect();
        sort(&mut given);
        QuadraticCells { space: self, cells: data, given, pressing }
    }

    /// The data of a cell, without divergence.
    fn known_of_cell(
        &self,
        cell: usize,
        (u, function): (&[f64], &PrimalDualPair<D>),
        (corners, table): (&[BasisAt], &StiffnessTable),
    ) -> KnownOfCell {
        let n = self.per_cell();
        let metric = self.metric(cell);
        let local = self.local_values(cell, u);
        let alpha = self.alpha(cell);
        let varying = self.varying_in(cell);
        let mut data = KnownOfCell::default();
        let of_function = self.gradients_at_vertices(function, cell);
        let geometry = self.mesh.geometry(cell);
        for (k, basis) in corners.iter().enumerate() {
            let slope = |m: usize| -> f64 {
                local.iter().zip(&basis.derivatives).take(n).map(|(u, d)| u * d[m]).sum()
            };
            let slopes: [f64; 4] = array_of(|m| if m <= D { slope(m) } else { 0.0 });
            let mut difference = of_function[k];
            for (m, slope) in slopes.iter().enumerate().take(D + 1) {
                difference -= geometry.gradient(m) * *slope;
            }
            let difference = self.isotropic_gradient(cell, &difference);
            data.difference[k][..D].copy_from_slice(difference.as_slice());
            let coefficient = match varying {
                None => alpha,
                Some(_) => {
                    let inward = |b: f64| b + (1.0 / (D + 1) as f64 - b) * INWARD;
                    let point = Node::vertex(k).centre(D).map(inward);
                    self.alpha_at(cell, &self.cell_point(&point, cell))
                }
            };
            for facet in vertices_of::<D>(k) {
                // |F| n = -D |K| grad lambda
                let products = metric.products[facet].iter().zip(&slopes);
                let sum: f64 = products.map(|(p, slope)| p * slope).sum();
                data.normal[facet][k] = -(D as f64) * coefficient * sum;
            }
        }
        let stiffness: Local = self.stiffness(table, cell, &metric.products);
        for (term, row) in data.stiffness.iter_mut().zip(&stiffness).take(n) {
            *term = row.iter().zip(&local).map(|(entry, value)| entry * value).sum();
        }
        data
    }
}

impl<const D: usize> PatchCells<D, 9> for QuadraticCells<'_, '_, D> {
    const DEGREE: usize = 1;

    fn normals(&self, cell: usize, numbers: &mut [f64]) {
        for (numbers, normal) in numbers.chunks_exact_mut(D + 1).zip(&self.cells[cell].normal) {
            numbers.copy_from_slice(&normal[..=D]);
        }
    }

    fn normal(&self, corner: Corner, facet: usize) -> [f64; 3] {
        let mut normal = self.cells[corner.cell()].normal[facet];
        // the first side of a facet has its force
        if let Some(force) = self.pressing.and_then(|p| p.on_facet((corner.cell(), facet))) {
            normal.iter_mut().zip(force.densities).for_each(|(normal, force)| *normal -= force);
        }
        let products = &products_on_facet::<D>(&normal, facet)[corner.own()];
        on_facet::<D>(&densities::<D>(products, facet), facet)
    }

    fn given(&self, corner: Corner, facet: usize) -> [f64; 3] {
        let place = (corner.cell(), facet);
        let given = self.given.binary_search_by_key(&place, |(place, _)| *place);
        given.map_or([0.0; 3], |k| {
            let products = &self.given[k].1[corner.own()];
            on_facet::<D>(&densities::<D>(products, facet), facet)
        })
    }

    fn problem(&self, corner: Corner, _: &[Corner]) -> CellProblem<9> {
        let known = &self.cells[corner.cell()];
        let tested = &known.divergence[corner.own()];
        quadratic_problem(self.space, corner, tested, &known.difference)
    }
}

/// The problem of a cell whose flux has this divergence, tested with the barycentric coordinates, and aims at the hat
/// function of the vertex times `alpha` times a linear function, given at the vertices.
pub(super) fn quadratic_problem<const D: usize>(
    space: &Space<'_, D>,
    corner: Corner,
    tested: &[f64; 4],
    difference: &[[f64; 3]; 4],
) -> CellProblem<9> {
    let (mesh, cell, d) = (space.mesh, corner.cell(), D as f64);
    let points = space.isotropic_corners(cell);
    let volume = mesh.geometry(cell).volume;
    let alpha = space.alpha(cell);
    let scale = 1.0 / (alpha * volume * d * d * (d + 1.0) * (d + 2.0));
    let of_divergence = divergence_products(&points, tested);
    let targets = target_products::<D>(corner.own(), difference);
    // of each number its vertex, and the vector from the vertex opposite its facet to it
    let mut numbers = [(0, Point::<D>::zeros()); 9];
    let all = corner.facets::<D>().flat_map(|f| vertices_of::<D>(f).map(move |j| (f, j)));
    for (number, (facet, j)) in numbers.iter_mut().zip(all) {
        *number = (j, points[j] - points[facet]);
    }
    let (mut products, mut aims) = ([[0.0; 9]; 9], [0.0; 9]);
    for (a, (j, along)) in numbers.iter().enumerate().take(D * D) {
        aims[a] = targets[*j].dot(along) - scale * of_divergence[*j].dot(along);
        for (b, (k, other)) in numbers.iter().enumerate().take(D * D) {
            products[a][b] = if j == k { 2.0 } else { 1.0 } * scale * along.dot(other);
        }
    }
    CellProblem::new(products, &aims, d * tested[..=D].iter().sum::<f64>(), D * D)
}

/// The integrals of `sum_j r_j lambda_j phi_j` times `lambda_k` over a cell, a vector for each vertex `k`. `tested` is
/// the divergence tested with the barycentric coordinates.
fn divergence_products<const D: usize>(points: &[Point<D>; 4], tested: &[f64; 4]) -> [Point<D>; 4] {
    let d = D as f64;
    let sum: Point<D> = points[..=D].iter().sum();
    let total: f64 = tested[..=D].iter().sum();
    array_of(|k| {
        let mut product = Point::zeros();
        for j in 0..=D {
            let inner = d * ((d + 2.0) * tested[j] - total);
            let weight = if j == k { 2.0 } else { 1.0 } * inner / (d + 3.0);
            product += (sum - points[j] * (d + 2.0) + points[k]) * weight;
        }
        product
    })
}

/// The integrals of the target of vertex `own` times `lambda_j` over a cell, a vector for each vertex `j`. The target
/// is the hat function of `own` times the difference of gradients.
fn target_products<const D: usize>(own: usize, differences: &[[f64; 3]; 4]) -> [Point<D>; 4] {
    let d = D as f64;
    array_of(|j| {
        let mut target = Point::zeros();
        for (k, difference) in differences.iter().enumerate().take(D + 1) {
            let product = triple(D, [j, own, k]) / d;
            target += Point::from_fn(|axis, _| product * difference[axis]);
        }
        target
    })
}
