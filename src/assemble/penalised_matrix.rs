//! The matrix of a form that ties cells by jumps alone, not multiplied out.

use std::convert::Infallible;
use std::ops::Range;

use super::facet_coefficients::FacetCoefficients;
use super::space::Space;
use super::space::metric::Metrics;
use super::space::tables::FacetDatum;
use super::space::tables::FacetTable;
use super::stiffness::Local;
use crate::algebra::{JumpTerm, Jumps, MeanJumps, NO_INDEX, PenalisedMatrix};
use crate::element::{MAX_BASIS, Node};
use crate::facet::FacetForm;
use crate::mesh::HalfFacet;
use crate::parallel::cells;
use crate::parallel::vectors::{concat, starts};

/// Moments up to this share of the largest are what quadrature leaves of zero, and differences up to
/// this share are none.
const ROUNDING: f64 = 1e-12;

/// Whether all there is of a form is a sum of products of jumps.
pub(crate) fn keeps_penalty_apart<const D: usize>(form: &dyn FacetForm<D>) -> bool {
    !form.uses_flux() && !form.is_lifted() && form.is_symmetric()
}

/// The terms: stiffness and reaction by cells, jumps of moments over facets with their weights, Dirichlet data.
pub(crate) fn penalised_matrix<const D: usize>(
    space: &Space<'_, D>,
    form: &dyn FacetForm<D>,
    (metrics, weights): (&Metrics, &FacetCoefficients),
    dirichlet: &[FacetDatum],
) -> PenalisedMatrix<f64> {
    let table = space.facet_table(form.moments(space.basis_degree));
    let templates = templates(D, &space.nodes, &table);
    let of_degree: Vec<f64> = table.degrees.iter().map(|&k| form.moment_weight(k)).collect();
    let n_cells = space.mesh.n_cells();
    let block_size = space.per_cell();
    let has_sides = has_mean_jumps(space, &table);
    let of_cells = |cells: Range<usize>| {
        let first = dirichlet.partition_point(|datum| datum.facet.0 < cells.start);
        let mut dirichlet = dirichlet[first..].iter().peekable();
        let mut jumps = JumpLists::default();
        for facet in cells.flat_map(|cell| space.form_facets_of(cell)) {
            let (cell, local) = facet.here;
            // D + 1: no cell across
            let (other, there) = facet.there.unwrap_or((cell, D + 1));
            let template = &templates[local][there];
            match dirichlet.next_if(|datum| datum.facet == facet.here) {
                Some(datum) => jumps.data.extend(&datum.moments),
                None => jumps.data.extend(of_degree.iter().map(|_| 0.0)),
            }
            let weight = weights.at::<D>(facet.here, true, facet.kind());
            let measure = metrics.measure::<D>(facet.here);
            for (moment, &factor) in template.iter().zip(&of_degree) {
                jumps.terms.extend(moment.iter().map(|t| t.between(cell, other, block_size)));
                jumps.ends.push(jumps.terms.len() as u32);
                let jump_jump = weight.coefficients.jump_jump.at(weight.penalty * factor);
                jumps.weights.push(measure * jump_jump);
            }
            if has_sides {
                let side = |(cell, local): HalfFacet| (cell * (D + 1) + local) as u32;
                jumps.sides.push([side(facet.here), facet.there.map_or(NO_INDEX, side)]);
            }
        }
        jumps
    };
    let mut lists = cells::map(n_cells, &of_cells);
    let starts = starts(&lists.iter().map(|list| &list.ends[..]).collect::<Vec<_>>());
    let terms = JumpLists::all(&mut lists, |list| &mut list.terms);
    let jumps = Jumps::new((n_cells, block_size), starts, terms)
        .expect("each side of a facet has the unknowns of one cell");
    let are_means = space.nodes[0] != Node::vertex(0);
    let sides = JumpLists::all(&mut lists, |list| &mut list.sides);
    PenalisedMatrix {
        blocks: blocks(space, metrics),
        jumps,
        weights: JumpLists::all(&mut lists, |list| &mut list.weights),
        jump_data: JumpLists::all(&mut lists, |list| &mut list.data),
        mean_jumps: has_sides.then_some(MeanJumps { are_means, sides }),
    }
}

/// The jumps that are counted with some cells.
#[derive(Default)]
struct JumpLists {
    /// Where the terms of each jump end.
    ends: Vec<u32>,
    terms: Vec<JumpTerm<f64>>,
    weights: Vec<f64>,
    data: Vec<f64>,
    /// See [`MeanJumps::sides`].
    sides: Vec<[u32; 2]>,
}

