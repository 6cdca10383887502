//! The patch of a vertex: a least squares problem with a balance for each cell.
//!
//! In a cell the numbers `c` of the flux on its facets at the vertex minimise `c . G c / 2 - b . c + m . c` among those
//! with the sum `s` ([`CellProblem`]), `m` the Lagrange multipliers of the conditions that the numbers on both sides of
//! a facet have a given sum. With `1` the vector of ones and `t = G^-1 1 / (1 . G^-1 1)`
//!
//! ```text
//! c = S (b - m) + s t,   S = G^-1 - (G^-1 1) (G^-1 1)^T / (1 . G^-1 1)
//! ```
//!
//! Where a number is known, its own multiplier holds it. What the two sides of each facet have too much gives a
//! symmetric positive semidefinite system for the multipliers. Those of facets on the Dirichlet boundary are zero;
//! without such facets a constant is free.

use super::corners::Corner;
use super::patch_cells::{CellProblem, PatchCells};
use crate::mesh::{BoundaryCondition, Neighbour, Neighbours};

/// Pivots up to this share of the diagonal are zero: in a patch without Dirichlet facets multipliers are
/// determined up to a constant.
const ZERO_PIVOT: f64 = 1e-11;

/// The known data of a number of the flux of a cell.
#[derive(Clone, Copy)]
enum Number {
    /// The sum with that on the other side of the facet; the multiplier of this condition.
    Shared(usize),
    /// Nothing.
    Free,
    /// The number.
    Given(f64),
}

/// A cell of a patch.
struct CellOfPatch<const N: usize> {
    known: [Number; N],
    problem: CellProblem<N>,
}

/// The arrays of one patch.
#[derive(Default)]
pub(super) struct Patch<const N: usize> {
    cells: Vec<CellOfPatch<N>>,
    /// The upper triangle of the matrix of the multipliers by rows.
    matrix: Vec<f64>,
    /// What the numbers on the two sides of facets have too much, then the multipliers.
    multipliers: Vec<f64>,
    /// The sums of the numbers on both sides; less that of the first side once it is known.
    sums: Vec<f64>,
}

impl<const N: usize> Patch<N> {
    /// Calls `set` with the numbers of the flux of a vertex, by its corners: number `k` of facet `f` among those at the
    /// vertex is the number `f PER_FACET + k`.
    pub fn solve<const D: usize, C: PatchCells<D, N>>(
        &mut self,
        of: &C,
        neighbours: &Neighbours,
        corners: &[Corner],
        mut set: impl FnMut(Corner, usize, f64),
    ) {
        self.cells.clear();
        self.multipliers.clear();
        for (k, corner) in corners.iter().enumerate() {
            let mut known = [Number::Free; N];
            let facets = known.chunks_exact_mut(C::PER_FACET).zip(corner.facets::<D>());
            for (known, facet) in facets {
                self.know(of, neighbours, (k, facet), corners, known);
            }
            let mut problem = of.problem(*corner, corners);
            problem.hold(&known, D * C::PER_FACET);
            self.cells.push(CellOfPatch { known, problem });
        }
        self.sums.clear();
        self.sums.extend(self.multipliers.iter().map(|excess| -excess));
        self.assemble();
        solve(&mut self.matrix, &mut self.multipliers);
        // the second side of a facet has the rest of the sum: sides agree to rounding
        let mut n_known = 0;
        for (corner, cell) in corners.iter().zip(&self.cells) {
            let numbers = cell.numbers_with(&self.multipliers);
            for (k, number) in numbers.into_iter().enumerate().take(D * C::PER_FACET) {
                let number = match cell.known[k] {
                    Number::Shared(i) if i < n_known => self.sums[i],
                    Number::Shared(i) => {
                        n_known += 1;
                        self.sums[i] -= number;
                        number
                    }
                    _ => number,
                };
                set(*corner, k, number);
            }
        }
    }

    /// Sets what is known of the numbers of a facet of cell `k` of the patch. The first cell of an interior facet adds
    /// multipliers, with minus the sums of the numbers on both sides.
    fn know<const D: usize, C: PatchCells<D, N>>(
        &mut self,
        of: &C,
        neighbours: &Neighbours,
        (k, facet): (usize, usize),
        corners: &[Corner],
        known: &mut [Number],
    ) {
        let corner = corners[k];
        let normal = of.normal(corner, facet);
        match neighbours.across(corner.cell(), facet) {
            Neighbour::Cell { cell: other, local: facet_there } => {
                let facet_there = usize::from(facet_there);
                let position = corners.binary_search_by_key(&(other as usize), |c| c.cell());
                let there = position.expect("a cell across a facet at a vertex has the vertex");
                if there < k {
                    let place =
                        corners[there].facets::<D>().take_while(|&f| f != facet_there).count();
                    let of_there = &self.cells[there].known[place * C::PER_FACET..];
                    known.copy_from_slice(&of_there[..C::PER_FACET]);
                    return;
                }
                let of_other = of.normal(corners[there], facet_there);
                for (known, (here, there)) in known.iter_mut().zip(normal.iter().zip(of_other)) {
                    *known = Number::Shared(self.multipliers.len());
                    self.multipliers.push(here + there);
                }
            }
            Neighbour::Boundary(BoundaryCondition::Dirichlet) => known.fill(Number::Free),
            Neighbour::Boundary(_) | Neighbour::Cut => {
                let given = of.given(corner, facet);
                for (known, (given, normal)) in known.iter_mut().zip(given.iter().zip(normal)) {
                    *known = Number::Given(given - normal);
                }
            }
        }
    }

