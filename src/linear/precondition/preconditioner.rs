//! The trait of preconditioners.

/// A preconditioner `B`: an approximate inverse of a matrix on the free unknowns, symmetric and
/// positive definite there, zero on the fixed ones.
pub(crate) trait Preconditioner<T> {
    /// `z = B r` for a residual `r` that is zero on the fixed unknowns.
    fn apply(&mut self, r: &[T], z: &mut [T]);
}
