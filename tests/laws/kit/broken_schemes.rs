//! Schemes with one mistake each.

use std::sync::Arc;

use unilateral::element::{Entity, Layout, Node};
use unilateral::facet::proven_bound;
use unilateral::kit::{KitError, KitErrorKind, Law, check_element, check_law, check_scheme};
use unilateral::prelude::*;

/// Interior penalty `sigma [u][v] - a {d_n u}[v] - b {d_n v}[u]` with a wrong sign, share or
/// declaration at will.
#[derive(Clone, Copy)]
struct Form<const SYMMETRIC: bool> {
    /// Factor of the consistency term.
    flux: f64,
    /// Factor of its mirror image.
    mirrored: f64,
    /// Factor of the proven penalty.
    share: f64,
    /// Added to the penalty in units of itself where the cell here is the larger one.
    lean: f64,
    /// Power of the diameter of the facet by which the penalty is multiplied.
    power: i32,
}

impl<const SYMMETRIC: bool> Form<SYMMETRIC> {
    const RIGHT: Self = Self { flux: 1.0, mirrored: 1.0, share: 1.5, lean: 0.0, power: 0 };
}

impl<const D: usize, const SYMMETRIC: bool> FacetForm<D> for Form<SYMMETRIC> {
    fn is_symmetric(&self) -> bool {
        SYMMETRIC
    }
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        let here_is_larger = facet.there.as_ref().is_some_and(|t| facet.here.volume > t.volume);
        let lean = if here_is_larger { 1.0 + self.lean } else { 1.0 };
        let power = facet.diameter().powi(self.power);
        (self.share * lean * power) * proven_bound::<D>(1, facet)
    }
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        let [flux, mirrored] = [self.flux, self.mirrored];
        penalty * u.jump * v.jump - flux * u.flux * v.jump - mirrored * v.flux * u.jump
    }
}

/// A scheme with such a form, on the broken version of some element.
struct Broken1<E, const SYMMETRIC: bool, const CONSISTENT: bool> {
    form: Form<SYMMETRIC>,
    element: E,
}

impl<const D: usize, E, const SYMMETRIC: bool, const CONSISTENT: bool> Scheme<D>
    for Broken1<E, SYMMETRIC, CONSISTENT>
where
    E: Element<D> + Copy + 'static,
{
    fn name(&self) -> &str {
        "broken"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(self.element))
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(self.form)
    }
    fn is_consistent(&self) -> bool {
        CONSISTENT
    }
}

type Symmetric = Broken1<P1, true, true>;
type NotSymmetric = Broken1<P1, false, true>;
type NotConsistent = Broken1<P1, true, false>;

fn symmetric(form: Form<true>) -> Symmetric {
    Broken1 { form, element: P1 }
}

/// The law by itself and all laws together fail with an error that names the law.
fn caught<R1, R2>(law: Law, alone: Result<R1, KitError>, all: Result<R2, KitError>) -> KitError {
    let alone = alone.err().unwrap_or_else(|| panic!("the law of {law} does not catch it"));
    let all = all.err().unwrap_or_else(|| panic!("no law catches it"));
    for error in [&alone, &all] {
        assert_eq!(error.law, law, "{error}");
        assert!(error.to_string().starts_with(&format!("{law}: ")), "{error}");
    }
    alone
}

/// The error is of this kind, and its sentence contains the words.
#[track_caller]
fn is(error: &KitError, kind: KitErrorKind, words: &str) {
    assert_eq!(error.kind, kind, "{error}");
    assert!(error.to_string().contains(words), "{error}");
}

/// The number that follows some words in the sentence of an error.
#[track_caller]
fn number_after(error: &KitError, words: &str) -> f64 {
    let sentence = error.to_string();
    let (_, rest) = sentence.split_once(words).unwrap_or_else(|| panic!("{words}: {sentence}"));
    let number = rest.split([' ', ',', ';', ')']).next().and_then(|number| number.parse().ok());
    number.unwrap_or_else(|| panic!("a number after {words}: {sentence}"))
}

#[test]
fn the_same_form_without_a_mistake_passes() {
    let scheme = symmetric(Form::RIGHT);
    let report = check_scheme::<2>(&scheme).unwrap_or_else(|e| panic!("{e}"));
    let sipg = check_scheme::<2>(&Sipg::default()).unwrap_or_else(|e| panic!("{e}"));
    // coercivity and orders
    for law in [2, 5] {
        assert_eq!(report.laws[law], sipg.laws[law]);
    }
}

fn wrong_sign<const D: usize>() {
    let scheme = symmetric(Form { flux: -1.0, mirrored: -1.0, ..Form::RIGHT });
    let error = caught(
        Law::Consistency,
        check_law::<D>(Law::Consistency, &scheme),
        check_scheme::<D>(&scheme),
    );
    is(&error, KitErrorKind::NotConsistent, "against a polynomial of degree 1");
    let [size, tolerance] =
        ["of degree 1 is ", "rounding explains "].map(|w| number_after(&error, w));
    assert!(size > 1e6 * tolerance, "{error}");
}

