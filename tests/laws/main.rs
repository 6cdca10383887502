//! Meshes, quadrature rules and the files of meshes; the laws that schemes obey.

mod bisection;
mod edges;
mod floors;
mod geometry;
mod gmsh;
mod kit;
mod levels;
mod locks;
mod mesh;
mod overlaps;
mod quadrature;

#[path = "../support"]
mod support {
    pub mod meshes;
    pub mod panics;
}