impl JumpLists {
    /// One kind of entry of all lists, one list after the other.
    fn all<V: Copy + Default + Send + Sync>(
        lists: &mut [Self],
        of: fn(&mut Self) -> &mut Vec<V>,
    ) -> Vec<V> {
        concat(lists.iter_mut().map(|list| std::mem::take(of(list))).collect::<Vec<_>>())
    }
}

/// Whether the functions are linear with their values at vertices or their means over facets as unknowns, and the form
/// acts on means of jumps alone.
fn has_mean_jumps<const D: usize>(space: &Space<'_, D>, table: &FacetTable) -> bool {
    let is_basis_of = |node: fn(usize) -> Node| space.nodes.iter().cloned().eq((0..=D).map(node));
    let is_linear = is_basis_of(Node::facet_mean) || is_basis_of(Node::vertex);
    D > 1 && space.basis_degree == 1 && table.degrees.len() == 1 && is_linear
}

/// Stiffness and reaction of all cells.
fn blocks<const D: usize>(space: &Space<'_, D>, metrics: &Metrics) -> Vec<f64> {
    let n = space.per_cell();
    let table = space.stiffness_table();
    let mut blocks = vec![0.0; n * n * space.mesh.n_cells()];
    let fill = |cells: Range<usize>, chunk: &mut [f64]| {
        for (cell, out) in cells.zip(chunk.chunks_exact_mut(n * n)) {
            let metric = metrics.at::<D>(cell);
            let mut matrix: Local = space.stiffness(&table, cell, &metric.products);
            space.add_reaction(cell, metric.volume, &mut matrix);
            for (row, entries) in out.chunks_exact_mut(n).zip(&matrix) {
                row.copy_from_slice(&entries[..n]);
            }
        }
        Ok::<(), Infallible>(())
    };
    let Ok(()) = cells::for_each(space.mesh.n_cells(), &|c| c * n * n, &mut blocks, &fill);
    blocks
}

/// A term by the numbers of unknowns in their cells.
struct LocalTerm {
    here: Option<usize>,
    there: Option<usize>,
    weight: f64,
}

impl LocalTerm {
    fn between(&self, cell: usize, other: usize, n: usize) -> JumpTerm<f64> {
        let unknown = |cell: usize, i: Option<usize>| {
            i.map_or(JumpTerm::<f64>::NO_UNKNOWN, |i| (cell * n + i) as u32)
        };
        JumpTerm {
            here: unknown(cell, self.here),
            there: unknown(other, self.there),
            weight: self.weight,
        }
    }
}

/// The terms of each moment, `[here][there]`, of a facet with the number `here` in its cell and `there` in the cell across;
/// `there` is `dimension + 1` if there is no cell across.
fn templates(
    dimension: usize,
    nodes: &[Node],
    table: &FacetTable,
) -> Vec<Vec<Vec<Vec<LocalTerm>>>> {
    let facets = dimension + 1;
    let side = |local: usize, k: usize| (local, &table.on(local)[k].values);
    let terms = |here: usize, there: usize| {
        let other = |k: usize| (there < facets).then(|| side(there, k));
        let of_moment = |k: usize| moment(dimension, nodes, side(here, k), other(k));
        (0..table.degrees.len()).map(of_moment).collect()
    };
    (0..facets).map(|here| (0..=facets).map(|there| terms(here, there)).collect()).collect()
}

/// A facet of a cell and the moments of the cell's functions on it.
type SideValues<'t> = (usize, &'t [f64; MAX_BASIS]);

/// The terms of one moment: unknowns at the same node make one, if they weigh the same.
fn moment(
    dimension: usize,
    nodes: &[Node],
    (facet, here): SideValues<'_>,
    there: Option<SideValues<'_>>,
) -> Vec<LocalTerm> {
    let largest = here.iter().map(|v| v.abs()).fold(0.0, f64::max);
    let is_zero = |v: f64| v.abs() <= ROUNDING * largest;
    let mut terms = Vec::new();
    let mut is_paired = [false; MAX_BASIS];
    for (i, node) in nodes.iter().enumerate().filter(|(i, _)| !is_zero(here[*i])) {
        let partner = there.and_then(|(other, values)| {
            let node = node.across(dimension, facet, other)?;
            let j = nodes.iter().position(|n| *n == node)?;
            is_zero(values[j] - here[i]).then_some(j)
        });
        if let Some(j) = partner {
            is_paired[j] = true;
        }
        terms.push(LocalTerm { here: Some(i), there: partner, weight: here[i] });
    }
    if let Some((_, values)) = there {
        let left = (0..nodes.len()).filter(|&j| !is_paired[j] && !is_zero(values[j]));
        terms.extend(left.map(|j| LocalTerm { here: None, there: Some(j), weight: values[j] }));
    }
    terms
}