#[test]
fn a_wrong_sign_of_the_flux_is_not_consistent() {
    wrong_sign::<1>();
    wrong_sign::<2>();
    wrong_sign::<3>();
}

#[test]
fn a_wrong_factor_of_the_flux_is_not_consistent() {
    let scheme = symmetric(Form { flux: 1.001, mirrored: 1.001, ..Form::RIGHT });
    let [alone, all] =
        [check_law::<2>(Law::Consistency, &scheme).err(), check_scheme::<2>(&scheme).err()];
    for error in [alone, all] {
        let kind = error.as_ref().map(|error| error.kind);
        assert_eq!(kind, Some(KitErrorKind::NotConsistent), "{error:?}");
    }
}

fn lopsided<const D: usize>() {
    let scheme = symmetric(Form { mirrored: 0.0, ..Form::RIGHT });
    let error =
        caught(Law::Symmetry, check_law::<D>(Law::Symmetry, &scheme), check_scheme::<D>(&scheme));
    assert_eq!(error.kind, KitErrorKind::NotSymmetric, "{error}");
    let [row, entry, mirrored] =
        ["the entry at (", ") is ", "mirror image "].map(|words| number_after(&error, words));
    let column = number_after(&error, &format!("({row}, "));
    assert!(row != column && (entry - mirrored).abs() > 1e-2, "{error}");
}

#[test]
fn an_incomplete_form_is_not_symmetric() {
    lopsided::<1>();
    lopsided::<2>();
    lopsided::<3>();
}

#[test]
fn a_form_that_hides_its_symmetry_is_told() {
    let scheme = NotSymmetric { form: Form::RIGHT, element: P1 };
    let error =
        caught(Law::Symmetry, check_law::<2>(Law::Symmetry, &scheme), check_scheme::<2>(&scheme));
    is(&error, KitErrorKind::SymmetricAfterAll, "declare it symmetric");
}

fn leaning<const D: usize>() {
    let scheme = symmetric(Form { lean: 0.01, ..Form::RIGHT });
    let error = caught(
        Law::Invariance,
        check_law::<D>(Law::Invariance, &scheme),
        check_scheme::<D>(&scheme),
    );
    assert_eq!(error.kind, KitErrorKind::EntryDependsOnNumbering, "{error}");
    let [before, after] = ["changes from ", " to "].map(|words| number_after(&error, words));
    assert!((before - after).abs() > 1e-3 * before.abs(), "{error}");
}

#[test]
fn a_penalty_that_depends_on_orientation_is_not_invariant() {
    leaning::<1>();
    leaning::<2>();
    leaning::<3>();
}

fn too_weak<const D: usize>(share: f64) {
    let scheme = symmetric(Form { share, ..Form::RIGHT });
    let error = caught(
        Law::Coercivity,
        check_law::<D>(Law::Coercivity, &scheme),
        check_scheme::<D>(&scheme),
    );
    assert_eq!(error.kind, KitErrorKind::NotCoercive, "{error}");
    let [not_positive, unknowns, smallest] =
        ["the form has ", " of ", "the smallest "].map(|words| number_after(&error, words));
    assert!(not_positive > 0.0 && not_positive < unknowns && smallest < 0.0, "{error}");
}

/// The proven bound is sharp in one dimension; above it the measured thresholds are less.
#[test]
fn a_penalty_below_the_threshold_is_not_coercive() {
    too_weak::<1>(0.9);
    too_weak::<2>(0.4);
    too_weak::<3>(0.2);
}

#[test]
fn a_consistent_form_that_says_otherwise_is_told() {
    let scheme = NotConsistent { form: Form::RIGHT, element: P1 };
    let error = caught(
        Law::Consistency,
        check_law::<2>(Law::Consistency, &scheme),
        check_scheme::<2>(&scheme),
    );
    is(&error, KitErrorKind::ConsistentAfterAll, "declare it consistent");
}

/// A penalty without consistency terms is not consistent and, of this strength, not convergent.
#[test]
fn a_penalty_alone_misses_the_order() {
    let form = Form { flux: 0.0, mirrored: 0.0, ..Form::RIGHT };
    let scheme = NotConsistent { form, element: P1 };
    let error =
        caught(Law::Orders, check_law::<2>(Law::Orders, &scheme), check_scheme::<2>(&scheme));
    is(&error, KitErrorKind::OrderMissed, "the H1 error falls from");
    let [measured, expected] = ["an order of ", "where "].map(|words| number_after(&error, words));
    assert!(measured < 0.5 && expected == 1.0, "{error}");
}

