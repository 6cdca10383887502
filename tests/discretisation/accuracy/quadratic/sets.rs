//! Which unknowns each set of constraints binds, and what it refuses.

use super::conforming;
use crate::support::meshes::mixed_box;
use unilateral::algebra::Bound;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::mesh::BoxDomain;
use unilateral::mesh::Mesh;
use unilateral::prelude::*;

fn bounds<const D: usize, S: Scheme<D>>(
    scheme: &S,
    set: impl ConstraintSet + 'static,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
) -> Result<Vec<(usize, Bound<f64>)>, Error> {
    let problem = problem.clone().on(set);
    let space = Discretisation::new(scheme, &problem, mesh, DataQuadrature::default())?;
    let locations = space.locations();
    Ok(locations.iter().map(|p| p.vertices().len()).zip(space.bounds()?).collect())
}

/// Which unknowns are bound, by the number of vertices of their place.
#[test]
fn each_set_binds_its_own_nodes() {
    let mesh = Mesh::<2>::kuhn_box(&mixed_box(), [2, 2]).unwrap();
    let count = |bounds: &[(usize, Bound<f64>)], vertices: usize| {
        bounds.iter().filter(|(n, b)| *n == vertices && b.is_inequality()).count()
    };
    let obstacle = Problem::new().obstacle_below(|x| x[0] * x[0] - 5.0);
    let nodes = bounds(&ConformingP2, Nodes, &obstacle, &mesh).unwrap();
    // 5 of 25 nodes lie on the lower end of the first axis, 5 on the upper one of the second
    assert_eq!([count(&nodes, 1), count(&nodes, 2)], [4, 12]);
    let midpoints = bounds(&ConformingP2, Midpoints, &obstacle, &mesh).unwrap();
    assert_eq!([count(&midpoints, 1), count(&midpoints, 2)], [0, 12]);
    let fixed = |b: &[(usize, Bound<f64>)]| b.iter().filter(|b| b.1 == Bound::Fixed(0.0)).count();
    assert_eq!([fixed(&nodes), fixed(&midpoints)], [9, 9]);

    let signorini = Problem::<2>::new().signorini(|x| -2.0 - x[0]);
    for nodes in [
        bounds(&ConformingP2, Nodes, &signorini, &mesh).unwrap(),
        bounds(&ConformingP2, Midpoints, &signorini, &mesh).unwrap(),
        bounds(&ConformingP2, Bernstein, &signorini, &mesh).unwrap(),
    ] {
        // the vertex that the Dirichlet boundary shares is pinned
        assert_eq!([count(&nodes, 1), count(&nodes, 2)], [2, 2]);
        let lowest = nodes.iter().filter_map(|b| b.1.lower()).fold(0.0, f64::min);
        assert_eq!(lowest, -3.0);
    }
    let cube = Mesh::<3>::kuhn_box(&mixed_box(), [1, 1, 1]).unwrap();
    let signorini = Problem::<3>::new().signorini(|_| -1.0);
    let count =
        |bounds: Vec<(usize, Bound<f64>)>| bounds.iter().filter(|(_, b)| b.is_inequality()).count();
    // of the nine nodes of the side all but those at its middle and on its Neumann edge are pinned
    let nodes = bounds(&ConformingP2, Nodes, &signorini, &cube).unwrap();
    let midpoints = bounds(&ConformingP2, Midpoints, &signorini, &cube).unwrap();
    let coefficients = bounds(&ConformingP2, Bernstein, &signorini, &cube).unwrap();
    assert_eq!([count(nodes), count(midpoints), count(coefficients)], [2; 3]);
    let domain = BoxDomain::above_contact();
    let line = Mesh::<1>::kuhn_box(&domain, [3]).unwrap();
    let end = bounds(&ConformingP2, Midpoints, &Problem::new().signorini(|_| 0.5), &line).unwrap();
    assert_eq!(end.iter().filter(|b| b.1 == Bound::Lower(0.5) && b.0 == 1).count(), 1);
}

#[test]
fn what_a_set_cannot_impose_is_refused() {
    let mesh = Mesh::<2>::kuhn_box(&mixed_box(), [2, 2]).unwrap();
    let signorini = Problem::new().signorini(|_| 0.0);
    for problem in [signorini, Problem::new().obstacle_above(|_| 1.0)] {
        let error = bounds(&ConformingP1, Midpoints, &problem, &mesh).unwrap_err();
        assert!(
            matches!(&error, Error::NothingToBound(why) if why.starts_with("bounds on midpoints")),
            "{error}"
        );
    }
    // a datum below the obstacle at the midpoint of a single edge
    let tent = |x: &Point<2>| if (x[1] - 0.25).abs() < 0.1 { 1.0 } else { -1.0 };
    for scheme in conforming::<2>() {
        let problem = scheme.constrain(&Problem::new().obstacle_below(tent));
        let error = scheme.inequality(&problem, &mesh, Default::default()).unwrap_err();
        assert!(matches!(error, Error::EmptyConstraint { lower: 1.0, upper: 0.0, .. }), "{error}");
    }
}
