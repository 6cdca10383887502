//! The Gmsh reader: small meshes in every form of the format, the meshes of a folder if it is
//! there, another reader as an oracle, one test for each error, and damaged files.

#[path = "gmsh/agreement.rs"]
mod agreement;
#[path = "gmsh/damage.rs"]
mod damage;
#[path = "gmsh/errors.rs"]
mod errors;
#[path = "gmsh/forms.rs"]
mod forms;
#[path = "gmsh/mesh_errors.rs"]
mod mesh_errors;
#[path = "gmsh/structure_errors.rs"]
mod structure_errors;
#[path = "gmsh/writer.rs"]
mod writer;
