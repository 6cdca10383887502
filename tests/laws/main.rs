//! Meshes, quadrature rules and the files of meshes; the laws that schemes obey.

mod bisection;
mod floors;
mod gmsh;
mod kit;
mod locks;
mod mesh;
mod overlaps;
mod quadrature;

#[path = "../support"]
mod support {
    pub mod meshes;
}
