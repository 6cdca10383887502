//! What a user may choose about schemes by name.

use std::fmt;

use crate::facet::{Lifts, WeightRule};

/// What a user may choose about schemes by name; a scheme reads what it takes and leaves the rest.
///
/// Displayed as users write it: `factor=2,lifts=full`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SchemeOptions {
    /// A multiple of the scheme's own scale: of the proven bound of the form for interior penalties, for
    /// NIPG of the bound of the symmetric form, of the number of facets of a cell for BR2, of one for
    /// BMMPR, of the diameter of the domain to the power `2k` for WOPSIP. The scheme's own choice where absent.
    pub factor: Option<f64>,
    /// WOPSIP factor as it stands; the dimensionless default where absent.
    pub eta: Option<f64>,
    /// Interior penalty factor over the facet's diameter; the scheme's own choice where absent.
    pub sigma: Option<f64>,
    /// How the factor of WOPSIP becomes a weight; [`WeightRule::Isotropic`] where absent.
    pub weight: Option<WeightRule>,
    /// The degree of the lifts; [`Lifts::Reduced`] where absent.
    pub lifts: Option<Lifts>,
}

/// Values of the keys that are words.
const WEIGHTS: [(&str, WeightRule); 2] =
    [("isotropic", WeightRule::Isotropic), ("anisotropic", WeightRule::Anisotropic)];
const LIFTS: [(&str, Lifts); 2] = [("reduced", Lifts::Reduced), ("full", Lifts::Full)];

impl SchemeOptions {
    /// Sets a key from the words of a user; otherwise says what is allowed.
    pub(super) fn set(&mut self, key: &str, value: &str) -> Result<(), String> {
        let number = || match value.parse::<f64>() {
            Ok(x) if x > 0.0 && x.is_finite() => Ok(Some(x)),
            _ => Err("must be a number, positive and finite".to_owned()),
        };
        match key {
            "factor" => self.factor = number()?,
            "eta" => self.eta = number()?,
            "sigma" => self.sigma = number()?,
            "weight" => self.weight = Some(word(&WEIGHTS, value)?),
            _ => self.lifts = Some(word(&LIFTS, value)?),
        }
        Ok(())
    }
    /// Keys and values of what is set.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&'static str, String)> {
        fn of<W: Copy + PartialEq>(words: &[(&str, W)], set: Option<W>) -> Option<String> {
            words.iter().find(|word| Some(word.1) == set).map(|word| word.0.to_owned())
        }
        let entries = [
            ("factor", self.factor.map(number)),
            ("eta", self.eta.map(number)),
            ("sigma", self.sigma.map(number)),
            ("weight", of(&WEIGHTS, self.weight)),
            ("lifts", of(&LIFTS, self.lifts)),
        ];
        entries.into_iter().filter_map(|(key, value)| Some((key, value?)))
    }
    /// What is set otherwise than in another choice.
    pub(super) fn unlike(&self, other: &Self) -> Self {
        fn of<T: PartialEq>(own: Option<T>, other: Option<T>) -> Option<T> {
            if own == other { None } else { own }
        }
        Self {
            factor: of(self.factor, other.factor),
            eta: of(self.eta, other.eta),
            sigma: of(self.sigma, other.sigma),
            weight: of(self.weight, other.weight),
            lifts: of(self.lifts, other.lifts),
        }
    }
    /// Whether a penalty is chosen.
    pub(super) fn has_penalty(&self) -> bool {
        self.factor.or(self.eta).or(self.sigma).is_some()
    }
}

impl fmt::Display for SchemeOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let entries: Vec<String> = self.entries().map(|(k, v)| format!("{k}={v}")).collect();
        f.write_str(&entries.join(","))
    }
}

fn word<W: Copy>(words: &[(&str, W)], value: &str) -> Result<W, String> {
    let found = words.iter().find(|word| word.0 == value);
    found.map(|word| word.1).ok_or_else(|| {
        let names: Vec<&str> = words.iter().map(|word| word.0).collect();
        format!("must be one of {}", names.join(", "))
    })
}

/// A number in the fewest characters, without what rounding added in the thirteenth digit.
fn number(x: f64) -> String {
    let x: f64 = format!("{x:.12e}").parse().unwrap_or(x);
    if (1e-3..1e5).contains(&x) { x.to_string() } else { format!("{x:e}") }
}
