//! Global numbers of unknowns, and values of unknowns of other parts, between threads.

use super::compare::{Assembled, some_values};
use super::meshes::{bisected, box_mesh, moved};
use super::problems::{obstacle_problem, schemes};
use unilateral::prelude::*;
use unilateral::processes::{Numbering, in_process};

/// Every unknown of the whole has one number in all parts, numbers of a part are consecutive, and an update
/// gives every part the values of the whole.
fn every_scheme<const D: usize>(mesh: &Mesh<D>, parts: usize) {
    let owners = mesh.partition(parts).unwrap();
    let problem = obstacle_problem();
    for entry in schemes::<D>() {
        let problem = problem.clone().on(entry.set.clone());
        let whole = Assembled::new(&*entry.scheme, &problem, mesh);
        let n = whole.discretisation.unknowns();
        let (owner_of, x) = (whole.discretisation.owners(&owners), some_values(n));
        let found = in_process(parts, |number, exchange| {
            let part = mesh.part(&owners, number, entry.layers(mesh)).unwrap();
            let on_part = Assembled::new(&*entry.scheme, &problem, &part.mesh).discretisation;
            let serial = whole.numbers_of(&part, &on_part);
            let numbering = Numbering::new(&part, &on_part, exchange).unwrap();
            let mut values = vec![f64::NAN; serial.len()];
            numbering.own().iter().for_each(|&i| values[i as usize] = x[serial[i as usize]]);
            numbering.update(&mut values, exchange).unwrap();
            assert!(values.iter().zip(&serial).all(|(value, &k)| *value == x[k]));
            (numbering, serial)
        });
        let mut number_of = vec![None; n];
        for (part, (numbering, serial)) in found.iter().enumerate() {
            assert_eq!(numbering.first().last(), Some(&(n as u64)));
            for (&number, &k) in numbering.numbers().iter().zip(serial) {
                assert_eq!(*number_of[k].get_or_insert(number), number, "{}", entry.name());
            }
            let range = numbering.first()[part]..numbering.first()[part + 1];
            let own = numbering.own().iter().map(|&i| i as usize);
            assert!(own.clone().map(|i| numbering.numbers()[i]).eq(range));
            assert!(own.map(|i| serial[i]).all(|k| owner_of[k] == part as u32));
        }
        let mut numbers: Vec<u64> = number_of.into_iter().map(Option::unwrap).collect();
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..n as u64), "{}", entry.name());
    }
}

#[test]
fn every_unknown_has_one_number_on_an_interval() {
    every_scheme(&moved::<1>(9), 4);
}

#[test]
fn every_unknown_has_one_number_in_the_plane() {
    every_scheme(&moved::<2>(4), 5);
    every_scheme(&bisected::<2>(3), 3);
}

#[test]
fn every_unknown_has_one_number_in_space() {
    every_scheme(&box_mesh::<3>(2), 4);
}
