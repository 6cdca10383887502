//! What the kit measures, where it is known.

use unilateral::algebra::SparseMatrix;
use unilateral::kit::spectrum::{
    MeanJump, SpectrumError, extreme_eigenvalues, negative_eigenvalues,
};
use unilateral::kit::{KitErrorKind, Law, LawReport, check_law, check_scheme, check_scheme_on};
use unilateral::linear::FactorError;
use unilateral::mesh::BoxDomain;
use unilateral::mesh::Mesh;
use unilateral::prelude::*;

/// Duality promises one order more in L2 to consistent symmetric forms and to no others.
#[test]
fn orders_asked_for_follow_from_what_is_declared() {
    let orders = |scheme: &dyn Scheme<2>| {
        let report = check_law(Law::Orders, scheme).unwrap();
        ["L2 due", "H1 due", "L2", "H1"].map(|name| report.figure(name))
    };
    let sipg = orders(&Sipg::default());
    assert_eq!(sipg[..2], [Some(2.0), Some(1.0)]);
    assert!(sipg[2] > Some(1.75) && sipg[3] > Some(0.75), "{sipg:?}");
    let incomplete = orders(&Iipg { penalty: PenaltyRule::Diameter(10.0) });
    assert_eq!(incomplete[0], None);
    // not consistent, but its own proof of duality exists
    assert_eq!(orders(&Wopsip::default())[0], Some(2.0));
}

/// WOPSIP on a line, by the closed form of its slope and jumps, is far from the rounding that
/// consistent schemes are held to.
#[test]
fn declarations_are_reported_with_what_was_measured() {
    let declared = |report: &LawReport, words: &str| report.to_string().contains(words);
    let wopsip = check_law::<1>(Law::Consistency, &Wopsip::default()).unwrap();
    assert!(
        declared(&wopsip, " not consistent") && wopsip.figure("error") > Some(1e-3),
        "{wopsip}"
    );
    let sipg = check_law::<1>(Law::Consistency, &Sipg::default()).unwrap();
    assert!(!declared(&sipg, "not ") && sipg.figure("error").unwrap() < 1e-13, "{sipg}");
    let means = check_scheme_on::<1>(&Wopsip::default(), FacetMeans).unwrap();
    assert!(declared(&means.laws[4], " not consistent"), "the basis does not change consistency");
    let incomplete = Iipg { penalty: PenaltyRule::Diameter(10.0) };
    let incomplete = check_law::<3>(Law::Symmetry, &incomplete).unwrap();
    assert!(declared(&incomplete, " not symmetric"), "{incomplete}");
    assert!(incomplete.figure("difference") > Some(1e-2), "{incomplete}");
}

#[test]
fn a_report_names_every_law() {
    let report = check_scheme::<3>(&Wopsip::default()).unwrap().to_string();
    for law in ["element", "symmetry", "coercivity", "invariance", "consistency", "orders"] {
        assert!(report.contains(law), "{law} is missing in\n{report}");
    }
    assert!(report.starts_with("wopsip in 3 dimensions\n") && report.contains("not consistent"));
    let refused = check_law::<3>(Law::Quadrature, &Wopsip::default()).unwrap_err();
    assert_eq!(refused.kind, KitErrorKind::NotOfSchemes, "{refused}");
}

/// The matrix of second differences.
fn differences(n: usize) -> SparseMatrix<f64> {
    let mut out = SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() };
    for i in 0..n {
        for j in i.saturating_sub(1)..(i + 2).min(n) {
            out.columns.push(j as u32);
            out.values.push(if i == j { 2.0 } else { -1.0 });
        }
        out.row_starts.push(out.columns.len() as u32);
    }
    out
}

/// Its eigenvalues are `4 sin^2(k pi / (2 n + 2))`.
#[test]
fn eigenvalues_of_second_differences() {
    for n in [1, 2, 3, 7, 50, 200] {
        let matrix = differences(n);
        let sine = |k: usize| (k as f64 * std::f64::consts::PI / (2 * n + 2) as f64).sin();
        let identity = SparseMatrix::from_diagonal(vec![1.0; n]);
        let found = extreme_eigenvalues(&matrix, &identity, 1e-10).unwrap();
        for (ours, k) in [(found.smallest, 1), (found.largest, n)] {
            let exact = 4.0 * sine(k).powi(2);
            assert!((ours - exact).abs() < 1e-11 * exact, "n = {n}: {ours} against {exact}");
        }
        // a pencil of a matrix and twice its own is one half everywhere
        let twice = SparseMatrix {
            values: matrix.values.iter().map(|a| 2.0 * a).collect(),
            ..matrix.clone()
        };
        let half = extreme_eigenvalues(&matrix, &twice, 1e-10).unwrap();
        assert!((half.smallest - 0.5).abs() + (half.largest - 0.5).abs() < 1e-11, "{half:?}");
    }
}

