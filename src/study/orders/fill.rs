//! Observed orders of convergence.

use crate::measure::observed_order;
use crate::study::row::{Orders, Row};
use crate::study::series::{Variant, series_of};

/// Fills in the order of every row against the previous level: the row with the next smaller level of its series. It is
/// that in the mesh size; on adaptive meshes `-D` times the slope in unknowns.
///
/// The order is none if one of the two rows did not converge, or has no error or one that is rounding. Rows further
/// back are never used, since the table would not show it.
pub fn fill_orders(rows: &mut [Row]) {
    let series = series_of(rows);
    let previous = |row: &Row| {
        let variant = Variant::of(row);
        let own = series.iter().find(|series| series.variant == variant)?;
        own.rows.iter().copied().rev().find(|other| other.level < row.level)
    };
    let of = |row: &Row| previous(row).map_or_else(Orders::default, |coarse| order(coarse, row));
    let orders: Vec<Orders> = rows.iter().map(of).collect();
    for (row, order) in rows.iter_mut().zip(orders) {
        row.order = order;
    }
}

/// The orders of two rows.
fn order(coarse: &Row, fine: &Row) -> Orders {
    if !coarse.converged() || !fine.converged() {
        return Orders::default();
    }
    let (c, f) = (coarse.errors_above_rounding(), fine.errors_above_rounding());
    let of = |c: Option<f64>, f: Option<f64>| observed_order(c?, f?, coarse.size(), fine.size());
    Orders {
        l2: of(c.l2, f.l2),
        h1: of(c.h1, f.h1),
        energy: of(c.energy, f.energy),
        max: of(c.max, f.max),
        bound: of(c.bound, f.bound),
        multiplier_l1: of(c.multiplier_l1, f.multiplier_l1),
        multiplier_l2: of(c.multiplier_l2, f.multiplier_l2),
    }
}
