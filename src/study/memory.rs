//! The memory that a run needs, what there is, and the peak of the process.

use crate::element::Layout;

/// Bytes for each cell, and for each unknown, of meshes, matrices and preconditioners.
const PER_CELL: f64 = 150.0;
const PER_UNKNOWN: f64 = 400.0;

/// The largest resident set of this process so far, if the system reports it: on Linux the peak the
/// kernel keeps (`VmHWM`), elsewhere nothing.
pub fn peak_memory_bytes() -> Option<u64> {
    bytes_in("/proc/self/status", "VmHWM:")
}

/// The memory that this process may have in all: what it has and what the machine has left. None where the system does
/// not say so in the files of Linux.
pub(crate) fn memory_of_process() -> Option<u64> {
    let [own, left] = [("/proc/self/status", "VmRSS:"), ("/proc/meminfo", "MemAvailable:")]
        .map(|(file, key)| bytes_in(file, key));
    Some(own?.saturating_add(left?))
}

/// A number of a file of the system in bytes; it is given in units of 1024 bytes, called kB.
fn bytes_in(file: &str, key: &str) -> Option<u64> {
    let text = std::fs::read_to_string(file).ok()?;
    let value = text.lines().find_map(|line| line.strip_prefix(key))?;
    let kilobytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// Bytes a run needs: so many for each cell and for each unknown, and for each unknown as many for factors as grow like
/// `log N` in the plane and `N^(1/3)` in space. Peaks of the process that were measured on obstacle and Signorini scenes
/// with 1e4 to 2e6 unknowns are met to a factor of two without factors, of three with them.
pub(super) fn bytes_about(dimension: usize, layout: Layout, cells: f64, has_factors: bool) -> f64 {
    let of_factors = match dimension {
        2 if has_factors => 15.0 * cells.max(2.0).log2(),
        3 if has_factors => 100.0 * cells.cbrt(),
        _ => 0.0,
    };
    PER_CELL * cells + (PER_UNKNOWN + of_factors) * unknowns_about(dimension, layout, cells)
}

/// The unknowns of a layout, about: of every six cells in the plane three have a vertex and nine an
/// edge of their own, in space one and seven, and twelve a facet.
pub(super) fn unknowns_about(dimension: usize, layout: Layout, cells: f64) -> f64 {
    let [vertex, edge, facet] = match dimension {
        1 => [1.0, 0.0, 1.0],
        2 => [0.5, 1.5, 1.5],
        _ => [1.0 / 6.0, 7.0 / 6.0, 2.0],
    };
    let of = |count: usize, share: f64| count as f64 * share;
    cells
        * (of(layout.vertex, vertex)
            + of(layout.edge, edge)
            + of(layout.facet, facet)
            + of(layout.cell, 1.0))
}
