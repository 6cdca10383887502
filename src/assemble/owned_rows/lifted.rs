//! Products of lifts: `int alpha r(v) . r(u)`.
//!
//! The lift on a cell, the *centre*, is made of the jumps on all its facets, so it couples all the
//! neighbours of the centre with each other. The rows of a cell get contributions from the cell
//! itself and from its neighbours as centres.
//!
//! On a centre `K` the jump `m` on facet `F` lifts to `-w/alpha n s`, `w` the weight of `K` in the flux and
//! `s` of the degree of lifts with `int_K s q = int_F m q`. With `|F||F'| n.n' = D^2 |K| int grad lambda
//! . grad lambda'` the product of two lifts is `D^2 w w'/alpha` times that integral times a number
//! of the reference cell.
//!
//! Where the coefficient varies on a facet, `w` is a function on it: `w m` is projected on polynomials of
//! degree `p - 1`, and what `m` has of degree `p` on those of degree `p`. Where it varies in `K`, `1/alpha`
//! is that of its least value. With the stiffness at the points of its rule the square is then completed
//! still: the form is coercive for every penalty.

use super::Coupled;
use crate::assemble::local::{flux_weight, view};
use crate::assemble::space::metric::{CellMetric, Metrics};
use crate::assemble::space::tables::{BasisAt, FacetTable};
use crate::assemble::space::{Place, Space};
use crate::element::MAX_BASIS;
use crate::facet::FacetForm;
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::quadrature::{OrthonormalPolynomials, Rule, facet_to_cell};

/// Most moments a lift is made of: quadratics on a triangle.
pub(crate) const MAX_MOMENTS: usize = 6;

type Moments = [[f64; MAX_MOMENTS]; MAX_BASIS];
type Product = [[f64; MAX_MOMENTS]; MAX_MOMENTS];

/// Lifts on the reference cell.
pub(crate) struct LiftTable {
    /// Moments of the basis, of degree up to that of lifts.
    pub facets: FacetTable,
    /// Number of moments on a facet.
    moments: usize,
    /// For two facets, the products of the lifts of their moments, per measures and volume.
    products: [[Product; 4]; 4],
}

impl LiftTable {
    /// The lifts of this degree of a space of degree one or two.
    pub fn new<const D: usize>(space: &Space<'_, D>, degree: usize) -> Self {
        let mut products = [[[[0.0; MAX_MOMENTS]; MAX_MOMENTS]; 4]; 4];
        let tests: Vec<Vec<Vec<f64>>> = (0..D + 1).map(|l| tests(D, degree, l)).collect();
        for l in 0..=D {
            for k in 0..=D {
                for (m, a) in tests[l].iter().enumerate() {
                    for (n, b) in tests[k].iter().enumerate() {
                        // tests are against an orthonormal basis of the cell
                        let product = a.iter().zip(b).map(|(a, b)| a * b).sum();
                        products[l][k][m][n] = product;
                    }
                }
            }
        }
        let facets = space.facet_table(degree);
        Self { moments: facets.degrees.len(), facets, products }
    }
}

/// By moment on facet `local`, its means with the orthonormal polynomials of the cell.
fn tests(dimension: usize, degree: usize, local: usize) -> Vec<Vec<f64>> {
    let on_facet = OrthonormalPolynomials::new(dimension - 1, degree);
    let in_cell = OrthonormalPolynomials::new(dimension, degree);
    let rule = Rule::new(dimension - 1, 2 * degree);
    let mean = |m: usize, q: usize| {
        let term = |(point, w): (&[f64; 4], f64)| {
            w * on_facet.value(m, point) * in_cell.value(q, &facet_to_cell(point, local))
        };
        rule.iter().map(term).sum()
    };
    (0..on_facet.len()).map(|m| (0..in_cell.len()).map(|q| mean(m, q)).collect()).collect()
}

