//! Lists of schemes.

use super::schemes::Boxed;
use unilateral::prelude::*;

/// The schemes that reproduce linear functions.
pub fn consistent_schemes<T: Real, const D: usize>() -> Vec<Boxed<T, D>> {
    vec![
        Box::new(ConformingP1),
        Box::new(NonconformingP1),
        Box::new(Sipg::default()),
        Box::new(FacetMeans(Sipg::default())),
    ]
}

/// Every scheme, and the discontinuous ones with both sets of constraints, with default penalties.
pub fn all_schemes<T: Real, const D: usize>() -> Vec<Boxed<T, D>> {
    let mut schemes = consistent_schemes();
    schemes.push(Box::new(Wopsip::default()));
    schemes.push(Box::new(FacetMeans(Wopsip::default())));
    schemes
}
