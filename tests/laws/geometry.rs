//! Volume, gradients and normals of simplices.

use approx::assert_relative_eq;
use unilateral::mesh::CellGeometry;
use unilateral::prelude::*;

fn check<const D: usize>(corners: &[Point<D>], volume: f64) {
    let geometry = CellGeometry::new(|k| corners[k]);
    assert_relative_eq!(geometry.volume, volume, max_relative = 1e-14);
    let mut closed = Point::<D>::zeros();
    for i in 0..=D {
        // duality with the corners, and normals that point away from the opposite vertex
        for j in 0..=D {
            let base = corners[(i + 1) % (D + 1)];
            let value = geometry.gradient(i).dot(&(corners[j] - base));
            assert_relative_eq!(value, f64::from(i == j), epsilon = 1e-14);
        }
        let away = corners[i] - corners[(i + 1) % (D + 1)];
        assert!(geometry.normal(i).dot(&away) < 0.0);
        closed += geometry.normal(i) * geometry.facet_measure(i);
    }
    // the normals of a closed surface, weighted by measure, vanish
    assert_relative_eq!(closed.norm(), 0.0, epsilon = 1e-14);
}

#[test]
fn simplices_of_known_volume() {
    check(&[Point::from([3.0]), Point::from([1.0])], 2.0);
    check(&[Point::from([0.0, 0.0]), Point::from([2.0, 0.5]), Point::from([0.5, 1.0])], 0.875);
    check(
        &[
            Point::from([0.0, 0.0, 0.0]),
            Point::from([0.0, 2.0, 0.0]),
            Point::from([1.0, 0.0, 0.0]),
            Point::from([0.3, 0.2, 3.0]),
        ],
        1.0,
    );
}