/// Moments of a weight times a function with these moments.
fn weigh(products: &Product, moments: &[f64; MAX_MOMENTS]) -> [f64; MAX_MOMENTS] {
    let sum =
        |row: &[f64; MAX_MOMENTS]| row.iter().zip(moments).fold(0.0, |sum, (&p, &m)| sum + p * m);
    std::array::from_fn(|k| sum(&products[k]))
}

/// The lifts of a discretisation.
pub(crate) struct Lifting<'s, 'a, const D: usize> {
    pub space: &'s Space<'a, D>,
    pub form: &'s dyn FacetForm<D>,
    pub metrics: &'s Metrics,
    pub table: &'s LiftTable,
}

/// A facet of a centre whose jump is lifted.
struct JumpFacet {
    local: usize,
    /// The cell across and the facet's number in it; none on the boundary.
    across: Option<(usize, usize)>,
    /// The weight of the centre's normal derivative in the flux; one where the coefficient varies in one
    /// of the cells.
    flux_weight: f64,
    /// There, the products of moments with that weight at the points of the facet.
    products: Option<Product>,
}

impl<const D: usize> Lifting<'_, '_, D> {
    /// Adds the products to the rows of a cell.
    pub fn add(&self, neighbours: &Neighbours, cell: usize, coupled: &Coupled, rows: &mut [f64]) {
        self.add_centre(neighbours, cell, None, coupled, rows);
        for local in 0..=D {
            if let Neighbour::Cell { cell: other, local: other_local } =
                neighbours.across(cell, local)
            {
                let shared = Some((other_local as usize, local));
                self.add_centre(neighbours, other as usize, shared, coupled, rows);
            }
        }
    }

    /// Adds what one centre contributes to the rows of a cell: the cell itself, or a neighbour that
    /// shares one facet with the cell, with the number of this facet there and here.
    fn add_centre(
        &self,
        neighbours: &Neighbours,
        centre: usize,
        shared: Option<(usize, usize)>,
        coupled: &Coupled,
        rows: &mut [f64],
    ) {
        let metric = self.metrics.at::<D>(centre);
        let facets_with_jumps: [Option<JumpFacet>; 4] = std::array::from_fn(|l| {
            if l <= D { self.jump_facet(neighbours, centre, &metric, l) } else { None }
        });
        let n = self.space.per_cell();
        let row = rows.len() / n;
        for test in facets_with_jumps.iter().flatten() {
            let (sign, local) = match shared {
                None => (1.0, test.local),
                Some((there, here)) if there == test.local => (-1.0, here),
                Some(_) => continue,
            };
            let tested = self.moments(local, test);
            for trial in facets_with_jumps.iter().flatten() {
                let scale = sign * self.scale(centre, &metric, test, trial);
                let weighted = self.weighted(&tested, test.local, trial.local, scale);
                let columns = self.moments(trial.local, trial);
                let start = coupled.position(centre) * n;
                self.add_block(&weighted, &columns, 1.0, start, row, rows);
                if let Some((other, other_local)) = trial.across {
                    let columns = self.moments(other_local, trial);
                    let start = coupled.position(other) * n;
                    self.add_block(&weighted, &columns, -1.0, start, row, rows);
                }
            }
        }
    }

    /// `D^2 w w' / alpha int grad lambda . grad lambda'`.
    fn scale(
        &self,
        centre: usize,
        metric: &CellMetric<D>,
        test: &JumpFacet,
        trial: &JumpFacet,
    ) -> f64 {
        let product = metric.products[test.local][trial.local];
        ((D * D) as f64) * test.flux_weight * trial.flux_weight * product
            / self.space.extreme_coefficients((centre, test.local))[1]
    }

