//! Coarse spaces rounded to another precision.

use std::sync::Arc;

use super::coarse_level::{CoarseLevel, P1Level};
use super::coarse_spaces::CoarseSpaces;
use crate::real::Real;

impl CoarseSpaces<f64> {
    /// The spaces with every entry of their matrices rounded once.
    #[must_use]
    pub fn in_precision<T: Real>(&self) -> CoarseSpaces<T> {
        match self {
            Self::Unknown => CoarseSpaces::Unknown,
            Self::CoarseLevel(coarser) => CoarseSpaces::CoarseLevel(coarser.in_precision()),
            Self::SameMesh(level) => CoarseSpaces::SameMesh(Arc::new(level.in_precision())),
        }
    }
}

impl P1Level<f64> {
    fn in_precision<T: Real>(&self) -> P1Level<T> {
        P1Level {
            matrix: self.matrix.in_precision(),
            fixed: self.fixed.clone(),
            coarser: self.coarser.as_ref().map(CoarseLevel::in_precision),
        }
    }
}

impl CoarseLevel<f64> {
    fn in_precision<T: Real>(&self) -> CoarseLevel<T> {
        CoarseLevel {
            level: Arc::new(self.level.in_precision()),
            prolongation: self.prolongation.clone(),
        }
    }
}
