//! Rows of broken spaces: each cell writes its own, once, in place.
//!
//! The rows of a cell consist of dense blocks, one for the cell and one for each cell coupled to
//! it, in ascending order of cells. A facet's form is evaluated from each of its two sides for the
//! rows of that side, so no local matrix is ever stored and no two cells write to the same place.
//! Where the unknowns are facet means and a form acts on means of jumps only, a block between two cells has one entry
//! that is not zero, and only this one is stored: [`facet_means`].
//!
//! A form is bilinear in moments, so on each facet it comes down to a few numbers: the products of
//! jumps are those of the reference cell, and fluxes of one moment make a matrix of rank one.

mod facet_means;
pub(crate) mod lifted;
mod rows;
mod rows_by_cell;

use std::iter::repeat_n;

use super::facet_coefficients::FacetCoefficients;
use super::jump_products::JumpProducts;
use super::space::Space;
use super::space::metric::Metrics;
use super::space::tables::FacetTable;
use super::stiffness::StiffnessTable;
use super::trace::MAX_FLUX_MOMENTS;
use crate::algebra::SparseMatrix;
use crate::element::MAX_BASIS;
use crate::facet::FacetForm;
use crate::mesh::{Neighbour, Neighbours};
use lifted::Lifting;
use rows_by_cell::for_each_cell;

/// The cells coupled to a cell, itself included, ascending.
pub(crate) struct Coupled {
    /// At most the cell, its neighbours and the neighbours of these.
    cells: [u32; 17],
    n: usize,
}

impl Coupled {
    /// The cell with its neighbours and, where jumps are lifted, the neighbours of these.
    #[inline(always)]
    fn of<const D: usize>(neighbours: &Neighbours, cell: usize, lifted: bool) -> Self {
        let mut found = Self { cells: [u32::MAX; 17], n: 1 };
        found.cells[0] = cell as u32;
        for local in 0..=D {
            if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local) {
                if !lifted {
                    found.insert(other);
                    continue;
                }
                // around a vertex or an edge of three cells each is the neighbour of the others
                found.insert_new(other);
                for local in 0..=D {
                    if let Neighbour::Cell { cell, .. } = neighbours.across(other as usize, local) {
                        found.insert_new(cell);
                    }
                }
            }
        }
        found
    }
    /// How many they are.
    #[inline(always)]
    fn count<const D: usize>(neighbours: &Neighbours, cell: usize, lifted: bool) -> usize {
        let is_cell =
            |local: &usize| matches!(neighbours.across(cell, *local), Neighbour::Cell { .. });
        if lifted {
            Self::of::<D>(neighbours, cell, true).n
        } else {
            1 + (0..D + 1).filter(is_cell).count()
        }
    }
    #[inline(always)]
    fn insert(&mut self, other: u32) {
        let mut k = self.n;
        while k > 0 && self.cells[k - 1] > other {
            self.cells[k] = self.cells[k - 1];
            k -= 1;
        }
        self.cells[k] = other;
        self.n += 1;
    }
    fn insert_new(&mut self, other: u32) {
        if !self.cells[..self.n].contains(&other) {
            self.insert(other);
        }
    }
    /// The place of a coupled cell among them.
    #[inline(always)]
    pub fn position(&self, cell: usize) -> usize {
        let found = self.cells[..self.n].iter().position(|&c| c == cell as u32);
        found.expect("the cell behind a facet is coupled")
    }
}

/// The pattern, with values zero.
pub(crate) fn pattern<const D: usize>(
    space: &Space<'_, D>,
    form: &dyn FacetForm<D>,
) -> SparseMatrix<f64> {
    if facet_means::is_applicable(space, form) {
        return facet_means::pattern(space);
    }
    let lifted = form.is_lifted();
    let neighbours = space.coupled_neighbours();
    let n = space.per_cell();
    let lengths = |cell| repeat_n(Coupled::count::<D>(neighbours, cell, lifted) * n, n);
    rows_by_cell::pattern(space.mesh.n_cells(), n, lengths, |cell, rows| {
        let coupled = Coupled::of::<D>(neighbours, cell, lifted);
        let (first, others) = rows.split_at_mut(coupled.n * n);
        for (block, &other) in first.chunks_exact_mut(n).zip(&coupled.cells) {
            for (j, column) in block.iter_mut().enumerate() {
                *column = other * n as u32 + j as u32;
            }
        }
        for row in others.chunks_exact_mut(first.len()) {
            row.copy_from_slice(first);
        }
    })
}

/// All that the loop over cells reads.
struct Filling<'s, 'a, const D: usize> {
    space: &'s Space<'a, D>,
    neighbours: &'s Neighbours,
    metrics: &'s Metrics,
    weights: &'s FacetCoefficients,
    stiffness: StiffnessTable,
    facets: FacetTable,
    jumps: JumpProducts,
    /// By what the penalty is multiplied for each moment that has a flux.
    flux_moments: Vec<f64>,
    lifted: bool,
}

/// The values, on a known pattern.
pub(crate) fn fill<const D: usize>(
    space: &Space<'_, D>,
    form: &dyn FacetForm<D>,
    metrics: &Metrics,
    weights: &FacetCoefficients,
    matrix: &mut SparseMatrix<f64>,
) {
    if facet_means::is_applicable(space, form) {
        return facet_means::fill(space, form, metrics, weights, matrix);
    }
    let facets = space.facet_table(form.moments(space.basis_degree));
    let of_degree = |k| form.moment_weight(k);
    let has_flux = |k: &&usize| form.uses_flux() && **k < space.basis_degree;
    let filling = Filling {
        space,
        neighbours: space.coupled_neighbours(),
        metrics,
        weights,
        stiffness: space.stiffness_table(),
        jumps: JumpProducts::new::<D>(&facets, of_degree),
        flux_moments: facets.degrees.iter().filter(has_flux).map(|&k| of_degree(k)).collect(),
        facets,
        lifted: form.is_lifted(),
    };
    let SparseMatrix { row_starts, values, .. } = matrix;
    // constant conditions: loops for another dimension are not even instantiated
    match (space.per_cell(), filling.flux_moments.len()) {
        (2, 0..=1) if const { D == 1 } => filling.fill::<2, 1>(row_starts, values),
        (3, 0..=1) if const { D < 3 } => filling.fill::<3, 1>(row_starts, values),
        (4, 0..=1) if const { D == 3 } => filling.fill::<4, 1>(row_starts, values),
        (6, 0..=2) if const { D == 2 } => filling.fill::<6, 2>(row_starts, values),
        (10, 0..=3) if const { D > 1 } => filling.fill::<10, 3>(row_starts, values),
        _ => filling.fill::<MAX_BASIS, MAX_FLUX_MOMENTS>(row_starts, values),
    }
    if form.is_lifted() {
        let lifting = Lifting::new(space, form, metrics);
        for_each_cell(row_starts, space.per_cell(), values, |cell, rows| {
            let coupled = Coupled::of::<D>(filling.neighbours, cell, true);
            lifting.add(cell, &coupled, rows);
        });
    }
}
