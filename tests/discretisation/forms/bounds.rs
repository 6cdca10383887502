//! What each unknown may be where several data meet.

use crate::support::meshes::mixed_box;
use unilateral::algebra::Bound;
use unilateral::mesh::{BoundaryCondition, BoxDomain, Mesh};
use unilateral::prelude::*;

/// Vertices with their bounds.
type AtVertices = Vec<(Point<2>, Bound<f64>)>;

/// The bounds of conforming linears on a box with contact at its lower end, by vertex.
fn bounds(problem: &Problem<2>) -> Result<AtVertices, Error> {
    let mesh = Mesh::<2>::kuhn_box(&mixed_box(), [3, 3]).unwrap();
    let of = Discretisation::new(&ConformingP1, problem, &mesh, Default::default())?;
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

/// Bounds that agree at the vertices may cross between them, in cells and on contact facets, and need not be numbers there.
#[test]
fn bounds_are_compared_between_nodes() {
    fn check<const D: usize>() {
        let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let domain = domain.side(D - 1, 0, BoundaryCondition::Contact);
        let mesh = Mesh::<D>::kuhn_box(&domain, [1; D]).unwrap();
        let of = |problem: Problem<D>| {
            Discretisation::new(&ConformingP1, &problem, &mesh, Default::default())?.bounds()
        };
        let bump = |x: &Point<D>| x[0] * (1.0 - x[0]);
        let hole = move |x: &Point<D>| if bump(x) > 0.01 { f64::NAN } else { 0.0 };
        let crosses = |found: Result<_, Error>| {
            let Err(Error::EmptyConstraint { lower, upper, .. }) = found else {
                panic!("{D}: {found:?}")
            };
            assert!(lower - upper > 0.01 && lower - upper <= 0.25, "{D}: {lower} {upper}");
        };
        let is_no_number = |found: Result<_, Error>| {
            assert!(matches!(found, Err(Error::DataNotFinite { .. })), "{D}: {found:?}");
        };
        let above = || Problem::<D>::new().obstacle_above(|_| 0.0);
        crosses(of(above().obstacle_below(bump)));
        crosses(of(Problem::new().obstacle_below(|_| 0.0).obstacle_above(move |x| -bump(x))));
        is_no_number(of(above().obstacle_below(hole)));
        is_no_number(of(Problem::new().obstacle_below(|_| 0.0).obstacle_above(hole)));
        assert!(of(above().obstacle_below(move |x| -bump(x))).is_ok());
        if D > 1 {
            crosses(of(above().signorini(bump)));
            is_no_number(of(above().signorini(hole)));
            assert!(of(above().signorini(move |x| -bump(x))).is_ok());
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

/// A Signorini condition binds the mean over a facet by the mean of the gap, an obstacle by its value
/// at the barycentre.
#[test]
fn facet_means_are_bound_by_means_in_contact_and_by_values_inside() {
    let mesh = Mesh::<2>::kuhn_box(&mixed_box(), [3, 3]).unwrap();
    let gap = |x: &Point<2>| x[0] * x[0];
    for scheme in [&Wopsip::default() as &dyn Scheme<2>, &NonconformingP1] {
        let lower = |problem: &Problem<2>| -> Vec<f64> {
            let of = scheme.discretise(problem, &mesh, Default::default()).unwrap();
            of.bounds().unwrap().iter().filter_map(|bound| bound.lower()).collect()
        };
        let mut means = lower(&Problem::new().signorini(gap).on(FacetMeans));
        means.sort_by(f64::total_cmp);
        let expected = [1.0, 7.0, 19.0].map(|mean| mean / 27.0);
        assert_eq!(means.len(), 3, "{}", scheme.name());
        for (mean, expected) in means.iter().zip(expected) {
            assert!((mean - expected).abs() < 1e-14, "{}: {mean}, {expected}", scheme.name());
        }
        let values = lower(&Problem::new().obstacle_below(gap).dirichlet(|_| 2.0).on(FacetMeans));
        assert!(values.iter().any(|x| (x - 1.0 / 36.0).abs() < 1e-14), "{}", scheme.name());
        assert!(values.iter().all(|x| (x - 1.0 / 27.0).abs() > 1e-3), "{}", scheme.name());
    }
}

/// Midpoints in contact: vertices belong to Simpson's rule in the plane and not in space.
#[test]
fn what_midpoints_bind_in_contact_and_promise() {
    let vertex = Node::vertex(0);
    assert!(
        Midpoints.on_contact(&vertex, 2).is_some() && Midpoints.on_contact(&vertex, 3).is_none()
    );
    assert!(Midpoints.in_domain(&vertex, 2).is_none());
    assert!(Midpoints.on_contact(&Node::midpoint(0), 3).is_some());
    for (dimension, obstacle, contact) in [(1, false, true), (2, true, true), (3, false, false)] {
        let setting = Setting::new(dimension, Regularity::smooth());
        assert!(Midpoints.keeps_orders(&Setting { obstacle, contact, ..setting }));
    }
    for (dimension, obstacle, contact) in [(1, true, false), (3, true, false), (3, false, true)] {
        let setting = Setting::new(dimension, Regularity::smooth());
        assert!(!Midpoints.keeps_orders(&Setting { obstacle, contact, ..setting }));
    }
}

/// A Dirichlet value counts, not the obstacle beside it.
#[test]
fn data_pin_unknowns_that_an_obstacle_binds_too() {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&domain, [3, 3]).unwrap();
    let problem = Problem::new().obstacle_below(|_| -0.5).dirichlet(|x| x[0]);
    let of = Discretisation::new(&ConformingP1, &problem, &mesh, Default::default()).unwrap();
    for (x, bound) in mesh.vertices().iter().zip(of.bounds().unwrap()) {
        let inside = (0..2).all(|k| x[k] > 0.1 && x[k] < 0.9);
        assert_eq!(bound, if inside { Bound::Lower(-0.5) } else { Bound::Fixed(x[0]) }, "{x}");
    }
}
