//! The program `compare` as its users and their scripts meet it: wrong requests, right requests.
//!
//! `cargo test` builds the program first. `cargo test --test program` does not: it runs whatever
//! `cargo build --example compare` left.

mod data;
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
