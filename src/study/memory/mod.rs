//! Peak memory of the process, the memory that it may have, and an estimate of the memory of a run.

#[cfg(target_os = "linux")]
mod limits;

use crate::element::Layout;
use crate::real::Precision;
#[cfg(target_os = "linux")]
use limits::{kilobytes, left_to_group, limit_of_process};
#[cfg(target_os = "linux")]
use std::path::Path;

/// The largest resident set of this process so far, if the system reports it: on Linux the peak the
/// kernel keeps (`VmHWM`), elsewhere nothing.
pub fn peak_memory_bytes() -> Option<u64> {
    #[cfg(target_os = "linux")]
    return kilobytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM:");
    #[cfg(not(target_os = "linux"))]
    None
}

/// The memory that this process may have in all: what the crate `sysinfo` finds available.
#[cfg(not(target_os = "linux"))]
pub(crate) fn memory_of_process() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    Some(system.available_memory()).filter(|bytes| *bytes > 0)
}

/// The memory that this process may have in all.
#[cfg(target_os = "linux")]
pub(crate) fn memory_of_process() -> Option<u64> {
    allowed_memory_bytes("/")
}

/// The memory that this process may have in all, in bytes: what it has and what machine and control groups leave, and
/// no more than its limits. This is what [`Study::check_memory`](crate::study::Study::check_memory) holds a run against,
/// on Linux, whose files `proc` and `sys` lie below `root`: `/`, or another folder that has them. None where nothing
/// sets a limit, or where a file does not say what the process has.
#[cfg(target_os = "linux")]
pub fn allowed_memory_bytes(root: impl AsRef<Path>) -> Option<u64> {
    let root = root.as_ref();
    let text = |file: &str| std::fs::read_to_string(root.join(file)).ok();
    let own = kilobytes(&text("proc/self/status")?, "VmRSS:")?;
    let machine = kilobytes(&text("proc/meminfo")?, "MemAvailable:");
    let left = [machine, left_to_group(root)].into_iter().flatten().map(|left| left + own);
    left.chain(limit_of_process(root)).min()
}

/// Bytes a run will need, most of them for the factors of the direct solver.
///
/// These grow like `N`, `N log N` and `N^(4/3)` in one, two and three dimensions. The constants are peaks of the
/// process measured on obstacle scenes with 1e6 (1D), 5e5 and 2e6 (2D) and 5e4 to 7e5 (3D) cells, and on Signorini
/// scenes of half that size, whose factors are larger because no contact set in the interior drops out: by 1.4 in two
/// and 1.5 in three dimensions. On these the estimate is right to a fifth; a scene with much or little contact may be
/// off by a half. Layouts with more unknowns than linear ones were not measured, but for conforming quadratics, and are
/// scaled by the square of their number.
pub(super) fn estimate(dimension: usize, layout: Layout, cells: f64, obstacle: bool) -> f64 {
    let (growth, constants) = match dimension {
        1 => (1.0, [320.0, 320.0, 750.0, 660.0]),
        2 => (cells.max(2.0).log2(), [17.5, 37.0, 135.0, 103.0]),
        _ => (cells.cbrt(), [10.0, 85.0, 480.0, 215.0]),
    };
    let constant = if layout.is_broken() {
        constants[2] * (layout.cell as f64 / (dimension + 1) as f64).powi(2)
    } else if layout.edge > 0 {
        let quadratics = (dimension + 1) * (dimension + 2) / 2;
        constants[3] * (layout.per_cell(dimension) as f64 / quadratics as f64).powi(2)
    } else if layout.facet > 0 {
        constants[1]
    } else {
        constants[0]
    };
    let contact = if obstacle { 1.0 } else { [1.0, 1.4, 1.5][dimension.min(3) - 1] };
    constant * growth * cells * contact
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

/// Bytes a run will need where no factors are made: so many for each unknown, coarser levels and
/// meshes included. Peaks of the process were measured on obstacle and Signorini scenes with 1e4 to
/// 1e6 unknowns; on these the estimate is right to a third but for matrices without symmetry, which
/// need up to twice as much. In single precision the rounded matrices come beside those of the problem: 1.25 times as
/// much. With factors the peak in single precision was 0.75 to 0.91 of that in double precision, and is taken as equal.
pub(super) fn estimate_without_factors(
    dimension: usize,
    layout: Layout,
    cells: f64,
    precision: Precision,
) -> f64 {
    let [vertices, facets, edges, own] = match dimension {
        2 => [600.0, 390.0, 450.0, 520.0],
        _ => [1500.0, 400.0, 750.0, 650.0],
    };
    let constant = match layout {
        _ if layout.is_broken() => own,
        _ if layout.edge > 0 => edges,
        _ if layout.facet > 0 => facets,
        _ => vertices,
    };
    let copies = match precision {
        Precision::Double => 1.0,
        Precision::Single => 1.25,
    };
    constant * unknowns_about(dimension, layout, cells) * copies
}
