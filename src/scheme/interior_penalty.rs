//! The interior penalty methods.

use std::sync::Arc;

use super::{
    ExpectedOrders, Scheme, SchemeOptions, Setting, broken_energy_order, name_of_degree,
    with_duality,
};
use crate::element::{Broken, Element, P1};
use crate::facet::{FacetForm, InteriorPenalty, PenaltyRule, Symmetry};
use crate::mesh::Mesh;

/// Interior penalty on broken elements, with the symmetrising term `THETA {d_n v}[u]`: written once
/// for [`Sipg`], [`Iipg`] and [`Nipg`], for which `THETA` is -1, 0 and 1.
#[derive(Clone, Debug)]
pub struct InteriorPenaltyMethod<const D: usize, const THETA: i8> {
    /// How the penalty is chosen: by default the proven bound with a margin of one half, for [`Nipg`]
    /// the coefficient over the diameter of the facet.
    pub penalty: PenaltyRule,
    /// The element, which is broken.
    pub element: Arc<dyn Element<D>>,
}

/// Symmetric interior penalty on broken elements.
///
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
pub type Sipg<const D: usize> = InteriorPenaltyMethod<D, -1>;

/// Incomplete interior penalty on broken elements: consistent, without a symmetrising term. Its
/// proven bound is a quarter of the symmetric one.
///
/// Source: C. Dawson, S. Sun, M. F. Wheeler, Comput. Methods Appl. Mech. Engrg. 193 (2004),
/// 2565-2580. Orders by the argument of F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48
/// (2010), 708-733, which asks for consistency and coercivity only.
pub type Iipg<const D: usize> = InteriorPenaltyMethod<D, 0>;

/// Non-symmetric interior penalty on broken elements: coercive for every positive penalty.
///
/// Source: B. Riviere, M. F. Wheeler, V. Girault, Comput. Geosci. 3 (1999), 337-360.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
pub type Nipg<const D: usize> = InteriorPenaltyMethod<D, 1>;

impl<const D: usize, const THETA: i8> Default for InteriorPenaltyMethod<D, THETA> {
    fn default() -> Self {
        let penalty = match Self::SYMMETRY {
            Symmetry::Symmetric | Symmetry::Incomplete => PenaltyRule::Proven(0.5),
            Symmetry::NonSymmetric => PenaltyRule::Diameter(1.0),
        };
        Self { penalty, element: Arc::new(Broken(P1)) }
    }
}

impl<const D: usize, const THETA: i8> InteriorPenaltyMethod<D, THETA> {
    const SYMMETRY: Symmetry = match THETA {
        -1 => Symmetry::Symmetric,
        0 => Symmetry::Incomplete,
        1 => Symmetry::NonSymmetric,
        _ => panic!("theta is -1, 0 or 1"),
    };

    /// The scheme by name: with the penalty factor that the options give.
    pub(super) fn with_options(options: &SchemeOptions) -> Self {
        let by_bound = options.factor.map(|factor| PenaltyRule::Proven(factor - 1.0));
        let chosen = options.sigma.map(PenaltyRule::Diameter).or(by_bound);
        let default = Self::default();
        Self { penalty: chosen.unwrap_or(default.penalty), ..default }
    }
    /// The scheme on the broken version of another element: `Sipg::default().on(P2)`.
    #[must_use]
    pub fn on(self, element: impl Element<D> + 'static) -> Self {
        Self { element: Arc::new(Broken(element)), ..self }
    }
}

impl<const D: usize, const THETA: i8> Scheme<D> for InteriorPenaltyMethod<D, THETA> {
    fn name(&self) -> &str {
        match Self::SYMMETRY {
            Symmetry::Symmetric => name_of_degree!("sipg", self.element.degree()),
            Symmetry::Incomplete => name_of_degree!("iipg", self.element.degree()),
            Symmetry::NonSymmetric => name_of_degree!("nipg", self.element.degree()),
        }
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        self.element.clone()
    }
    fn choices(&self) -> SchemeOptions {
        let none = SchemeOptions::default();
        match self.penalty {
            penalty if penalty == Self::default().penalty => none,
            PenaltyRule::Proven(margin) => SchemeOptions { factor: Some(1.0 + margin), ..none },
            PenaltyRule::Diameter(sigma) => SchemeOptions { sigma: Some(sigma), ..none },
        }
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let degree = self.element.basis_degree();
        Box::new(InteriorPenalty { symmetry: Self::SYMMETRY, rule: self.penalty, degree })
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        let orders = broken_energy_order(setting, self.element.degree());
        // duality needs a scheme that is consistent with the dual problem
        match Self::SYMMETRY {
            Symmetry::Symmetric => with_duality(orders, setting),
            Symmetry::Incomplete | Symmetry::NonSymmetric => orders,
        }
    }
}
