//! Penalty factors as reports state them.

/// Penalty factors in force.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PenaltyParameters {
    /// Interior penalty factor.
    pub sigma: Option<f64>,
    /// WOPSIP factor.
    pub eta: Option<f64>,
    /// The rule that turns the factor into a weight.
    pub rule: Option<String>,
}

impl PenaltyParameters {
    /// Sets the interior penalty factor.
    #[must_use]
    pub const fn with_sigma(mut self, sigma: f64) -> Self {
        self.sigma = Some(sigma);
        self
    }
    /// Sets the rule that turns the factor into a weight.
    #[must_use]
    pub fn with_rule(mut self, rule: impl Into<String>) -> Self {
        self.rule = Some(rule.into());
        self
    }
}
