//! Large meshes: whether time per cell stays what it is, and how much memory they need.

use std::process::Command;

use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::prelude::*;
use unilateral::study::peak_memory_bytes;

use super::cases::unit_box;
use super::table::seconds;

/// Cases by name and subdivisions: the first of each pair has about 10^6 cells.
const CASES: [(&str, [usize; 2]); 4] =
    [("2d/p1", [707, 2236]), ("3d/p1", [55, 80]), ("2d/sipg", [707, 2236]), ("3d/sipg", [55, 80])];

/// Runs the cases that the filters name, or all, each mesh in a process of its own: the peak of
/// memory is that of a process.
pub fn all(filters: &[String]) {
    println!(
        "| case | n | 10^6 cells | from nothing, ns per cell | refill, ns per cell | mesh, MB | matrix, MB | peak, MB |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|");
    let Ok(program) = std::env::current_exe() else { return };
    for (name, sizes) in CASES {
        if filters.is_empty() || filters.iter().any(|f| f == name) {
            for n in sizes {
                let n = n.to_string();
                let run = Command::new(&program).args(["--one-large", name, &n]).status();
                if !run.is_ok_and(|status| status.success()) {
                    println!("| {name} | {n} | failed |");
                }
            }
        }
    }
}

/// Runs one case: its name and subdivisions.
pub fn one(arguments: &[String]) {
    let [name, n] = arguments else { return };
    let Ok(n) = n.parse() else { return };
    match name.as_str() {
        "2d/p1" => run::<2, _>(name, &ConformingP1, n),
        "3d/p1" => run::<3, _>(name, &ConformingP1, n),
        "2d/sipg" => run::<2, _>(name, &Sipg::default(), n),
        "3d/sipg" => run::<3, _>(name, &Sipg::default(), n),
        _ => eprintln!("no such case: {name}"),
    }
}

fn run<const D: usize, S: Scheme<D>>(name: &str, scheme: &S, n: usize) {
    let mesh = unit_box::<D>(n);
    let problem = Problem::<D>::new();
    let discretise = || {
        Discretisation::new(scheme, &problem, &mesh, DataQuadrature::default()).expect("a space")
    };
    let least = |work: &mut (dyn FnMut() + Send)| {
        (0..5).map(|_| seconds(1, work)).fold(f64::INFINITY, f64::min)
    };
    let from_nothing = least(&mut || drop(discretise().matrix()));
    // the peak of one assembly from nothing, before anything else is kept
    let peak = peak_memory_bytes().unwrap_or(0);
    let space = discretise();
    let mut matrix = space.matrix();
    let refill = least(&mut || space.fill(&mut matrix));
    let bytes = 12 * matrix.nonzeros() + 4 * (matrix.size() + 1);
    let mesh_bytes = 4 * mesh.cells().len() + 8 * D * mesh.vertices().len();
    let cells = mesh.n_cells() as f64;
    let megabytes = |bytes: usize| bytes as f64 / 1e6;
    println!(
        "| {name} | {n} | {:.2} | {:.1} | {:.1} | {:.0} | {:.0} | {:.0} |",
        1e-6 * cells,
        1e9 * from_nothing / cells,
        1e9 * refill / cells,
        megabytes(mesh_bytes),
        megabytes(bytes),
        megabytes(peak as usize)
    );
}
