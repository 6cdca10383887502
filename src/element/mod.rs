//! Reference elements on simplices, in barycentric coordinates.

mod basis;
mod bernstein;
mod broken;
mod crouzeix_raviart;
mod definition;
mod node;
mod p1;
mod p2;

pub use basis::Basis;
pub use broken::Broken;
pub use crouzeix_raviart::CrouzeixRaviart;
pub(crate) use definition::MAX_BASIS;
pub use definition::{Element, Layout};
pub use node::{Entity, Node};
pub use p1::P1;
pub use p2::P2;
