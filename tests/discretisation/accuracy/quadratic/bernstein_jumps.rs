//! Bounds on Bernstein coefficients of data with jumps and kinks.

use super::broken;
use unilateral::algebra::Bound;
use unilateral::assemble::Discretisation;
use unilateral::mesh::{BoundaryCondition, BoxDomain, Mesh};
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::Row;

fn row(problem: Problem<2>, domain: BoxDomain<2>, level: usize) -> Row {
    let scene = Scene::new("step", domain, problem);
    let study = Study::<2>::new(scene).levels([level]).scheme_on(ConformingP2, Bernstein);
    study.run().unwrap().rows.remove(0)
}

/// An obstacle that steps by one at a line of the mesh, or amid its edges: the energy is -10.07 in the limit, by linear
/// elements of another program. With coefficients half a step above the obstacle it was -9.17 on these 8 squares, -5.25
/// on 64.
#[test]
fn an_obstacle_may_jump() {
    let domain = || BoxDomain::centred(1.0);
    // at the line of the mesh, in the second half of edges, and in their first; energies of fine meshes
    let steps = [
        (0.0, -1.2, -10.07, 0.1),
        (0.0, -1e30, -10.07, 0.1),
        (0.2, -1.2, -8.03, 1.3),
        (0.05, -1.2, -9.49, 0.6),
    ];
    for (step, low, limit, most) in steps {
        let psi = move |x: &Point<2>| if x[0] < step { -0.2 } else { low };
        let lower = Problem::new().constant_source(-10.0).obstacle_below(psi);
        let upper = Problem::new().constant_source(10.0).obstacle_above(move |x| -psi(x));
        let [of_lower, of_upper] = [lower, upper].map(|problem| row(problem, domain(), 8));
        let energy = of_lower.energy.unwrap();
        assert!((energy - limit).abs() < most, "{step}: {energy}");
        assert!((of_upper.energy.unwrap() / energy - 1.0).abs() < 1e-12, "{step}");
        let is_resolved = step == 0.0;
        let beyond = of_lower.penetration.unwrap();
        assert!(beyond < if is_resolved { 1e-15 } else { 0.4 }, "{step}: {beyond}");
        let says = of_lower.warnings.iter().any(|warning| warning.contains("jumps at"));
        assert_eq!(says, step != 0.05, "{step}: {:?}", of_lower.warnings);
    }
}

/// A stepped foundation: -0.169 by bounds at nodes, and -0.1611 before.
#[test]
fn a_gap_may_jump() {
    let gap = |x: &Point<2>| if x[0] < 1.0 { -0.02 } else { -0.3 };
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::from([2.0, 1.0]))
        .side(0, 0, BoundaryCondition::Neumann)
        .side(0, 1, BoundaryCondition::Neumann)
        .side(1, 0, BoundaryCondition::Contact);
    let problem = Problem::new().constant_source(-1.0).signorini(gap).neumann(|_, _| 0.0);
    let row = row(problem, domain, 8);
    assert!((row.energy.unwrap() + 0.168).abs() < 2e-3, "{:?}", row.energy);
    assert!(row.penetration.unwrap() < 1e-15, "{:?}", row.penetration);
}

/// Kinks, inflections, roots and steep slopes are no jumps: bounds are the coefficients of the data.
#[test]
fn data_without_jumps_keep_their_coefficients() {
    let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [5, 5]).unwrap();
    let data: [fn(f64) -> f64; 6] = [
        |x| -4.0 * (x - 0.0625).abs(),
        |x| (x - 0.1).powi(3),
        |x| (40.0 * x).sin(),
        |x| (x.abs()).sqrt(),
        |x| 1e6 + 1e-3 * (9.0 * x).cos(),
        |x| (50.0 * (x - 0.3)).tanh(),
    ];
    for (k, psi) in data.into_iter().enumerate() {
        let at = move |x: &Point<2>| psi(x[0] + 0.3 * x[1]);
        for is_upper in [false, true] {
            let problem = match is_upper {
                true => Problem::new().obstacle_above(at),
                false => Problem::new().obstacle_below(at),
            };
            let problem = problem.on(Bernstein);
            let of =
                Discretisation::new(&broken::<2>(), &problem, &mesh, Default::default()).unwrap();
            for (bound, place) in of.bounds().unwrap().iter().zip(of.locations()) {
                let ends: Vec<_> =
                    place.vertices().iter().map(|&v| mesh.vertices()[v as usize]).collect();
                let (a, b) = (ends[0], ends[ends.len() - 1]);
                let middle = mesh_middle(&a, &b);
                let coefficient = match ends.len() {
                    1 => at(&a),
                    _ => -0.5 * at(&a) + -0.5 * at(&b) + 2.0 * at(&middle),
                };
                let found = match bound {
                    Bound::Lower(x) | Bound::Upper(x) => *x,
                    other => panic!("{other:?}"),
                };
                // the middle may be rounded another way
                let rounding = 1e-12 * (1.0 + coefficient.abs());
                assert!((found - coefficient).abs() < rounding, "{k}: {found} for {coefficient}");
            }
        }
    }
}

fn mesh_middle(a: &Point<2>, b: &Point<2>) -> Point<2> {
    (a + b) * 0.5
}
