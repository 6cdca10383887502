//! What a user may choose about schemes by name.

use super::{AnyScheme, CellMeans, FacetMeans, Midpoints, Scheme};
use crate::element::{Broken, P1, P2, ReferenceElement};
use crate::real::Real;

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
        ("nodes", Self::Nodes, "all nodes of the element: vertices for linear elements"),
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
    /// A scheme whose constraint set is not for choice.
    pub(super) fn fixed<T: Real, const D: usize>(
        &self,
        scheme: impl Scheme<T, D> + 'static,
    ) -> Box<dyn AnyScheme<T, D>> {
        Box::new(scheme)
    }
    /// A scheme on broken linears with bounds where the user wants them.
    pub(super) fn linear<T: Real, const D: usize>(
        &self,
        scheme: impl Scheme<T, D, Element = Broken<P1>> + 'static,
    ) -> Box<dyn AnyScheme<T, D>> {
        match self.placement {
            Placement::FacetMeans => Box::new(FacetMeans(scheme)),
            _ => Box::new(scheme),
        }
    }
    /// A scheme on quadratics with bounds at all nodes or at midpoints.
    pub(super) fn at_nodes<T: Real, const D: usize>(
        &self,
        scheme: impl Scheme<T, D> + 'static,
    ) -> Box<dyn AnyScheme<T, D>> {
        match self.placement {
            Placement::Midpoints => Box::new(Midpoints(scheme)),
            _ => Box::new(scheme),
        }
    }
    /// A scheme on broken quadratics with bounds where the user wants them.
    pub(super) fn quadratic<T: Real, const D: usize>(
        &self,
        scheme: impl Scheme<T, D, Element = Broken<P2>> + 'static,
    ) -> Box<dyn AnyScheme<T, D>>
    where
        P2: ReferenceElement<T, D>,
    {
        match self.placement {
            Placement::CellMeans => Box::new(CellMeans(scheme)),
            _ => self.at_nodes(scheme),
        }
    }
}
