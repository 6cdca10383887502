//! Schemes by name.

use super::AnyScheme;
use crate::facet::PenaltyRule;
use crate::real::Real;
use crate::scheme::{
    Bmmpr, Br2, ConformingP1, CrouzeixRaviartScheme, Eta, FacetMeans, Iipg, Ldg, Nipg, Sipg, Wopsip,
};

/// What a user may choose about schemes by name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SchemeOptions {
    /// Interior penalty factor over the facet's diameter; the scheme's own choice where absent.
    pub sigma: Option<f64>,
    /// WOPSIP factor as it stands; the dimensionless default where absent.
    pub eta: Option<f64>,
    /// Whether discontinuous schemes impose bounds on facet means instead of vertex values.
    pub facet_means: bool,
}

impl SchemeOptions {
    fn penalty(&self, default: PenaltyRule) -> PenaltyRule {
        self.sigma.map_or(default, PenaltyRule::Diameter)
    }
    fn sipg(&self) -> Sipg {
        let default = Sipg::default();
        Sipg { penalty: self.penalty(default.penalty), ..default }
    }
    fn nipg(&self) -> Nipg {
        let default = Nipg::default();
        Nipg { penalty: self.penalty(default.penalty), ..default }
    }
    fn iipg(&self) -> Iipg {
        let default = Iipg::default();
        Iipg { penalty: self.penalty(default.penalty), ..default }
    }
    fn ldg(&self, switch: bool) -> Ldg {
        let default = Ldg::default();
        Ldg { eta: self.sigma.unwrap_or(default.eta), switch, ..default }
    }
    fn wopsip(&self) -> Wopsip {
        let default = Wopsip::default();
        Wopsip { eta: self.eta.map_or(default.eta, Eta::Absolute), ..default }
    }
}

/// Names of the schemes, with one line each. Registering a scheme is one line here and one in
/// [`scheme_by_name`].
pub const SCHEMES: &[(&str, &str)] = &[
    ("p1", "conforming linear elements"),
    ("cr", "Crouzeix-Raviart elements, bounds on facet means"),
    ("sipg", "symmetric interior penalty on broken linears (takes --sigma)"),
    ("nipg", "non-symmetric interior penalty on broken linears (takes --sigma)"),
    ("iipg", "incomplete interior penalty on broken linears (takes --sigma)"),
    ("ldg", "local discontinuous Galerkin on broken linears, mean fluxes (takes --sigma)"),
    (
        "ldg-switch",
        "local discontinuous Galerkin on broken linears, one-sided fluxes (takes --sigma)",
    ),
    ("br2", "second method of Bassi and Rebay on broken linears"),
    ("bmmpr", "method of Brezzi, Manzini, Marini, Pietra and Russo on broken linears"),
    ("wopsip", "weakly over-penalised symmetric interior penalty on broken linears (takes --eta)"),
];

/// The scheme of this name.
pub fn scheme_by_name<T: Real, const D: usize>(
    name: &str,
    options: &SchemeOptions,
) -> Option<Box<dyn AnyScheme<T, D>>> {
    match name {
        "p1" => Some(Box::new(ConformingP1)),
        "cr" => Some(Box::new(CrouzeixRaviartScheme)),
        _ if options.facet_means => with_facet_means(name, options),
        _ => with_nodes(name, options),
    }
}

/// The discontinuous scheme of this name with bounds at nodes.
fn with_nodes<T: Real, const D: usize>(
    name: &str,
    options: &SchemeOptions,
) -> Option<Box<dyn AnyScheme<T, D>>> {
    Some(match name {
        "sipg" => Box::new(options.sipg()),
        "nipg" => Box::new(options.nipg()),
        "iipg" => Box::new(options.iipg()),
        "ldg" => Box::new(options.ldg(false)),
        "ldg-switch" => Box::new(options.ldg(true)),
        "br2" => Box::new(Br2::default()),
        "bmmpr" => Box::new(Bmmpr::default()),
        "wopsip" => Box::new(options.wopsip()),
        _ => return None,
    })
}

/// The discontinuous scheme of this name with bounds on facet means.
fn with_facet_means<T: Real, const D: usize>(
    name: &str,
    options: &SchemeOptions,
) -> Option<Box<dyn AnyScheme<T, D>>> {
    Some(match name {
        "sipg" => Box::new(FacetMeans(options.sipg())),
        "nipg" => Box::new(FacetMeans(options.nipg())),
        "iipg" => Box::new(FacetMeans(options.iipg())),
        "ldg" => Box::new(FacetMeans(options.ldg(false))),
        "ldg-switch" => Box::new(FacetMeans(options.ldg(true))),
        "br2" => Box::new(FacetMeans(Br2::default())),
        "bmmpr" => Box::new(FacetMeans(Bmmpr::default())),
        "wopsip" => Box::new(FacetMeans(options.wopsip())),
        _ => return None,
    })
}
