//! The matrix of one cell, as a list.

use super::unknowns::CellUnknowns;
use crate::assemble::space::Space;
use crate::assemble::space::metric::CellMetric;
use crate::assemble::stiffness::{Local, zero_local};
use crate::element::MAX_BASIS;

/// The upper triangle of a cell's matrix, by rows; a power of two holds the largest.
type Triangle = [f64; TRIANGLE];
const TRIANGLE: usize = 256;
const _: () = assert!(MAX_BASIS * (MAX_BASIS + 1) / 2 <= TRIANGLE);

/// Pairs of barycentric coordinates of a tetrahedron.
const PAIRS: usize = 6;

/// Matrices of cells, one after the other.
pub(crate) trait CellMatrix {
    /// Computes that of a cell.
    fn of_cell(&mut self, cell: usize);
    /// An entry of it.
    fn entry(&self, i: usize, j: usize) -> f64;
}

/// The contributions of cells, tabulated.
pub(crate) struct CellMatrices<'s, 'a, const D: usize> {
    space: &'s Space<'a, D>,
    /// For each pair `k < l` of barycentric coordinates what their product of gradients adds.
    pairs: [Triangle; PAIRS],
    /// For entry `(i, j)`, at `N i + j`, where it is in the triangle.
    places: [u8; MAX_BASIS * MAX_BASIS],
}

impl<'s, 'a, const D: usize> CellMatrices<'s, 'a, D> {
    pub fn new(space: &'s Space<'a, D>) -> Self {
        let n = space.per_cell();
        let table = space.stiffness_table();
        let unit = |k, l| CellMetric { products: unit(k, l), volume: 0.0, measures: [0.0; 4] };
        let mut pairs = [[0.0; TRIANGLE]; PAIRS];
        let mut places = [0; MAX_BASIS * MAX_BASIS];
        for (pair, (k, l)) in pairs_of::<D>().enumerate() {
            let mut place = 0;
            for i in 0..n {
                for j in i..n {
                    pairs[pair][place] = table.entry::<D>(&unit(k, l), i, j);
                    places[i * n + j] = place as u8;
                    places[j * n + i] = place as u8;
                    place += 1;
                }
            }
        }
        Self { space, pairs, places }
    }

    /// The square by which products of gradients make the whole matrix, if they do.
    pub fn only_gradients(&self) -> Option<f64> {
        let factor = self.space.gradient_factor().filter(|_| self.space.reaction.is_none());
        factor.map(|factor| factor * factor)
    }

    /// Writes the stiffness of a cell in which the coefficient varies.
    #[inline(never)]
    fn write_varying(&self, cell: usize, out: &mut Triangle) {
        let Some((varying, values)) = self.space.varying_in(cell) else { return };
        let metric = self.space.metric(cell);
        let n = self.space.per_cell();
        let entries = (0..n).flat_map(|i| (i..n).map(move |j| (i, j)));
        for (out, (i, j)) in out.iter_mut().zip(entries) {
            *out = varying.stiffness::<D>(values, &metric, i, j);
        }
    }

    /// Writes the matrix of a cell.
    #[inline(always)]
    fn write(&self, n: usize, cell: usize, out: &mut Triangle, local: &mut Local) {
        let (volume, shape) = self.space.shape(cell, self.space.alpha(cell));
        let mut products = [0.0; PAIRS];
        for (product, (k, l)) in products.iter_mut().zip(pairs_of::<D>()) {
            *product = shape[k][l];
        }
        if self.space.varying_in(cell).is_some() {
            self.write_varying(cell, out);
        } else {
            for place in 0..n * (n + 1) / 2 {
                let mut sum = products[0] * self.pairs[0][place];
                for pair in 1..D * (D + 1) / 2 {
                    sum += products[pair] * self.pairs[pair][place];
                }
                out[place] = sum;
            }
        }
        if let Some(reaction) = &self.space.reaction {
            local[..n].iter_mut().for_each(|row| row[..n].fill(0.0));
            reaction.add(self.space.mesh, cell, volume, local);
            let mut place = 0;
            for i in 0..n {
                for j in i..n {
                    out[place] += local[i][j];
                    place += 1;
                }
            }
        }
    }
}

/// The pairs `k < l` of barycentric coordinates.
#[inline(always)]
fn pairs_of<const D: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..D).flat_map(|k| (k + 1..=D).map(move |l| (k, l)))
}

/// Matrices that are products of gradients times a square: they stay in registers.
pub(crate) struct Gradients<'c, 's, 'a, const D: usize> {
    cells: &'c CellMatrices<'s, 'a, D>,
    square: f64,
    products: [[f64; 4]; 4],
}

impl<'c, 's, 'a, const D: usize> Gradients<'c, 's, 'a, D> {
    pub fn new(cells: &'c CellMatrices<'s, 'a, D>, square: f64) -> Self {
        Self { cells, square, products: [[0.0; 4]; 4] }
    }
}

impl<const D: usize> CellMatrix for Gradients<'_, '_, '_, D> {
    #[inline(always)]
    fn of_cell(&mut self, cell: usize) {
        let space = self.cells.space;
        self.products = space.shape(cell, self.square * space.alpha(cell)).1;
    }
    #[inline(always)]
    fn entry(&self, i: usize, j: usize) -> f64 {
        self.products[i][j]
    }
}

/// Matrices of any kind.
pub(crate) struct General<'c, 's, 'a, const D: usize, const N: usize> {
    cells: &'c CellMatrices<'s, 'a, D>,
    unknowns: &'c CellUnknowns<D, N>,
    triangle: Triangle,
    /// Workspace: the reaction term of a cell.
    local: Local,
}

impl<'c, 's, 'a, const D: usize, const N: usize> General<'c, 's, 'a, D, N> {
    pub fn new(cells: &'c CellMatrices<'s, 'a, D>, unknowns: &'c CellUnknowns<D, N>) -> Self {
        Self { cells, unknowns, triangle: [0.0; TRIANGLE], local: zero_local() }
    }
}

impl<const D: usize, const N: usize> CellMatrix for General<'_, '_, '_, D, N> {
    #[inline(always)]
    fn of_cell(&mut self, cell: usize) {
        self.cells.write(self.unknowns.count(), cell, &mut self.triangle, &mut self.local);
    }
    #[inline(always)]
    fn entry(&self, i: usize, j: usize) -> f64 {
        let entry = i * self.unknowns.count() + j;
        self.triangle[self.cells.places[entry] as usize % TRIANGLE]
    }
}

/// Products of gradients of which only those of one pair are not zero.
fn unit(k: usize, l: usize) -> [[f64; 4]; 4] {
    let mut products = [[0.0; 4]; 4];
    products[k][l] = 1.0;
    products[l][k] = 1.0;
    products
}
