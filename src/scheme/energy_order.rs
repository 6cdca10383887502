//! Orders that theory proves, shared by schemes of one kind.
//!
//! A scheme states its promise itself, with the source of the proof: neither element nor form imply
//! one, and a scheme of one's own is promised nothing before somebody has proven it. Inequalities are
//! promised nothing in L2: duality needs a linear problem, and what is proven without it, for conforming
//! linears in the maximum norm and in L4, asks for acute meshes or for data of which a setting says nothing.
//! Nothing is promised for solutions that are not better than `H^{3/2}`, where traces of the gradient, which
//! all proofs for inequalities use, need not exist.

use super::{ExpectedOrders, Setting};

/// What elements of this degree reach in the energy norm for a solution in `H^s`: `s - 1`, at most
/// the degree for equations. Under an inequality linears reach one, and quadratics with bounds at all
/// nodes three halves up to any small number, because solutions are not better than `H^{5/2}` at a
/// free boundary; with an obstacle this needs that a function which is not negative at the nodes has
/// no negative mean over a cell, true on segments and triangles, false on tetrahedra.
///
/// With a coefficient that is a function, at most the order up to which it has bounded derivatives in every
/// cell: elements of degree one see it at barycentres, others at the points of a rule that is exact for
/// products of gradients (P. G. Ciarlet, The finite element method for elliptic problems, 1978, theorem
/// 4.1.6).
///
/// R. S. Falk, Math. Comp. 28 (1974), 963-971, F. Brezzi, W. W. Hager, P.-A. Raviart, Numer. Math. 28
/// (1977), 431-443 and L.-H. Wang, Numer. Math. 92 (2002), 771-778 for obstacles; Z. Belhachmi, F. Ben
/// Belgacem, Math. Comp. 72 (2003), 83-104 and G. Drouet, P. Hild, SIAM J. Numer. Anal. 53 (2015),
/// 1488-1507 for Signorini; R. Glowinski, Numerical Methods for Nonlinear Variational Problems, 1984, chapter 2, for
/// friction with linears, about which nothing is promised of others; for discontinuous schemes F. Wang, W. Han, X.-L.
/// Cheng, SIAM J. Numer. Anal. 48 (2010), 708-733.
pub(crate) fn energy_order(setting: &Setting, degree: usize) -> ExpectedOrders {
    let s = setting.regularity.sobolev;
    let most = match degree {
        _ if setting.friction && (setting.obstacle || setting.contact) => None,
        1 => Some(1.0),
        _ if setting.is_linear() => Some(degree as f64),
        _ if setting.friction => None,
        _ if setting.obstacle && setting.dimension == 3 => None,
        _ => Some(1.5),
    };
    let of_coefficient =
        if setting.coefficient { setting.regularity.coefficient } else { f64::INFINITY };
    let order = |most: f64| (s - 1.0).min(most).min(of_coefficient);
    ExpectedOrders { l2: None, h1: most.filter(|_| s > 1.5).map(order) }
}

/// The orders of [`energy_order`] for schemes whose functions jump. Under an inequality the proofs for
/// these schemes ask for solutions in `H^2`, and the proofs for Signorini conditions cover linears only.
pub(crate) fn broken_energy_order(setting: &Setting, degree: usize) -> ExpectedOrders {
    let is_smooth = setting.regularity.sobolev >= 2.0;
    let covered = is_smooth && (degree == 1 || !setting.contact);
    if setting.is_linear() || covered {
        energy_order(setting, degree)
    } else {
        ExpectedOrders::default()
    }
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
pub(crate) fn with_duality(orders: ExpectedOrders, setting: &Setting) -> ExpectedOrders {
    let at_ends = setting.dimension == 1 && !setting.obstacle && !setting.friction;
    let holds = setting.regular_dual && (setting.is_linear() || at_ends);
    ExpectedOrders { l2: orders.h1.filter(|_| holds).map(|h1| h1 + 1.0), ..orders }
}
