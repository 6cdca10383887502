//! The functions and constants that expressions know.

/// A function of one number.
pub(super) type One = fn(f64) -> f64;
/// A function of two numbers.
pub(super) type Two = fn(f64, f64) -> f64;

/// A function by how many arguments it takes.
#[derive(Clone, Copy)]
pub(super) enum Function {
    One(One),
    Two(Two),
    /// Of two and more numbers.
    Many(Two),
    /// A condition and two values.
    If,
}
use Function::{If, Many, Two as Pair};

pub(super) const FUNCTIONS: [(&str, Function); 27] = [
    ("abs", Function::One(f64::abs)),
    ("acos", Function::One(f64::acos)),
    ("asin", Function::One(f64::asin)),
    ("atan", Function::One(f64::atan)),
    ("cbrt", Function::One(f64::cbrt)),
    ("ceil", Function::One(f64::ceil)),
    ("cos", Function::One(f64::cos)),
    ("cosh", Function::One(f64::cosh)),
    ("exp", Function::One(f64::exp)),
    ("floor", Function::One(f64::floor)),
    ("ln", Function::One(f64::ln)),
    ("log", Function::One(f64::ln)),
    ("log10", Function::One(f64::log10)),
    ("log2", Function::One(f64::log2)),
    ("round", Function::One(f64::round)),
    ("sign", Function::One(sign)),
    ("sin", Function::One(f64::sin)),
    ("sinh", Function::One(f64::sinh)),
    ("sqrt", Function::One(f64::sqrt)),
    ("tan", Function::One(f64::tan)),
    ("tanh", Function::One(f64::tanh)),
    ("atan2", Pair(f64::atan2)),
    ("hypot", Pair(f64::hypot)),
    ("pow", Pair(f64::powf)),
    ("max", Many(f64::max)),
    ("min", Many(f64::min)),
    ("if", If),
];

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
