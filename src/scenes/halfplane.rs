//! The square root in the closed upper half plane, where the contact boundary is the real axis.
//!
//! The principal branch is continuous up to the negative real axis from above and jumps just below
//! it. Meshes put points on that axis, and rounding puts them at `-1e-17` or at `-0.0`, so every
//! point enters through [`point`], which lifts it back to the axis.

use nalgebra::Complex;

/// The complex number `x + iy`, with `y` below zero (and minus zero) taken as zero.
///
/// `f64::max` is not used because it may return either of `0.0` and `-0.0`.
pub(super) fn point(x: f64, y: f64) -> Complex<f64> {
    Complex::new(x, if y <= 0.0 { 0.0 } else { y })
}

/// The root with nonnegative real and imaginary part of a number `x + iy`, `y >= 0`.
///
/// Of `(r + x)/2` and `(r - x)/2` only the one without cancellation is formed; the other part of
/// the root follows from `y`. So the root of a negative number is purely imaginary, exactly, and
/// quantities that vanish on the contact boundary vanish there without rounding error.
pub(super) fn square_root(z: Complex<f64>) -> Complex<f64> {
    let r = z.re.hypot(z.im);
    let larger = ((r + z.re.abs()) / 2.0).sqrt();
    let smaller = if larger == 0.0 { 0.0 } else { z.im / (2.0 * larger) };
    if z.re >= 0.0 { Complex::new(larger, smaller) } else { Complex::new(smaller, larger) }
}
