//! The interior penalty methods: symmetric, incomplete, non-symmetric.

use super::{
    BrokenScheme, ExpectedOrders, SchemeOptions, Setting, broken_energy_order, with_duality,
};
use crate::element::Element;
use crate::facet::{FacetForm, InteriorPenalty, PenaltyRule, Symmetry};
use crate::mesh::Mesh;

/// Interior penalty on broken elements, with the symmetrising term `THETA {d_n v}[u]`: written once
/// for [`Sipg`], [`Iipg`] and [`Nipg`], for which `THETA` is -1, 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InteriorPenaltyMethod<const THETA: i8> {
    /// How the penalty is chosen: by default the proven bound with a margin of one half, for [`Nipg`]
    /// the coefficient over the diameter of the facet.
    pub penalty: PenaltyRule,
}

/// Symmetric interior penalty on broken elements.
///
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
pub type Sipg = InteriorPenaltyMethod<-1>;

/// Incomplete interior penalty on broken elements: consistent, without a symmetrising term. Its
/// proven bound is a quarter of the symmetric one.
///
/// Source: C. Dawson, S. Sun, M. F. Wheeler, Comput. Methods Appl. Mech. Engrg. 193 (2004),
/// 2565-2580. Orders by the argument of F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48
/// (2010), 708-733, which asks for consistency and coercivity only.
pub type Iipg = InteriorPenaltyMethod<0>;

/// Non-symmetric interior penalty on broken elements: coercive for every positive penalty.
///
/// Source: B. Riviere, M. F. Wheeler, V. Girault, Comput. Geosci. 3 (1999), 337-360.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
pub type Nipg = InteriorPenaltyMethod<1>;

impl<const THETA: i8> InteriorPenaltyMethod<THETA> {
    const SYMMETRY: Symmetry = match THETA {
        -1 => Symmetry::Symmetric,
        0 => Symmetry::Incomplete,
        1 => Symmetry::NonSymmetric,
        _ => panic!("theta is -1, 0 or 1"),
    };
}

impl<const THETA: i8> Default for InteriorPenaltyMethod<THETA> {
    fn default() -> Self {
        let penalty = match Self::SYMMETRY {
            Symmetry::Symmetric | Symmetry::Incomplete => PenaltyRule::Proven(0.5),
            Symmetry::NonSymmetric => PenaltyRule::Diameter(1.0),
        };
        Self { penalty }
    }
}

impl<const THETA: i8> BrokenScheme for InteriorPenaltyMethod<THETA> {
    fn name_on_linears(&self) -> &str {
        match Self::SYMMETRY {
            Symmetry::Symmetric => "sipg",
            Symmetry::Incomplete => "iipg",
            Symmetry::NonSymmetric => "nipg",
        }
    }
    fn form_on<const D: usize>(&self, on: &dyn Element<D>, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let degree = on.basis_degree();
        Box::new(InteriorPenalty { symmetry: Self::SYMMETRY, rule: self.penalty, degree })
    }
    fn options(&self) -> SchemeOptions {
        let none = SchemeOptions::default();
        match self.penalty {
            PenaltyRule::Proven(margin) => SchemeOptions { factor: Some(1.0 + margin), ..none },
            PenaltyRule::Diameter(sigma) => SchemeOptions { sigma: Some(sigma), ..none },
        }
    }
    fn with_options(self, options: &SchemeOptions) -> Self {
        let by_bound = options.factor.map(|factor| PenaltyRule::Proven(factor - 1.0));
        let chosen = options.sigma.map(PenaltyRule::Diameter).or(by_bound);
        Self { penalty: chosen.unwrap_or(self.penalty) }
    }
    fn orders_of_degree(&self, degree: usize, setting: &Setting) -> ExpectedOrders {
        let orders = broken_energy_order(setting, degree);
        // duality needs a scheme that is consistent with the dual problem
        match Self::SYMMETRY {
            Symmetry::Symmetric => with_duality(orders, setting),
            Symmetry::Incomplete | Symmetry::NonSymmetric => orders,
        }
    }
}
