//! The contact forces of unknowns: everything that shows a force takes it from here.

use std::ops::Range;

use super::Solution;
use super::certificate::{residual, stiffness_diagonal};
use crate::algebra::{Contact, Inequality, JumpTerm, Jumps, PenalisedMatrix};
use crate::mesh::Components;
use crate::parallel::grouping::group_by_key;
use crate::parallel::vectors::{
    self, collect, concat, flags, for_each_chunk, indices, map_chunks, map_chunks_of_groups,
    positions,
};
use crate::real::{Precision, Real};

/// Forces have no digit where their errors may exceed this share of them.
const LARGEST_ERROR: f64 = 0.1;

/// Forces that are known up to this share of the load, rounding in double precision, have digits even where they
/// vanish.
const NO_LOAD: f64 = 8.0 * f64::EPSILON;

/// The forces with which active bounds hold their unknowns, the entries of `r = A u - b`.
///
/// For a [`PenalisedMatrix`] `r = K u + M^T p - c`. Jump multipliers that are computed as `p = S (M u - g)` lose `eps
/// S` to cancellation: with a large weight more than the force. Forces therefore follow from balances. Unknowns that
/// jumps subtract from one another are the *copies* of a node: at a vertex those of the cells around it, of facet means
/// those of both sides. In the sum over the copies of a node `M^T p` cancels, whatever `p` is, and copies without
/// contact have no force: the sum of `K u - c` over all copies is the force of those in contact, which share it
/// equally.
///
/// Where a jump has an unknown without a counterpart (on weakly imposed Dirichlet data, or for means over cells), where
/// copies touch different bounds or have one admissible value, and on one part of a mesh, `p` is that of the solver, or
/// `S (M u - g)` where the solver has none.
pub(crate) struct ContactForces {
    /// By unknown, positive where a lower bound pushes upward; zero without an active inequality.
    pub values: Vec<f64>,
    /// By unknown the size of the rounding error of its force.
    rounding: Vec<f64>,
}

impl ContactForces {
    /// The forces of a solution. All parts of a distributed inequality call it.
    pub fn of<T: Real>(inequality: &Inequality<T>, solution: &Solution<T>) -> Self {
        let Solution { values: u, contact, jump_multipliers, precision, .. } = solution;
        let state = |i: usize| match inequality.bounds[i].is_inequality() {
            true => contact[i],
            false => Contact::Inactive,
        };
        let is_active = |i: usize| state(i) != Contact::Inactive;
        let mut r = vec![0.0; u.len()];
        residual(inequality, u, jump_multipliers, &mut r);
        let force = |i: usize| if is_active(i) { -r[i] } else { 0.0 };
        let terms = |i: usize| squared_terms(inequality, i, u, jump_multipliers);
        let size = |i: usize| if is_active(i) { rounding(terms(i), *precision) } else { 0.0 };
        let mut forces = Self { values: collect(u.len(), force), rounding: collect(u.len(), size) };
        if let Some(nodes) = BalancedNodes::of(inequality) {
            let Self { values, rounding } = &mut forces;
            nodes.share(u, &state, values, Some((rounding, *precision)));
        }
        inequality.distribution().update(&mut forces.values);
        forces
    }

    /// Whether rounding and what the solver leaves are less than a tenth of the forces of the unknowns that `counts`,
    /// in the sum of absolute values over all parts. The solver leaves a residual that is small beside the energy of
    /// the whole problem; by the inequality of Cauchy and Schwarz the forces of unknowns at a bound, or as near to one
    /// as the limit of the certificate, may be off by it times the root of the sum of their diagonal entries.
    pub fn have_digits<T: Real>(
        &self,
        inequality: &Inequality<T>,
        solution: &Solution<T>,
        counts: impl Fn(usize) -> bool + Sync,
    ) -> bool {
        let size = |i: usize| solution.values[i].to_f64().abs();
        let mut largest = [vectors::largest(solution.values.len(), size)];
        inequality.distribution().largest(&mut largest);
        let slack = solution.precision.certificate_limit() * largest[0];
        let is_near = |i: usize| {
            let bound = &inequality.bounds[i];
            bound.distances(solution.values[i].to_f64()).iter().any(|distance| *distance <= slack)
        };
        let of_chunk = |range: Range<usize>| {
            let mut sums = [0.0; 4];
            for i in range.filter(|&i| inequality.owns(i) && counts(i)) {
                sums[3] += inequality.load[i].to_f64().abs();
                sums[0] += self.values[i].abs();
                sums[1] += self.rounding[i];
                if is_near(i) {
                    sums[2] += stiffness_diagonal(inequality, i);
                }
            }
            sums
        };
        let chunks = map_chunks(self.values.len(), of_chunk);
        let mut sums = [0, 1, 2, 3].map(|k| chunks.iter().map(|sums| sums[k]).sum::<f64>());
        inequality.distribution().sum(&mut sums);
        let [forces, rounding, diagonal, load] = sums;
        let error = rounding + solution.dual_residual * diagonal.sqrt();
        error <= LARGEST_ERROR * forces || error <= NO_LOAD * load
    }
}

