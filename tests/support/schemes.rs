//! Schemes with penalties as tables state them.

use std::ops::Deref;
use std::sync::Arc;
use unilateral::prelude::*;

/// A scheme chosen at run time.
pub type Boxed<const D: usize> = Box<dyn Scheme<D>>;

/// A scheme with its constraint set: an entry of a list.
pub struct Entry<const D: usize> {
    pub scheme: Boxed<D>,
    pub set: Arc<dyn ConstraintSet>,
}

impl<const D: usize> From<Boxed<D>> for Entry<D> {
    fn from(scheme: Boxed<D>) -> Self {
        Self { scheme, set: Arc::new(Nodes) }
    }
}

impl<const D: usize> Deref for Entry<D> {
    type Target = dyn Scheme<D>;

    fn deref(&self) -> &Self::Target {
        &*self.scheme
    }
}

/// Interior penalty with `sigma / h_F`.
pub fn sipg(sigma: f64) -> Sipg {
    Sipg { penalty: PenaltyRule::Diameter(sigma) }
}

/// Over-penalty with `eta / h_F^3`.
pub fn wopsip(eta: f64) -> Wopsip {
    Wopsip { eta: Eta::Absolute(eta), ..Wopsip::default() }
}
