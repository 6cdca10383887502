//! Forms made outside the library whose formula depends on the facet.

use std::sync::Arc;

use unilateral::algebra::Inequality;
use unilateral::facet::FacetKind;
use unilateral::kit::{Law, check_scheme};
use unilateral::mesh::{BoundaryCondition, BoxDomain, Mesh};
use unilateral::prelude::*;

/// Nothing or an over-penalty between cells, Nitsche's method on the Dirichlet boundary.
struct NitscheAtBoundary {
    between_cells: f64,
}

impl<const D: usize> FacetForm<D> for NitscheAtBoundary {
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        let h = facet.diameter();
        match facet.kind() {
            FacetKind::Interior => self.between_cells * facet.coefficient() / (h * h * h),
            FacetKind::Dirichlet => 20.0 * facet.coefficient() / h,
        }
    }
    fn integrand(&self, facet: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        let jumps = penalty * u.jump * v.jump;
        match facet.kind() {
            FacetKind::Interior => jumps,
            FacetKind::Dirichlet => jumps - u.flux * v.jump - v.flux * u.jump,
        }
    }
}

/// Continuous linears with weak Dirichlet data: consistent.
struct Nitsche;

impl<const D: usize> Scheme<D> for Nitsche {
    fn name(&self) -> &str {
        "nitsche"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(P1)
    }
    fn dirichlet(&self) -> DirichletBy {
        DirichletBy::FacetForm
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(NitscheAtBoundary { between_cells: 0.0 })
    }
}

/// Broken linears, over-penalised between cells: consistent on the boundary only.
struct OverPenaltyWithNitsche;

impl<const D: usize> Scheme<D> for OverPenaltyWithNitsche {
    fn name(&self) -> &str {
        "over-penalty-with-nitsche"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(P1))
    }
    fn is_consistent(&self) -> bool {
        false
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(NitscheAtBoundary { between_cells: 10.0 })
    }
}

/// All laws hold in every dimension; the patch test tells the two apart.
#[test]
fn no_flux_inside_and_nitsche_on_the_boundary_is_one_form() {
    fn on<const D: usize>() {
        let nitsche = check_scheme::<D>(&Nitsche).unwrap_or_else(|e| panic!("{e}"));
        let error = nitsche.figure(Law::Consistency, "error").unwrap();
        assert!(!nitsche.to_string().contains("not consistent") && error < 1e-12, "{nitsche}");
        let broken = check_scheme::<D>(&OverPenaltyWithNitsche);
        let broken = broken.unwrap_or_else(|e| panic!("{e}"));
        assert!(broken.to_string().contains("not consistent"), "{broken}");
        assert!(broken.figure(Law::Orders, "H1") > Some(0.75), "{broken}");
    }
    on::<1>();
    on::<2>();
    on::<3>();
    let report = Study::<2>::new(scenes::radial(1.0))
        .scheme(ConformingP1)
        .scheme(Nitsche)
        .scheme(OverPenaltyWithNitsche)
        .levels([16, 32])
        .run()
        .unwrap();
    for row in report.rows.iter().filter(|row| row.level == 32) {
        assert!(row.converged() && row.certificate.largest() < 1e-9, "{}", row.scheme);
        let order = row.order.h1.unwrap();
        assert!((0.93..1.07).contains(&order), "{}: {order:.3}", row.scheme);
    }
}

/// Interior penalty with the weight in the formula instead of in the penalty, so that it differs from
/// facet to facet.
struct WeightInFormula(f64);

impl<const D: usize> FacetForm<D> for WeightInFormula {
    fn penalty(&self, _: &FacetView<D>) -> f64 {
        1.0
    }
    fn integrand(&self, facet: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        let weight = self.0 * facet.coefficient() / facet.diameter();
        weight * penalty * u.jump * v.jump - u.flux * v.jump - v.flux * u.jump
    }
}

struct SipgByFormula<E>(E);

