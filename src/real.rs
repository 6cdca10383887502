//! The scalar of assembly and solve, and points of space.

/// A real scalar this crate can assemble and solve in: `f64`, or `f32`.
///
/// Data of a scene are always evaluated in `f64` and rounded once, by [`Real::lit`]. The trait is
/// sealed: the solvers are compiled for these two scalars, in this library.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a scalar this crate can solve in",
    note = "use `f64` or `f32`"
)]
pub trait Real: nalgebra::RealField + sealed::Scalar + Copy {
    /// The name users type and reports state.
    const NAME: &'static str;
    /// Distance from one to the next larger number, as `f64`.
    const EPSILON: f64;
    /// A certificate above this is not that of a solution, whatever the size of rounding: 1e-9, and
    /// 1e-4 in single precision.
    const CERTIFICATE_LIMIT: f64;
    /// The largest bound on the relative algebraic error in the energy norm with which a solve counts
    /// as converged, where the bound is known.
    const ALGEBRAIC_BOUND_LIMIT: f64;
    /// The nearest scalar to a constant or datum.
    fn lit(x: f64) -> Self;
    /// The same number in `f64`, exactly.
    fn to_f64(self) -> f64;
}

mod sealed {
    /// What no other crate can implement; the library that factors matrices asks for its supertrait.
    pub trait Scalar: faer::traits::RealField {}
    impl Scalar for f64 {}
    impl Scalar for f32 {}
}

impl Real for f64 {
    const NAME: &'static str = "f64";
    const EPSILON: f64 = f64::EPSILON;
    const CERTIFICATE_LIMIT: f64 = 1e-9;
    const ALGEBRAIC_BOUND_LIMIT: f64 = 1e-6;
    #[inline(always)]
    fn lit(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
}

impl Real for f32 {
    const NAME: &'static str = "f32";
    const EPSILON: f64 = f32::EPSILON as f64;
    const CERTIFICATE_LIMIT: f64 = 1e-4;
    const ALGEBRAIC_BOUND_LIMIT: f64 = 1e-2;
    #[inline(always)]
    fn lit(x: f64) -> Self {
        x as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

/// A point or vector of `D`-dimensional space.
pub type Point<T, const D: usize> = nalgebra::SVector<T, D>;

/// The point in `f64`, in which all data are evaluated.
#[inline(always)]
pub(crate) fn point_f64<T: Real, const D: usize>(x: &Point<T, D>) -> Point<f64, D> {
    Point::from_fn(|k, _| x[k].to_f64())
}

/// The larger number; NaN if one of the two is NaN, which [`f64::max`] drops.
#[inline(always)]
pub(crate) fn maximum(a: f64, b: f64) -> f64 {
    if a <= b || b.is_nan() { b } else { a }
}
