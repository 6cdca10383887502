//! Linear systems: sparse factors, Krylov methods, preconditioners.

mod choice;
pub(crate) mod direct;
pub(crate) mod krylov;
pub(crate) mod precondition;

pub use choice::Linear;
pub use direct::elimination::EliminationOrder;
pub use direct::factors::{FactorError, Factors, is_positive_definite};
pub use direct::kernels::SparseKernels;
pub use precondition::coarse_level::{Coarser, VertexLevel};
pub use precondition::coarse_spaces::Functions;
pub use precondition::prolongation::Transfer;
