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
//! the square smaller by more than a negligible number. Facets within a chunk of cells are visited on one thread, chunks in
//! parallel, then the facets between chunks: the order depends on the number of cells alone.

mod cells_of_quadratics;
mod forces;
mod linears;
mod quadratics;

use crate::algebra::NO_INDEX;
use crate::assemble::space::Space;
use crate::measure::Counts;
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbour, Neighbours};
use crate::parallel::vectors::{
    chunk_length, flags, for_each_chunk_of_two, indices, map_chunks, positions,
};

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
    /// The step with its cells counted from the cell with the number `first`.
    fn from(self, first: usize) -> Self {
        let counted =
            |FacetOfCell { cell, local }| FacetOfCell { cell: cell - first as u32, local };
        match self {
            Self::Between(at) => Self::Between(at.map(counted)),
            Self::WithDirichlet(facet) => Self::WithDirichlet(counted(facet)),
            Self::Inside(cell) => Self::Inside(cell - first as u32),
        }
    }

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

/// The steps of an exchange, by the chunks of its cells ([`map_chunks`]).
struct ExchangeSteps {
    /// For each chunk the steps all of whose cells belong to the chunk. Cells of these steps are counted from the first
    /// cell of the chunk.
    within: Vec<Vec<ExchangeStep>>,
    /// The steps between cells of two chunks: few where neighbours have near numbers.
    between: Vec<ExchangeStep>,
}

impl ExchangeSteps {
    /// Visits each step at most `sweeps` times; `square` is the square of the bound over all cells before the first
    /// visit. `visit` receives consecutive cells, the number of the first one, and a step whose cells are counted from
    /// that one; it returns by how much the square of the bound falls.
    fn visit<C: Send>(
        &self,
        sweeps: u8,
        cells: &mut [C],
        square: f64,
        visit: impl Fn(&mut [C], usize, ExchangeStep) -> f64 + Sync,
    ) {
        let negligible = NEGLIGIBLE * square / cells.len() as f64;
        let length = chunk_length(cells.len(), 1);
        // the sweep in which each cell last changed
        let mut last_change = vec![0; cells.len()];
        for sweep in 1..=sweeps {
            let at = (sweep, negligible);
            for_each_chunk_of_two(cells, &mut last_change, 1, |range, cells, last_change| {
                let steps = &self.within[range.start / length];
                visit_once(steps, at, last_change, |step| visit(cells, range.start, step));
            });
            visit_once(&self.between, at, &mut last_change, |step| visit(cells, 0, step));
        }
    }
}

/// Visits steps once, those one of whose cells has changed since the sweep before began. Cells count as changed if the
/// square of the bound falls by more than `negligible`. Sweeps count from one.
fn visit_once(
    steps: &[ExchangeStep],
    (sweep, negligible): (u8, f64),
    last_change: &mut [u8],
    mut visit: impl FnMut(ExchangeStep) -> f64,
) {
    for &step in steps {
        let may_change = step.cells().iter().any(|&k| last_change[k] + 1 >= sweep);
        if may_change && visit(step) > negligible {
            step.cells().iter().for_each(|&k| last_change[k] = sweep);
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
    ) -> (Vec<u32>, ExchangeSteps) {
        let n_cells = self.mesh.n_cells();
        let is_in_exchange = flags(n_cells, |set| {
            map_chunks(n_cells, |range| {
                for cell in range.filter(|&cell| presses(cell)) {
                    set(cell);
                    for local in 0..=D {
                        if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local)
                            && counts(other as usize)
                        {
                            set(other as usize);
                        }
                    }
                }
            });
        });
        let numbers = indices(n_cells, |cell| is_in_exchange[cell]);
        let places = positions(n_cells, &numbers);
        let steps_of = |here: usize, add: &mut dyn FnMut(ExchangeStep)| {
            let cell = numbers[here] as usize;
            for local in 0..=D {
                let facet = FacetOfCell { cell: here as u32, local: local as u8 };
                match neighbours.across(cell, local) {
                    Neighbour::Cell { cell: other, local } => {
                        let there = places[other as usize];
                        if other as usize > cell && there != NO_INDEX {
                            let facet_there = FacetOfCell { cell: there, local };
                            add(ExchangeStep::Between([facet, facet_there]));
                        }
                    }
                    Neighbour::Boundary(BoundaryCondition::Dirichlet) => {
                        add(ExchangeStep::WithDirichlet(facet));
                    }
                    Neighbour::Boundary(_) | Neighbour::Cut => {}
                }
            }
            if has_inner_steps {
                add(ExchangeStep::Inside(here as u32));
            }
        };
        let of_chunks = map_chunks(numbers.len(), |range| {
            // about half a facet for each of a cell, and one step inside
            let capacity = range.len() * (D + 3) / 2;
            let (mut within, mut between) = (Vec::with_capacity(capacity), Vec::new());
            for here in range.clone() {
                steps_of(here, &mut |step| match step.cells().iter().all(|k| range.contains(k)) {
                    true => within.push(step.from(range.start)),
                    false => between.push(step),
                });
            }
            (within, between)
        });
        let (within, between): (Vec<_>, Vec<_>) = of_chunks.into_iter().unzip();
        (numbers, ExchangeSteps { within, between: between.concat() })
    }
}
