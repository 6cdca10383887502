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
//! degree `p - 1`, and what `m` has of degree `p` on those of degree `p`. Where it varies in `K`, the lift is
//! `-n s w` with `int_K alpha s q = int_F m q` by the points of the rule in `K`. With the stiffness at these
//! points the square is then completed: the form is coercive for every penalty.

use std::borrow::Cow;

use super::Coupled;
use crate::assemble::space::Space;
use crate::assemble::space::coefficient::weighted_polynomials::{
    Factor, Functional, MOST, facet_moments, product,
};
use crate::assemble::space::metric::{CellMetric, Metrics};
use crate::assemble::space::tables::FacetDatum;
use crate::assemble::space::tables::FacetTable;
use crate::assemble::trace::flux_weight;
use crate::element::MAX_BASIS;
use crate::facet::FacetForm;
use crate::mesh::HalfFacet;

/// Most moments a lift is made of: quadratics on a triangle.
pub(crate) const MAX_MOMENTS: usize = 6;

/// The moments of a jump on a facet.
type Moments = [f64; MAX_MOMENTS];
/// By two moments a number.
type Product = [Moments; MAX_MOMENTS];

/// Lifts on the reference cell.
struct LiftTable {
    /// Moments of the basis, of degree up to that of lifts.
    facets: FacetTable,
    /// The degree of lifts.
    degree: usize,
    /// Number of moments on a facet.
    moments: usize,
    /// By facet and moment on it, its means with the polynomials of the cell.
    tests: Vec<Vec<Functional>>,
    /// For two facets, the products of the lifts of their moments, per measures and volume.
    products: [[Product; 4]; 4],
}

impl LiftTable {
    /// The lifts of this degree of a space of degree one or two.
    fn new<const D: usize>(space: &Space<'_, D>, degree: usize) -> Self {
        let mut products = [[[[0.0; MAX_MOMENTS]; MAX_MOMENTS]; 4]; 4];
        let tests: Vec<_> = (0..D + 1).map(|l| facet_moments(D, degree, l)).collect();
        for l in 0..=D {
            for k in 0..=D {
                for (m, a) in tests[l].iter().enumerate() {
                    for (n, b) in tests[k].iter().enumerate() {
                        products[l][k][m][n] = product(a, b);
                    }
                }
            }
        }
        let facets = space.facet_table(degree);
        Self { degree, moments: facets.degrees.len(), tests, facets, products }
    }
}

/// The lifts of a discretisation.
pub(crate) struct Lifting<'s, 'a, const D: usize> {
    space: &'s Space<'a, D>,
    form: &'s dyn FacetForm<D>,
    metrics: &'s Metrics,
    table: LiftTable,
}

/// A facet of a centre whose jump is lifted.
struct JumpFacet {
    local: usize,
    /// The facet seen from the other cell; none on the boundary.
    other: Option<HalfFacet>,
    /// The weight of the centre's normal derivative in the flux; one where the coefficient varies in one
    /// of the cells.
    flux_weight: f64,
    /// There, the products of moments with that weight at the points of the facet.
    products: Option<Product>,
}

impl JumpFacet {
    /// What is lifted of a jump with these moments: they are those of the weight times the jump where the coefficient
    /// varies.
    fn weighted(&self, moments: &Moments) -> Moments {
        let Some(products) = &self.products else { return *moments };
        let sum = |row: &Moments| row.iter().zip(moments).fold(0.0, |sum, (&p, &m)| sum + p * m);
        std::array::from_fn(|k| sum(&products[k]))
    }
    /// What is lifted of a datum, of whose moments lifts take the first.
    fn weighted_datum(&self, datum: &[f64]) -> Moments {
        self.weighted(&std::array::from_fn(|k| datum.get(k).copied().unwrap_or(0.0)))
    }
}

/// A cell to which the jumps on its facets are lifted.
struct Centre<const D: usize> {
    cell: usize,
    metric: CellMetric<D>,
    /// By number, the facets on whose jumps a form acts.
    facets: [Option<JumpFacet>; 4],
    /// Where the coefficient varies in the cell, by facet and moment on it the lift: its values in an orthonormal basis.
    lifts: Option<[[Functional; MAX_MOMENTS]; 4]>,
}

impl<'s, 'a, const D: usize> Lifting<'s, 'a, D> {
    /// The lifts of a form, with the metrics of all cells.
    pub fn new(space: &'s Space<'a, D>, form: &'s dyn FacetForm<D>, metrics: &'s Metrics) -> Self {
        let table = LiftTable::new(space, form.lift_degree(space.basis_degree));
        Self { space, form, metrics, table }
    }