/// With the power of the weak over-penalty it converges.
#[test]
fn an_over_penalty_alone_does_not() {
    let form = Form { flux: 0.0, mirrored: 0.0, power: -2, ..Form::RIGHT };
    let scheme = NotConsistent { form, element: P1 };
    let orders = check_law::<2>(Law::Orders, &scheme).unwrap_or_else(|e| panic!("{e}"));
    assert!(orders.figure("H1") > Some(0.8), "{orders:?}");
}

/// Linears with a mistake, by number.
#[derive(Clone, Copy, Debug)]
struct Wrong<const MISTAKE: usize>;

const DERIVATIVE: usize = 0;
const NODE: usize = 1;
const SUM: usize = 2;
const COUNT: usize = 3;
const DEGREE: usize = 4;
const ENTITY: usize = 5;
const MANY: usize = 6;

impl<const D: usize, const MISTAKE: usize> Element<D> for Wrong<MISTAKE> {
    fn degree(&self) -> usize {
        if MISTAKE == DEGREE { 2 } else { 1 }
    }
    fn basis_degree(&self) -> usize {
        if MISTAKE == DEGREE || MISTAKE == SUM { 2 } else { 1 }
    }
    fn layout(&self) -> Layout {
        let cell = match MISTAKE {
            COUNT => 1,
            MANY => 18,
            _ => 0,
        };
        Layout { vertex: 1, edge: 0, facet: 0, cell }
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        Element::<D>::values(&P1, lambda, out);
        if MISTAKE == SUM {
            // vanishes at all vertices
            out[0] += lambda[0] * lambda[1];
        }
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        Element::<D>::derivatives(&P1, lambda, out);
        if MISTAKE == DERIVATIVE {
            out[1][0] = 0.125;
        }
    }
    fn node(&self, i: usize) -> Node {
        match Node::vertex(i) {
            _ if MISTAKE == NODE => Node::facet_mean(i),
            right if MISTAKE == ENTITY => Node::value(Entity::Cell, right.centre(D)),
            right => right,
        }
    }
}

/// Quadratics that state the degree of linears for themselves and for their basis.
#[derive(Clone, Copy, Debug)]
struct Understated;

impl<const D: usize> Element<D> for Understated {
    fn degree(&self) -> usize {
        1
    }
    fn layout(&self) -> Layout {
        Element::<D>::layout(&P2)
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        Element::<D>::values(&P2, lambda, out);
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        Element::<D>::derivatives(&P2, lambda, out);
    }
    fn node(&self, i: usize) -> Node {
        Element::<D>::node(&P2, i)
    }
}

fn wrong_element<const D: usize, const MISTAKE: usize>() -> KitError {
    let scheme = Broken1::<_, true, true> { form: Form::RIGHT, element: Wrong::<MISTAKE> };
    caught(Law::Element, check_element::<D>(&Wrong::<MISTAKE>), check_scheme::<D>(&scheme))
}

fn wrong_elements<const D: usize>() {
    let error = wrong_element::<D, DERIVATIVE>();
    is(&error, KitErrorKind::WrongDerivative, "basis function 1 has derivative");
    let error = wrong_element::<D, NODE>();
    is(&error, KitErrorKind::NotDual, "node 0 of");
    let error = wrong_element::<D, SUM>();
    is(&error, KitErrorKind::NotPartitionOfUnity, "not to one");
    let error = wrong_element::<D, DEGREE>();
    is(&error, KitErrorKind::PolynomialMissing, "a polynomial of degree 2");
    let error = check_element::<D>(&Understated).unwrap_err();
    is(&error, KitErrorKind::DegreeExceeded, "a rule for basis functions of degree 1 gives");
    is(&error, KitErrorKind::DegreeExceeded, "the square of function 0,");
    // the value at a vertex as a functional of the cell, where the vertex owns the unknown
    let error = check_element::<D>(&Wrong::<ENTITY>).unwrap_err();
    is(&error, KitErrorKind::NodeElsewhere, "node 0 is tied to Cell");
}

#[test]
fn mistakes_of_elements_are_told_apart() {
    wrong_elements::<1>();
    wrong_elements::<2>();
    wrong_elements::<3>();
}

/// The layout has an unknown in the cell for which no function is written.
#[test]
fn a_function_that_is_not_written_is_told() {
    let error = wrong_element::<2, COUNT>();
    is(&error, KitErrorKind::NotANumber, "basis function 3 is");
}

/// More functions than the assembler has room for are refused by the kit and by the assembler.
#[test]
fn too_many_functions_are_told() {
    let error = wrong_element::<2, MANY>();
    is(&error, KitErrorKind::TooManyFunctions, "21 unknowns of a cell, at most 20");
    let mesh = Mesh::kuhn_box(&BoxDomain::centred(1.0), [2; 2]).unwrap();
    let scheme = Broken1::<_, true, true> { form: Form::RIGHT, element: Wrong::<MANY> };
    let problem = Problem::new();
    let refused = Discretisation::new(&scheme, &problem, &mesh, Default::default());
    let message = refused.unwrap_err().to_string();
    assert!(message.contains("at most 20 unknowns"), "{message}");
}
