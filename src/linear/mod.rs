//! LinearMethod systems: sparse factors, Krylov methods, preconditioners.

mod choice;
pub(crate) mod direct;
pub(crate) mod krylov;
pub(crate) mod precondition;

pub use choice::LinearMethod;
pub use direct::elimination::EliminationOrder;
pub use direct::factors::{FactorError, Factors, is_positive_definite};
pub use precondition::coarse_level::{CoarseLevel, P1Level};
pub use precondition::coarse_spaces::CoarseSpaces;
pub use precondition::prolongation::Prolongation;
