//! Penalty factors as reports state them.

/// Penalty factors in force.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
pub struct PenaltyParameters {
    /// Interior penalty factor.
    pub sigma: Option<f64>,
    /// WOPSIP factor.
    pub eta: Option<f64>,
    /// The rule that turns the factor into a weight.
    pub rule: Option<String>,
}
