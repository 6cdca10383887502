//! What a scheme or a problem does not have costs nothing and changes no bit.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use unilateral::algebra::{Bound, Inequality};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::element::Layout;
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::scheme::{SCHEMES, scheme_by_name};

/// The number of calls of a function.
#[derive(Clone, Debug, Default)]
struct Calls(Arc<AtomicUsize>);

impl Calls {
    fn count(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
    fn get(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }
}

/// The 4 x 4 box: 32 cells, 40 interior facets and four facets on each side.
fn mesh(sides: [[BoundaryCondition; 2]; 2]) -> Mesh<2> {
    mesh_of(4, sides)
}

fn mesh_of(n: usize, sides: [[BoundaryCondition; 2]; 2]) -> Mesh<2> {
    let mut domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    domain.sides = sides;
    Mesh::kuhn_box(&domain, [n, n]).unwrap()
}

/// Two Dirichlet sides, a Neumann and a contact side.
const MIXED: [[BoundaryCondition; 2]; 2] = [
    [BoundaryCondition::Dirichlet, BoundaryCondition::Neumann],
    [BoundaryCondition::Contact, BoundaryCondition::Dirichlet],
];

fn inequality_on(mesh: &Mesh<2>, scheme: &dyn Scheme<2>, problem: &Problem<2>) -> Inequality<f64> {
    let of = Discretisation::new(scheme, problem, mesh, DataQuadrature::default()).unwrap();
    of.inequality().unwrap()
}

/// The number of calls of one datum in an assembly: `problem` makes the problem with a function that counts.
fn calls_on(
    mesh: &Mesh<2>,
    scheme: &dyn Scheme<2>,
    problem: impl Fn(Problem<2>, Calls) -> Problem<2>,
) -> usize {
    let calls = Calls::default();
    inequality_on(mesh, scheme, &problem(Problem::new(), calls.clone()));
    calls.get()
}

/// The datum with this value everywhere, whose calls are counted.
fn counted(value: f64, calls: Calls) -> impl Fn(&Point<2>) -> f64 + Send + Sync + 'static {
    move |_| {
        calls.count();
        value
    }
}

/// Each datum is evaluated once at each of its points: at nine points of 32 cells, at 32 barycentres, at eight points of
/// four or eight facets, or at nodes. Where a node has a Dirichlet value as well, its bounds are evaluated once more; and
/// Dirichlet data and gaps at the two ends of eight and four facets, for the constant that is taken off.
#[test]
fn data_are_evaluated_once_at_each_point() {
    let mesh = mesh(MIXED);
    let schemes: [(&dyn Scheme<2>, usize); 4] = [
        (&ConformingP1, 9),
        (&NonconformingP1, 8 * 8),
        (&Sipg::default(), 8 * 8),
        (&Wopsip::default(), 8 * 8),
    ];
    for (scheme, dirichlet) in schemes {
        let found = [
            calls_on(&mesh, scheme, |of, calls| of.source(counted(1.0, calls))),
            calls_on(&mesh, scheme, |of, calls| of.coefficient(counted(2.0, calls))),
            calls_on(&mesh, scheme, |of, calls| {
                let flux = counted(1.0, calls);
                of.neumann(move |x, _| flux(x))
            }),
            calls_on(&mesh, scheme, |of, calls| of.dirichlet(counted(1.0, calls))),
        ];
        assert_eq!(found, [9 * 32, 32, 8 * 4, dirichlet + 2 * 8], "{}", scheme.name());
    }
    let obstacle =
        calls_on(&mesh, &ConformingP1, |of, calls| of.obstacle_below(counted(0.0, calls)));
    let gap = calls_on(&mesh, &ConformingP1, |of, calls| of.signorini(counted(0.0, calls)));
    assert_eq!([obstacle, gap], [25 + 9, 2 * 4 + 1 + 2 * 4]);
}

