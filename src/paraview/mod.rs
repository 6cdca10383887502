//! Fields on meshes as files that ParaView opens.

mod pvd;
mod vtu;

pub use pvd::write_pvd;
pub use vtu::{CellFields, write_vtu};
