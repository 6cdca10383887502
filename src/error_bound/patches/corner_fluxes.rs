//! The fluxes around each vertex of some cells, which the patches write.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use super::corners::Corner;

/// The fluxes of the corners of the cells that are kept, `per_corner` numbers each.
pub(super) struct CornerFluxes {
    kept: Range<usize>,
    per_corner: usize,
    per_cell: usize,
    /// The bits of the numbers: each is written once, by the task of its vertex.
    bits: Vec<AtomicU64>,
}

impl CornerFluxes {
    pub fn new(per_corner: usize, n_corners: usize) -> Self {
        Self { kept: 0..0, per_corner, per_cell: per_corner * n_corners, bits: Vec::new() }
    }

    /// Keeps the fluxes of these cells from now on. Every flux of a kept cell is written before it is read.
    pub fn keep(&mut self, cells: Range<usize>) {
        self.bits.resize_with(cells.len() * self.per_cell, AtomicU64::default);
        self.kept = cells;
    }

    /// Writes number `k` of a corner, if its cell is kept.
    pub fn set(&self, corner: Corner, k: usize, flux: f64) {
        if self.kept.contains(&corner.cell()) {
            self.entry(corner, k).store(flux.to_bits(), Ordering::Relaxed);
        }
    }

    /// Number `k` of a corner of a kept cell.
    pub fn get(&self, corner: Corner, k: usize) -> f64 {
        f64::from_bits(self.entry(corner, k).load(Ordering::Relaxed))
    }

    fn entry(&self, corner: Corner, k: usize) -> &AtomicU64 {
        let cell = corner.cell() - self.kept.start;
        &self.bits[cell * self.per_cell + corner.own() * self.per_corner + k]
    }
}
