//! Every monomial up to the stated degree, positive weights, points inside.

use crate::support::panics::message_of_panic;
use unilateral::kit::check_quadrature;
use unilateral::quadrature::{
    ConicalProduct, FullySymmetric, Quadrature, QuadratureError, Rule, VertexRule,
};

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// Mean of a monomial in all barycentric coordinates: d! prod(p_i!) / (d + sum p_i)!
fn mean(powers: &[usize]) -> f64 {
    let d = powers.len() - 1;
    let total: usize = powers.iter().sum();
    factorial(d) * powers.iter().map(|&p| factorial(p)).product::<f64>() / factorial(d + total)
}

fn all_powers(n: usize, degree: usize) -> Vec<Vec<usize>> {
    if n == 1 {
        return (0..=degree).map(|p| vec![p]).collect();
    }
    let rest = |p| all_powers(n - 1, degree - p).into_iter().map(move |r| [vec![p], r].concat());
    (0..=degree).flat_map(rest).collect()
}

#[test]
fn exact_for_every_monomial_of_the_degree() {
    for dimension in 0..=3 {
        for degree in 0..=if dimension == 3 { 9 } else { 15 } {
            let rule = Rule::new(dimension, degree);
            for powers in all_powers(dimension + 1, degree) {
                let sum: f64 = rule
                    .iter()
                    .map(|(x, w)| {
                        w * (0..=dimension).map(|k| x[k].powi(powers[k] as i32)).product::<f64>()
                    })
                    .sum();
                let exact = mean(&powers);
                assert!(
                    (sum - exact).abs() <= 1e-13 * exact.max(1e-3),
                    "{dimension} {degree} {powers:?}: {sum} {exact}"
                );
            }
        }
    }
}

/// Powers of one coordinate, to the degree of twelve points in each direction.
#[test]
fn powers_of_each_coordinate_are_exact() {
    for dimension in 1..=3 {
        for degree in 0..=23 {
            let rule = Rule::new(dimension, degree);
            for (k, power) in (0..=dimension).flat_map(|k| (0..=degree).map(move |p| (k, p))) {
                let sum: f64 = rule.iter().map(|(x, w)| w * x[k].powi(power as i32)).sum();
                let mut powers = vec![0; dimension + 1];
                powers[k] = power;
                let difference = (sum - mean(&powers)).abs();
                assert!(difference < 1e-13, "{dimension} {degree} {k} {power}: {difference:e}");
            }
        }
    }
}

