//! Observed orders of convergence.

/// The exponent `p` for which the errors of two meshes behave like `h^p`.
///
/// Nothing where no exponent exists: an error or mesh size that is not positive and finite, or two
/// meshes of the same size.
///
/// ```
/// use unilateral::measure::observed_order;
/// let order = observed_order(4e-2, 1e-2, 0.5, 0.25).unwrap();
/// assert!((order - 2.0).abs() < 1e-12);
/// assert_eq!(observed_order(4e-2, 0.0, 0.5, 0.25), None);
/// ```
pub fn observed_order(
    coarse_error: f64,
    fine_error: f64,
    coarse_h: f64,
    fine_h: f64,
) -> Option<f64> {
    let positive = |x: f64| x.is_finite() && x > 0.0;
    if ![coarse_error, fine_error, coarse_h, fine_h].into_iter().all(positive) {
        return None;
    }
    // Logarithms are subtracted, not quotients taken: a quotient of tiny numbers may overflow.
    let order = (coarse_error.ln() - fine_error.ln()) / (coarse_h.ln() - fine_h.ln());
    order.is_finite().then_some(order)
}
