//! Every monomial up to the stated degree, positive weights, points inside.

use unilateral::quadrature::Rule;

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