#[test]
fn a_spectrum_that_is_not_reached_is_an_error() {
    let matrix = differences(400);
    let identity = SparseMatrix::from_diagonal(vec![1.0; 400]);
    let error = extreme_eigenvalues(&matrix, &identity, 0.0).unwrap_err();
    let SpectrumError::NotReached(why) = error else { panic!("{error}") };
    let residual = why.split_once("residual of ").and_then(|(_, rest)| rest.split(' ').next());
    assert!(why.starts_with("after ") && residual.unwrap().parse::<f64>().unwrap() > 0.0, "{why}");
    let three = SparseMatrix::from_diagonal(vec![1.0; 3]);
    let error = extreme_eigenvalues(&matrix, &three, 1e-10).unwrap_err();
    let sizes = "matrices of 400 and 3 rows have no common spectrum";
    assert_eq!(error, SpectrumError::Sizes(sizes.to_owned()));
    let mut negative = identity;
    negative.values[7] = -1e9;
    let error = extreme_eigenvalues(&matrix, &negative, 1e-10).unwrap_err();
    assert_eq!(error, SpectrumError::NotFactored(FactorError::NotPositive), "{error}");
}

#[test]
fn negative_eigenvalues_of_an_indefinite_matrix() {
    // eigenvalues 3 and -1, and 2
    let matrix = SparseMatrix {
        row_starts: vec![0, 2, 4, 5],
        columns: vec![0, 1, 0, 1, 2],
        values: vec![1.0, 2.0, 2.0, 1.0, 2.0],
    };
    assert_eq!(negative_eigenvalues(&matrix), Some(1));
    let without_pivot = SparseMatrix { values: vec![0.0, 2.0, 2.0, 0.0, 2.0], ..matrix };
    assert_eq!(negative_eigenvalues(&without_pivot), None);
}

/// The change of variables is what it is said to be, under every boundary condition.
#[test]
fn means_and_jumps() {
    fn on<const D: usize>() {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
            .side(0, 1, unilateral::mesh::BoundaryCondition::Neumann)
            .side(D - 1, 0, unilateral::mesh::BoundaryCondition::Contact);
        let mesh = Mesh::<D>::kuhn_box(&domain, [3; D]).unwrap();
        let assemble = |scheme: &Wopsip| {
            let problem = Problem::new().on(FacetMeans);
            let quadrature = Default::default();
            let discretisation =
                unilateral::assemble::Discretisation::new(scheme, &problem, &mesh, quadrature);
            discretisation.unwrap().matrix()
        };
        let factor = |eta: f64| Wopsip { eta: Eta::Absolute(eta), ..Wopsip::default() };
        let (one, many) = (assemble(&factor(1.0)), assemble(&factor(100.0)));
        let change = MeanJump::new(&mesh);
        let [small, large] = [&one, &many].map(|matrix| change.transform(matrix));
        assert!(small.is_well_formed() && small.size() == one.size());
        // a global constant has the mean one on every facet and no jump but at the boundary
        let y: Vec<f64> =
            (0..change.size()).map(|k| f64::from(u8::from(k < change.means()))).collect();
        let c = change.expand(&y);
        let inner = |c: &[f64]| c.iter().filter(|&&c| c == 1.0).count();
        let dirichlet = mesh.boundary().iter();
        let dirichlet = dirichlet
            .filter(|f| f.condition == unilateral::mesh::BoundaryCondition::Dirichlet)
            .count();
        assert_eq!(inner(&c), change.size() - dirichlet);
        // E^T A E applied in one go and step by step
        let mut random = 1_u64;
        let x: Vec<f64> = (0..change.size())
            .map(|_| {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695);
                (random >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
            })
            .collect();
        let expanded = change.expand(&x);
        let product: Vec<f64> = (0..one.size()).map(|i| one.row_dot(i, &expanded)).collect();
        for (i, gathered) in change.gather(&product).into_iter().enumerate() {
            assert!((gathered - small.row_dot(i, &x)).abs() < 1e-11 * small.get(i, i).max(1.0));
        }
        // the factor is seen on the diagonal of jumps and nowhere else
        for i in 0..small.size() {
            let (columns, values) = small.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                let same = (a - large.get(i, j as usize)).abs() < 1e-9;
                let on_jump = i == j as usize && i >= change.means();
                assert_eq!(same, !on_jump, "entry ({i}, {j}) of {D}D");
            }
        }
    }
    on::<2>();
    on::<3>();
}
