//! The unknowns of a cell, with constants where loops over cells need them.

use crate::assemble::space::dofs::{Dofs, KINDS};
use crate::element::MAX_BASIS;
use crate::mesh::incidence::{Columns, Ranges};

/// A range of rows for each kind of owner.
pub(super) type Rows = Ranges<KINDS>;

/// In place of a constant number of unknowns: the number is known at run time only, and at most this one.
pub(super) const ANY: usize = MAX_BASIS;

/// How many unknowns a cell has and which kind owns each of them.
///
/// A constant `N` unrolls the loops over them; then one kind owns the first `D + 1` unknowns and one
/// kind the others, if there are others: so it is with P1, P2 and Crouzeix-Raviart elements.
#[derive(Clone, Copy)]
pub(super) struct CellUnknowns<const D: usize, const N: usize = ANY> {
    count: usize,
    kinds: [u8; MAX_BASIS],
}

impl<const D: usize, const N: usize> CellUnknowns<D, N> {
    pub fn new(dofs: &Dofs<'_>) -> Self {
        let mut kinds = [0; MAX_BASIS];
        for (i, kind) in kinds[..dofs.per_cell()].iter_mut().enumerate() {
            *kind = dofs.kind(D, i) as u8;
        }
        Self { count: dofs.per_cell(), kinds }
    }
    /// How many there are.
    #[inline(always)]
    pub fn count(&self) -> usize {
        if const { N == ANY } { self.count } else { N }
    }
}

impl<const D: usize, const N: usize> Columns for CellUnknowns<D, N> {
    #[inline(always)]
    fn width(&self) -> usize {
        self.count()
    }
    #[inline(always)]
    fn inverted(&self) -> usize {
        self.count()
    }
    /// Which kind owns unknown `i`.
    #[inline(always)]
    fn kind(&self, i: usize) -> usize {
        let kind = match const { N == ANY } {
            true => self.kinds[i],
            false if i <= D => self.kinds[0],
            false => self.kinds[D + 1],
        };
        // the remainder saves a comparison with the length wherever kinds are indices
        usize::from(kind) % KINDS
    }
    #[inline(always)]
    fn place(&self, cell: usize, i: usize) -> usize {
        cell * self.count() + i
    }
}

impl<const D: usize> CellUnknowns<D> {
    /// The number of unknowns if one kind owns the first `D + 1` of them and one kind the others;
    /// else [`ANY`].
    pub fn constant_count(dofs: &Dofs<'_>) -> usize {
        let of = Self::new(dofs);
        let is_one = |kinds: &[u8]| kinds.iter().all(|kind| *kind == kinds[0]);
        let kinds = &of.kinds[..of.count];
        let fits = kinds.len() > D && is_one(&kinds[..=D]) && is_one(&kinds[D + 1..]);
        if fits { of.count } else { ANY }
    }
}

/// Calls a function with the number of unknowns of a cell as the constant `N` where loops over them are unrolled, else
/// with [`ANY`]: `with_constant_count!(D, dofs, N => function::<D, N>(dofs))`.
macro_rules! with_constant_count {
    ($D:ident, $dofs:expr, $N:ident => $call:expr) => {{
        macro_rules! with {
            ($count:expr) => {{
                const $N: usize = $count;
                $call
            }};
        }
        // constant conditions: loops for another dimension are not even instantiated
        match $crate::assemble::shared_rows::unknowns::CellUnknowns::<$D>::constant_count($dofs) {
            2 if const { $D == 1 } => with!(2),
            3 if const { $D < 3 } => with!(3),
            4 if const { $D == 3 } => with!(4),
            6 if const { $D == 2 } => with!(6),
            10 if const { $D == 3 } => with!(10),
            _ => with!($crate::assemble::shared_rows::unknowns::ANY),
        }
    }};
}
pub(super) use with_constant_count;
