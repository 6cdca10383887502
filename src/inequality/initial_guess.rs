//! What is known beside an inequality and helps to solve it fast.

use crate::linear::Functions;

/// Meshes and a solution nearby: numbers only.
#[derive(Clone, Debug)]
pub struct Nearby<T> {
    /// Conforming linear functions.
    pub functions: Functions<T>,
    /// Values of all unknowns to start from.
    pub values: Option<Vec<T>>,
    /// Relative size of the energy error that will do; `None` for as small as makes sense. A
    /// direct solver may do better.
    pub accuracy: Option<f64>,
}

impl<T> Default for Nearby<T> {
    fn default() -> Self {
        Self { functions: Functions::Unknown, values: None, accuracy: None }
    }
}
