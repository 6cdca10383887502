//! The flux of a discrete quadratic function: in each cell of the space of Raviart and Thomas of degree one.
//!
//! With `c_Fj` the measure of facet `F` times `q.n` at its vertex `j`, and `phi_F = (x - a_F) / (D |K|)`,
//! `a_F` the vertex opposite `F`, in a cell `K`
//!
//! ```text
//! q = sum_F s_F phi_F,   s_F = sum_j c_Fj lambda_j,
//! div q = ((D + 1) sum_F s_F - sum_F c_FF) / (D |K|)
//! ```
//!
//! Here `j` is any vertex: `lambda_F phi_F` vanishes on the boundary in normal direction. The sum of these
//! `D + 1` functions is zero, so that `sum_F c_FF = 0` may be asked for. Facet moments and the products of
//! `div q` with the linear functions determine `q`; the latter are those of load and multiplier.

use std::convert::Infallible;
use std::ops::Range;

use super::NoBound;
use super::contact_forces::NodeForce;
use super::flux::Flux;
use crate::algebra::{Bound, Contact};
use crate::arrays::{array_of, map_entries};
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::assemble::stiffness::zero_local;
use crate::mesh::{BoundaryCondition, HalfFacet, edge_vertices};
use crate::parallel::cells;
use crate::quadrature::{OrthonormalPolynomials, facet_to_cell};

/// A mean of a basis function below this is rounding.
const MEAN_ROUNDING: f64 = 1e-12;

/// The numbers that a functional gives to the products `lambda_a lambda_j` of barycentric coordinates, symmetric.
pub(super) type Products = [[f64; 4]; 4];

/// Load and multiplier of each unknown of each cell: the load less the reaction term of the discrete function, plus
/// the multiplier less contact forces. Cells that share an unknown have a share of its multiplier each.
pub(super) struct CellLoads {
    /// By cell and unknown.
    pub values: Vec<f64>,
    /// The same without multipliers.
    pub given: Vec<f64>,
    /// By facet the products of Neumann data, which are among the loads.
    pub neumann: Vec<(HalfFacet, Products)>,
    /// By facet the products of contact forces.
    pub contact: Vec<(HalfFacet, Products)>,
    /// By unknown of a cell its functional at `lambda_a lambda_j`.
    pub functionals: Vec<Products>,
}

impl CellLoads {
    /// The multipliers of a cell, by unknown.
    fn multipliers(&self, cell: usize) -> impl Iterator<Item = f64> {
        let places = cell * self.functionals.len()..(cell + 1) * self.functionals.len();
        places.map(|k| self.values[k] - self.given[k])
    }
    /// The largest multiplier of a cell.
    pub fn strength(&self, cell: usize) -> f64 {
        self.multipliers(cell).fold(0.0, |most, multiplier| most.max(multiplier.abs()))
    }
    /// The multiplier of a cell, tested with the hat function of one of its vertices times barycentric coordinates.
    pub fn multiplier_at(&self, cell: usize, own: usize) -> [f64; 4] {
        let mut tested = [0.0; 4];
        for (multiplier, functional) in self.multipliers(cell).zip(&self.functionals) {
            let products = functional[own].map(|product| multiplier * product);
            tested.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        }
        tested
    }
}

/// `c_Fj` from the products `int_F q.n lambda_j`: `lambda` has on a facet the products
/// `(1 + delta) / (D (D + 1))`.
pub(super) fn densities<const D: usize>(products: &[f64; 4], facet: usize) -> [f64; 4] {
    let sum: f64 = products[..=D].iter().sum();
    let d = D as f64;
    array_of(|j| match j <= D && j != facet {
        true => d * ((d + 1.0) * products[j] - sum),
        false => 0.0,
    })
}

