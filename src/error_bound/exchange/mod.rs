//! Multipliers exchanged for flux between cells in contact.
//!
//! Where an obstacle binds the unknowns of two neighbouring cells, the multipliers of the two may carry a share of the
//! flux through their facet: the sum of both is determined by the discrete equations, its division is not, and
//! over-penalties have no flux where jumps vanish. A number `e` added to the flux from `K` to `K'`, taken from
//! the multiplier of `K` and given to that of `K'`, keeps the balance of both cells. The square of the bound
//! is a quadratic polynomial in `e`,
//!
//! ```text
//! |alpha^-1/2 (alpha grad v - q)|^2 over K and K' + 2 (|mu|, distance of v from the obstacle) over K and K'
//! ```
//!
//! Facet by facet the least value is taken, among those numbers that keep the signs of both multipliers. Through a
//! Dirichlet facet the flux is free, and `K` is alone. Cells beside those in contact count, too: their multipliers
//! may grow, if the distance costs less than the mismatch. A facet is visited again as long as visits of its cells make
//! the square smaller by more than a negligible number.

mod cells_of_quadratics;
mod forces;
mod linears;
mod quadratics;

use crate::assemble::space::Space;
use crate::measure::Counts;
use crate::memory::in_large_pages;
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbour, Neighbours};
use crate::parallel::vectors::indices;

/// Multipliers below this share of the largest one are rounding.
const ROUNDING: f64 = 1e-10;

/// A step that makes the square of the bound smaller by less than this share of its mean over cells changes nothing for
/// other steps.
const NEGLIGIBLE: f64 = 1e-3;

/// A facet of a cell of an exchange: the number of the cell among these, and that of the facet in it.
#[derive(Clone, Copy)]
struct FacetOfCell {
    cell: u32,
    local: u8,
}

impl FacetOfCell {
    fn half(self) -> HalfFacet {
        (self.cell as usize, self.local.into())
    }
}

/// A step of an exchange. Steps are as many as facets: they are small.
#[derive(Clone, Copy)]
enum ExchangeStep {
    /// Between two cells, through their facet.
    Between([FacetOfCell; 2]),
    /// Through a Dirichlet facet of a cell.
    WithDirichlet(FacetOfCell),
    /// Inside a cell, after its facets.
    Inside(u32),
}

impl ExchangeStep {
    /// The cells of the step, twice the same one where it has one.
    fn cells(self) -> [usize; 2] {
        match self {
            Self::Between(at) => at.map(|facet| facet.cell as usize),
            Self::WithDirichlet(FacetOfCell { cell, .. }) | Self::Inside(cell) => {
                [cell as usize; 2]
            }
        }
    }
}

/// Visits the steps of an exchange in sweeps; after the first one those only one of whose cells has changed since the
/// sweep before began. A visit returns by how much the square of the bound falls. The square of the bound is that of all
/// cells of the exchange at the beginning.
fn visit_steps(
    steps: &[ExchangeStep],
    (n_cells, square): (usize, f64),
    n_sweeps: usize,
    mut visit: impl FnMut(ExchangeStep) -> f64,
) {
    let negligible = NEGLIGIBLE * square / n_cells as f64;
    // sweeps count from one
    let mut last_change = vec![0; n_cells];
    for sweep in 1..=n_sweeps {
        for step in steps {
            let cells = step.cells();
            let may_change = cells.iter().any(|&k| last_change[k] + 1 >= sweep);
            if may_change && visit(*step) > negligible {
                cells.iter().for_each(|&k| last_change[k] = sweep);
            }
        }
    }
}

/// By how much a quadratic polynomial that vanishes at zero falls there, from half of its derivative at zero and half of
/// its second derivative.
fn decrease([slope, curvature]: [f64; 2], at: f64) -> f64 {
    -(2.0 * slope + curvature * at) * at
}

impl<const D: usize> Space<'_, D> {
    /// The cells of an exchange, those with a multiplier and their neighbours, as far as these count, and its steps, cell
    /// by cell; with those inside cells if asked for.
    fn cells_of_exchange(
        &self,
        presses: &(dyn Fn(usize) -> bool + Sync),
        (neighbours, counts): (&Neighbours, Counts<'_>),
        has_inner_steps: bool,
    ) -> (Vec<usize>, Vec<ExchangeStep>) {
        let n_cells = self.mesh.n_cells();
        let mut places = vec![u32::MAX; n_cells];
        for cell in indices(n_cells, presses) {
            let cell = cell as usize;
            places[cell] = 0;
            for local in 0..=D {
                if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local)
                    && counts(other as usize)
                {
                    places[other as usize] = 0;
                }
            }
        }
        let numbers = indices(n_cells, |cell| places[cell] == 0);
        let numbers: Vec<usize> = numbers.into_iter().map(|cell| cell as usize).collect();
        numbers.iter().enumerate().for_each(|(place, &cell)| places[cell] = place as u32);
        // about half a facet for each of a cell, and one step inside
        let mut steps = in_large_pages(Vec::with_capacity(numbers.len() * (D + 3) / 2));
        for (here, &cell) in numbers.iter().enumerate() {
            let here = here as u32;
            for local in 0..=D {
                let facet = FacetOfCell { cell: here, local: local as u8 };
                match neighbours.across(cell, local) {
                    Neighbour::Cell { cell: other, local } => {
                        let there = places[other as usize];
                        if other as usize > cell && there != u32::MAX {
                            steps.push(ExchangeStep::Between([
                                facet,
                                FacetOfCell { cell: there, local },
                            ]));
                        }
                    }
                    Neighbour::Boundary(BoundaryCondition::Dirichlet) => {
                        steps.push(ExchangeStep::WithDirichlet(facet));
                    }
                    Neighbour::Boundary(_) | Neighbour::Cut => {}
                }
            }
            if has_inner_steps {
                steps.push(ExchangeStep::Inside(here));
            }
        }
        (numbers, steps)
    }
}
