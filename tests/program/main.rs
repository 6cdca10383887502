//! The program `unilateral`, subcommand `compare`: wrong requests and right requests.

mod adaptive;
mod constants;
mod contact_forces;
mod data;
mod dump;
mod figures;
mod free_bodies;
mod hard_rows;
mod help;
#[cfg(unix)]
mod interrupt;
mod limits;
mod mesh_faults;
mod meshes;
mod messages;
mod obstacles;
#[cfg(unix)]
mod one_run;
mod output;
mod over_processes;
mod own_problems;
mod panics;
mod readme;
mod requests;
mod rows;
mod run;
mod square;
mod stretched;
mod sweeps;
#[cfg(target_os = "linux")]
mod threads;
mod values;

/// The handlers of the program for panics and interrupts, and what they need of it.
#[path = "../../src/bin/unilateral/compare/interrupt.rs"]
#[expect(dead_code, reason = "a run that ends of itself is tested by the program")]
mod interrupt_of_program;
#[path = "../../src/bin/unilateral/shared.rs"]
#[expect(dead_code, reason = "the program needs the rest")]
mod shared;

#[path = "../support"]
mod support {
    pub mod keys;
    pub mod scratch;
}