/// Boundary data where no side has their condition.
#[test]
fn data_of_absent_sides_are_never_evaluated() {
    use BoundaryCondition::{Contact, Dirichlet, Neumann};
    let schemes: [&dyn Scheme<2>; 4] =
        [&ConformingP1, &NonconformingP1, &Sipg::default(), &Wopsip::default()];
    for scheme in schemes {
        let without = |condition| {
            let [one, other] = match condition {
                Dirichlet => [Neumann, Contact],
                Neumann => [Dirichlet, Contact],
                Contact => [Dirichlet, Neumann],
            };
            mesh([[one, other], [other, one]])
        };
        let dirichlet = calls_on(&without(Dirichlet), scheme, |of, calls| {
            of.reaction(1.0).dirichlet(counted(1.0, calls))
        });
        let neumann = calls_on(&without(Neumann), scheme, |of, calls| {
            let flux = counted(1.0, calls);
            of.neumann(move |x, _| flux(x))
        });
        let gap =
            calls_on(&without(Contact), scheme, |of, calls| of.signorini(counted(0.0, calls)));
        assert_eq!([dirichlet, neumann, gap], [0; 3], "{}", scheme.name());
    }
}

/// The numbers of calls of the functions of a form.
#[derive(Clone, Debug, Default)]
struct CallsOfForm {
    penalty: Calls,
    average_weight: Calls,
    integrand: Calls,
    derivatives: Calls,
}

impl CallsOfForm {
    fn numbers(&self) -> [usize; 3] {
        [&self.penalty, &self.average_weight, &self.integrand].map(Calls::get)
    }
}

/// Linears, continuous ones or not, that count evaluations of their derivatives.
#[derive(Debug)]
struct CountedElement {
    is_broken: bool,
    calls: CallsOfForm,
}

impl Element<2> for CountedElement {
    fn degree(&self) -> usize {
        1
    }
    fn layout(&self) -> Layout {
        match self.is_broken {
            true => Layout::in_cells(3),
            false => Element::<2>::layout(&P1),
        }
    }
    fn node(&self, i: usize) -> Node {
        Node::vertex(i)
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        Element::<2>::values(&P1, lambda, out);
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        self.calls.derivatives.count();
        Element::<2>::derivatives(&P1, lambda, out);
    }
}

/// A form that counts its calls.
struct CountedForm {
    form: Box<dyn FacetForm<2>>,
    calls: CallsOfForm,
}

impl FacetForm<2> for CountedForm {
    fn couples(&self) -> bool {
        self.form.couples()
    }
    fn uses_flux(&self) -> bool {
        self.form.uses_flux()
    }
    fn moments(&self, degree: usize) -> usize {
        self.form.moments(degree)
    }
    fn is_uniform(&self) -> bool {
        self.form.is_uniform()
    }
    fn average_weight(&self, facet: &FacetView<2>) -> f64 {
        self.calls.average_weight.count();
        self.form.average_weight(facet)
    }
    fn penalty(&self, facet: &FacetView<2>) -> f64 {
        self.calls.penalty.count();
        self.form.penalty(facet)
    }
    fn integrand(&self, facet: &FacetView<2>, v: Trace, u: Trace, penalty: f64) -> f64 {
        self.calls.integrand.count();
        self.form.integrand(facet, v, u, penalty)
    }
}

/// The form of a scheme on an element, both counted.
struct CountedScheme {
    scheme: Box<dyn Scheme<2>>,
    is_broken: bool,
    calls: CallsOfForm,
}

impl Scheme<2> for CountedScheme {
    fn name(&self) -> &str {
        "counted"
    }
    fn element(&self) -> Arc<dyn Element<2>> {
        Arc::new(CountedElement { is_broken: self.is_broken, calls: self.calls.clone() })
    }
    fn form(&self, mesh: &Mesh<2>) -> Box<dyn FacetForm<2>> {
        Box::new(CountedForm { form: self.scheme.form(mesh), calls: self.calls.clone() })
    }
}

