//! Schemes with penalties as tables state them.

use unilateral::prelude::*;

/// A scheme chosen at run time.
pub type Boxed<T, const D: usize> = Box<dyn AnyScheme<T, D>>;

/// Interior penalty with `sigma / h_F`.
pub fn sipg(sigma: f64) -> Sipg {
    Sipg { penalty: PenaltyRule::Diameter(sigma), ..Sipg::default() }
}

/// Over-penalty with `eta / h_F^3`.
pub fn wopsip(eta: f64) -> Wopsip {
    Wopsip { eta: Eta::Absolute(eta), ..Wopsip::default() }
}
