//! Reference elements on simplices, in barycentric coordinates.

mod basis;
mod broken;
mod crouzeix_raviart;
mod node;
mod p1;
mod p2;
mod quadratic_cell_mean;
mod reference_element;

pub use basis::Basis;
pub use broken::Broken;
pub use crouzeix_raviart::CrouzeixRaviart;
pub use node::{Entity, Node};
pub use p1::P1;
pub use p2::P2;
#[cfg(test)]
pub(crate) use quadratic_cell_mean::QuadraticCellMean;
pub(crate) use reference_element::MAX_BASIS;
pub use reference_element::{ElementVisitor, Layout, ReferenceElement};
