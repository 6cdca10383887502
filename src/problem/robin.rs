//! The data of a Robin side.

use std::sync::Arc;

use super::datum::Shifted;
use super::{BodyConstants, Datum};
use crate::mesh::Mesh;

/// The data of a Robin side, `alpha du/dn + k (u - g) = 0`: an elastic foundation, or the transfer of heat.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Robin<const D: usize> {
    /// The coefficient `k`, not negative.
    pub coefficient: Datum<D>,
    /// The value `g`.
    pub value: Datum<D>,
}

impl<const D: usize> Robin<D> {
    /// The side with this coefficient and this value.
    pub fn new(coefficient: impl Into<Datum<D>>, value: impl Into<Datum<D>>) -> Self {
        Self { coefficient: coefficient.into(), value: value.into() }
    }
    /// The side of the problem for the function less the constants of bodies.
    pub(super) fn less(&self, constants: &Arc<BodyConstants>, mesh: &Mesh<D>) -> Self {
        let value = Shifted::datum(Some(&self.value), None, (constants, mesh));
        Self { coefficient: self.coefficient.clone(), value }
    }
    /// Coefficient and value.
    pub(crate) fn data(&self) -> [&Datum<D>; 2] {
        [&self.coefficient, &self.value]
    }
}
