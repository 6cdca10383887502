//! Reference energies, and discrete errors of scenes that are known in closed form.

use unilateral::assemble::DataQuadrature;
use unilateral::scenes::{
    Scene, pyramid_2d, pyramid_full_2d, ridge, signorini_sine_2d, spiral_2d, torsion_2d,
};
use unilateral::scheme::ConformingP1;
use unilateral::study::{Row, Study};

fn solved<const D: usize>(
    scene: Scene<D>,
    levels: &[usize],
    quadrature: DataQuadrature,
) -> Vec<Row> {
    let name = scene.name.clone();
    let rows = Study::<D>::new(scene)
        .scheme(ConformingP1)
        .levels(levels.iter().copied())
        .quadrature(quadrature)
        .run()
        .unwrap()
        .rows;
    for row in &rows {
        assert!(row.converged(), "{name} level {}", row.level);
    }
    rows
}

/// Conforming P1 on Kuhn meshes at n = 64 and 128 by an independent program, to the digits printed
/// there; the reference is what both tend to, from above.
#[test]
fn energies_are_those_of_an_independent_program() {
    let cases = [
        (spiral_2d(), [33.809_379_30, 34.177_215_83]),
        (signorini_sine_2d(), [-0.461_518_53, -0.461_695_02]),
        (torsion_2d(5.0), [-0.418_236_33, -0.418_430_21]),
        (torsion_2d(10.0), [-1.204_078_90, -1.204_499_93]),
        (torsion_2d(20.0), [-2.850_004_36, -2.850_868_28]),
        (pyramid_2d(-4.0), [0.646_965_06, 0.645_804_35]),
        (pyramid_2d(0.0), [0.262_914_17, 0.262_751_74]),
    ];
    let mut wrong = Vec::new();
    for (scene, printed) in cases {
        let name = scene.name.clone();
        let reference = scene.problem.reference_energy.unwrap();
        let rows = solved(scene, &[64, 128], DataQuadrature::default());
        let found: Vec<f64> = rows.iter().map(|row| row.objective.unwrap()).collect();
        for (found, printed) in found.iter().zip(printed) {
            if (found - printed).abs() > 6e-9 {
                wrong.push(format!("{name}: {found:.8} instead of {printed:.8}"));
            }
        }
        let gaps: Vec<f64> = found.iter().map(|j| (j - reference.value).abs()).collect();
        assert!(gaps[1] < gaps[0], "{name} does not tend to its reference: {gaps:?}");
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn energies_are_known_for_some_loads_only() {
    assert!(torsion_2d(7.0).problem.reference_energy.is_none());
    assert!(pyramid_2d(-1.0).problem.reference_energy.is_none());
}

/// The kink lies on mesh lines.
#[test]
fn conforming_elements_are_exact_on_the_ridge() {
    fn check<const D: usize>(level: usize) {
        for row in solved(ridge::<D>(), &[level], DataQuadrature::default()) {
            let h1 = row.error.h1.unwrap();
            assert!(h1 < 1e-13, "{}: {h1}", row.scene);
        }
    }
    check::<1>(8);
    check::<2>(8);
    check::<3>(4);
}

/// One diagonal is not a mesh line: the error is `2 n^(-1/2)`, that of interpolation.
#[test]
fn the_pyramid_is_interpolated() {
    let quadrature = DataQuadrature::default();
    for row in solved(pyramid_full_2d(), &[8, 16, 32], quadrature) {
        let (expected, h1) = (2.0 / (row.level as f64).sqrt(), row.error.h1.unwrap());
        assert!((h1 / expected - 1.0).abs() < 0.02, "n = {}: {h1} not {expected}", row.level);
    }
}
