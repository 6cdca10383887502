//! Observed orders of convergence.

use crate::measure::observed_order;
use crate::study::row::{Orders, Row};

/// Fills in the order of every row against the previous level: the row with the next smaller level
/// of the same scene, label, constraint and solver. It is that in the mesh size; on adaptive meshes `-D` times the
/// slope in unknowns.
///
/// The order is none if one of the two rows did not converge, or has no error or one that is rounding. Rows further
/// back are never used, since the table would not show it.
pub fn fill_orders(rows: &mut [Row]) {
    let orders: Vec<Orders> = rows
        .iter()
        .map(|row| previous(rows, row).map_or_else(Orders::default, |coarse| order(coarse, row)))
        .collect();
    for (row, order) in rows.iter_mut().zip(orders) {
        row.order = order;
    }
}

/// The row one level coarser, with the same penalty.
fn previous<'a>(rows: &'a [Row], row: &Row) -> Option<&'a Row> {
    rows.iter()
        .filter(|r| {
            r.scene == row.scene
                && r.label == row.label
                && r.constraint == row.constraint
                && r.solver == row.solver
        })
        // a scheme of one's own with another penalty is another scheme; the dimensionless factor of
        // one rule resolves to the same number on all levels of a domain, but not on adaptive meshes
        .filter(|r| r.parameters == row.parameters || r.theta.is_some())
        .filter(|r| r.theta == row.theta)
        .filter(|r| r.level < row.level)
        .max_by_key(|r| r.level)
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
