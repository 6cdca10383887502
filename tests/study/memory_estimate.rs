//! The estimate of the memory that a run needs, against peaks of the process that were measured.

use unilateral::inequality::{ActiveSet, in_precision};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;
use unilateral::real::Precision;

/// The estimate for a scheme on a mesh of so many cells.
fn estimate_on<const D: usize>(
    scene: Scene<D>,
    scheme: &str,
    cells: u32,
    (linear, precision): (LinearMethod, Precision),
) -> f64 {
    let of_level = |level: &usize| scene.domain.cells(*level) == f64::from(cells);
    let level = (1..=1_000_000).find(of_level).expect("a level has so many cells");
    let solver = in_precision(precision, ActiveSet::default().linear(linear));
    let study = Study::new(scene).boxed_solver(solver).levels([1, level]);
    assert_eq!(study.memory_bytes(), None, "there is no scheme yet");
    study.named_scheme(&scheme.parse().unwrap()).memory_bytes().unwrap()
}

/// Two triangles or six tetrahedra for each small box, of an obstacle in a cube or of a contact condition below a box that
/// is half as high as wide.
fn estimate(
    dimension: usize,
    scheme: &str,
    cells: u32,
    has_obstacle: bool,
    how: (LinearMethod, Precision),
) -> f64 {
    fn scene<const D: usize>(has_obstacle: bool) -> Scene<D> {
        let contact = Problem::new().signorini(|_| 0.0);
        match has_obstacle {
            true => scenes::radial(1.0),
            false => Scene::new("contact", BoxDomain::above_contact(), contact),
        }
    }
    match dimension {
        1 => estimate_on::<1>(scene(has_obstacle), scheme, cells, how),
        2 => estimate_on::<2>(scene(has_obstacle), scheme, cells, how),
        _ => estimate_on::<3>(scene(has_obstacle), scheme, cells, how),
    }
}

#[test]
fn the_estimate_meets_peaks_that_were_measured() {
    for (dimension, scheme, cells, has_obstacle, peak) in [
        (1, "sipg", 1_000_000, true, 740.6e6),
        (1, "p1", 1_000_000, true, 319.4e6),
        (2, "sipg", 524_288, true, 1345.0e6),
        (2, "sipg", 2_097_152, true, 5966.7e6),
        (2, "sipg", 524_176, false, 1901.5e6),
        (2, "cr", 524_288, true, 371.4e6),
        (2, "cr", 524_176, false, 517.2e6),
        (2, "p1", 2_097_152, true, 768.5e6),
        (2, "p1", 1_048_576, false, 520.9e6),
        (3, "sipg", 48_000, true, 812.6e6),
        (3, "sipg", 82_944, true, 1899.1e6),
        (3, "sipg", 98_304, false, 3905.8e6),
        (3, "cr", 48_000, true, 147.5e6),
        (3, "cr", 41_472, false, 190.5e6),
        (3, "p1", 663_552, true, 591.3e6),
        (3, "p1", 331_776, false, 333.0e6),
        (1, "p2", 250_000, true, 170.4e6),
        (2, "p2", 131_072, true, 228.1e6),
        (2, "p2", 320_000, true, 574.3e6),
        (2, "p2", 160_000, false, 444.0e6),
        (3, "p2", 34_992, true, 218.9e6),
        (3, "p2", 82_944, true, 777.5e6),
        (3, "p2", 41_472, false, 437.8e6),
    ] {
        let of = |precision| {
            let how = (LinearMethod::Direct, precision);
            estimate(dimension, scheme, cells, has_obstacle, how) / peak
        };
        let ratio = of(Precision::Double);
        assert!((0.45..3.0).contains(&ratio), "{dimension} {scheme} {cells}: {ratio}");
        assert_eq!(of(Precision::Single), ratio);
    }
}

#[test]
fn the_estimate_without_factors_meets_peaks_that_were_measured() {
    for (dimension, scheme, cells, has_obstacle, precision, peak) in [
        (2, "p1", 2_097_152, true, Precision::Double, 541e6),
        (2, "p1", 262_144, false, Precision::Double, 89.8e6),
        (2, "cr", 131_072, true, Precision::Double, 88.6e6),
        (2, "p2", 32_768, true, Precision::Double, 41.6e6),
        (2, "sipg", 131_072, true, Precision::Double, 176.4e6),
        (2, "sipg", 131_072, true, Precision::Double, 214.3e6),
        (2, "sipg", 131_072, true, Precision::Single, 239.2e6),
        (2, "sipg-p2", 32_768, true, Precision::Double, 119.3e6),
        (3, "p1", 1_572_864, true, Precision::Double, 336e6),
        (3, "p1", 196_608, true, Precision::Double, 77.6e6),
        (3, "cr", 24_576, true, Precision::Double, 32.3e6),
        (3, "p2", 24_576, true, Precision::Double, 38.3e6),
        (3, "sipg", 82_944, true, Precision::Double, 175.9e6),
        (3, "sipg", 24_576, true, Precision::Double, 87.8e6),
        (3, "sipg-p2", 3_072, true, Precision::Double, 37.8e6),
    ] {
        let how = (LinearMethod::Iterative, precision);
        let bytes = estimate(dimension, scheme, cells, has_obstacle, how);
        // the program itself takes 12 MB
        let ratio = bytes / (peak - 12e6);
        assert!((0.45..1.5).contains(&ratio), "{dimension} {scheme} {cells}: {ratio}");
    }
}

/// What is estimated is the largest run.
#[test]
fn the_largest_run_counts() {
    let study = |levels: &[usize]| {
        Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).levels(levels.iter().copied())
    };
    let coarse = study(&[64]).memory_bytes();
    assert_eq!(study(&[8, 64, 16]).memory_bytes(), coarse);
    assert!(study(&[64]).scheme(Sipg::default()).memory_bytes() > coarse);
    assert_eq!(study(&[]).memory_bytes(), None);
}
