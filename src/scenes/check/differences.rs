//! Derivatives by differences, with a test of convergence.

/// The derivative of `phi` at zero, from values at arguments of size up to `reach`, or `None` where
/// differences do not converge to within `tolerance`.
///
/// The step of fourth-order central differences is halved until three successive ones agree: across a
/// kink or near a singularity they disagree until the stencil no longer contains it. Two may agree by
/// chance where the error changes its sign. The smallest step is a thousandth of the largest: below,
/// rounding errors dominate.
pub(super) fn settled_derivative(
    phi: impl Fn(f64) -> f64,
    reach: f64,
    tolerance: f64,
) -> Option<f64> {
    let central = |h: f64| (8.0 * (phi(h) - phi(-h)) - (phi(2.0 * h) - phi(-2.0 * h))) / (12.0 * h);
    let mut h = reach / 2.0;
    let mut coarse = central(h);
    let mut agreed = false;
    for _ in 0..10 {
        h /= 2.0;
        let fine = central(h);
        let agrees = (fine - coarse).abs() <= tolerance;
        if agrees && agreed {
            return Some(fine);
        }
        (coarse, agreed) = (fine, agrees);
    }
    None
}
