//! Refinement.
/// stub
pub struct Refinement;
/// stub
pub struct Hierarchy;
