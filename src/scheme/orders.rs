//! Orders that theory proves, shared by schemes of one kind.
//!
//! A scheme states its promise itself, with the source of the proof: neither element nor form imply
//! one, and a scheme of one's own is promised nothing before somebody has proven it. Inequalities are
//! promised nothing in L2: duality needs a linear problem. Nothing is
//! promised for solutions that are not better than `H^{3/2}`, where traces of the gradient, which
//! all proofs for inequalities use, need not exist.

use super::Setting;
use crate::study::ExpectedOrders;

/// What linear elements reach in the energy norm: one for solutions in `H^2`, `s - 1` below, for
/// equations and for both inequalities.
///
/// R. S. Falk, Math. Comp. 28 (1974), 963-971 and F. Brezzi, W. W. Hager, P.-A. Raviart, Numer.
/// Math. 28 (1977), 431-443 for obstacles; G. Drouet, P. Hild, SIAM J. Numer. Anal. 53 (2015),
/// 1488-1507 for Signorini.
pub(super) fn linear_energy_order(setting: &Setting) -> ExpectedOrders {
    energy_order(setting, 1.0)
}

/// What quadratic elements reach in the energy norm: `s - 1`, at most two for equations and three
/// halves for inequalities, whose solutions are not better than `H^{5/2}` at a free boundary. The
/// order of three halves is proven up to any small number.
///
/// F. Brezzi, W. W. Hager, P.-A. Raviart, Numer. Math. 28 (1977), 431-443 and L.-H. Wang, Numer.
/// Math. 92 (2002), 771-778 for obstacles; Z. Belhachmi, F. Ben Belgacem, Math. Comp. 72 (2003),
/// 83-104 for Signorini.
#[expect(dead_code, reason = "for schemes of second degree")]
pub(super) fn quadratic_energy_order(setting: &Setting) -> ExpectedOrders {
    energy_order(setting, if setting.is_linear() { 2.0 } else { 1.5 })
}

fn energy_order(setting: &Setting, most: f64) -> ExpectedOrders {
    let s = setting.regularity.sobolev;
    ExpectedOrders { l2: None, h1: (s > 1.5).then(|| (s - 1.0).min(most)) }
}

/// Adds one more order in L2 where the problem is linear and its dual problem has solutions in
/// `H^2`: for schemes that are consistent with the dual problem, that is symmetric ones.
///
/// In one dimension a Signorini condition is linear too, once the mesh is fine: it binds at the two
/// ends at most, values there converge, so the state of each end is the exact one from some mesh on,
/// or one that is exact as well (no gap and no force), and the problem is that with Dirichlet or
/// Neumann data there.
///
/// J. P. Aubin, Ann. Scuola Norm. Sup. Pisa 21 (1967), 599-637; J. Nitsche, Numer. Math. 11 (1968),
/// 346-348; for schemes with penalties D. N. Arnold, F. Brezzi, B. Cockburn, L. D. Marini, SIAM J.
/// Numer. Anal. 39 (2002), 1749-1779.
pub(super) fn with_duality(orders: ExpectedOrders, setting: &Setting) -> ExpectedOrders {
    let at_ends = setting.dimension == 1 && !setting.obstacle;
    let holds = setting.regular_dual && (setting.is_linear() || at_ends);
    ExpectedOrders { l2: orders.h1.filter(|_| holds).map(|h1| h1 + 1.0), ..orders }
}
