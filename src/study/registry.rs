//! Schemes by name.

use super::AnyScheme;
use crate::facet::{PenaltyRule, WeightRule};
use crate::real::Real;
use crate::scheme::{
    ConformingP1, ConformingP2, CrouzeixRaviartScheme, Eta, FacetMeans, Sipg, Wopsip,
};

/// What a user may choose about schemes by name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SchemeOptions {
    /// Interior penalty factor over the facet's diameter; the proven bound where absent.
    pub sigma: Option<f64>,
    /// WOPSIP factor as it stands; the dimensionless default where absent.
    pub eta: Option<f64>,
    /// Whether discontinuous schemes impose bounds on facet means instead of vertex values.
    pub facet_means: bool,
}

impl SchemeOptions {
    fn sipg(&self) -> Sipg {
        self.sigma
            .map_or_else(Sipg::default, |sigma| Sipg { penalty: PenaltyRule::Diameter(sigma) })
    }
    fn wopsip(&self) -> Wopsip {
        self.eta.map_or_else(Wopsip::default, |eta| Wopsip {
            eta: Eta::Absolute(eta),
            weight: WeightRule::Isotropic,
        })
    }
}

/// Names of the schemes, with one line each. Registering a scheme is one line here and one in
/// [`scheme_by_name`].
pub const SCHEMES: &[(&str, &str)] = &[
    ("p1", "conforming linear elements"),
    ("p2", "conforming quadratic elements"),
    ("cr", "Crouzeix-Raviart elements, bounds on facet means"),
    ("sipg", "symmetric interior penalty on broken linears (takes --sigma)"),
    ("wopsip", "weakly over-penalised symmetric interior penalty on broken linears (takes --eta)"),
];

/// The scheme of this name.
pub fn scheme_by_name<T: Real, const D: usize>(
    name: &str,
    options: &SchemeOptions,
) -> Option<Box<dyn AnyScheme<T, D>>> {
    let scheme: Box<dyn AnyScheme<T, D>> = match (name, options.facet_means) {
        ("p1", _) => Box::new(ConformingP1),
        ("p2", _) => Box::new(ConformingP2),
        ("cr", _) => Box::new(CrouzeixRaviartScheme),
        ("sipg", false) => Box::new(options.sipg()),
        ("sipg", true) => Box::new(FacetMeans(options.sipg())),
        ("wopsip", false) => Box::new(options.wopsip()),
        ("wopsip", true) => Box::new(FacetMeans(options.wopsip())),
        _ => return None,
    };
    Some(scheme)
}
