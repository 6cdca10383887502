//! Bounds of an unknown, and which of them is active.

use crate::real::Real;

/// The set of admissible values of an unknown. An absent bound is a variant, not a large number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound<T> {
    /// Any value.
    Free,
    /// This value: a Dirichlet datum.
    Fixed(T),
    /// At least this value.
    Lower(T),
    /// At most this value.
    Upper(T),
    /// Between the two, lower first.
    Both(T, T),
}

impl<T: Real> Bound<T> {
    /// The lower bound, if there is one.
    pub fn lower(&self) -> Option<T> {
        match *self {
            Bound::Lower(l) | Bound::Both(l, _) => Some(l),
            _ => None,
        }
    }
    /// The upper bound, if there is one.
    pub fn upper(&self) -> Option<T> {
        match *self {
            Bound::Upper(u) | Bound::Both(_, u) => Some(u),
            _ => None,
        }
    }
    /// The value of a fixed unknown: a Dirichlet datum, or two bounds that coincide; else `None`.
    pub fn fixed_value(&self) -> Option<T> {
        match *self {
            Bound::Fixed(v) => Some(v),
            Bound::Both(l, u) if l == u => Some(l),
            _ => None,
        }
    }
    /// The projection of `x` onto the admissible values.
    pub fn nearest(&self, x: T) -> T {
        match *self {
            Bound::Fixed(v) => v,
            Bound::Lower(l) | Bound::Both(l, _) if x < l => l,
            Bound::Upper(u) | Bound::Both(_, u) if x > u => u,
            _ => x,
        }
    }
    /// The ends of the interval of admissible values, infinite where there is no bound.
    pub(crate) fn interval(&self) -> [f64; 2] {
        let fixed = self.fixed_value();
        let end = |bound: Option<T>, none: f64| bound.or(fixed).map_or(none, T::to_f64);
        [end(self.lower(), f64::NEG_INFINITY), end(self.upper(), f64::INFINITY)]
    }
    /// The distances of `x` from the lower and from the upper bound: negative beyond it, infinite without it.
    pub(crate) fn distances(&self, x: f64) -> [f64; 2] {
        let to_lower = self.lower().map_or(f64::INFINITY, |l| x - l.to_f64());
        let to_upper = self.upper().map_or(f64::INFINITY, |u| u.to_f64() - x);
        [to_lower, to_upper]
    }
    /// Whether the set is given by one or two inequalities.
    pub fn is_inequality(&self) -> bool {
        matches!(self, Bound::Lower(_) | Bound::Upper(_) | Bound::Both(..))
    }
}

/// The contact state of an unknown: the bound that is active.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Contact {
    /// No bound is active: the unknown is solved for.
    #[default]
    Inactive,
    /// The lower bound is active.
    Lower,
    /// The upper bound is active.
    Upper,
}
