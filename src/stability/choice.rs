//! Schemes with what is chosen about their penalties.

use super::cases::unweighted::Blind;
use crate::facet::WeightRule;
use crate::real::Real;
use crate::scheme::{AnyScheme, FacetMeans, Placement, SchemeOptions, Wopsip, scheme_by_name};

/// The schemes of the study, as users type them.
pub(crate) const NAMES: [&str; 7] =
    ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means", "p2", "nipg"];

/// What is chosen about a penalty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Penalty {
    /// What the library chooses.
    Default,
    /// WOPSIP: this number over the cube of the facet's diameter.
    Eta(f64),
    /// Interior penalty: this number over the facet's diameter.
    Sigma(f64),
    /// WOPSIP: weights by heights, for stretched cells.
    ByHeights,
    /// WOPSIP: without the coefficient.
    Blind,
}

/// A scheme and what is chosen about it.
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
    /// Whether it is WOPSIP.
    pub fn is_over_penalised(&self) -> bool {
        self.scheme.starts_with("wopsip")
    }
    /// The choice in words; nothing where there is none.
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
            Penalty::Blind => "eta = diam^2, eta/h_F^3, coefficient ignored".into(),
        }
    }
    /// The scheme.
    pub fn make<T: Real, const D: usize>(&self) -> Box<dyn AnyScheme<T, D>> {
        let (name, at) = match self.scheme.split_once(':') {
            Some((name, _)) => (name, Placement::FacetMeans),
            None => (self.scheme, Placement::Nodes),
        };
        let mut options = SchemeOptions { placement: at, ..SchemeOptions::default() };
        match self.penalty {
            Penalty::Default => {}
            Penalty::Eta(eta) => options.eta = Some(eta),
            Penalty::Sigma(sigma) => options.sigma = Some(sigma),
            Penalty::ByHeights => {
                let scheme = Wopsip { weight: WeightRule::Anisotropic, ..Wopsip::default() };
                return match at {
                    Placement::FacetMeans => Box::new(FacetMeans(scheme)),
                    _ => Box::new(scheme),
                };
            }
            Penalty::Blind => {
                return match at {
                    Placement::FacetMeans => Box::new(FacetMeans(Blind::default())),
                    _ => Box::new(Blind::default()),
                };
            }
        }
        match scheme_by_name(name, &options) {
            Some(scheme) => scheme,
            None => unreachable!("names are those of the list above"),
        }
    }
}

/// The library's choice of the schemes every case compares.
pub(crate) fn compared() -> Vec<Choice> {
    NAMES[..6].iter().map(|name| Choice::default(name)).collect()
}

/// These and further ones.
pub(crate) fn compared_and(further: &[Choice]) -> Vec<Choice> {
    let mut all = compared();
    all.extend_from_slice(further);
    all
}
