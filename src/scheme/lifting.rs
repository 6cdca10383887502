//! The methods whose penalty is made of lifts of jumps.

use super::{
    DirichletBy, ExpectedOrders, Scheme, SchemeOptions, Setting, broken_energy_order,
    name_of_degree, with_duality,
};
use crate::element::{Broken, P1, ReferenceElement};
use crate::facet::{FacetLifts, Lifted, Lifts};
use crate::mesh::Mesh;

/// The second method of Bassi and Rebay: penalty by the lifts of single facets, on broken elements, by
/// default of degree `k - 1` on elements of degree `k`.
///
/// Source: F. Bassi, S. Rebay, G. Mariotti, S. Pedinotti, M. Savini, 2nd European Conference on
/// Turbomachinery (1997), 99-108.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug)]
pub struct Br2<E = P1> {
    /// The factor of the penalty; where absent three halves of the number of facets of a cell,
    /// above which the form is coercive.
    pub eta: Option<f64>,
    /// The degree of the lifts.
    pub lifts: Lifts,
    /// The element whose broken version carries the scheme.
    pub element: E,
}

impl Default for Br2 {
    fn default() -> Self {
        Self { eta: None, lifts: Lifts::Reduced, element: P1 }
    }
}

/// The factor of the penalty over the number of facets of a cell.
const MARGIN: f64 = 1.5;

impl Br2 {
    /// The scheme by name in a dimension: with what the options give.
    pub(super) fn with_options(options: &SchemeOptions, dimension: usize) -> Self {
        let eta = options.factor.map(|factor| factor * (dimension + 1) as f64);
        Self { eta, lifts: options.lifts.unwrap_or_default(), element: P1 }
    }
}

impl<E> Br2<E> {
    /// The scheme on the broken version of another element: `Br2::default().on(P2)`.
    #[must_use]
    pub fn on<F>(self, element: F) -> Br2<F> {
        Br2 { eta: self.eta, lifts: self.lifts, element }
    }
}

impl<const D: usize, E: ReferenceElement<D>> Scheme<D> for Br2<E> {
    type Element = Broken<E>;
    type Facet = FacetLifts;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        name_of_degree!("br2", E::DEGREE)
    }
    fn choices(&self) -> SchemeOptions {
        let factor = self.eta.map(|eta| eta / (D + 1) as f64).filter(|&factor| factor != MARGIN);
        SchemeOptions { factor, lifts: self.lifts.unless_default(), ..SchemeOptions::default() }
    }
    fn facet(&self, _: &Mesh<D>) -> FacetLifts {
        let eta = self.eta.unwrap_or(MARGIN * (D + 1) as f64);
        FacetLifts { eta, lift_degree: self.lifts.degree(E::BASIS_DEGREE), bounded: true }
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, E::DEGREE), setting)
    }
}

/// The method of Brezzi, Manzini, Marini, Pietra and Russo: `int alpha (grad u + r(u)) . (grad v +
/// r(v))` with a penalty by the lifts of single facets, on broken elements, by default of degree `k - 1`
/// on elements of degree `k`. The form is coercive for every positive factor.
///
/// Source: F. Brezzi, G. Manzini, L. D. Marini, P. Pietra, A. Russo, Numer. Methods Partial
/// Differential Equations 16 (2000), 365-378.
/// Orders: F. Wang, W. Han, X.-L. Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733 for obstacles and
/// IMA J. Numer. Anal. 31 (2011), 1754-1772 for Signorini.
#[derive(Clone, Copy, Debug)]
pub struct Bmmpr<E = P1> {
    /// The factor of the penalty; by default one.
    pub eta: f64,
    /// The degree of the lifts.
    pub lifts: Lifts,
    /// The element whose broken version carries the scheme.
    pub element: E,
}

impl Default for Bmmpr {
    fn default() -> Self {
        Self { eta: 1.0, lifts: Lifts::Reduced, element: P1 }
    }
}

impl Bmmpr {
    /// The scheme by name: with what the options give.
    pub(super) fn with_options(options: &SchemeOptions) -> Self {
        let eta = options.factor.unwrap_or(Self::default().eta);
        Self { eta, lifts: options.lifts.unwrap_or_default(), element: P1 }
    }
}

impl<E> Bmmpr<E> {
    /// The scheme on the broken version of another element: `Bmmpr::default().on(P2)`.
    #[must_use]
    pub fn on<F>(self, element: F) -> Bmmpr<F> {
        Bmmpr { eta: self.eta, lifts: self.lifts, element }
    }
}

impl<const D: usize, E: ReferenceElement<D>> Scheme<D> for Bmmpr<E> {
    type Element = Broken<E>;
    type Facet = Lifted<FacetLifts>;
    const DIRICHLET: DirichletBy = DirichletBy::FacetForm;

    fn name(&self) -> &str {
        name_of_degree!("bmmpr", E::DEGREE)
    }
    fn choices(&self) -> SchemeOptions {
        let factor = Some(self.eta).filter(|&eta| eta != Bmmpr::default().eta);
        SchemeOptions { factor, lifts: self.lifts.unless_default(), ..SchemeOptions::default() }
    }
    fn facet(&self, _: &Mesh<D>) -> Lifted<FacetLifts> {
        let lift_degree = self.lifts.degree(E::BASIS_DEGREE);
        Lifted(FacetLifts { eta: self.eta, lift_degree, bounded: false })
    }
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        with_duality(broken_energy_order(setting, E::DEGREE), setting)
    }
}
