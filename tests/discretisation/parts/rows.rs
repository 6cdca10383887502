//! Rows, loads, bounds and residuals of own unknowns: the bits of the whole mesh.

use super::compare::{differences, same_bits};
use super::meshes::{bisected, box_mesh, files, moved};
use super::problems::{obstacle_problem, schemes, signorini_problem};
use unilateral::mesh::Layers;
use unilateral::prelude::*;
use unilateral::scenes::Scene;

/// Both problems in every scheme.
fn every_scheme<const D: usize>(mesh: &Mesh<D>, parts: [usize; 2]) {
    for entry in schemes::<D>() {
        let [obstacle, signorini] =
            [obstacle_problem(), signorini_problem()].map(|problem| problem.on(entry.set.clone()));
        same_bits(&*entry.scheme, &obstacle, mesh, parts[0]);
        same_bits(&*entry.scheme, &signorini, mesh, parts[1]);
    }
}

#[test]
fn every_scheme_has_the_rows_of_the_whole_mesh_on_an_interval() {
    every_scheme(&box_mesh::<1>(12), [2, 4]);
    every_scheme(&moved::<1>(9), [3, 5]);
    files::<1>(&mut |mesh| every_scheme(mesh, [2, 3]));
}

#[test]
fn every_scheme_has_the_rows_of_the_whole_mesh_in_the_plane() {
    every_scheme(&box_mesh::<2>(5), [2, 4]);
    every_scheme(&moved::<2>(4), [3, 5]);
    every_scheme(&bisected::<2>(3), [4, 3]);
}

#[test]
fn every_scheme_has_the_rows_of_the_whole_mesh_in_space() {
    every_scheme(&box_mesh::<3>(2), [2, 3]);
    every_scheme(&moved::<3>(2), [5, 4]);
}

/// Schemes of every kind on the meshes of files.
#[test]
fn parts_of_meshes_from_files_have_the_rows_of_the_whole_mesh() {
    fn on<const D: usize>() {
        let schemes = NamedScheme::list(["p1", "cr", "sipg", "wopsip", "ldg", "p2", "br2-p2"]);
        let schemes = schemes.unwrap();
        files::<D>(&mut |mesh| {
            for (k, scheme) in schemes.iter().enumerate() {
                let parts = (2 + k % 4).min(mesh.n_cells());
                let scheme = scheme.make::<D>();
                same_bits(&*scheme, &obstacle_problem(), mesh, parts);
                same_bits(&*scheme, &signorini_problem(), mesh, parts);
            }
        });
    }
    on::<2>();
    on::<3>();
}

/// With a layer less than [`Scheme::layers`] some rows differ, for schemes of every kind.
#[test]
fn one_layer_less_is_not_enough() {
    fn on<const D: usize>(mesh: &Mesh<D>, names: &[&str]) {
        for scheme in NamedScheme::list(names.iter().copied()).unwrap() {
            let scheme = scheme.make::<D>();
            let layers = scheme.layers(mesh);
            let fewer = Layers { count: layers.count - 1, ..layers };
            let found = differences(&*scheme, &signorini_problem(), mesh, (4, fewer));
            assert!(found.columns > 0, "{} {found:?}", scheme.name());
        }
    }
    let names = ["p1", "p2", "cr", "sipg", "wopsip", "br2", "ldg", "bmmpr", "ldg-switch-p2"];
    // in the order of the axis the facets of an interval have the order of the whole in any case
    on(&moved::<1>(12), &names);
    on(&box_mesh::<2>(6), &names);
    on(&box_mesh::<3>(3), &names);
}

/// Layers across facets are not enough for unknowns that cells around a vertex share.
#[test]
fn layers_across_facets_are_not_enough_for_shared_unknowns() {
    let mesh = box_mesh::<2>(8);
    let layers = Layers::across_facets(1);
    let found = differences(&ConformingP1, &obstacle_problem(), &mesh, (4, layers));
    assert!(found.columns > 0 && found.loads > 0, "{found:?}");
}

/// Bounds that contradict each other by rounding of the largest datum are no error on the whole mesh, and
/// none on a part without that datum.
#[test]
fn parts_leave_contradictions_of_bounds_to_the_whole() {
    let mesh = box_mesh::<1>(8);
    let problem = Problem::new()
        .dirichlet(|_| -1e-17)
        .obstacle_below(|x: &Point<1>| if x[0] > 0.8 { 1.0 } else { 0.0 });
    same_bits(&ConformingP1, &problem, &mesh, 3);
}

/// Scenes with data of the catalogue: kinks, a jump of the coefficient, a domain with a re-entrant corner, a
/// disc, Signorini conditions beside Dirichlet and Neumann data.
#[test]
fn scenes_have_the_rows_of_the_whole_mesh() {
    fn on<const D: usize>(scene: &Scene<D>, n: usize) {
        let mesh = scene.domain.mesh(n).unwrap();
        for scheme in NamedScheme::list(["p1", "p2", "cr", "sipg", "wopsip", "ldg-p2"]).unwrap() {
            same_bits(&*scheme.make::<D>(), &scene.problem, &mesh, 3);
        }
    }
    on(&scenes::bilateral_1d(), 8);
    on(&scenes::signorini_reaction_1d(), 8);
    let plane = [
        scenes::radial(1.0),
        scenes::lshape_2d(),
        scenes::disc_2d(),
        scenes::contrast(1e6),
        scenes::signorini_2d(),
        scenes::signorini_layers_2d(1e4),
    ];
    plane.iter().for_each(|scene| on(scene, 4));
    on(&scenes::radial::<3>(1.0), 2);
    on(&scenes::signorini_line_3d(), 2);
}
