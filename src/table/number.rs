//! Numbers as a table has them.

/// A number with so many digits after the point and the power of ten: `1.37e-2`.
pub(crate) fn digits(x: f64, places: usize) -> String {
    match x {
        0.0 => "0".to_owned(),
        x if x.is_finite() => format!("{x:.places$e}"),
        x => x.to_string(),
    }
}

/// Two digits after the point: `1.98`.
pub(crate) fn fixed(x: f64) -> String {
    format!("{x:.2}")
}

/// Seconds in six characters, down to what a clock can tell.
pub(crate) fn seconds(x: f64) -> String {
    match x {
        x if x > 0.0 && x < 1e-3 => format!("{x:.1e}"),
        x if x < 10.0 => format!("{x:.4}"),
        x if x < 100.0 => format!("{x:.3}"),
        x if x < 1000.0 => format!("{x:.2}"),
        x => format!("{x:.1}"),
    }
}
