//! The scalar of the algebra, and points of space.

use std::fmt::Debug;

/// The precision in which an inequality is solved. Meshes, elements, data, matrices, errors and bounds are in `f64`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// `f64`.
    #[default]
    Double,
    /// `f32`.
    Single,
}

impl Precision {
    /// The precisions by the names users type.
    pub const NAMES: [(&'static str, Self); 2] = [("f64", Self::Double), ("f32", Self::Single)];

    /// The name users type and reports state.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
    /// The precision of a name that users type.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, precision)| *precision)
    }
    /// Distance from one to the next larger number.
    pub fn epsilon(self) -> f64 {
        match self {
            Self::Double => f64::EPSILON,
            Self::Single => f64::from(f32::EPSILON),
        }
    }
    /// [`Real::CERTIFICATE_LIMIT`] of its scalar.
    pub fn certificate_limit(self) -> f64 {
        match self {
            Self::Double => f64::CERTIFICATE_LIMIT,
            Self::Single => f32::CERTIFICATE_LIMIT,
        }
    }
    /// [`Real::ALGEBRAIC_BOUND_LIMIT`] of its scalar.
    pub fn algebraic_bound_limit(self) -> f64 {
        match self {
            Self::Double => f64::ALGEBRAIC_BOUND_LIMIT,
            Self::Single => f32::ALGEBRAIC_BOUND_LIMIT,
        }
    }
}

/// A real scalar that matrices and solvers are generic over: `f64`, or `f32`.
///
/// Problems are assembled in `f64` and rounded once. The trait is sealed: the solvers are compiled for these two
/// scalars, in this library.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a scalar this crate can solve in",
    note = "use `f64` or `f32`"
)]
pub trait Real:
    num_traits::NumAssign
    + num_traits::Signed
    + PartialOrd
    + Copy
    + Default
    + Send
    + Sync
    + Debug
    + 'static
    + sealed::Scalar
{
    /// The precision of the scalar.
    const PRECISION: Precision;
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
    const PRECISION: Precision = Precision::Double;
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
    const PRECISION: Precision = Precision::Single;
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
pub type Point<const D: usize> = nalgebra::SVector<f64, D>;
/// A matrix of `D`-dimensional space.
pub type Matrix<const D: usize> = nalgebra::SMatrix<f64, D, D>;

/// The ends of the smallest box around points; zero without any.
pub(crate) fn box_around<'p, const D: usize>(
    points: impl IntoIterator<Item = &'p Point<D>>,
) -> [Point<D>; 2] {
    let ends = points.into_iter().map(|x| [*x; 2]);
    let both = |[low, high]: [Point<D>; 2], [x, _]: [Point<D>; 2]| {
        [low.zip_map(&x, f64::min), high.zip_map(&x, f64::max)]
    };
    ends.reduce(both).unwrap_or([Point::zeros(); 2])
}

/// The larger number; NaN if one of the two is NaN, which [`f64::max`] drops.
#[inline(always)]
pub(crate) fn maximum(a: f64, b: f64) -> f64 {
    if a <= b || b.is_nan() { b } else { a }
}
