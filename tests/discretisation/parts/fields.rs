//! Fields of solutions over parts against those of one process.

use super::gathered::{on_parts, parts_of, process};
use std::collections::HashMap;
use unilateral::prelude::*;
use unilateral::processes::in_process;
use unilateral::scenes::Scene;

/// By cell of the whole mesh the multiplier, and by cell and facet the pressure, of own cells.
type OwnFields = (Vec<(u64, f64)>, Vec<((u64, usize), f64)>);

/// Multipliers and pressures beside a cut are those of one part: the residuals of ghosts are those of their owners.
fn holds(scene: &Scene<2>) {
    let mesh: Mesh<2> = scene.domain.mesh(4).unwrap();
    for name in ["p1", "sipg", "nipg", "br2", "wopsip"] {
        let scheme = name.parse::<NamedScheme>().unwrap().make::<2>();
        let of_parts = |parts: usize| {
            in_process(parts, |number, exchange| -> OwnFields {
                let process = process(number, exchange);
                let meshes = parts_of(&mesh, (1, 1), &process);
                let mut nested = on_parts(&scene.problem, &meshes, process);
                let solved = nested.solve_on(1, &*scheme).unwrap();
                assert!(solved.converged(), "{name}");
                let fields = solved.discretisation().fields(solved.inequality(), solved.solution());
                let part = solved.part().unwrap();
                let multipliers = fields.multiplier.iter().enumerate();
                let multipliers = multipliers.filter(|(cell, _)| part.owns(*cell));
                let places = fields.contact_boundary.iter().zip(&fields.pressure);
                let places = places.filter(|((cell, _), _)| part.owns(*cell));
                (
                    multipliers.map(|(cell, &m)| (part.cells[cell], m)).collect(),
                    places.map(|(&(cell, k), &p)| ((part.cells[cell], k), p)).collect(),
                )
            })
        };
        let alone = of_parts(1).remove(0);
        let multipliers: HashMap<u64, f64> = alone.0.into_iter().collect();
        let pressures: HashMap<(u64, usize), f64> = alone.1.into_iter().collect();
        let largest =
            multipliers.values().chain(pressures.values()).fold(0.0_f64, |a, x| a.max(x.abs()));
        let mut n = 0;
        for (own, on_facets) in of_parts(3) {
            let of_cells = own.iter().map(|(cell, m)| (m, multipliers[cell]));
            let of_facets = on_facets.iter().map(|(place, p)| (p, pressures[place]));
            for (found, expected) in of_cells.chain(of_facets) {
                assert!((found - expected).abs() <= 1e-6 * largest, "{name}: {found} {expected}");
                n += 1;
            }
        }
        assert_eq!(n, multipliers.len() + pressures.len());
        assert!(largest > 0.0);
    }
}

#[test]
fn multipliers_beside_a_cut_are_those_of_the_whole() {
    holds(&scenes::radial::<2>(1.0));
    let signorini =
        scenes::catalogue().into_iter().find(|scene| scene.name == "signorini-2d").unwrap();
    let scenes::AnyScene::Two(signorini) = signorini.make(&scenes::Parameters::new()).unwrap()
    else {
        panic!("two dimensions")
    };
    holds(&signorini);
}

/// The files of all parts have the arrays that their list names, the groups of the mesh among them.
#[test]
fn files_of_parts_have_the_arrays_of_their_list() {
    let scene = scenes::signorini_2d();
    let mesh: Mesh<2> = scene.domain.mesh(4).unwrap();
    let folder = std::env::temp_dir().join(format!("unilateral-parts-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    in_process(3, |number, exchange| {
        let process = process(number, exchange);
        let meshes = parts_of(&mesh, (1, 1), &process);
        let mut nested = on_parts(&scene.problem, &meshes, process);
        let solved = nested.solve_on(1, &ConformingP1).unwrap();
        solved.write_vtu_of_parts(&folder, "fields", |file| file).unwrap();
    });
    let list = std::fs::read_to_string(folder.join("fields.pvtu")).unwrap();
    let arrays = list.split("<PDataArray ").skip(1).map(|rest| rest.split('/').next().unwrap());
    let arrays: Vec<&str> = arrays.collect();
    for name in ["pressure", "dimension", "left", "right", "bottom", "top"] {
        assert!(list.contains(&format!("Name=\"{name}\"")), "{list}");
    }
    assert!(list.contains("type=\"Float64\" Name=\"Points\""), "{list}");
    for part in 0..3 {
        let bytes = std::fs::read(folder.join(format!("fields.{part}.vtu"))).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        for array in &arrays {
            assert!(text.contains(&format!("<DataArray {}", array.trim())), "part {part}: {array}");
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
