//! Schemes with choices of their penalties.

use super::unweighted::UnweightedWopsip;
use crate::algebra::Inequality;
use crate::assemble::DataQuadrature;
use crate::constraint::FacetMeans;
use crate::error::Error;
use crate::facet::WeightRule;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::{AnyScheme, SchemeOptions, Wopsip, scheme_by_name};

/// A scheme of the study.
struct StudiedScheme {
    /// The name that users type.
    name: &'static str,
    /// The name in the catalogue of schemes.
    registered: &'static str,
    /// Whether facet means are bound instead of nodes.
    on_facet_means: bool,
    /// Whether the penalty is of order `h^-3`.
    is_over_penalised: bool,
}

const fn scheme(name: &'static str) -> StudiedScheme {
    StudiedScheme { name, registered: name, on_facet_means: false, is_over_penalised: false }
}

/// The schemes of the study.
const SCHEMES: [StudiedScheme; 7] = [
    scheme("p1"),
    scheme("cr"),
    scheme("sipg"),
    StudiedScheme { is_over_penalised: true, ..scheme("wopsip") },
    StudiedScheme {
        name: "wopsip:facet-means",
        registered: "wopsip",
        on_facet_means: true,
        is_over_penalised: true,
    },
    scheme("p2"),
    scheme("nipg"),
];

/// The schemes of the study, as users type them.
pub(crate) const NAMES: [&str; 7] = {
    let mut names = [""; 7];
    let mut k = 0;
    while k < names.len() {
        names[k] = SCHEMES[k].name;
        k += 1;
    }
    names
};

/// The choice of a penalty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Penalty {
    /// The default of the library.
    Default,
    /// WOPSIP: this number over the cube of the facet's diameter.
    Eta(f64),
    /// Interior penalty: this number over the facet's diameter.
    Sigma(f64),
    /// WOPSIP: weights by heights, for stretched cells.
    ByHeights,
    /// WOPSIP: without the coefficient.
    Unweighted,
}

/// A scheme with the choice of its penalty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    /// Its name, with the placement of bounds after a colon.
    pub scheme: &'static str,
    pub penalty: Penalty,
}

impl Choice {
    pub const fn new(scheme: &'static str, penalty: Penalty) -> Self {
        Self { scheme, penalty }
    }
    /// The library's choice.
    pub const fn default(scheme: &'static str) -> Self {
        Self::new(scheme, Penalty::Default)
    }
    fn studied(&self) -> &'static StudiedScheme {
        match SCHEMES.iter().find(|known| known.name == self.scheme) {
            Some(known) => known,
            None => unreachable!("names are those of the list above"),
        }
    }
    /// Whether the penalty of the scheme is of order `h^-3`.
    pub fn is_over_penalised(&self) -> bool {
        self.studied().is_over_penalised
    }
    /// The penalty in words; empty for a scheme without a penalty.
    pub fn words(&self) -> String {
        match self.penalty {
            Penalty::Default if self.is_over_penalised() => "eta = diam^2, eta/h_F^3".into(),
            Penalty::Default if self.scheme == "sipg" => "1.5 times proven bound".into(),
            Penalty::Default if self.scheme == "nipg" => "1/h_F".into(),
            Penalty::Default => String::new(),
            Penalty::Eta(1.0) => "1/h_F^3".into(),
            Penalty::Eta(eta) => format!("{eta:e}/h_F^3"),
            Penalty::Sigma(sigma) => format!("{sigma}/h_F"),
            Penalty::ByHeights => "eta = diam^2, eta/(h^2 l_F)".into(),
            Penalty::Unweighted => "eta = diam^2, eta/h_F^3, coefficient ignored".into(),
        }
    }
    /// The problem with the constraint set of the choice.
    pub fn constrain<const D: usize>(&self, problem: Problem<D>) -> Problem<D> {
        if self.studied().on_facet_means { problem.on(FacetMeans) } else { problem }
    }
    /// The inequality of a problem on a mesh.
    pub fn inequality<const D: usize>(
        &self,
        problem: &Problem<D>,
        mesh: &Mesh<f64, D>,
    ) -> Result<Inequality<f64>, Error> {
        let problem = self.constrain(problem.clone());
        self.make::<f64, D>().inequality(&problem, mesh, DataQuadrature::default())
    }
    /// The scheme.
    pub fn make<T: Real, const D: usize>(&self) -> Box<dyn AnyScheme<T, D>> {
        let mut options = SchemeOptions::default();
        match self.penalty {
            Penalty::Default => {}
            Penalty::Eta(eta) => options.eta = Some(eta),
            Penalty::Sigma(sigma) => options.sigma = Some(sigma),
            Penalty::ByHeights => {
                return Box::new(Wopsip { weight: WeightRule::Anisotropic, ..Wopsip::default() });
            }
            Penalty::Unweighted => return Box::new(UnweightedWopsip::default()),
        }
        match scheme_by_name(self.studied().registered, &options) {
            Some(scheme) => scheme,
            None => unreachable!("names are those of the list above"),
        }
    }
}

/// The schemes that every case compares, with default penalties.
pub(crate) fn compared() -> Vec<Choice> {
    NAMES[..6].iter().map(|name| Choice::default(name)).collect()
}

/// The schemes that every case compares, with default penalties, followed by further choices.
pub(crate) fn compared_and(further: &[Choice]) -> Vec<Choice> {
    let mut all = compared();
    all.extend_from_slice(further);
    all
}
