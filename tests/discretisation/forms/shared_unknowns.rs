//! Spaces that share unknowns: meshes whose numbering is anyhow, rows of any length, patterns that
//! do not belong.

use crate::support::meshes::{Random, Raw, mixed_box};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::mesh::{BoundaryCondition, Mesh, TaggedFacet};
use unilateral::prelude::*;
use unilateral::scheme::ConformingP2;

#[test]
fn the_same_bits_where_neighbours_have_distant_numbers() {
    fn check<const D: usize, S: Scheme<D>>(scheme: &S, n: usize) {
        let mut random = Random(6);
        let raw = Raw::<D>::jittered(&mixed_box(), n, 0.3, &mut random).shuffled(&mut random);
        let mesh = raw.mesh();
        let problem = Problem::<D>::new().coefficient(|x| 1.0 + x[0] * x[0]);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                Discretisation::new(scheme, &problem, &mesh, DataQuadrature::default())
                    .unwrap()
                    .matrix()
            })
        };
        let one = run(1);
        assert!(one.is_well_formed() && one.values.iter().all(|v| v.is_finite()));
        for threads in [2, 8] {
            assert_eq!(one, run(threads), "{} with {threads} threads", scheme.name());
        }
    }
    // enough rows for several pieces, in the second case for several parts of each
    check::<2, _>(&ConformingP1, 50);
    check::<2, _>(&ConformingP1, 200);
    check::<2, _>(&ConformingP2, 40);
    check::<2, _>(&NonconformingP1, 40);
    check::<3, _>(&ConformingP1, 14);
    check::<3, _>(&ConformingP2, 9);
}

/// A disc of this many triangles around its middle, whose row is as long.
fn fan(n: u32) -> Mesh<2> {
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let rim = (0..n).map(|k| Point::from([angle(k).cos(), angle(k).sin()]));
    let vertices = std::iter::once(Point::from([0.0, 0.0])).chain(rim).collect();
    let rims = (0..n).map(|k| [k + 1, (k + 1) % n + 1]);
    let cells = rims.clone().flat_map(|[a, b]| [0, a, b]).collect();
    let condition = BoundaryCondition::Dirichlet;
    let boundary: Vec<_> = rims.map(|vertices| TaggedFacet { vertices, condition }).collect();
    Mesh::new(vertices, cells, &boundary).unwrap()
}

#[test]
fn rows_of_any_length_are_filled() {
    // about the longest row ranked without sorting, and the number of places a byte can name
    for n in [126, 127, 128, 254, 255, 256, 257, 700] {
        let mesh = fan(n);
        let problem = Problem::<2>::new();
        let space =
            Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default()).unwrap();
        let matrix = space.matrix();
        assert!(matrix.is_well_formed());
        assert_eq!(matrix.row(0).0.len(), n as usize + 1);
        // cotangents: of the angles at the rim across a spoke, of that in the middle across a rim
        let angle = std::f64::consts::TAU / f64::from(n);
        let spoke = -(0.5 * angle).tan();
        let rim = -0.5 / angle.tan();
        let close = |(i, j): (usize, usize), expected: f64, scale: f64| {
            let found = matrix.get(i, j);
            assert!((found - expected).abs() < 1e-12 * scale, "{n}, ({i}, {j}): {found}");
        };
        for k in 1..=n as usize {
            close((0, k), spoke, 1.0);
            close((k, 0), spoke, 1.0);
            close((k, k % n as usize + 1), rim, f64::from(n));
            close((k, k), -2.0 * rim - spoke, f64::from(n));
        }
        close((0, 0), -f64::from(n) * spoke, f64::from(n));
    }
}

#[test]
#[should_panic(expected = "pattern of another discretisation")]
fn the_pattern_of_another_discretisation_is_refused() {
    let mesh = Mesh::<2>::kuhn_box(&mixed_box(), [3, 3]).unwrap();
    let problem = Problem::<2>::new();
    let quadrature = DataQuadrature::default();
    let quadratic = Discretisation::new(&ConformingP2, &problem, &mesh, quadrature).unwrap();
    let linear = Discretisation::new(&ConformingP1, &problem, &mesh, quadrature).unwrap();
    linear.fill(&mut quadratic.matrix());
}