    /// The system for the multipliers.
    fn assemble(&mut self) {
        let n = self.multipliers.len();
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for CellOfPatch { known, problem: CellProblem { slopes, numbers } } in &self.cells {
            for (a, number) in known.iter().enumerate() {
                let &Number::Shared(i) = number else { continue };
                self.multipliers[i] += numbers[a];
                for (b, other) in known.iter().enumerate() {
                    if let &Number::Shared(j) = other
                        && i <= j
                    {
                        self.matrix[i * n + j] += slopes[a][b];
                    }
                }
            }
        }
    }
}

impl<const N: usize> CellProblem<N> {
    /// The problem with these products `G` of `n` fluxes with each other and `b` with what the flux aims at, and this
    /// sum `s`.
    pub fn new(products: [[f64; N]; N], aims: &[f64; N], sum: f64, n: usize) -> Self {
        let mut slopes = products;
        invert(&mut slopes, n);
        // the numbers that a unit of the sum adds, but for a factor
        let unit = slopes.map(|row| row[..n].iter().sum::<f64>());
        let total: f64 = unit[..n].iter().sum();
        let mut numbers = [0.0; N];
        for a in 0..n {
            (0..n).for_each(|b| slopes[a][b] -= unit[a] * unit[b] / total);
            let of_aims: f64 = slopes[a][..n].iter().zip(aims).map(|(s, b)| s * b).sum();
            numbers[a] = unit[a] / total * sum + of_aims;
        }
        Self { slopes, numbers }
    }

    /// Holds the numbers that are given; the sum of the others is what it was as long as one of them is free.
    fn hold(&mut self, known: &[Number; N], n: usize) {
        let before = self.slopes;
        for (a, known) in known.iter().enumerate().take(n) {
            let &Number::Given(number) = known else { continue };
            let row = self.slopes[a];
            if row[a] > ZERO_PIVOT * before[a][a] {
                let multiplier = (number - self.numbers[a]) / row[a];
                for b in 0..n {
                    self.numbers[b] += row[b] * multiplier;
                    (0..n).for_each(|c| self.slopes[b][c] -= row[b] * row[c] / row[a]);
                }
            }
            self.numbers[a] = number;
            self.fix(a);
        }
        // what rounding leaves of numbers that the others determine is no slope
        for a in (0..n).filter(|&a| before[a][a] > 0.0) {
            if self.slopes[a][a] <= ZERO_PIVOT * before[a][a] {
                self.fix(a);
            }
        }
    }

    /// Takes a number from the multipliers.
    fn fix(&mut self, a: usize) {
        self.slopes[a] = [0.0; N];
        self.slopes.iter_mut().for_each(|row| row[a] = 0.0);
    }
}

impl<const N: usize> CellOfPatch<N> {
    /// The numbers with these multipliers.
    fn numbers_with(&self, multipliers: &[f64]) -> [f64; N] {
        let CellProblem { slopes, mut numbers } = self.problem;
        for (b, known) in self.known.iter().enumerate() {
            let &Number::Shared(i) = known else { continue };
            for (number, slopes) in numbers.iter_mut().zip(&slopes) {
                *number -= slopes[b] * multipliers[i];
            }
        }
        numbers
    }
}

/// Inverts the first `n` rows and columns of a symmetric positive definite matrix, in place.
fn invert<const N: usize>(a: &mut [[f64; N]; N], n: usize) {
    for k in 0..n {
        let pivot = 1.0 / a[k][k];
        let mut row = a[k];
        row[..n].iter_mut().for_each(|entry| *entry *= pivot);
        row[k] = pivot;
        for (i, other) in a.iter_mut().enumerate().take(n) {
            if i != k {
                let factor = other[k];
                other[k] = 0.0;
                (0..n).for_each(|j| other[j] -= factor * row[j]);
            }
        }
        a[k] = row;
    }
}

/// Solves with a symmetric positive semidefinite matrix, given by the upper triangle of its rows, by elimination in
/// place. Where a pivot is zero but for rounding, the unknown is zero.
pub(super) fn solve(a: &mut [f64], x: &mut [f64]) {
    let n = x.len();
    // the lower triangle is free: its first column keeps the diagonal
    (1..n).for_each(|i| a[i * n] = a[i * n + i]);
    for k in 0..n {
        let (above, below) = a.split_at_mut((k + 1) * n);
        let row = &mut above[k * n..];
        if row[k] <= ZERO_PIVOT * row[0] {
            row[k] = 0.0;
            continue;
        }
        // patches are sparse
        let end = row.iter().rposition(|entry| *entry != 0.0).map_or(n, |last| last + 1);
        for (i, lower) in (k + 1..end).zip(below.chunks_exact_mut(n)) {
            let factor = row[i] / row[k];
            if factor != 0.0 {
                x[i] -= factor * x[k];
                let entries = lower[i..end].iter_mut().zip(&row[i..end]);
                entries.for_each(|(to, from)| *to -= factor * from);
            }
        }
    }
    for (k, row) in a.chunks_exact(n.max(1)).enumerate().rev() {
        let sum: f64 = row[k + 1..].iter().zip(&x[k + 1..]).map(|(a, x)| a * x).sum();
        x[k] = if row[k] != 0.0 { (x[k] - sum) / row[k] } else { 0.0 };
    }
}
