//! The active sets of cells under over-penalty: the unknowns of a cell change their states together.

use crate::proximal::inequality_of;
use unilateral::algebra::{Bound, Inequality};
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome};

/// The inequality turned upside down.
fn turned(mut inequality: Inequality<f64>) -> Inequality<f64> {
    for bound in &mut inequality.bounds {
        *bound = match *bound {
            Bound::Lower(lower) => Bound::Upper(-lower),
            Bound::Fixed(x) => Bound::Fixed(-x),
            other => other,
        };
    }
    inequality.load.iter_mut().for_each(|load| *load = -*load);
    let data = &mut inequality.penalised.as_mut().unwrap().jump_data;
    data.iter_mut().for_each(|jump| *jump = -*jump);
    inequality
}

/// The number of systems with factors, from below and turned upside down.
fn systems(scene: &str, scheme: &str, level: usize) -> usize {
    let below = inequality_of(scene, scheme, level);
    let [below, above] = [below.clone(), turned(below)].map(|inequality| {
        let solution = ActiveSet::default().solve(&inequality);
        assert_eq!(solution.outcome, Outcome::Converged, "{scene}, {scheme}, {level}");
        assert_eq!(solution.stages.len(), 1, "{scene}, {scheme}, {level}: {:?}", solution.stages);
        solution.outer
    });
    assert_eq!(below, above, "{scene}, {scheme}, {level}");
    below
}

/// With the prediction of single unknowns the active sets of these scenes stagnate.
#[test]
fn cells_of_facet_means_change_their_states_together() {
    for (scene, levels, most) in [
        ("lshape-2d", &[8][..], 9),
        ("biactive-half-2d", &[8, 16], 7),
        ("biactive-ring-2d", &[8, 16], 9),
    ] {
        for &level in levels {
            let found = systems(scene, "wopsip:facet-means", level);
            assert!(found <= most, "{scene}, {level}: {found} systems");
        }
    }
    assert_eq!(systems("radial-3d", "wopsip:facet-means", 2), 3);
}

/// Vertex values of triangles change one by one: with the prediction of cells the active set of this scene stagnates.
#[test]
fn vertex_values_of_triangles_change_one_by_one() {
    for level in [8, 16] {
        let found = systems("biactive-half-2d", "wopsip", level);
        assert!(found <= 10, "{level}: {found} systems");
    }
}

/// On a contact boundary cells have free unknowns beside those with bounds: they change one by one. With the prediction of
/// such cells the active set stagnates.
#[test]
fn unknowns_of_cells_with_free_ones_change_one_by_one() {
    for level in [2, 4] {
        assert_eq!(systems("signorini-harmonic-3d", "wopsip", level), 3, "{level}");
    }
}
