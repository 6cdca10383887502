//! The interior penalty methods.

use super::{
    DirichletBy, ExpectedOrders, Scheme, SchemeOptions, Setting, broken_energy_order,
    name_of_degree, with_duality,
};
use crate::element::{Broken, P1, ReferenceElement};
use crate::facet::{InteriorPenalty, PenaltyRule, Symmetry};
use crate::mesh::Mesh;

/// Interior penalty on broken elements, with the symmetrising term `THETA {d_n v}[u]`: written once
/// for [`Sipg`], [`Iipg`] and [`Nipg`], for which `THETA` is -1, 0 and 1.
#[derive(Clone, Copy, Debug)]
pub struct InteriorPenaltyMethod<const THETA: i8, E = P1> {
    /// How the penalty is chosen: by default the proven bound with a margin of one half, for [`Nipg`]
    /// the coefficient over the diameter of the facet.
    pub penalty: PenaltyRule,
    /// The element whose broken version carries the scheme.
    pub element: E,
}

/// Symmetric interior penalty on broken elements.
///
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
pub type Sipg<E = P1> = InteriorPenaltyMethod<-1, E>;

/// Incomplete interior penalty on broken elements: consistent, without a symmetrising term. Its
/// proven bound is a quarter of the symmetric one.
///
/// Source: C. Dawson, S. Sun, M. F. Wheeler, Comput. Methods Appl. Mech. Engrg. 193 (2004),
/// 2565-2580. Orders by the argument of F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48
/// (2010), 708-733, which asks for consistency and coercivity only.
pub type Iipg<E = P1> = InteriorPenaltyMethod<0, E>;

/// Non-symmetric interior penalty on broken elements: coercive for every positive penalty.
///
/// Source: B. Riviere, M. F. Wheeler, V. Girault, Comput. Geosci. 3 (1999), 337-360.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
pub type Nipg<E = P1> = InteriorPenaltyMethod<1, E>;

impl<const THETA: i8> Default for InteriorPenaltyMethod<THETA, P1> {
    fn default() -> Self {
        let penalty = match Self::SYMMETRY {
            Symmetry::Symmetric | Symmetry::Incomplete => PenaltyRule::Proven(0.5),
            Symmetry::NonSymmetric => PenaltyRule::Diameter(1.0),
        };
        Self { penalty, element: P1 }
    }
}

impl<const THETA: i8> InteriorPenaltyMethod<THETA, P1> {
    /// The scheme by name: with the penalty factor that the options give.
    pub(super) fn with_options(options: &SchemeOptions) -> Self {
        let by_bound = options.factor.map(|factor| PenaltyRule::Proven(factor - 1.0));
        let chosen = options.sigma.map(PenaltyRule::Diameter).or(by_bound);
        Self { penalty: chosen.unwrap_or(Self::default().penalty), ..Self::default() }
    }
}

impl<const THETA: i8, E> InteriorPenaltyMethod<THETA, E> {
    const SYMMETRY: Symmetry = match THETA {
        -1 => Symmetry::Symmetric,
        0 => Symmetry::Incomplete,
        1 => Symmetry::NonSymmetric,
        _ => panic!("theta is -1, 0 or 1"),
    };

    /// The scheme on the broken version of another element: `Sipg::default().on(P2)`.
    #[must_use]
    pub fn on<F>(self, element: F) -> InteriorPenaltyMethod<THETA, F> {
        InteriorPenaltyMethod { penalty: self.penalty, element }
    }
}

impl<const D: usize, const THETA: i8, E: ReferenceElement<D>> Scheme<D>
    for InteriorPenaltyMethod<THETA, E>
{
    type Element = Broken<E>;
    type Facet = InteriorPenalty;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        match Self::SYMMETRY {
            Symmetry::Symmetric => name_of_degree!("sipg", E::DEGREE),
            Symmetry::Incomplete => name_of_degree!("iipg", E::DEGREE),
            Symmetry::NonSymmetric => name_of_degree!("nipg", E::DEGREE),
        }
    }
    fn choices(&self) -> SchemeOptions {
        let none = SchemeOptions::default();
        match self.penalty {
            penalty if penalty == InteriorPenaltyMethod::<THETA>::default().penalty => none,
            PenaltyRule::Proven(margin) => SchemeOptions { factor: Some(1.0 + margin), ..none },
            PenaltyRule::Diameter(sigma) => SchemeOptions { sigma: Some(sigma), ..none },
        }
    }
    fn facet(&self, _: &Mesh<D>) -> InteriorPenalty {
        InteriorPenalty { symmetry: Self::SYMMETRY, rule: self.penalty, degree: E::BASIS_DEGREE }
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        let orders = broken_energy_order(setting, E::DEGREE);
        // duality needs a scheme that is consistent with the dual problem
        match Self::SYMMETRY {
            Symmetry::Symmetric => with_duality(orders, setting),
            Symmetry::Incomplete | Symmetry::NonSymmetric => orders,
        }
    }
}
