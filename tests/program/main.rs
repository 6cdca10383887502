//! The program `unilateral`, subcommand `compare`: wrong requests and right requests.

mod adaptive;
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
mod readme;
mod requests;
mod rows;
mod run;
mod square;
#[cfg(target_os = "linux")]
mod threads;

#[path = "../support"]
mod support {
    pub mod keys;
    pub mod scratch;
}