    /// Facet `local` of a centre, if a form acts on its jumps.
    fn jump_facet(
        &self,
        neighbours: &Neighbours,
        centre: usize,
        metric: &CellMetric<D>,
        local: usize,
    ) -> Option<JumpFacet> {
        let mesh = self.space.mesh;
        let me = self.space.side(centre, local, metric);
        match neighbours.across(centre, local) {
            Neighbour::Cell { cell, local: other_local } => {
                let (cell, other_local) = (cell as usize, other_local as usize);
                let metric = self.metrics.at(cell);
                let other = self.space.side(cell, other_local, &metric);
                let is_here = centre < cell;
                let (here, there) = if is_here { (&me, &other) } else { (&other, &me) };
                let facet = view(mesh, here, Some(there));
                let average_weight = self.form.average_weight(&facet);
                let flux_weight = flux_weight(&facet, average_weight, is_here);
                let own = if is_here { average_weight } else { 1.0 - average_weight };
                let across = Some((cell, other_local));
                Some(self.with_products((centre, local), across, flux_weight, own))
            }
            Neighbour::Boundary(BoundaryPart::Dirichlet) => {
                let weight = me.coefficient;
                Some(self.with_products((centre, local), None, weight, 1.0))
            }
            Neighbour::Boundary(_) | Neighbour::Cut => None,
        }
    }

    /// A facet of a centre, with the products of moments where the coefficient varies.
    fn with_products(
        &self,
        (centre, local): Place,
        across: Option<Place>,
        flux_weight: f64,
        own_weight: f64,
    ) -> JumpFacet {
        if !self.space.varies_at((centre, local), across) {
            return JumpFacet { local, across, flux_weight, products: None };
        }
        let product = |k, l| self.space.flux_product((centre, local), across, own_weight, (k, l));
        let or_zero = |k, l| product(k, l).unwrap_or(0.0);
        let products = std::array::from_fn(|k| std::array::from_fn(|l| or_zero(k, l)));
        JumpFacet { local, across, flux_weight: 1.0, products: Some(products) }
    }

    /// The moments on facet `local` of a cell, which is this facet of a centre, of what is lifted.
    fn moments(&self, local: usize, facet: &JumpFacet) -> Moments {
        let mut moments = [[0.0; MAX_MOMENTS]; MAX_BASIS];
        for (m, basis) in self.table.facets.on(local).iter().enumerate() {
            let basis: &BasisAt = basis;
            for i in 0..self.space.per_cell() {
                moments[i][m] = basis.values[i];
            }
        }
        match &facet.products {
            Some(products) => moments.map(|moments| weigh(products, &moments)),
            None => moments,
        }
    }

    /// The moments of test functions times the products with the moments of another facet.
    fn weighted(&self, tested: &Moments, test: usize, trial: usize, scale: f64) -> Moments {
        let products = &self.table.products[test][trial];
        let mut weighted = [[0.0; MAX_MOMENTS]; MAX_BASIS];
        for i in 0..self.space.per_cell() {
            for n in 0..self.table.moments {
                for m in 0..self.table.moments {
                    weighted[i][n] += scale * tested[i][m] * products[m][n];
                }
            }
        }
        weighted
    }

    fn add_block(
        &self,
        tests: &Moments,
        trials: &Moments,
        sign: f64,
        start: usize,
        row: usize,
        rows: &mut [f64],
    ) {
        let n = self.space.per_cell();
        for i in 0..n {
            let out = &mut rows[i * row + start..i * row + start + n];
            for j in 0..n {
                for m in 0..self.table.moments {
                    out[j] += sign * tests[i][m] * trials[j][m];
                }
            }
        }
    }