impl<const D: usize> Space<'_, D> {
    /// Whether the unknowns of a cell are those of a continuous quadratic, one for each vertex and edge.
    pub(super) fn is_conforming_quadratic(&self) -> bool {
        !self.broken && self.has_nodes_of_quadratics()
    }

    /// Whether the unknowns of a cell are the values of a quadratic at vertices and midpoints, or its Bernstein
    /// coefficients: one for each vertex and edge.
    pub(super) fn has_nodes_of_quadratics(&self) -> bool {
        let is_vertex = |i: usize| self.nodes[i].point().is_some_and(|p| p[i] == 1.0);
        let is_lagrange = || {
            self.basis_degree == 2
                && self.per_cell() == D + 1 + edge_vertices(D).len()
                && (0..D + 1).all(is_vertex)
                && self.nodes[D + 1..].iter().all(|node| node.is_midpoint())
        };
        self.has_coefficients() || is_lagrange()
    }

    /// Loads and multipliers by cell; `residual` is that of the inequality, `numbers` are those of the nodes whose
    /// multipliers cells share.
    pub(super) fn cell_loads(
        &self,
        u: &[f64],
        (residual, obstacles): (&[f64], &ActiveObstacles),
        (bounds, contact): (&[Bound<f64>], &[Contact]),
        forces: &[NodeForce],
        numbers: Option<Vec<u32>>,
    ) -> Result<CellLoads, NoBound> {
        let n = self.per_cell();
        let mut multipliers = self.multipliers_of_obstacles(residual, forces);
        let is_pinned = |unknown: usize| self.pins && matches!(bounds[unknown], Bound::Fixed(_));
        (0..multipliers.len()).filter(|&i| is_pinned(i)).for_each(|i| multipliers[i] = 0.0);
        let given = self.loads_less_reaction(u)?;
        let mut values = given.clone();
        match numbers {
            Some(numbers) => {
                let states = (bounds, contact, obstacles);
                self.add_multipliers(&multipliers, states, &numbers, &mut values);
            }
            None => {
                for (k, value) in values.iter_mut().enumerate() {
                    *value += multipliers[self.dofs.of(k / n, k % n)];
                }
            }
        }
        let terms = self.node_terms(&self.facet_rule);
        let functional = |terms: &Vec<([f64; 4], f64)>| -> Products {
            array_of(|a| array_of(|j| terms.iter().map(|(p, w)| w * p[a] * p[j]).sum()))
        };
        let functionals: Vec<Products> = terms.iter().map(functional).collect();
        let neumann = self.neumann_products(u)?;
        let contact = contact_products(forces, &functionals);
        Ok(CellLoads { values, given, neumann, contact, functionals })
    }

    /// The load less the reaction term of a discrete function, by cell and unknown.
    fn loads_less_reaction(&self, u: &[f64]) -> Result<Vec<f64>, NoBound> {
        let (n, n_cells) = (self.per_cell(), self.mesh.n_cells());
        let mut loads = self.load_by_cell()?.into_owned();
        // without data the list is empty
        loads.resize(n_cells * n, 0.0);
        let Some(reaction) = &self.reaction else { return Ok(loads) };
        let subtract = |cells: Range<usize>, out: &mut [f64]| {
            for (cell, out) in cells.zip(out.chunks_exact_mut(n)) {
                let mut products = zero_local();
                let volume = self.mesh.geometry(cell).volume;
                reaction.add(self.mesh, cell, volume, &mut products);
                let local = self.local_values(cell, u);
                for (i, out) in out.iter_mut().enumerate() {
                    let terms = products[i].iter().zip(&local).take(n);
                    *out -= terms.map(|(c, value)| c * value).sum::<f64>();
                }
            }
            Ok::<(), Infallible>(())
        };
        let Ok(()) = cells::for_each(n_cells, &|c| c * n, &mut loads, &subtract);
        Ok(loads)
    }

    /// The unknowns of a cell whose basis functions have a positive integral over the cell, but for rounding. Where the
    /// integral is not positive, as at vertices in the plane, the multiplier has no definite sign, and unknowns deep in
    /// contact are inactive at random.
    pub(super) fn unknowns_with_positive_mean(&self) -> Vec<usize> {
        let mean = |node: usize| -> f64 {
            self.cell_rule.iter().map(|(point, w)| w * self.basis_at(point).values[node]).sum()
        };
        (0..self.per_cell()).filter(|&node| mean(node) > MEAN_ROUNDING).collect()
    }

    /// The products of Neumann data, by facet.
    fn neumann_products(&self, u: &[f64]) -> Result<Vec<(HalfFacet, Products)>, NoBound> {
        let mut neumann = Vec::new();
        if self.problem.has_neumann_data() {
            // friction has forces
            let facets = self.grouped_facets_of(BoundaryCondition::Neumann);
            for (facet, group) in facets.filter(|(_, g)| self.data.friction.of(*g).is_none()) {
                neumann.push((facet, self.neumann_products_on(facet, group, Some(u))?));
            }
        }
        Ok(neumann)
    }

    /// The products of the Neumann datum on a facet, on a Robin side with the discrete function.
    pub(super) fn neumann_products_on(
        &self,
        facet: HalfFacet,
        group: usize,
        u: Option<&[f64]>,
    ) -> Result<Products, NoBound> {
        let measure = self.facet_measure(facet);
        let mut products = Products::default();
        for (point, weight) in self.facet_rule.iter() {
            let flux = weight * measure * self.neumann_at(facet, group, point, u)?;
            let point = facet_to_cell(point, facet.1);
            add(&mut products, |a, j| flux * point[a] * point[j]);
        }
        Ok(products)
    }

    /// The flux with these moments, `D` of each facet of each cell, without its numbers inside cells.
    pub(super) fn flux_of_moments(&self, moments: &[f64]) -> Flux<D> {
        let polynomials = OrthonormalPolynomials::new(D - 1, 1);
        let mut flux = Flux::zero(1, self.mesh.n_cells());
        for (k, moments) in moments.chunks_exact(D).enumerate() {
            let (cell, facet) = (k / (D + 1), k % (D + 1));
            for (p, j) in vertices_of::<D>(facet).enumerate() {
                let mut vertex = [0.0; 4];
                vertex[p] = 1.0;
                let term = |(k, m): (usize, &f64)| m * polynomials.value(k, &vertex);
                flux.add_density(cell, facet, j, moments.iter().enumerate().map(term).sum());
            }
        }
        flux
    }

    /// Adds the fluxes of Neumann data and contact.
    pub(super) fn add_boundary_fluxes(&self, loads: &CellLoads, flux: &mut Flux<D>) {
        for ((cell, local), products) in loads.neumann.iter().chain(&loads.contact) {
            let of_facet = densities::<D>(&map_entries(*products, |row| row.iter().sum()), *local);
            flux.add_densities(*cell, *local, &of_facet);
        }
    }

    /// Sets `c_FF` such that the divergence balances loads and multipliers tested with linear functions, these less what
    /// facets have of them. What rounding leaves of the balance of a cell is divided among these.
    pub(super) fn balance(
        &self,
        (loads, on_facets): (&CellLoads, &[[f64; 4]]),
        flux: &mut Flux<D>,
    ) {
        let (n, n_cells, square) = (self.per_cell(), self.mesh.n_cells(), flux.per_cell());
        let d = D as f64;
        let mut given = vec![[0.0; 4]; if loads.neumann.is_empty() { 0 } else { n_cells }];
        for ((cell, _), products) in &loads.neumann {
            let moments = products.iter().map(|row| row.iter().sum::<f64>());
            given[*cell].iter_mut().zip(moments).for_each(|(to, moment)| *to += moment);
        }
        let linear: Vec<[f64; 4]> =
            loads.functionals.iter().map(|f| map_entries(*f, |row| row.iter().sum())).collect();
        let fill = |cells: Range<usize>, out: &mut [f64]| {
            for (cell, flux) in cells.zip(out.chunks_exact_mut(square)) {
                let mut tested = [0.0; 4];
                for (load, of_linear) in loads.values[cell * n..][..n].iter().zip(&linear) {
                    tested.iter_mut().zip(of_linear).for_each(|(to, l)| *to += load * l);
                }
                for less in [given.get(cell), on_facets.get(cell)].into_iter().flatten() {
                    tested.iter_mut().zip(less).for_each(|(to, less)| *to -= less);
                }
                let through: f64 = flux.iter().sum::<f64>() / d;
                let left = (tested[..=D].iter().sum::<f64>() + through) / (d + 1.0);
                tested[..=D].iter_mut().for_each(|t| *t -= left);
                let sum: f64 = tested[..=D].iter().sum();
                for j in 0..=D {
                    let of_vertex = (0..D + 1).map(|facet| flux[Flux::<D>::place(facet, j)]);
                    let others: f64 = of_vertex.sum();
                    tested[j] = d * (sum - (d + 2.0) * tested[j]) - others;
                }
                (0..D + 1).for_each(|j| flux[Flux::<D>::place(j, j)] = tested[j]);
            }
            Ok::<(), Infallible>(())
        };
        let numbers = flux.of_cells_mut(0..n_cells);
        let Ok(()) = cells::for_each(n_cells, &|c| c * square, numbers, &fill);
    }
}

