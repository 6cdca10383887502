//! Fields on meshes as files that ParaView opens.

mod encode;
mod grid;
mod groups;
mod pvd;
mod vtu;

pub use pvd::write_pvd;
pub use vtu::VtuFile;
