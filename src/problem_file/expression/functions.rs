//! The functions and constants that expressions know.

/// A function of one number.
pub(super) type One = fn(f64) -> f64;
/// A function of two numbers.
pub(super) type Two = fn(f64, f64) -> f64;

pub(super) const FUNCTIONS: [(&str, One); 21] = [
    ("abs", f64::abs),
    ("acos", f64::acos),
    ("asin", f64::asin),
    ("atan", f64::atan),
    ("cbrt", f64::cbrt),
    ("ceil", f64::ceil),
    ("cos", f64::cos),
    ("cosh", f64::cosh),
    ("exp", f64::exp),
    ("floor", f64::floor),
    ("ln", f64::ln),
    ("log", f64::ln),
    ("log10", f64::log10),
    ("log2", f64::log2),
    ("round", f64::round),
    ("sign", sign),
    ("sin", f64::sin),
    ("sinh", f64::sinh),
    ("sqrt", f64::sqrt),
    ("tan", f64::tan),
    ("tanh", f64::tanh),
];

pub(super) const FUNCTIONS_OF_TWO: [(&str, Two); 3] =
    [("atan2", f64::atan2), ("hypot", f64::hypot), ("pow", f64::powf)];

/// Functions of two and more numbers.
pub(super) const FUNCTIONS_OF_MANY: [(&str, Two); 2] = [("max", f64::max), ("min", f64::min)];

pub(super) const CONSTANTS: [(&str, f64); 2] =
    [("e", std::f64::consts::E), ("pi", std::f64::consts::PI)];

/// The sign of a number, zero for zero.
fn sign(x: f64) -> f64 {
    if x == 0.0 { x } else { x.signum() }
}

/// A power; products for small whole exponents, which are faster and no less accurate.
pub(super) fn power(a: f64, b: f64) -> f64 {
    match b {
        2.0 => a * a,
        3.0 => a * a * a,
        _ => a.powf(b),
    }
}

/// A truth value as a number.
pub(super) fn truth(condition: bool) -> f64 {
    f64::from(u8::from(condition))
}
