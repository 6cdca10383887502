//! Observed orders of convergence.

/// The exponent `p` for which the errors of two meshes behave like `h^p`.
///
/// Nothing where no exponent exists: an error or mesh size that is not positive and finite, or two
/// meshes of the same size.
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

/// Fits an order to mesh sizes and errors, the finest mesh last.
///
/// Nothing for fewer than two meshes, and nothing where a mesh size or error is not positive and
/// finite or two meshes that follow each other have the same size.
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

#[cfg(test)]
mod tests {
    use super::{fit_order, observed_order};

    #[test]
    fn orders_are_of_the_ratio_of_mesh_sizes() {
        let order = observed_order(4e-2, 1e-2, 0.5, 0.25).unwrap();
        assert!((order - 2.0).abs() < 1e-12);
        assert_eq!(observed_order(4e-2, 0.0, 0.5, 0.25), None);
        let order = observed_order(8.0, 1.0, 0.9, 0.3).unwrap();
        assert!((order - 8f64.ln() / 3f64.ln()).abs() < 1e-14);
        // Quotients that overflow or vanish have an order all the same.
        assert!((observed_order(1e300, 1e-300, 1.0, 0.1).unwrap() - 600.0).abs() < 1e-9);
        assert!(observed_order(1e-3, 2e-3, 0.2, 0.1).unwrap() < 0.0, "growing errors");
        for (coarse, fine, h, half) in [
            (0.0, 1.0, 0.2, 0.1),
            (1.0, 0.0, 0.2, 0.1),
            (1.0, f64::NAN, 0.2, 0.1),
            (f64::INFINITY, 1.0, 0.2, 0.1),
            (1.0, 0.5, 0.2, 0.2),
            (1.0, 0.5, 0.2, 0.0),
            (-1.0, 0.5, 0.2, 0.1),
        ] {
            assert_eq!(observed_order(coarse, fine, h, half), None);
        }
    }

    #[test]
    fn fitted_orders_have_the_spread_of_a_regression() {
        // logarithms of base 2 at 0, 1, 2, 3: 0, -1, -3, -4; slope -1.4, residuals 0.1, -0.3, 0.3, -0.1
        let fitted = fit_order(&[(1.0, 1.0), (0.5, 0.5), (0.25, 0.125), (0.125, 0.0625)]).unwrap();
        assert!((fitted.order - 1.4).abs() < 1e-14);
        assert!((fitted.spread - 2.0 * (0.2_f64 / 2.0 / 5.0).sqrt()).abs() < 1e-14);
        assert!(fitted.local.iter().zip([1.0, 2.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-14));
        assert_eq!(fit_order(&[(1.0, 1.0), (0.5, 0.5)]).unwrap().spread, f64::INFINITY);
        for wrong in [
            &[(1.0, 1.0)][..],
            &[(1.0, f64::NAN), (0.5, 1.0), (0.25, 0.5)],
            &[(1.0, 1.0), (0.5, 0.0), (0.25, 0.5)],
            &[(0.5, 1.0), (0.5, 0.5)],
        ] {
            assert_eq!(fit_order(wrong), None);
        }
    }

    #[test]
    fn a_power_law_has_its_order_and_no_spread() {
        let fitted = fit_order(&[(0.4, 4.0), (0.2, 1.0), (0.1, 0.25), (0.05, 0.0625)]).unwrap();
        assert!((fitted.order - 2.0).abs() < 1e-12 && fitted.spread < 1e-12);
    }
}