#[test]
fn weights_are_positive_and_points_inside_for_every_degree() {
    for dimension in 0..=3 {
        for degree in 0..=30 {
            let rule = Rule::new(dimension, degree);
            assert!(rule.weights.iter().all(|&w| w > 0.0));
            assert!((rule.weights.iter().sum::<f64>() - 1.0).abs() < 1e-13);
            for x in &rule.points {
                assert!(
                    x[..=dimension].iter().all(|&b| b > 0.0)
                        && x[dimension + 1..].iter().all(|&b| b == 0.0)
                );
                assert!((x.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            }
        }
    }
}

#[test]
fn a_rule_is_not_exact_beyond_what_its_points_allow() {
    // two points per direction cannot integrate degree 4: the test above can fail
    let rule = Rule::new(1, 3);
    let sum: f64 = rule.iter().map(|(x, w)| w * x[0].powi(4)).sum();
    assert!((sum - 0.2).abs() > 1e-3);
}

#[test]
fn symmetric_rules_are_exact_with_positive_weights_and_few_points() {
    for dimension in 1..=3 {
        for degree in 0..=12 {
            let report = check_quadrature(&FullySymmetric, dimension, degree)
                .unwrap_or_else(|error| panic!("{error}"));
            assert!(report.figure("smallest weight") > Some(0.0), "{dimension} {degree}");
            let rule = FullySymmetric.rule(dimension, degree).unwrap();
            let inside = |x: &[f64; 4]| x[..=dimension].iter().all(|&b| b > 0.0);
            assert!(rule.points.iter().all(inside), "{dimension} {degree}");
            assert!(rule.points.len() <= Rule::new(dimension, degree).points.len());
        }
    }
    let points = |dimension: usize, degrees: std::ops::RangeInclusive<usize>| -> Vec<usize> {
        degrees.map(|degree| FullySymmetric.rule(dimension, degree).unwrap().points.len()).collect()
    };
    assert_eq!(points(2, 4..=10), [6, 7, 12, 15, 16, 19, 25]);
    assert_eq!(points(3, 4..=8), [14, 14, 24, 35, 46]);
}

#[test]
fn symmetric_rules_do_not_change_with_the_order_of_vertices() {
    for (dimension, degree) in [(2, 7), (2, 10), (3, 6), (3, 8)] {
        let rule = FullySymmetric.rule(dimension, degree).unwrap();
        for (point, weight) in rule.iter() {
            for k in 0..dimension {
                let mut moved = *point;
                moved.swap(k, k + 1);
                let is_it = |(x, w): (&[f64; 4], f64)| {
                    w == weight && x.iter().zip(&moved).all(|(a, b)| (a - b).abs() < 1e-14)
                };
                assert_eq!(rule.iter().filter(|&x| is_it(x)).count(), 1, "{dimension} {degree}");
            }
        }
    }
}

#[test]
fn the_vertex_rule_is_exact_for_linears() {
    for dimension in 0..=3 {
        let report = check_quadrature(&VertexRule, dimension, 1).unwrap();
        assert_eq!(report.figure("points"), Some((dimension + 1) as f64));
    }
    assert!(check_quadrature(&VertexRule, 1, 2).is_err());
}

#[test]
fn points_and_weights_that_are_no_rule_are_refused() {
    let middle = [0.5, 0.5, 0.0, 0.0];
    let refused = |points: &[[f64; 4]], weights: &[f64]| {
        Rule::from_points(1, points.to_vec(), weights.to_vec()).unwrap_err().to_string()
    };
    assert!(refused(&[], &[]).starts_with("0 points have 0 weights"));
    let lengths = "1 points have 2 weights: a rule has one weight for each point";
    assert_eq!(refused(&[middle], &[0.5, 0.5]), lengths);
    assert!(refused(&[middle], &[0.5]).starts_with("the weights of a rule sum to 0.5"));
    for point in [[0.5, 0.6, 0.0, 0.0], [0.5, 0.25, 0.25, 0.0], [f64::NAN, 0.5, 0.0, 0.0]] {
        assert!(refused(&[middle, point], &[0.5, 0.5]).starts_with("point 1 with "));
    }
    assert_eq!(Rule::from_points(1, vec![middle], vec![1.0]), Ok(Rule::new(1, 1)));
}

/// The largest degree has a rule that is exact, and beyond it no time is spent.
#[test]
fn degrees_and_dimensions_without_a_rule_are_refused() {
    let largest = Rule::LARGEST_DEGREE;
    let rule = Rule::new(1, largest);
    for power in [1, 50, largest] {
        let sum: f64 = rule.iter().map(|(x, w)| w * x[0].powi(power as i32)).sum();
        assert!((sum * (power + 1) as f64 - 1.0).abs() < 1e-12, "{power}: {sum}");
    }
    let families: [&dyn Quadrature; 3] = [&ConicalProduct, &FullySymmetric, &VertexRule];
    for family in families {
        for dimension in [4, usize::MAX] {
            let error = family.rule(dimension, 3).unwrap_err();
            let said = format!("there are no rules in dimension {dimension}: ");
            assert!(error.to_string().starts_with(&said), "{error}");
        }
        for (dimension, degree) in [(1, largest + 1), (3, 1000), (2, usize::MAX)] {
            let found = family.rule(dimension, degree);
            let is_limited = family.name() != "vertices";
            let expected = QuadratureError::no_rule(family.name(), dimension, degree, largest);
            assert_eq!(found.err(), is_limited.then_some(expected));
        }
    }
    let refused = Rule::from_points(4, vec![[0.2; 4]], vec![1.0]);
    assert!(refused.is_err());
    for (dimension, degree, said) in [
        (4, 3, "there are no rules in dimension 4: simplices have the dimensions 0 to 3"),
        (2, 1000, "no rule of degree 1000 in dimension 2: ask for degree 99 at most"),
    ] {
        let message = message_of_panic(|| drop(Rule::new(dimension, degree)));
        assert!(message.contains(said), "{message}");
    }
}
