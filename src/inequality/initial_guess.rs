//! What is known beside an inequality and helps to solve it fast.

use crate::linear::CoarseSpaces;

/// Meshes and a solution nearby: numbers only.
#[derive(Clone, Debug)]
pub struct InitialGuess<T> {
    /// Conforming linear functions.
    pub functions: CoarseSpaces<T>,
    /// Values of all unknowns to start from.
    pub values: Option<Vec<T>>,
    /// Relative size of the energy error that will do; `None` for as small as makes sense. A
    /// direct solver may do better.
    pub accuracy: Option<f64>,
}

impl<T> Default for InitialGuess<T> {
    fn default() -> Self {
        Self { functions: CoarseSpaces::Unknown, values: None, accuracy: None }
    }
}