/// The calls of a form in the assembly of a matrix on the `n x n` box.
fn calls_of_form(scheme: impl Scheme<2> + 'static, is_broken: bool, n: usize) -> CallsOfForm {
    let calls = CallsOfForm::default();
    let counted = CountedScheme { scheme: Box::new(scheme), is_broken, calls: calls.clone() };
    let (mesh, problem) = (mesh_of(n, MIXED), Problem::new());
    let quadrature = DataQuadrature::default();
    Discretisation::new(&counted, &problem, &mesh, quadrature).unwrap().matrix();
    calls
}

/// A form that couples no cells is never asked, one without fluxes not for weights of fluxes. The integrand of a uniform
/// form is read off on one facet of each kind, by eight pairs of traces and weights. Basis functions are evaluated as often
/// on any number of cells.
#[test]
fn forms_are_asked_for_what_they_have() {
    let [coarse, fine] = [4, 8].map(|n| {
        [
            calls_of_form(ConformingP1, false, n),
            calls_of_form(Wopsip::default(), true, n),
            calls_of_form(Sipg::default(), true, n),
        ]
    });
    let numbers = coarse.each_ref().map(CallsOfForm::numbers);
    assert_eq!(numbers, [[0; 3], [48, 0, 2 * 8], [48, 48, 2 * 8]]);
    let derivatives = |of: [CallsOfForm; 3]| of.map(|calls| calls.derivatives.get());
    let (coarse, fine) = (derivatives(coarse), derivatives(fine));
    assert!(coarse == fine && coarse[0] > 0, "{coarse:?} {fine:?}");
}

/// A term that is put to nothing, as a constant, or data of a side that the mesh does not have, beside no such term.
#[test]
fn terms_put_to_nothing_change_no_bit() {
    use BoundaryCondition::{Dirichlet, Neumann};
    let plain = || {
        let problem = Problem::<2>::new().source(|x| x[0] - 0.3 * x[1]);
        problem.dirichlet(|x| 0.1 * x[0]).obstacle_below(|x| -0.2 - x[1])
    };
    let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let held = mesh([[Dirichlet; 2]; 2]);
    let with_neumann = mesh([[Dirichlet; 2], [Neumann, Dirichlet]]);
    for (name, _) in SCHEMES {
        let scheme = scheme_by_name::<2>(name, &Default::default()).unwrap();
        let check = |mesh: &Mesh<2>, of: &Problem<2>, without: &Problem<2>, what: &str| {
            let [one, other] = [of, without].map(|problem| inequality_on(mesh, &*scheme, problem));
            let what = format!("{name}, {what}");
            assert_eq!(one.matrix.nonzeros(), other.matrix.nonzeros(), "{what}");
            assert!(one.matrix.columns == other.matrix.columns, "{what}");
            assert!(bits(&one.matrix.values) == bits(&other.matrix.values), "{what}");
            assert!(bits(&one.load) == bits(&other.load), "{what}");
            assert_eq!(one.bounds, other.bounds, "{what}");
            assert_eq!(one.penalised, other.penalised, "{what}");
        };
        let mut no_source = plain();
        no_source.source = Default::default();
        check(&held, &no_source.clone().constant_source(0.0), &no_source, "source");
        check(&held, &plain().reaction(0.0), &plain(), "reaction");
        let mut one = plain();
        one.coefficient.everywhere = Some(Datum::Constant(1.0));
        check(&held, &one, &plain(), "coefficient");
        check(&held, &plain().signorini(|_| 0.0), &plain(), "contact side");
        check(&held, &plain().neumann(|_, _| 1.0), &plain(), "Neumann side");
        check(&with_neumann, &plain().neumann(|_, _| 0.0), &plain(), "Neumann data");
        let mut no_data = plain();
        no_data.dirichlet = Default::default();
        check(&held, &no_data.clone().dirichlet(|_| 0.0), &no_data, "Dirichlet data");
        let mut free = plain();
        free.lower = Default::default();
        let inequality = inequality_on(&held, &*scheme, &free);
        let is_bound = |bound: &Bound<f64>| bound.is_inequality();
        assert!(!inequality.bounds.iter().any(is_bound), "{name}, obstacle");
    }
}
