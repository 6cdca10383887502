//! The American put of the examples, against a binomial tree. It is worth 6.0904 at the strike in print (100, a rate of
//! 5 %, a volatility of 20 %, one year).

#[path = "../../examples/american_put.rs"]
#[allow(dead_code, reason = "the main function of the example, and what it alone uses")]
mod example;

use example::{by_steps, by_tree};
use unilateral::prelude::*;

/// Implicit steps have the order one in time and linears the order two in space: the error falls to a quarter where the
/// mesh size is halved and the step divided by four. In time alone the kink of the first values costs a little.
#[test]
fn a_put_has_the_worth_of_a_binomial_tree_and_its_exercise_price() {
    let mean = |steps| (by_tree(steps).at_strike + by_tree(steps + 1).at_strike) / 2.0;
    let price = 2.0 * mean(1024) - mean(512);
    assert!((price - 6.0904).abs() < 2e-4, "{price}");
    let tree = by_tree(2048);
    // derivatives of the tree oscillate by less
    let half = by_tree(1024);
    assert!((tree.delta - half.delta).abs() < 2e-4 && (tree.gamma - half.gamma).abs() < 2e-5);
    let exercise = tree.exercise;
    let schemes: [Box<dyn Scheme<1>>; 3] =
        [Box::new(ConformingP1), Box::new(Sipg::default()), Box::new(Wopsip::default())];
    for scheme in schemes {
        let name = scheme.name().to_owned();
        let of = |cells, steps| by_steps(&*scheme, cells, steps).unwrap();
        let orders = |levels: [(usize, usize); 3]| {
            let errors = levels.map(|(cells, steps)| price - of(cells, steps).at_strike);
            // a step too long gives too little
            assert!(errors.iter().all(|e| *e > 0.0), "{name}: {errors:?}");
            [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2)
        };
        let of_both = orders([(32, 16), (64, 64), (128, 256)]);
        assert!(of_both.iter().all(|order| *order > 1.9 && *order < 2.05), "{name}: {of_both:?}");
        let of_time = orders([(512, 16), (512, 32), (512, 64)]);
        assert!(of_time.iter().all(|order| *order > 0.9 && *order < 1.0), "{name}: {of_time:?}");
        let found = of(256, 256);
        assert!((found.at_strike - price).abs() < 7e-3, "{name}: {}", found.at_strike);
        let of_delta = (found.delta - tree.delta).abs();
        assert!(of_delta < 2e-3, "{name}: {} for {}", found.delta, tree.delta);
        let of_gamma = (found.gamma - tree.gamma).abs();
        assert!(of_gamma < 2e-4, "{name}: {} for {}", found.gamma, tree.gamma);
        assert_eq!(found.exercise.len(), exercise.len());
        for (found, by_tree) in found.exercise.iter().zip(&exercise) {
            assert_eq!(found[0], by_tree[0]);
            assert!((found[1] - by_tree[1]).abs() < 0.5, "{name}: {found:?} {by_tree:?}");
        }
    }
}
