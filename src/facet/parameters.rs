//! Penalty factors as reports state them.

use serde::Serialize;

/// Penalty factors in force.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PenaltyParameters {
    /// Interior penalty factor.
    pub sigma: Option<f64>,
    /// WOPSIP factor.
    pub eta: Option<f64>,
    /// The rule that turns the factor into a weight.
    pub rule: Option<String>,
}
