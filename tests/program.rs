//! The program `compare` as its users and their scripts meet it: wrong requests, right requests.

#[path = "rows/keys.rs"]
mod keys;

#[path = "program/data.rs"]
mod data;
#[path = "program/meshes.rs"]
mod meshes;
#[path = "program/output.rs"]
mod output;
#[path = "program/requests.rs"]
mod requests;
#[path = "program/rows.rs"]
mod rows;
#[path = "program/run.rs"]
mod run;
#[path = "program/square.rs"]
mod square;