    /// Adds the products to the rows of a cell.
    pub fn add(&self, cell: usize, coupled: &Coupled, rows: &mut [f64]) {
        self.add_centre(cell, None, coupled, rows);
        for local in 0..=D {
            let facet = self.space.form_facet((cell, local));
            if let Some((centre, shared)) = facet.and_then(|facet| facet.other((cell, local))) {
                self.add_centre(centre, Some((shared, local)), coupled, rows);
            }
        }
    }

    /// Adds what one centre contributes to the rows of a cell: the cell itself, or a neighbour that
    /// shares one facet with the cell, with the number of this facet in the centre and in the cell.
    fn add_centre(
        &self,
        centre: usize,
        shared: Option<(usize, usize)>,
        coupled: &Coupled,
        rows: &mut [f64],
    ) {
        let centre = self.centre(centre);
        let n = self.space.per_cell();
        let row = rows.len() / n;
        for test in centre.facets.iter().flatten() {
            let (sign, local) = match shared {
                None => (1.0, test.local),
                Some((in_centre, in_cell)) if in_centre == test.local => (-1.0, in_cell),
                Some(_) => continue,
            };
            let tested = self.functions(local, test);
            for trial in centre.facets.iter().flatten() {
                let scale = sign * self.scale(&centre, test, trial);
                let products = self.products(&centre, [test, trial]);
                let lifted = self.lifted(&tested, &products, scale);
                let mut add = |(cell, local): HalfFacet, sign| {
                    let trials = self.functions(local, trial);
                    let start = coupled.position(cell) * n;
                    self.add_products(&lifted, &trials[..n], sign, (start, row), rows);
                };
                add((centre.cell, trial.local), 1.0);
                if let Some(other) = trial.other {
                    add(other, -1.0);
                }
            }
        }
    }

    /// A cell with the facets on whose jumps the form acts.
    fn centre(&self, cell: usize) -> Centre<D> {
        let facet = |local| if local <= D { self.jump_facet((cell, local)) } else { None };
        let varying = self.space.varying_in(cell);
        Centre {
            cell,
            metric: self.metrics.at(cell),
            facets: std::array::from_fn(facet),
            lifts: varying
                .map(|(varying, values)| self.lifts(&varying.factor(self.table.degree, values))),
        }
    }

    /// By facet and moment the lifts in a cell with this factor.
    fn lifts(&self, factor: &Factor) -> [[Functional; MAX_MOMENTS]; 4] {
        let mut lifts = [[[0.0; MOST]; MAX_MOMENTS]; 4];
        for (of_facet, tests) in lifts.iter_mut().zip(&self.table.tests) {
            of_facet.iter_mut().zip(tests).for_each(|(lift, test)| *lift = factor.solve(test));
        }
        lifts
    }

