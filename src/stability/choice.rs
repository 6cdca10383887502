//! Schemes with choices of their penalties.

use super::unweighted::UnweightedWopsip;
use crate::algebra::Inequality;
use crate::assemble::DataQuadrature;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::scheme::{NamedScheme, Scheme};

/// The schemes of the study, as users write them.
pub(crate) const NAMES: [&str; 7] =
    ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means", "p2", "nipg"];

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
    /// All that a user wrote, placement of bounds included.
    Written(NamedScheme),
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
    /// A scheme as a user wrote it.
    pub const fn written(scheme: NamedScheme) -> Self {
        Self::new(scheme.name(), Penalty::Written(scheme))
    }
    /// The scheme with its choices, but for a penalty without the coefficient.
    fn named(&self) -> NamedScheme {
        let choices = match self.penalty {
            Penalty::Written(scheme) => return scheme,
            Penalty::Default | Penalty::Unweighted => String::new(),
            Penalty::Eta(eta) => format!("@eta={eta:e}"),
            Penalty::Sigma(sigma) => format!("@sigma={sigma:e}"),
            Penalty::ByHeights => "@weight=anisotropic".to_owned(),
        };
        match format!("{}{choices}", self.scheme).parse() {
            Ok(scheme) => scheme,
            Err(_) => unreachable!("cases give schemes penalties that they take"),
        }
    }
    /// Whether the penalty of the scheme is of order `h^-3`.
    pub fn is_over_penalised(&self) -> bool {
        self.scheme.starts_with("wopsip")
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
            Penalty::Written(scheme) => {
                scheme.to_string()[self.scheme.len()..].replacen('@', "", 1)
            }
        }
    }
    /// The problem with the constraint set of the choice.
    pub fn constrain<const D: usize>(&self, problem: Problem<D>) -> Problem<D> {
        match self.named().constraint_set() {
            Some(set) => problem.on(set),
            None => problem,
        }
    }
    /// The inequality of a problem on a mesh.
    pub fn inequality<const D: usize>(
        &self,
        problem: &Problem<D>,
        mesh: &Mesh<D>,
    ) -> Result<Inequality<f64>, Error> {
        let problem = self.constrain(problem.clone());
        self.make::<D>().inequality(&problem, mesh, DataQuadrature::default())
    }
    /// The scheme.
    pub fn make<const D: usize>(&self) -> Box<dyn Scheme<D>> {
        match self.penalty {
            Penalty::Unweighted => Box::new(UnweightedWopsip::default()),
            _ => self.named().make(),
        }
    }
}
