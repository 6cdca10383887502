//! Penalty factors that make no penalty are refused by name; small ones are not.

use unilateral::inequality::{ActiveSet, Outcome, in_precision};
use unilateral::prelude::*;
use unilateral::real::Precision;
use unilateral::scenes::Scene;

type Schemes<const D: usize> = Vec<(&'static str, Box<dyn Scheme<D>>)>;

/// Every scheme with a penalty, with this factor, and the name of the parameter.
fn with_factor<const D: usize>(x: f64) -> Schemes<D> {
    let diameter = PenaltyRule::Diameter(x);
    // the factor of the bound is one plus the margin
    let proven = PenaltyRule::Proven(x - 1.0);
    let over = |eta| Wopsip { eta, ..Wopsip::default() };
    let anisotropic = Wopsip { weight: WeightRule::Anisotropic, ..over(Eta::Absolute(x)) };
    vec![
        ("margin", Box::new(Sipg { penalty: proven })),
        ("margin", Box::new(Iipg { penalty: proven }.on(P2))),
        ("sigma", Box::new(Sipg { penalty: diameter })),
        ("sigma", Box::new(Iipg { penalty: diameter })),
        ("sigma", Box::new(Nipg { penalty: diameter }.on(P2))),
        ("sigma", Box::new(Ldg { eta: x, ..Ldg::default() })),
        ("eta", Box::new(Br2 { factor: x / (D + 1) as f64, ..Br2::default() })),
        ("eta", Box::new(Bmmpr { factor: x, ..Bmmpr::default() }.on(P2))),
        ("eta", Box::new(over(Eta::Absolute(x)))),
        ("eta", Box::new(over(Eta::Dimensionless(x)))),
        ("eta", Box::new(over(Eta::Absolute(x)).on(P2))),
        ("eta", Box::new(anisotropic)),
    ]
}

fn refused<const D: usize>(factors: &[f64], why: &str) {
    let (problem, domain) = (Problem::new().source(|_| 1.0), BoxDomain::centred(1.0));
    let mesh = Mesh::<D>::kuhn_box(&domain, [2; D]).unwrap();
    for &x in factors {
        for (parameter, scheme) in with_factor(x) {
            let error = scheme.discretise(&problem, &mesh, Default::default()).unwrap_err();
            let name = scheme.name();
            let Error::Parameter(said) = &error else { panic!("{name} with {x}: {error}") };
            assert!(said.starts_with(&format!("{parameter} = ")), "{name} with {x}: {error}");
            let message = error.to_string();
            assert!(message.contains(why), "{name} with {x}: {message}");
        }
    }
}

#[test]
fn what_is_no_penalty_is_refused() {
    let none = [f64::NAN, 0.0, -0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY];
    refused::<1>(&none, "must be positive and finite");
    refused::<2>(&none, "must be positive and finite");
    refused::<3>(&none, "must be positive and finite");
    refused::<2>(&[1e300], "times the stiffness beside it");
    // what is multiplied out holds fewer digits than what is kept as a sum
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [2; 2]).unwrap();
    for (parameter, scheme) in with_factor::<2>(1e25) {
        let is_sum = scheme.name().starts_with("wopsip");
        let problem = Problem::new();
        let made = scheme.discretise(&problem, &mesh, Default::default());
        assert_eq!(made.is_ok(), is_sum, "{} with {parameter}", scheme.name());
    }
    // a margin cannot be so near to -1
    for (parameter, scheme) in with_factor::<2>(1e-300).split_off(2) {
        let error = scheme.discretise(&Problem::new(), &mesh, Default::default()).unwrap_err();
        assert!(error.to_string().contains("times the stiffness"), "{parameter}: {error}");
    }
}

#[test]
fn single_precision_refuses_a_penalty_that_leaves_no_digit_of_the_stiffness() {
    let row = |precision| {
        let sipg = Sipg { penalty: PenaltyRule::Diameter(1e9) };
        let study = Study::<2>::new(scenes::radial(1.0)).scheme(sipg).levels([4]);
        let study = study.boxed_solver(in_precision(precision, ActiveSet::default()));
        study.run().unwrap().rows.remove(0)
    };
    assert_eq!(row(Precision::Double).status, Outcome::Converged);
    let single = row(Precision::Single);
    assert_eq!(single.status, Outcome::Singular);
    let is_told = |warning: &String| warning.contains("leaves no digit of it in f32");
    assert!(single.warnings.iter().any(is_told), "{:?}", single.warnings);
}

