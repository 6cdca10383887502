//! Guaranteed bounds over the parts of a mesh.

use super::gathered::{on_parts, parts_of, process};
use std::collections::HashMap;
use unilateral::error_bound::Unproven;
use unilateral::mesh::{Neighbour, Neighbours};
use unilateral::prelude::*;
use unilateral::processes::in_process;
use unilateral::scenes::Scene;

/// Refinements of the coarsest mesh.
const REFINEMENTS: usize = 2;

/// Every scheme on linears.
const SCHEMES: &str = "p1 cr sipg nipg ldg br2 bmmpr wopsip wopsip:facet-means";

/// What a part knows of the pair of a solve: the fluxes of own cells by their numbers, and the values at the vertices of
/// own cells by the bits of the coordinates.
type OwnPair<const D: usize> = (Vec<(u64, Vec<f64>)>, Vec<([u64; D], u64)>, [f64; 2]);

/// Fluxes of two cells in two parts cancel on their facet, and both parts have the same function there: so a sum over
/// parts is a bound. The bound is that of one part, but for the multipliers that are not exchanged between parts.
fn holds<const D: usize>(scene: &Scene<D>, coarsest: usize, parts: usize) {
    let mesh: Mesh<D> = scene.domain.mesh(coarsest).unwrap();
    for name in SCHEMES.split(' ') {
        let scheme = name.parse::<NamedScheme>().unwrap();
        let problem = match scheme.constraint_set() {
            Some(set) => scene.problem.clone().on(set),
            None => scene.problem.clone(),
        };
        let scheme = scheme.make::<D>();
        let of_parts = |parts: usize| {
            in_process(parts, |number, exchange| -> OwnPair<D> {
                let process = process(number, exchange);
                let meshes = parts_of(&mesh, (REFINEMENTS, 2), &process);
                let mut nested = on_parts(&problem, &meshes, process.clone());
                let solved = nested.solve_on(REFINEMENTS, &*scheme).unwrap();
                assert!(solved.converged(), "{name}");
                let part = solved.part().unwrap();
                let pair = solved.primal_dual_pair().unwrap();
                let own = (0..part.mesh.n_cells()).filter(|&cell| part.owns(cell));
                let (mut fluxes, mut values) = (Vec::new(), Vec::new());
                for cell in own {
                    let flux = (0..=D).map(|facet| pair.flux.through(cell, facet));
                    fluxes.push((part.cells[cell], flux.collect::<Vec<_>>()));
                    for &v in part.mesh.cell(cell) {
                        let x = part.mesh.vertices()[v as usize];
                        let bits = std::array::from_fn(|k| x[k].to_bits());
                        values.push((bits, pair.function[v as usize].to_bits()));
                    }
                }
                let bound = solved.bound().unwrap();
                let share: f64 = bound.cells.iter().sum();
                let all = exchange_sum(&process, share) + bound.terms.algebra;
                // what the solver left counts with the extent of all parts
                assert!(bound.terms.algebra > 0.0, "{name}: {:?}", bound.terms);
                assert!((all - 1.0).abs() < 1e-9 || bound.terms.algebra > 1e-9, "{name}: {all}");
                (fluxes, values, [bound.total, bound.distance])
            })
        };
        let (found, alone) = (of_parts(parts), of_parts(1).remove(0));
        let mut function = HashMap::new();
        for (point, value) in found.iter().flat_map(|(_, values, _)| values) {
            assert_eq!(function.entry(point).or_insert(value), &value, "{name}");
        }
        let whole = (0..REFINEMENTS).fold(mesh.clone(), |mesh, _| mesh.refine().unwrap().0);
        let mut fluxes = vec![Vec::new(); whole.n_cells()];
        for (cell, flux) in found.iter().flat_map(|(fluxes, ..)| fluxes) {
            fluxes[*cell as usize].clone_from(flux);
        }
        let largest = fluxes.iter().flatten().fold(0.0_f64, |largest, q| largest.max(q.abs()));
        let neighbours = Neighbours::new(&whole);
        for cell in 0..whole.n_cells() {
            for local in 0..=D {
                if let Neighbour::Cell { cell: other, local: there } =
                    neighbours.across(cell, local)
                {
                    let sum = fluxes[cell][local] + fluxes[other as usize][usize::from(there)];
                    assert!(sum.abs() <= 1e-9 * largest, "{name}, cell {cell}: {sum} of {largest}");
                }
            }
        }
        for (_, _, bound) in &found {
            assert_eq!(bound, &found[0].2);
            for (found, expected) in bound.iter().zip(&alone.2) {
                assert!((found - expected).abs() < 0.1 * alone.2[0], "{name}: {found} {expected}");
            }
        }
    }
}

fn exchange_sum(process: &unilateral::distributed::Process, number: f64) -> f64 {
    process.exchange.sum(&[number]).unwrap()[0]
}

#[test]
fn fluxes_and_functions_of_pairs_fit_between_parts() {
    holds(&scenes::radial::<2>(1.0), 4, 3);
    let signorini =
        scenes::catalogue().into_iter().find(|scene| scene.name == "signorini-2d").unwrap();
    let scenes::AnyScene::Two(signorini) = signorini.make(&scenes::Parameters::new()).unwrap()
    else {
        panic!("two dimensions")
    };
    holds(&signorini, 4, 3);
    holds(&scenes::radial::<3>(1.0), 1, 2);
}

/// Dirichlet data that disagree at one corner are in one part: no part has a guaranteed bound.
#[test]
fn what_one_part_cannot_prove_is_proven_nowhere() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let problem = Problem::new()
        .constant_source(1.0)
        .dirichlet_on("bottom", |x: &Point<2>| 1.0 - x[0])
        .dirichlet_on("left", 0.0)
        .dirichlet_on("right", 0.0)
        .dirichlet_on("top", 0.0)
        .polynomial_data(1);
    let mesh = Mesh::<2>::kuhn_box(&square, [4, 4]).unwrap();
    let mesh = problem.bind_boundary(mesh).unwrap();
    let unproven = in_process(3, |number, exchange| {
        let process = process(number, exchange);
        let meshes = parts_of(&mesh, (REFINEMENTS, 2), &process);
        let mut nested = on_parts(&problem, &meshes, process.clone());
        nested.solve_on(REFINEMENTS, &ConformingP1).unwrap().bound().unwrap().unproven
    });
    assert_eq!(unproven, vec![[Unproven::Boundary]; 3]);
}
