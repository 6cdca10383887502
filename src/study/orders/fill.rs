//! Observed orders of convergence.

use crate::measure::observed_order;
use crate::study::row::{Orders, Row};

/// Fills in the order of every row against the previous level: the row with the next smaller level
/// of the same scene, label, constraint and solver. It is that in the mesh size; on adaptive meshes `-D` times the
/// slope in unknowns.
///
/// The order is none if one of the two rows did not converge or has no error. Rows further back are
/// never used, since the table would not show it.
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
    let of = |c: Option<f64>, f: Option<f64>| observed_order(c?, f?, coarse.size(), fine.size());
    Orders {
        l2: of(coarse.error.l2, fine.error.l2),
        h1: of(coarse.error.h1, fine.error.h1),
        energy: of(coarse.error.energy, fine.error.energy),
        max: of(coarse.error.max, fine.error.max),
        bound: of(coarse.bound.discrete, fine.bound.discrete),
        multiplier_l1: of(coarse.contact.multiplier_l1, fine.contact.multiplier_l1),
        multiplier_l2: of(coarse.contact.multiplier_l2, fine.contact.multiplier_l2),
    }
}