impl<const D: usize, E: Element<D> + Copy + 'static> Scheme<D> for SipgByFormula<E> {
    fn name(&self) -> &str {
        "sipg-by-formula"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(self.0))
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(WeightInFormula(30.0))
    }
}

#[track_caller]
fn same_matrix_and_load(a: &Inequality<f64>, b: &Inequality<f64>) {
    let largest = a.matrix.values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    assert_eq!(a.matrix.columns, b.matrix.columns);
    for (a, b) in a.matrix.values.iter().zip(&b.matrix.values) {
        assert!((a - b).abs() < 1e-13 * largest, "matrix: {a} and {b}");
    }
    for (a, b) in a.assembled_load().iter().zip(&*b.assembled_load()) {
        assert!((a - b).abs() < 1e-13 * largest, "load: {a} and {b}");
    }
}

/// A formula that differs between facets is read off on each of them: matrix, load and energy are
/// those of the penalty.
#[test]
fn a_formula_may_differ_from_facet_to_facet() {
    fn check<const D: usize, E: Element<D> + Copy + 'static>(element: E) {
        let sides = [[BoundaryCondition::Dirichlet, BoundaryCondition::Neumann]; D];
        let mut upper = Point::repeat(1.0);
        upper[0] = 1.7;
        let mesh =
            Mesh::<D>::kuhn_box(&BoxDomain::new(Point::zeros(), upper, sides), [3; D]).unwrap();
        let problem = Problem::new()
            .coefficient(|x: &Point<D>| 1.0 + 3.0 * x[0])
            .exact(|x: &Point<D>| x[0] * x[D - 1], |_| Point::repeat(1.0));
        let penalty = PenaltyRule::Diameter(30.0);
        let known = Sipg { penalty }.on(element);
        let known = Discretisation::new(&known, &problem, &mesh, Default::default()).unwrap();
        let own = SipgByFormula(element);
        let own = Discretisation::new(&own, &problem, &mesh, Default::default()).unwrap();
        let [a, b] = [&known, &own].map(|d| d.inequality().unwrap());
        same_matrix_and_load(&a, &b);
        let u: Vec<f64> = (0..a.size()).map(|i| ((i * 7) % 5) as f64).collect();
        let [a, b] = [&known, &own].map(|d| d.errors(&u).unwrap().energy.unwrap());
        assert!((a / b - 1.0).abs() < 1e-12, "{D}D, energy: {a} and {b}");
    }
    check::<1, _>(P1);
    check::<2, _>(P1);
    check::<3, _>(P1);
    check::<1, _>(P2);
    check::<2, _>(P2);
    check::<3, _>(P2);
}

/// The local discontinuous Galerkin method, without a word on the degree of its lifts.
struct FluxesAndJumps;

impl<const D: usize> FacetForm<D> for FluxesAndJumps {
    fn is_lifted(&self) -> bool {
        true
    }
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        facet.coefficient() / facet.diameter()
    }
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump - u.flux * v.jump - v.flux * u.jump
    }
}

struct OwnLdg<E>(E);

impl<const D: usize, E: Element<D> + Copy + 'static> Scheme<D> for OwnLdg<E> {
    fn name(&self) -> &str {
        "own-ldg"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(self.0))
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(FluxesAndJumps)
    }
}

/// Without a word on lifts they have one degree less than the element.
#[test]
fn lifts_have_the_degree_of_gradients_by_default() {
    fn check<E: Element<2> + Copy + 'static>(element: E) {
        let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [3; 2]).unwrap();
        let problem = Problem::new().dirichlet(|x: &Point<2>| x[0] * x[1]);
        let known = Ldg::default().on(element);
        let known = Discretisation::new(&known, &problem, &mesh, Default::default()).unwrap();
        let own = OwnLdg(element);
        let own = Discretisation::new(&own, &problem, &mesh, Default::default()).unwrap();
        same_matrix_and_load(&known.inequality().unwrap(), &own.inequality().unwrap());
    }
    check(P1);
    check(P2);
}
