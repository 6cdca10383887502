//! Schemes by name.

use std::any::Any;

use crate::element::{Broken, P1, P2};
use crate::facet::PenaltyRule;
use crate::mesh::Mesh;
use crate::nested::AnyScheme;
use crate::real::Real;
use crate::scheme::{
    Bmmpr, BoundedNodes, Br2, CellMeans, ConformingP1, ConformingP2, DirichletBy, Eta,
    ExpectedOrders, FacetMeans, Iipg, Ldg, Nipg, NonconformingP1, Scheme, Setting, Sipg, Wopsip,
    midpoint_orders,
};

/// Where schemes that have a choice impose the inequality.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// At the nodes of the element: vertices for linears, midpoints of edges besides for quadratics.
    #[default]
    Nodes,
    /// On means over facets: discontinuous schemes on linears.
    FacetMeans,
    /// At midpoints of edges only: schemes on quadratics.
    Midpoints,
    /// On means over cells: discontinuous schemes on quadratics, obstacles only.
    CellMeans,
}

impl Placement {
    /// All placements, by the names users type, with one line each.
    pub const ALL: [(&'static str, Self, &'static str); 5] = [
        (
            "vertices",
            Self::Nodes,
            "values at vertices (linear elements), all nodes (quadratic ones)",
        ),
        ("nodes", Self::Nodes, "the same"),
        ("facet-means", Self::FacetMeans, "means over facets (discontinuous schemes on linears)"),
        ("midpoints", Self::Midpoints, "midpoints of edges only (schemes on quadratics)"),
        (
            "cell-means",
            Self::CellMeans,
            "means over cells (discontinuous schemes on quadratics, obstacles only)",
        ),
    ];
    /// The placement of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|p| p.0 == name).map(|p| p.1)
    }
}

/// What a user may choose about schemes by name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SchemeOptions {
    /// Interior penalty factor over the facet's diameter; the scheme's own choice where absent.
    pub sigma: Option<f64>,
    /// WOPSIP factor as it stands; the dimensionless default where absent.
    pub eta: Option<f64>,
    /// Where the inequality is imposed by schemes that have this placement; others keep their own.
    pub placement: Placement,
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
/// `made` below.
pub const SCHEMES: &[(&str, &str)] = &[
    ("p1", "conforming linear elements"),
    ("p2", "conforming quadratic elements"),
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
    ("sipg-p2", "sipg on broken quadratics (takes --sigma)"),
    ("nipg-p2", "nipg on broken quadratics (takes --sigma)"),
    ("iipg-p2", "iipg on broken quadratics (takes --sigma)"),
    ("ldg-p2", "ldg on broken quadratics (takes --sigma)"),
    ("ldg-switch-p2", "ldg-switch on broken quadratics (takes --sigma)"),
    ("br2-p2", "br2 on broken quadratics"),
    ("bmmpr-p2", "bmmpr on broken quadratics"),
    ("wopsip-p2", "wopsip on broken quadratics, moments of degree one (takes --eta)"),
];

/// The scheme of this name.
pub fn scheme_by_name<T: Real, const D: usize>(
    name: &str,
    options: &SchemeOptions,
) -> Option<Box<dyn AnyScheme<T, D>>> {
    let erased = T::registered_scheme(D, name, options)?;
    erased.downcast::<Box<dyn AnyScheme<T, D>>>().ok().map(|scheme| *scheme)
}

/// The registered schemes, compiled in this library for each scalar and dimension, so that programs
/// which choose by name need not compile them all again.
pub trait RegisteredSchemes {
    /// A `Box<dyn AnyScheme<Self, D>>` for this dimension `D`.
    fn registered_scheme(
        dimension: usize,
        name: &str,
        options: &SchemeOptions,
    ) -> Option<Box<dyn Any>>;
}

impl RegisteredSchemes for f64 {
    fn registered_scheme(
        dimension: usize,
        name: &str,
        options: &SchemeOptions,
    ) -> Option<Box<dyn Any>> {
        erased::<f64>(dimension, name, options)
    }
}

