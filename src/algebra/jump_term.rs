//! A term of the jumps of a penalised matrix.

use super::NO_INDEX;

/// The term `weight * (u[here] - u[there])` of a jump. The difference is computed first, so that a
/// function without jump has none in rounded arithmetic.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JumpTerm<T> {
    /// The first unknown, or [`JumpTerm::NO_UNKNOWN`].
    pub here: u32,
    /// The second unknown, or [`JumpTerm::NO_UNKNOWN`].
    pub there: u32,
    /// The weight.
    pub weight: T,
}

impl<T> JumpTerm<T> {
    /// No unknown; its value in the difference is zero.
    pub const NO_UNKNOWN: u32 = NO_INDEX;
}
