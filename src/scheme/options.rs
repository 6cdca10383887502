//! What a user may choose about schemes by name.

/// What a user may choose about schemes by name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SchemeOptions {
    /// Interior penalty factor over the facet's diameter; the scheme's own choice where absent.
    pub sigma: Option<f64>,
    /// WOPSIP factor as it stands; the dimensionless default where absent.
    pub eta: Option<f64>,
}
