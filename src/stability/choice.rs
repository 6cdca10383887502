//! Schemes of the study, each with the choice of its penalty.

use super::unweighted::UnweightedWopsip;
use crate::problem::Problem;
use crate::scenes::Scene;
use crate::scheme::{NamedScheme, Scheme, SchemeOptions};

/// The schemes of the study, as users write them. All but the last are compared in every case.
pub(crate) const NAMES: [&str; 7] =
    ["p1", "cr", "sipg", "wopsip", "wopsip:facet-means", "p2", "nipg"];

/// A scheme as users write it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    name: NamedScheme,
    /// Whether the penalty lacks the coefficient of the problem: of WOPSIP only, and users cannot choose it.
    pub ignores_coefficient: bool,
}

impl Choice {
    pub const fn new(name: NamedScheme) -> Self {
        Self { name, ignores_coefficient: false }
    }
    /// The scheme that this text names.
    pub fn of(text: &str) -> Self {
        Self::new(text.parse().expect("cases name schemes that exist"))
    }
    /// A scheme with a power of ten as its over-penalty factor `eta`.
    pub fn with_eta(scheme: &str, exponent: i32) -> Self {
        Self::of(&format!("{scheme}@eta=1e{exponent}"))
    }
    /// A scheme with a penalty that lacks the coefficient.
    pub fn without_coefficient(scheme: &str) -> Self {
        Self { ignores_coefficient: true, ..Self::of(scheme) }
    }
    /// The label of its rows: the text that users write, without choices that are default.
    pub fn label(&self) -> String {
        match self.ignores_coefficient {
            true => format!("{}, coefficient ignored", self.name),
            false => self.name.to_string(),
        }
    }
    /// The label without choices: the scheme, with the placement of its bounds if that is not the default.
    pub fn scheme(&self) -> String {
        self.name.label_without_choices()
    }
    /// Its choices.
    pub fn options(&self) -> &SchemeOptions {
        self.name.options()
    }
    /// Whether the penalty of the scheme is of order `h^-3`.
    pub fn is_over_penalised(&self) -> bool {
        self.name.name().starts_with("wopsip")
    }
    /// The problem of a scene with the constraint set of the choice.
    pub fn problem<const D: usize>(&self, scene: &Scene<D>) -> Problem<D> {
        let mut problem = scene.problem.clone();
        problem.constraint_set = self.name.constraint_set().or(problem.constraint_set);
        problem
    }
    /// The scheme.
    pub fn make<const D: usize>(&self) -> Box<dyn Scheme<D>> {
        match self.ignores_coefficient {
            true => Box::new(UnweightedWopsip),
            false => self.name.make(),
        }
    }
}
