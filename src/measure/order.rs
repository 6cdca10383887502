//! Observed orders of convergence.

/// The exponent `p` for which the errors of two meshes behave like `h^p`.
///
/// Nothing where no exponent exists: an error or mesh size that is not positive and finite, or two
/// meshes of the same size.
#[must_use]
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

/// The order of a sequence of meshes: a power of the mesh size fitted to all errors.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FittedOrder {
    /// The exponent `p` of the `C h^p` that is closest to the errors, by least squares of their
    /// logarithms.
    pub order: f64,
    /// The width of the interval within one standard error of the fitted order, infinite for two
    /// meshes. Under an inequality errors oscillate with the place where the free boundary cuts cells;
    /// the range of their local orders stays the same however many meshes there are, while the spread
    /// of the fit falls like their number to the power `-3/2`, so that further meshes decide.
    pub spread: f64,
    /// The orders from each mesh to the next.
    pub local: Vec<f64>,
}

impl FittedOrder {
    /// Whether the local orders rise from mesh to mesh, so that one more rise like the last reaches a
    /// limit: the fit over meshes that are still coarse is then below the order of small mesh sizes.
    pub fn rises_to(&self, limit: f64) -> bool {
        let rises = self.local.windows(2).all(|pair| pair[0] <= pair[1]);
        match self.local[..] {
            [.., before, last] => rises && 2.0 * last - before >= limit,
            _ => false,
        }
    }
}

/// Fits an order to pairs of mesh size and error, the finest mesh last.
///
/// Nothing for fewer than two meshes, and nothing where a mesh size or error is not positive and
/// finite or two meshes that follow each other have the same size.
///
/// ```
/// let fitted = unilateral::measure::fit_order(&[(0.5, 0.4), (0.25, 0.1), (0.125, 0.025)]).unwrap();
/// assert!((fitted.order - 2.0).abs() < 1e-12);
/// ```
#[must_use]
pub fn fit_order(meshes: &[(f64, f64)]) -> Option<FittedOrder> {
    let of = |pair: &[(f64, f64)]| observed_order(pair[0].1, pair[1].1, pair[0].0, pair[1].0);
    let local: Vec<f64> = meshes.windows(2).map(of).collect::<Option<_>>()?;
    let points: Vec<(f64, f64)> = meshes.iter().map(|(h, error)| (h.ln(), error.ln())).collect();
    let count = points.len() as f64;
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / count;
    let squares: f64 = points.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    let products: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let order = products / squares;
    let residual = |p: &(f64, f64)| (p.1 - mean_y - order * (p.0 - mean_x)).powi(2);
    let residuals: f64 = points.iter().map(residual).sum();
    let spread = match local.len() {
        0 => return None,
        1 => f64::INFINITY,
        _ => 2.0 * (residuals / (count - 2.0) / squares).sqrt(),
    };
    order.is_finite().then_some(FittedOrder { order, spread, local })
}
