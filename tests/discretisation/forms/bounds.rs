//! What each unknown may be where several data meet.

use crate::support::meshes::mixed_box;
use unilateral::algebra::Bound;
use unilateral::mesh::{BoxDomain, Mesh};
use unilateral::prelude::*;

/// The bounds of conforming linears on a box with contact at its lower end, by vertex.
fn bounds(problem: &Problem<2>) -> Result<Vec<(Point<f64, 2>, Bound<f64>)>, Error> {
    let mesh = Mesh::<f64, 2>::kuhn_box(&mixed_box(), [3, 3]).unwrap();
    let of = ConformingP1.discretise(problem, &mesh, Default::default())?;
    Ok(mesh.vertices().iter().copied().zip(of.bounds()?).collect())
}

#[test]
fn of_a_gap_and_an_obstacle_the_higher_one_binds() {
    for (obstacle, gap) in [(-0.3, -0.1), (-0.1, -0.3)] {
        let problem = Problem::new().obstacle_below(move |_| obstacle).signorini(move |_| gap);
        let all = bounds(&problem).unwrap();
        let inside = |x: f64| x > 0.1 && x < 0.9;
        let in_contact = all.iter().filter(|(x, _)| x[1] == 0.0 && inside(x[0]));
        for (x, bound) in in_contact.clone() {
            assert_eq!(*bound, Bound::Lower(f64::max(obstacle, gap)), "{x}");
        }
        let free = all.iter().filter(|(x, _)| inside(x[1]) && inside(x[0]));
        free.clone().for_each(|(x, bound)| assert_eq!(*bound, Bound::Lower(obstacle), "{x}"));
        assert_eq!((in_contact.count(), free.count()), (2, 4));
    }
    let above = Problem::new().obstacle_above(|_| 0.2).signorini(|_| -0.1);
    let (x, bound) = bounds(&above).unwrap()[1];
    assert_eq!((x[1], bound), (0.0, Bound::Both(-0.1, 0.2)));
}

/// Bounds that contradict each other by more than a billionth of their size, above rounding, leave no
/// admissible value.
#[test]
fn contradictions_are_told_from_rounding() {
    type Contradiction = fn(f64) -> Problem<2>;
    let pairs: [(&str, Contradiction); 4] = [
        ("an obstacle above another", |by| {
            let one = Problem::new().dirichlet(|_| 1.0).obstacle_above(|_| 1.0);
            one.obstacle_below(move |_| 1.0 + by)
        }),
        ("data below an obstacle", |by| {
            Problem::new().obstacle_below(move |_| 1.0 + by).dirichlet(|_| 1.0)
        }),
        ("data above an obstacle", |by| {
            Problem::new().obstacle_above(move |_| 1.0 - by).dirichlet(|_| 1.0)
        }),
        ("a gap above an obstacle", |by| {
            Problem::new().obstacle_above(|_| 1.0).signorini(move |_| 1.0 + by).dirichlet(|_| 1.0)
        }),
    ];
    for (what, problem) in pairs {
        for by in [1e-2, 1e-4, 1e-8] {
            let error = bounds(&problem(by)).unwrap_err();
            let Error::EmptyConstraint { lower, upper, .. } = error else {
                panic!("{what}: {error}")
            };
            assert!((lower - upper - by).abs() < 1e-12, "{what}: {lower} above {upper}");
        }
        for by in [0.0, 1e-12] {
            assert!(bounds(&problem(by)).is_ok(), "{what} by {by}");
        }
    }
}

/// A Dirichlet value counts, not the obstacle beside it.
#[test]
fn data_pin_unknowns_that_an_obstacle_binds_too() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<f64, 2>::kuhn_box(&domain, [3, 3]).unwrap();
    let problem = Problem::new().obstacle_below(|_| -0.5).dirichlet(|x| x[0]);
    let of = ConformingP1.discretise(&problem, &mesh, Default::default()).unwrap();
    for (x, bound) in mesh.vertices().iter().zip(of.bounds().unwrap()) {
        let inside = (0..2).all(|k| x[k] > 0.1 && x[k] < 0.9);
        assert_eq!(bound, if inside { Bound::Lower(-0.5) } else { Bound::Fixed(x[0]) }, "{x}");
    }
}