    /// The products of the lifts of jumps on two facets of a centre, by moments: per measures and volume, and times the
    /// coefficient where that is a constant.
    fn products(&self, centre: &Centre<D>, [test, trial]: [&JumpFacet; 2]) -> Cow<'_, Product> {
        let Some(lifts) = &centre.lifts else {
            return Cow::Borrowed(&self.table.products[test.local][trial.local]);
        };
        let [of_test, of_trial] = [test, trial].map(|facet| &lifts[facet.local]);
        let mut products = [[0.0; MAX_MOMENTS]; MAX_MOMENTS];
        for (row, a) in products.iter_mut().zip(of_test).take(self.table.moments) {
            for (entry, b) in row.iter_mut().zip(of_trial).take(self.table.moments) {
                *entry = product(a, b);
            }
        }
        Cow::Owned(products)
    }

    /// A facet of a centre, if the form acts on its jumps.
    fn jump_facet(&self, own: HalfFacet) -> Option<JumpFacet> {
        let facet = self.space.form_facet(own)?;
        let (is_here, other) = (facet.here == own, facet.other(own));
        let view = self.space.facet_view(facet, Some(self.metrics));
        let average_weight = self.form.average_weight(&view);
        let of_normal = self.space.normal_component(own);
        let flux_weight = flux_weight(&view, average_weight, (is_here, of_normal));
        // on the boundary it is not read
        let own_weight = if is_here { average_weight } else { 1.0 - average_weight };
        let product = self.space.flux_products(own, other, own_weight);
        let products = product.map(|of| std::array::from_fn(|k| std::array::from_fn(|l| of(k, l))));
        let flux_weight = if products.is_some() { 1.0 } else { flux_weight };
        Some(JumpFacet { local: own.1, other, flux_weight, products })
    }

    /// `D^2 w w' / alpha int grad lambda . grad lambda'`, without `alpha` where it varies.
    fn scale(&self, centre: &Centre<D>, test: &JumpFacet, trial: &JumpFacet) -> f64 {
        let product = centre.metric.products[test.local][trial.local];
        let alpha = if centre.lifts.is_some() { 1.0 } else { self.space.alpha(centre.cell) };
        ((D * D) as f64) * test.flux_weight * trial.flux_weight * product / alpha
    }

    /// What is lifted of the functions of a cell, which sees a facet of a centre as its facet `local`.
    fn functions(&self, local: usize, facet: &JumpFacet) -> [Moments; MAX_BASIS] {
        let mut moments = [[0.0; MAX_MOMENTS]; MAX_BASIS];
        for (m, basis) in self.table.facets.on(local).iter().enumerate() {
            for (moments, &value) in moments.iter_mut().zip(&basis.values) {
                moments[m] = value;
            }
        }
        for moments in &mut moments[..self.space.per_cell()] {
            *moments = facet.weighted(moments);
        }
        moments
    }

    /// By what the moments of a trial jump are multiplied in its products with test functions.
    fn lifted(
        &self,
        tested: &[Moments; MAX_BASIS],
        products: &Product,
        scale: f64,
    ) -> [Moments; MAX_BASIS] {
        let mut lifted = [[0.0; MAX_MOMENTS]; MAX_BASIS];
        for i in 0..self.space.per_cell() {
            for n in 0..self.table.moments {
                for m in 0..self.table.moments {
                    lifted[i][n] += scale * tested[i][m] * products[m][n];
                }
            }
        }
        lifted
    }

    /// Adds the products of test functions with some trial jumps to a block of rows of this length.
    fn add_products(
        &self,
        lifted: &[Moments; MAX_BASIS],
        trials: &[Moments],
        sign: f64,
        (start, row): (usize, usize),
        rows: &mut [f64],
    ) {
        for (i, lifted) in lifted.iter().enumerate().take(self.space.per_cell()) {
            let out = &mut rows[i * row + start..][..trials.len()];
            for (out, trial) in out.iter_mut().zip(trials) {
                for m in 0..self.table.moments {
                    *out += sign * lifted[m] * trial[m];
                }
            }
        }
    }

    /// Adds to the load by cell the products of the lifts of basis functions with the lift of a Dirichlet datum.
    pub fn add_load(&self, datum: &FacetDatum, load: &mut [f64]) {
        let (cell, local) = datum.facet;
        let centre = self.centre(cell);
        let trial = centre.facets[local].as_ref().expect("the form acts where there is a datum");
        let weighted = trial.weighted_datum(&datum.moments);
        for test in centre.facets.iter().flatten() {
            let scale = self.scale(&centre, test, trial);
            let products = self.products(&centre, [test, trial]);
            let mut add = |(cell, local): HalfFacet, sign| {
                let lifted = self.lifted(&self.functions(local, test), &products, scale);
                let start = cell * self.space.per_cell();
                self.add_products(&lifted, &[weighted], sign, (start, 1), load);
            };
            add((cell, test.local), 1.0);
            if let Some(other) = test.other {
                add(other, -1.0);
            }
        }
    }

    /// Adds the product of the lifts of two jumps on facets of a centre.
    fn add_product(
        &self,
        centre: &Centre<D>,
        (test, tested): (&JumpFacet, &Moments),
        (trial, jump): (&JumpFacet, &Moments),
        sum: &mut f64,
    ) {
        let scale = self.scale(centre, test, trial);
        let products = self.products(centre, [test, trial]);
        for (row, &tested) in products.iter().zip(tested) {
            for (&product, &jump) in row.iter().zip(jump) {
                *sum += scale * tested * product * jump;
            }
        }
    }

    /// By facet of a centre and moment on it, of the first `kept` ones, the products, over the centre, of
    /// the lift of the function that has this moment with the lift of jumps, given by facet and moment as
    /// seen from the centre.
    pub fn products_with_moments(
        &self,
        centre: usize,
        jumps: &[Moments; 4],
        kept: usize,
    ) -> [[f64; 3]; 4] {
        let centre = self.centre(centre);
        let mut sums = [[0.0; 3]; 4];
        for test in centre.facets.iter().flatten() {
            for trial in centre.facets.iter().flatten() {
                let jump = trial.weighted(&jumps[trial.local]);
                for (k, sum) in sums[test.local].iter_mut().enumerate().take(kept) {
                    let tested = test.weighted(&std::array::from_fn(|m| f64::from(m == k)));
                    self.add_product(&centre, (test, &tested), (trial, &jump), sum);
                }
            }
        }
        sums
    }

    /// The product of the lifts of Dirichlet data on two facets of a centre.
    pub fn product_of_data(&self, first: &FacetDatum, second: &FacetDatum) -> f64 {
        let centre = self.centre(first.facet.0);
        let [test, trial] = [first, second].map(|datum| {
            let facet = centre.facets[datum.facet.1].as_ref();
            let facet = facet.expect("the form acts where there is a datum");
            (facet, facet.weighted_datum(&datum.moments))
        });
        let mut sum = 0.0;
        self.add_product(&centre, (test.0, &test.1), (trial.0, &trial.1), &mut sum);
        sum
    }
}
