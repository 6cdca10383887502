//! The fluxes around each vertex, which the patches write.

use std::sync::atomic::{AtomicU64, Ordering};

use super::corners::Corner;
use crate::parallel::vectors::collect;

/// The fluxes of the corners of all cells, `per_corner` numbers each.
pub(super) struct CornerFluxes {
    per_corner: usize,
    n_corners: usize,
    /// The bits of the numbers: each is written once, by the task of its vertex.
    bits: Vec<AtomicU64>,
}

impl CornerFluxes {
    /// The fluxes of so many cells with so many corners each, none written yet.
    pub fn new(per_corner: usize, n_corners: usize, n_cells: usize) -> Self {
        let bits = collect(n_cells * n_corners * per_corner, |_| AtomicU64::default());
        Self { per_corner, n_corners, bits }
    }

    /// Writes number `k` of a corner.
    pub fn set(&self, corner: Corner, k: usize, flux: f64) {
        self.entry(corner, k).store(flux.to_bits(), Ordering::Relaxed);
    }

    /// Number `k` of a corner.
    pub fn get(&self, corner: Corner, k: usize) -> f64 {
        f64::from_bits(self.entry(corner, k).load(Ordering::Relaxed))
    }

    fn entry(&self, corner: Corner, k: usize) -> &AtomicU64 {
        &self.bits[(corner.cell() * self.n_corners + corner.own()) * self.per_corner + k]
    }
}