    /// Adds to the load what a Dirichlet datum on a facet of the centre lifts to: the number of the
    /// facet and the moments of the datum, of which lifts take the first.
    pub fn add_load(
        &self,
        neighbours: &Neighbours,
        centre: usize,
        (datum_local, moments): &(usize, Vec<f64>),
        load: &mut [f64],
    ) {
        let metric = self.metrics.at::<D>(centre);
        let Some(datum) = self.jump_facet(neighbours, centre, &metric, *datum_local) else {
            return;
        };
        let lifted = lifted_moments(&datum, moments);
        for local in 0..=D {
            let Some(test) = self.jump_facet(neighbours, centre, &metric, local) else { continue };
            let scale = self.scale(centre, &metric, &test, &datum);
            let mut add = |cell: usize, local: usize, sign: f64| {
                let tested = self.moments(local, &test);
                let weighted = self.weighted(&tested, test.local, *datum_local, scale);
                let n = self.space.per_cell();
                let out = &mut load[cell * n..(cell + 1) * n];
                for (out, weighted) in out.iter_mut().zip(&weighted) {
                    for (w, &moment) in weighted.iter().zip(&lifted) {
                        *out += sign * *w * moment;
                    }
                }
            };
            add(centre, local, 1.0);
            if let Some((other, other_local)) = test.across {
                add(other, other_local, -1.0);
            }
        }
    }

    /// By facet of a centre and moment on it, of the first `kept` ones, the products, over the centre, of
    /// the lift of the function that has this moment with the lift of jumps, given by facet and moment as
    /// seen from the centre.
    pub fn products_with_moments(
        &self,
        neighbours: &Neighbours,
        centre: usize,
        jumps: &[[f64; MAX_MOMENTS]; 4],
        kept: usize,
    ) -> [[f64; 3]; 4] {
        let metric = self.metrics.at::<D>(centre);
        let facets: [Option<JumpFacet>; 4] = std::array::from_fn(|local| match local <= D {
            true => self.jump_facet(neighbours, centre, &metric, local),
            false => None,
        });
        let weighted = |facet: &JumpFacet, moments: &[f64; MAX_MOMENTS]| match &facet.products {
            Some(products) => weigh(products, moments),
            None => *moments,
        };
        let mut sums = [[0.0; 3]; 4];
        for test in facets.iter().flatten() {
            for trial in facets.iter().flatten() {
                let jump = weighted(trial, &jumps[trial.local]);
                let products = &self.table.products[test.local][trial.local];
                let scale = self.scale(centre, &metric, test, trial);
                for (k, sum) in sums[test.local].iter_mut().enumerate().take(kept) {
                    let mut moment = [0.0; MAX_MOMENTS];
                    moment[k] = 1.0;
                    let tested = weighted(test, &moment);
                    for (row, &tested) in products.iter().zip(&tested) {
                        for (&product, &jump) in row.iter().zip(&jump) {
                            *sum += scale * tested * product * jump;
                        }
                    }
                }
            }
        }
        sums
    }

    /// The product of the lifts of Dirichlet data on two facets of a centre, each given by the number of
    /// the facet and the moments of the datum, of which lifts take the first.
    pub fn product_of_data(
        &self,
        neighbours: &Neighbours,
        centre: usize,
        (first, first_moments): &(usize, Vec<f64>),
        (second, second_moments): &(usize, Vec<f64>),
    ) -> f64 {
        let metric = self.metrics.at::<D>(centre);
        let facet = |local| self.jump_facet(neighbours, centre, &metric, local);
        let (Some(a), Some(b)) = (facet(*first), facet(*second)) else { return 0.0 };
        let scale = self.scale(centre, &metric, &a, &b);
        let (a, b) = (lifted_moments(&a, first_moments), lifted_moments(&b, second_moments));
        let mut sum = 0.0;
        for (products, &a) in self.table.products[*first][*second].iter().zip(&a) {
            for (&product, &b) in products.iter().zip(&b) {
                sum += scale * a * product * b;
            }
        }
        sum
    }
}

/// The moments of a Dirichlet datum of which lifts are made, weighted where the coefficient varies.
fn lifted_moments(facet: &JumpFacet, moments: &[f64]) -> [f64; MAX_MOMENTS] {
    let mut lifted = [0.0; MAX_MOMENTS];
    lifted.iter_mut().zip(moments).for_each(|(to, &from)| *to = from);
    facet.products.as_ref().map_or(lifted, |products| weigh(products, &lifted))
}