/// The size of the rounding error of a sum with these squared terms, whose values are rounded.
fn rounding(squared_terms: f64, precision: Precision) -> f64 {
    0.5 * precision.epsilon() * squared_terms.sqrt()
}

/// The sum of the squares of the terms of row `i` of `A u`; of `K u` where jump multipliers are known beside `u`.
fn squared_terms<T: Real>(
    inequality: &Inequality<T>,
    i: usize,
    u: &[T],
    jump_multipliers: &[T],
) -> f64 {
    match &inequality.penalised {
        Some(penalised) if jump_multipliers.len() == penalised.n_jumps() => {
            squared_stiffness_terms(penalised, i, u)
        }
        _ => {
            let (columns, entries) = inequality.matrix.row(i);
            let product = |(&j, a): (&u32, &T)| a.to_f64() * u[j as usize].to_f64();
            columns.iter().zip(entries).map(product).map(|term| term * term).sum()
        }
    }
}

fn squared_stiffness_terms<T: Real>(penalised: &PenalisedMatrix<T>, i: usize, u: &[T]) -> f64 {
    let n = penalised.block_size();
    let (row, values) = (&penalised.blocks[i * n..][..n], &u[i / n * n..][..n]);
    row.iter().zip(values).map(|(a, u)| (a.to_f64() * u.to_f64()).powi(2)).sum()
}

/// The nodes of a penalised matrix in the sum over whose copies the jump multipliers cancel.
pub(super) struct BalancedNodes<'a, T> {
    penalised: &'a PenalisedMatrix<T>,
    load: &'a [T],
    /// By unknown one of the copies of its node, the same for all of them.
    node: Vec<u32>,
    /// By this copy whether every jump of the node has a counterpart of the same weight.
    is_balanced: Vec<bool>,
}

impl<'a, T: Real> BalancedNodes<'a, T> {
    /// The nodes; none without a penalised matrix and on one part of several, which does not have all copies.
    pub fn of(inequality: &'a Inequality<T>) -> Option<Self> {
        let penalised = inequality.penalised.as_ref()?;
        if inequality.is_in_parts() {
            return None;
        }
        let node = nodes(&penalised.jumps);
        let no_unknown = JumpTerm::<T>::NO_UNKNOWN;
        let bounds = &inequality.bounds;
        let is_loose = flags(node.len(), |set| {
            let set_node = |i: u32| set(node[i as usize] as usize);
            map_chunks(penalised.n_jumps(), |jumps| {
                for term in jumps.flat_map(|jump| penalised.terms_of(jump)) {
                    match [term.here, term.there] {
                        [i, none] | [none, i] if none == no_unknown => set_node(i),
                        _ => {}
                    }
                }
            });
            // a copy with one admissible value has a force of any sign
            map_chunks(bounds.len(), |unknowns| {
                let fixed = unknowns.filter(|&i| bounds[i].fixed_value().is_some());
                fixed.for_each(|i| set_node(i as u32));
            });
        });
        let is_balanced = collect(node.len(), |i| !is_loose[i]);
        Some(Self { penalised, load: &inequality.load, node, is_balanced })
    }

