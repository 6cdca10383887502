//! What the patches read of each cell: normal fluxes, the aim of the flux, and the divergence to be balanced.

use std::convert::Infallible;
use std::ops::Range;

use crate::arrays::tabulate;
use crate::assemble::local::StiffnessTable;
use crate::assemble::space::tables::BasisAt;
use crate::assemble::space::{INWARD, Space};
use crate::element::Node;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::quadratics::{
    CellLoads, Products, add, densities, products_on_facet, vertices_of,
};
use crate::error_bound::shared_multipliers::SharedNodes;
use crate::measure::Admissible;
use crate::mesh::{Neighbour, Neighbours, edge_vertices};
use crate::parallel::cells;
use crate::real::{Point, Real};

/// What is known of a cell before its patches are.
#[derive(Clone, Default)]
pub(super) struct CellData {
    /// By facet the densities of `alpha grad u . n`.
    pub normal: Products,
    /// The gradient of the admissible function less that of the discrete function, at the vertices.
    pub difference: [[f64; 3]; 4],
    /// The stiffness term of each unknown.
    pub stiffness: [f64; 10],
    /// By vertex of the patch the divergence tested with the barycentric coordinates.
    pub divergence: Products,
}

impl CellData {
    /// The densities of the part of a vertex of a facet, `phi alpha grad u . n`.
    pub fn part<const D: usize>(&self, facet: usize, vertex: usize) -> [f64; 4] {
        densities::<D>(&products_on_facet::<D>(&self.normal[facet], facet)[vertex], facet)
    }
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The data of all cells. Divides the multipliers of shared unknowns among their cells in `loads`.
    pub(super) fn patch_data(
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
