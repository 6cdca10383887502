//! The program `unilateral`, subcommand `compare`: wrong requests and right requests.

mod data;
#[cfg(unix)]
mod interrupt;
mod limits;
mod meshes;
mod output;
mod requests;
mod rows;
mod run;
mod square;

#[path = "../support"]
mod support {
    pub mod keys;
}