#[test]
fn a_study_names_the_factor() {
    let wopsip = Wopsip { eta: Eta::Absolute(-1.0), ..Wopsip::default() };
    let study = Study::<2>::new(scenes::radial(1.0)).scheme(wopsip).levels([4]);
    let expected = "eta = -1: the penalty factor is -1, it must be positive and finite";
    let row = &study.run().unwrap().rows[0];
    assert_eq!(row.status, Outcome::OutOfRange);
    assert_eq!(row.message.as_deref(), Some(expected));
}

/// Small positive factors are the user's choice: schemes that are coercive with every factor converge,
/// the others are warned of or not coercive.
#[test]
fn small_penalties_are_possible() {
    let scene = || scenes::radial::<2>(1.0);
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.5), [8; 2]).unwrap();
    let problem = scene().problem;
    for x in [1e-8, 1e-3, 0.9] {
        for (_, scheme) in with_factor::<2>(x) {
            let name = scheme.name().to_owned();
            let of = scheme.discretise(&problem, &mesh, Default::default()).unwrap();
            let is_warned = of.penalty_below_bound().is_some();
            let has_bound = ["sipg", "iipg", "br2"].iter().any(|own| name.starts_with(own));
            assert_eq!(is_warned, has_bound, "{name} with {x}");
            let outcome = solve(&problem, &mesh, &*scheme).unwrap().solution().outcome;
            let is_honest = match outcome {
                Outcome::Converged => true,
                Outcome::NotCoercive => has_bound,
                // of a penalty this small rounding leaves little
                Outcome::Stalled => x < 1e-6,
                _ => false,
            };
            assert!(is_honest, "{name} with {x}: {outcome}");
        }
    }
}

/// From its bound on, theory proves every form with a penalty coercive.
#[test]
fn large_penalties_are_proven_coercive() {
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [3; 2]).unwrap();
    let problem = Problem::new();
    for (parameter, scheme) in with_factor::<2>(100.0) {
        let of = scheme.discretise(&problem, &mesh, Default::default()).unwrap();
        let is_proven = of.is_coercive() && of.penalty_below_bound().is_none();
        assert!(is_proven, "{} with {parameter}", scheme.name());
    }
}

/// The form without symmetry is coercive with every penalty, and not proven so with none.
#[test]
fn without_a_penalty_nothing_is_proven() {
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [2; 2]).unwrap();
    let is_proven = |penalty| {
        let scheme = Nipg { penalty };
        Scheme::<2>::form(&scheme, &mesh).theory().is_coercive
    };
    for rule in [PenaltyRule::Diameter, |factor| PenaltyRule::Proven(factor - 1.0)] {
        assert!(is_proven(rule(1e-8)));
        assert!(!is_proven(rule(0.0)));
    }
}

#[test]
fn coefficients_out_of_range_are_refused() {
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [2; 2]).unwrap();
    for (value, why) in [
        (1e-300, "coefficient = 1e-300 in cell 0: "),
        (1e300, "coefficient = 1e300 in cell 0: "),
        (0.0, "in cell 0: it must be positive and finite"),
        (-2.0, "in cell 0: it must be positive and finite"),
        (f64::NAN, "coefficient is NaN at ("),
    ] {
        let problem = Problem::new().coefficient(move |_| value);
        for scheme in [&ConformingP1 as &dyn Scheme<2>, &Wopsip::default()] {
            let error = scheme.discretise(&problem, &mesh, Default::default()).unwrap_err();
            assert!(error.to_string().contains(why), "{value}: {error}");
        }
    }
    let problem = Problem::new().coefficient(|_| 1e-100).source(|_| 1e-100);
    let solved = solve(&problem, &mesh, &Wopsip::default()).unwrap();
    assert_eq!(solved.solution().outcome, Outcome::Converged);
}

#[test]
fn boxes_turned_inside_out_are_refused() {
    let scene = |lower: [f64; 2], upper: [f64; 2]| {
        let domain = BoxDomain::dirichlet(lower.into(), upper.into());
        Scene::new("box", domain, Problem::new().source(|_| 1.0))
    };
    for (lower, upper, side) in [
        ([1.0, 0.0], [0.0, 1.0], "-1"),
        ([1.0, 1.0], [0.0, 0.0], "-1"),
        ([0.0, 0.0], [1.0, 0.0], "0"),
        ([0.0, 0.0], [1.0, f64::INFINITY], "inf"),
        ([0.0, 0.0], [1.0, f64::NAN], "NaN"),
    ] {
        let study = Study::<2>::new(scene(lower, upper)).scheme(ConformingP1).levels([4]);
        let error = study.run().unwrap_err().to_string();
        let expected = format!("side of the domain = {side}: positive and finite");
        assert!(error.starts_with(&expected), "{error}");
    }
}