/// The products of contact forces, by facet; those of a facet follow each other.
fn contact_products(forces: &[NodeForce], functionals: &[Products]) -> Vec<(HalfFacet, Products)> {
    let is_same = |a: &NodeForce, b: &NodeForce| (a.cell, a.local) == (b.cell, b.local);
    let of_facet = |forces: &[NodeForce]| {
        let mut products = Products::default();
        for force in forces {
            add(&mut products, |a, j| force.value * functionals[force.node][a][j]);
        }
        ((forces[0].cell, forces[0].local), products)
    };
    forces.chunk_by(is_same).map(of_facet).collect()
}

/// The integral of `lambda_a lambda_j lambda_k` over a simplex of a dimension and of measure one.
pub(super) fn triple(dimension: usize, [a, j, k]: [usize; 3]) -> f64 {
    let d = dimension as f64;
    let equal = usize::from(a == j) + usize::from(j == k) + usize::from(a == k);
    [1.0, 2.0, 0.0, 6.0][equal] / ((d + 1.0) * (d + 2.0) * (d + 3.0))
}

/// The vertices of a facet by their numbers in the cell.
pub(super) fn vertices_of<const D: usize>(facet: usize) -> impl Iterator<Item = usize> {
    (0..D + 1).filter(move |&j| j != facet)
}

/// The products of a flux with these densities on a facet.
pub(super) fn products_on_facet<const D: usize>(densities: &[f64; 4], facet: usize) -> Products {
    let mut products = Products::default();
    for a in vertices_of::<D>(facet) {
        for j in vertices_of::<D>(facet) {
            let terms = vertices_of::<D>(facet).map(|k| densities[k] * triple(D - 1, [a, j, k]));
            products[a][j] = terms.sum();
        }
    }
    products
}

/// Adds to each product.
pub(super) fn add(products: &mut Products, term: impl Fn(usize, usize) -> f64) {
    for (a, row) in products.iter_mut().enumerate() {
        row.iter_mut().enumerate().for_each(|(j, product)| *product += term(a, j));
    }
}