    /// Replaces the forces of active copies by equal shares in the sum of `K u - c` over all copies of their node, and
    /// the sizes of rounding errors by those of the shares, where the node is balanced and its active copies touch
    /// bounds of one side.
    pub fn share(
        &self,
        u: &[T],
        state: &(impl Fn(usize) -> Contact + Sync),
        forces: &mut [f64],
        rounding_errors: Option<(&mut Vec<f64>, Precision)>,
    ) {
        let n = self.node.len();
        let is_active = |i: usize| state(i) != Contact::Inactive;
        let is_touched = flags(n, |set| {
            map_chunks(n, |unknowns| {
                let active = unknowns.filter(|&i| is_active(i));
                active.for_each(|i| set(self.node[i] as usize));
            });
        });
        let is_shared = |i: usize| is_touched[i] && self.is_balanced[i];
        let touched = indices(n, is_shared);
        let positions = positions(n, &touched);
        let position = |i: usize| positions[self.node[i] as usize];
        let (starts, copies) = group_by_key(n, touched.len(), |i, put| match position(i) {
            u32::MAX => {}
            position => put(position, i as u32),
        });
        let shares = collect(touched.len(), |k| {
            self.share_of(&copies[starts[k] as usize..starts[k + 1] as usize], u, state)
        });
        let share_at = |i: usize| *shares.get(position(i) as usize).filter(|_| is_active(i))?;
        for_each_chunk(forces, |range, forces| {
            let shared = forces.iter_mut().zip(range);
            shared.for_each(|(force, i)| *force = share_at(i).map_or(*force, |share| share.force));
        });
        let Some((errors, precision)) = rounding_errors else { return };
        for_each_chunk(errors, |range, errors| {
            for (error, i) in errors.iter_mut().zip(range) {
                let of_share = |share: Share| rounding(share.terms, precision) / share.number;
                *error = share_at(i).map_or(*error, of_share);
            }
        });
    }

    /// The share of each active copy of a node; `None` if some touch a lower and some an upper bound.
    fn share_of(
        &self,
        copies: &[u32],
        u: &[T],
        state: &impl Fn(usize) -> Contact,
    ) -> Option<Share> {
        let number = |side: Contact| copies.iter().filter(|&&i| state(i as usize) == side).count();
        let number = match (number(Contact::Lower), number(Contact::Upper)) {
            (n, 0) | (0, n) => n as f64,
            _ => return None,
        };
        let (mut force, mut terms) = (0.0, 0.0);
        for i in copies.iter().map(|&i| i as usize) {
            let stiffness = self.penalised.stiffness(i, |j| u[j].to_f64());
            force += stiffness - self.load[i].to_f64();
            terms += squared_stiffness_terms(self.penalised, i, u);
        }
        Some(Share { number, force: force / number, terms })
    }
}

/// The share of an active copy in the balance of its node.
#[derive(Clone, Copy)]
struct Share {
    /// The number of shares.
    number: f64,
    /// The sum of `K u - c` over all copies, divided by the number.
    force: f64,
    /// The sum of the squares of all terms of the former sum.
    terms: f64,
}

/// By unknown one of the copies of its node, the same for all of them: unknowns that jumps subtract from one another
/// are copies of a node.
fn nodes<T: Real>(jumps: &Jumps<T>) -> Vec<u32> {
    let size = jumps.block_size();
    let n = jumps.n_blocks() * size;
    // the sets that jumps within each chunk of blocks make, and the pairs with one unknown in another chunk
    let of_chunk = |range: Range<usize>| {
        let mut sets = Components::new(range.len());
        let mut pairs = Vec::new();
        for block in range.start / size..range.end / size {
            let sides = jumps.sides_of(block).iter().filter(|side| side.is_here());
            for term in sides.flat_map(|side| jumps.terms_of(side.jump())) {
                if [term.here, term.there].contains(&JumpTerm::<T>::NO_UNKNOWN) {
                    continue;
                }
                let [here, there] = [term.here, term.there].map(|i| i as usize);
                match range.contains(&there) {
                    true => sets.join(here - range.start, there - range.start),
                    false => pairs.push([here, there]),
                }
            }
        }
        let smallest = range.clone().map(|i| range.start + sets.find(i - range.start));
        (smallest.map(|i| i as u32).collect::<Vec<_>>(), pairs)
    };
    let (smallest, pairs): (Vec<_>, Vec<_>) =
        map_chunks_of_groups(n, size, of_chunk).into_iter().unzip();
    let mut sets = Components::from_smallest(concat(smallest));
    pairs.into_iter().flatten().for_each(|[here, there]| sets.join(here, there));
    collect(n, |i| sets.smallest(i))
}
