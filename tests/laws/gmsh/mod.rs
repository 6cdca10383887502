//! The Gmsh reader: small meshes in every form of the format, the meshes of a folder if it is
//! there, another reader as an oracle, one test for each error, and damaged files.

mod agreement;
mod damage;
mod element_types;
mod errors;
mod files;
mod forms;
mod mesh_errors;
mod order;
mod structure_errors;
mod writer;