impl RegisteredSchemes for f32 {
    fn registered_scheme(
        dimension: usize,
        name: &str,
        options: &SchemeOptions,
    ) -> Option<Box<dyn Any>> {
        erased::<f32>(dimension, name, options)
    }
}

fn erased<T: Real>(dimension: usize, name: &str, options: &SchemeOptions) -> Option<Box<dyn Any>> {
    Some(match dimension {
        1 => Box::new(made::<T, 1>(name, options)?),
        2 => Box::new(made::<T, 2>(name, options)?),
        3 => Box::new(made::<T, 3>(name, options)?),
        _ => return None,
    })
}

fn made<T: Real, const D: usize>(
    name: &str,
    options: &SchemeOptions,
) -> Option<Box<dyn AnyScheme<T, D>>> {
    let at = options.placement;
    Some(match name {
        "p1" => Box::new(ConformingP1),
        "p2" => Box::new(Quadratic { scheme: ConformingP2, at }),
        "cr" => Box::new(NonconformingP1),
        "sipg" => linear(options.sipg(), at),
        "nipg" => linear(options.nipg(), at),
        "iipg" => linear(options.iipg(), at),
        "ldg" => linear(options.ldg(false), at),
        "ldg-switch" => linear(options.ldg(true), at),
        "br2" => linear(Br2::default(), at),
        "bmmpr" => linear(Bmmpr::default(), at),
        "wopsip" => linear(options.wopsip(), at),
        "sipg-p2" => quadratic(options.sipg().on(P2), at),
        "nipg-p2" => quadratic(options.nipg().on(P2), at),
        "iipg-p2" => quadratic(options.iipg().on(P2), at),
        "ldg-p2" => quadratic(options.ldg(false).on(P2), at),
        "ldg-switch-p2" => quadratic(options.ldg(true).on(P2), at),
        "br2-p2" => quadratic(Br2::default().on(P2), at),
        "bmmpr-p2" => quadratic(Bmmpr::default().on(P2), at),
        "wopsip-p2" => quadratic(options.wopsip().on(P2), at),
        _ => return None,
    })
}

/// A scheme on broken linears with bounds where the user wants them.
fn linear<T: Real, const D: usize, S>(scheme: S, at: Placement) -> Box<dyn AnyScheme<T, D>>
where
    S: Scheme<T, D, Element = Broken<P1>> + 'static,
{
    match at {
        Placement::FacetMeans => Box::new(FacetMeans(scheme)),
        _ => Box::new(scheme),
    }
}

/// A scheme on broken quadratics with bounds where the user wants them.
fn quadratic<T: Real, const D: usize, S>(scheme: S, at: Placement) -> Box<dyn AnyScheme<T, D>>
where
    S: Scheme<T, D, Element = Broken<P2>> + 'static,
{
    match at {
        Placement::CellMeans => Box::new(CellMeans(scheme)),
        _ => Box::new(Quadratic { scheme, at }),
    }
}

/// A scheme on quadratics with bounds at all nodes or, chosen at run time so that it is not
/// compiled twice, at midpoints.
struct Quadratic<S> {
    scheme: S,
    at: Placement,
}

impl<T: Real, const D: usize, S: Scheme<T, D>> Scheme<T, D> for Quadratic<S> {
    type Element = S::Element;
    type Facet = S::Facet;
    const DIRICHLET: DirichletBy = S::DIRICHLET;
    const CONSISTENT: bool = S::CONSISTENT;

    fn name(&self) -> &str {
        self.scheme.name()
    }
    fn bounded_nodes(&self) -> BoundedNodes {
        match self.at {
            Placement::Midpoints => BoundedNodes::Midpoints,
            _ => self.scheme.bounded_nodes(),
        }
    }
    fn facet(&self, mesh: &Mesh<T, D>) -> S::Facet {
        self.scheme.facet(mesh)
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        match self.at {
            Placement::Midpoints => {
                midpoint_orders(setting, || self.scheme.expected_orders(setting))
            }
            _ => self.scheme.expected_orders(setting),
        }
    }
}
