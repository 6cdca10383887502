//! The program `compare` as its users and their scripts meet it: wrong requests, right requests.

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
