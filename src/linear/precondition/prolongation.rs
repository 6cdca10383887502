//! Prolongations from coarse to fine functions, and their transposes.

use crate::algebra::{DofLocation, NO_INDEX, RectangularMatrix, sort_by_column};
use crate::parallel::grouping::group_by_key;
use crate::parallel::vectors::{all, collect, for_each_chunk, zeros};
use crate::real::Real;

/// A prolongation `P`: a sparse matrix whose columns are the coarse basis functions in the fine basis.
///
/// The *children* of a coarse unknown are the fine unknowns with entries in its column, the *parents* of a fine
/// unknown are the coarse unknowns with entries in its row.
#[derive(Clone, Debug)]
pub struct Prolongation<T> {
    entries: Entries<T>,
    n_coarse: usize,
}

#[derive(Clone, Debug)]
enum Entries<T> {
    /// Each fine unknown is the mean of its two `parents`, which are equal if it belongs to a vertex of the coarse
    /// mesh. A coarse unknown has one child of weight one, its entry of `own`. Its children of weight 1/2 are the
    /// midpoints in `children` from its entry of `starts` up to the next entry.
    Midpoints { parents: Vec<[u32; 2]>, starts: Vec<u32>, children: Vec<u32>, own: Vec<u32> },
    /// Each fine unknown has the value at one coarse unknown, its entry of `parents`. The children of a coarse unknown
    /// are those in `children` from its entry of `starts` up to the next entry. As rows with weights of one, an entry
    /// would take three numbers in place of one, in every cycle on the finest level.
    Injection { parents: Vec<u32>, starts: Vec<u32>, children: Vec<u32> },
    /// General weights: `P` by rows (`fine`), and its transpose by rows (`coarse`).
    Weights { fine: RectangularMatrix<T>, coarse: RectangularMatrix<T> },
}

impl Prolongation<f64> {
    /// The prolongation with every weight rounded once.
    pub(super) fn in_precision<T: Real>(&self) -> Prolongation<T> {
        let entries = match &self.entries {
            Entries::Midpoints { parents, starts, children, own } => Entries::Midpoints {
                parents: parents.clone(),
                starts: starts.clone(),
                children: children.clone(),
                own: own.clone(),
            },
            Entries::Injection { parents, starts, children } => Entries::Injection {
                parents: parents.clone(),
                starts: starts.clone(),
                children: children.clone(),
            },
            Entries::Weights { fine, coarse } => {
                Entries::Weights { fine: fine.in_precision(), coarse: coarse.in_precision() }
            }
        };
        Prolongation { entries, n_coarse: self.n_coarse }
    }
}

impl<T: Real> Prolongation<T> {
    /// The prolongation of conforming linear functions to a uniform refinement: fine vertex `i` is the midpoint of the
    /// coarse vertices `parents[i]`, which are equal for a vertex of the coarse mesh. Every coarse vertex must be a
    /// fine vertex.
    ///
    /// # Panics
    /// If a parent is not less than `n_coarse`.
    #[must_use]
    pub fn midpoints(parents: Vec<[u32; 2]>, n_coarse: usize) -> Self {
        let (_, own) = group_by_key(parents.len(), n_coarse, |i, put| match parents[i] {
            [a, b] if a == b => put(a, i as u32),
            _ => {}
        });
        let (starts, children) = group_by_key(parents.len(), n_coarse, |i, put| {
            let [a, b] = parents[i];
            if a != b {
                put(a, i as u32);
                put(b, i as u32);
            }
        });
        Self { entries: Entries::Midpoints { parents, starts, children, own }, n_coarse }
    }

    /// The prolongation of conforming linear functions to a mesh that results from bisections. The first `n_coarse`
    /// vertices of this mesh are those of the coarse mesh; `parents` has for each further vertex the two preceding
    /// vertices of which it is the midpoint.
    ///
    /// # Panics
    /// If a parent does not come before its child.
    #[must_use]
    pub fn bisections(parents: impl IntoIterator<Item = [u32; 2]>, n_coarse: usize) -> Self {
        let mut fine = RectangularMatrix {
            starts: (0..=n_coarse as u32).collect(),
            columns: (0..n_coarse as u32).collect(),
            values: vec![T::lit(1.0); n_coarse],
        };
        // a vertex lies in one coarse cell: its row has at most as many entries as the cell has vertices
        let mut row: Vec<(u32, T)> = Vec::new();
        for pair in parents {
            row.clear();
            for parent in pair {
                let (columns, values) = fine.row(parent as usize);
                for (&column, &value) in columns.iter().zip(values) {
                    let half = T::lit(0.5) * value;
                    match row.iter_mut().find(|(known, _)| *known == column) {
                        Some((_, sum)) => *sum += half,
                        None => row.push((column, half)),
                    }
                }
            }
            sort_by_column(&mut row);
            fine.columns.extend(row.iter().map(|entry| entry.0));
            fine.values.extend(row.iter().map(|entry| entry.1));
            fine.starts.push(fine.columns.len() as u32);
        }
        Self::from_weights(fine, n_coarse)
    }

    /// The prolongation of conforming linear functions to the unknowns of another element, each of which
    /// is the mean of the values at the vertices of its location; `None` if a location is empty or has a
    /// vertex that is not less than `n_vertices`.
    pub(crate) fn to_element(locations: &[DofLocation], n_vertices: usize) -> Option<Self> {
        Self::injection(locations, n_vertices)
            .or_else(|| Some(Self::from_weights(rows_of_means(locations, n_vertices)?, n_vertices)))
    }

    /// [`Prolongation::to_element`] if each location is one vertex, else `None`.
    fn injection(locations: &[DofLocation], n_coarse: usize) -> Option<Self> {
        let parents = collect(locations.len(), |i| match locations[i].vertices() {
            [vertex] if (*vertex as usize) < n_coarse => *vertex,
            _ => NO_INDEX,
        });
        if parents.contains(&NO_INDEX) {
            return None;
        }
        let (starts, children) =
            group_by_key(parents.len(), n_coarse, |i, put| put(parents[i], i as u32));
        Some(Self { entries: Entries::Injection { parents, starts, children }, n_coarse })
    }

    /// The prolongation after a renumbering of the unknowns: `fine[i]` and `coarse[j]` are the new numbers of the fine
    /// unknown `i` and of the coarse unknown `j`.
    pub(crate) fn renumbered(&self, fine: &[u32], coarse: &[u32]) -> Self {
        let mut order = vec![0; fine.len()];
        (0..).zip(fine).for_each(|(old, &new): (u32, _)| order[new as usize] = old);
        let mut row: Vec<(u32, T)> = Vec::new();
        let rows = RectangularMatrix::by_rows(0..order.len(), |new, columns, values| {
            row.clear();
            let old = order[new] as usize;
            self.for_each_parent(old, |j, weight| row.push((coarse[j as usize], weight)));
            sort_by_column(&mut row);
            columns.extend(row.iter().map(|entry| entry.0));
            values.extend(row.iter().map(|entry| entry.1));
        });
        Self::from_weights(rows, self.n_coarse)
    }

    /// The prolongation with the rows `fine`.
    pub(crate) fn from_weights(fine: RectangularMatrix<T>, n_coarse: usize) -> Self {
        let coarse = fine.transpose(n_coarse);
        Self { entries: Entries::Weights { fine, coarse }, n_coarse }
    }

    /// Number of coarse unknowns.
    pub fn n_coarse(&self) -> usize {
        self.n_coarse
    }

    /// Number of fine unknowns.
    pub fn n_fine(&self) -> usize {
        match &self.entries {
            Entries::Midpoints { parents, .. } => parents.len(),
            Entries::Injection { parents, .. } => parents.len(),
            Entries::Weights { fine, .. } => fine.n_rows(),
        }
    }

    /// Sets the coarse residual to `P^T r` for the fine residual `r`, computed in the scalar of the residuals.
    pub(crate) fn restrict<S: Real>(&self, fine_residual: &[S], coarse_residual: &mut [S]) {
        let half = S::lit(0.5);
        for_each_chunk(coarse_residual, |range, out| match &self.entries {
            Entries::Midpoints { starts, children, own, .. } => {
                for (j, out) in range.zip(out) {
                    let midpoints = &children[starts[j] as usize..starts[j + 1] as usize];
                    let add = |s, &i: &u32| s + fine_residual[i as usize];
                    let sum = midpoints.iter().fold(S::lit(0.0), add);
                    *out = fine_residual[own[j] as usize] + half * sum;
                }
            }
            Entries::Injection { starts, children, .. } => {
                for (j, out) in range.zip(out) {
                    let children = &children[starts[j] as usize..starts[j + 1] as usize];
                    *out = children.iter().fold(S::lit(0.0), |s, &i| s + fine_residual[i as usize]);
                }
            }
            Entries::Weights { coarse, .. } => {
                for (j, out) in range.zip(out) {
                    *out = coarse.row_dot(j, fine_residual);
                }
            }
        });
    }

    /// Adds the entries of `P v`, for the coarse values `v`, to the fine values at which `mask` is
    /// not zero. The entries of `mask` are only compared with zero.
    pub(crate) fn add_prolongation<S: Real>(
        &self,
        coarse_values: &[S],
        mask: &[S],
        fine_values: &mut [S],
    ) {
        let (zero, half) = (S::lit(0.0), S::lit(0.5));
        for_each_chunk(fine_values, |range, out| match &self.entries {
            Entries::Midpoints { parents, .. } => {
                let rows = parents[range.clone()].iter().zip(&mask[range]);
                for ((&[a, b], &mask), x) in rows.zip(out) {
                    if mask != zero {
                        *x += half * (coarse_values[a as usize] + coarse_values[b as usize]);
                    }
                }
            }
            Entries::Injection { parents, .. } => {
                let rows = parents[range.clone()].iter().zip(&mask[range]);
                for ((&parent, &mask), x) in rows.zip(out) {
                    if mask != zero {
                        *x += coarse_values[parent as usize];
                    }
                }
            }
            Entries::Weights { fine, .. } => {
                for (i, x) in range.zip(out) {
                    if mask[i] != zero {
                        *x += fine.row_dot(i, coarse_values);
                    }
                }
            }
        });
    }

    /// The fine values `P v` of coarse values `v`.
    ///
    /// # Panics
    /// If there are fewer values than coarse unknowns.
    pub fn prolongate(&self, coarse_values: &[T]) -> Vec<T> {
        let mut fine = zeros(self.n_fine());
        let mask = vec![T::lit(1.0); self.n_fine()];
        self.add_prolongation(coarse_values, &mask, &mut fine);
        fine
    }

    /// Fixes every coarse unknown all of whose children are fixed; coarse unknowns that are fixed
    /// already stay fixed.
    pub(crate) fn fix_covered(&self, fine_fixed: &[bool], coarse_fixed: &mut [bool]) {
        for_each_chunk(coarse_fixed, |range, out| {
            for (j, fixed) in range.zip(out).filter(|(_, fixed)| !**fixed) {
                *fixed = !self.any_child(j, |i| !fine_fixed[i]);
            }
        });
    }

    /// Whether a predicate holds for any child of the coarse unknown `j`.
    pub(crate) fn any_child(&self, j: usize, predicate: impl Fn(usize) -> bool) -> bool {
        let mut any = false;
        self.for_each_child(j, |i, _| any |= predicate(i));
        any
    }

    /// Whether a predicate holds for any parent of the fine unknown `i`.
    pub(crate) fn any_parent(&self, i: usize, predicate: impl Fn(u32) -> bool) -> bool {
        let mut any = false;
        self.for_each_parent(i, |j, _| any |= predicate(j));
        any
    }

    /// Calls a function with each child of the coarse unknown `j` and its weight.
    #[inline(always)]
    pub(crate) fn for_each_child(&self, j: usize, mut call: impl FnMut(usize, T)) {
        match &self.entries {
            Entries::Midpoints { starts, children, own, .. } => {
                call(own[j] as usize, T::lit(1.0));
                for &i in &children[starts[j] as usize..starts[j + 1] as usize] {
                    call(i as usize, T::lit(0.5));
                }
            }
            Entries::Injection { starts, children, .. } => {
                for &i in &children[starts[j] as usize..starts[j + 1] as usize] {
                    call(i as usize, T::lit(1.0));
                }
            }
            Entries::Weights { coarse, .. } => {
                let (columns, weights) = coarse.row(j);
                columns.iter().zip(weights).for_each(|(&i, &w)| call(i as usize, w));
            }
        }
    }

    /// Calls a function with each parent of the fine unknown `i` and the weight of the parent. The two equal parents of
    /// a vertex of the coarse mesh are passed one by one, with weight 1/2 each.
    #[inline(always)]
    pub(crate) fn for_each_parent(&self, i: usize, mut call: impl FnMut(u32, T)) {
        match &self.entries {
            Entries::Midpoints { parents, .. } => {
                for parent in parents[i] {
                    call(parent, T::lit(0.5));
                }
            }
            Entries::Injection { parents, .. } => call(parents[i], T::lit(1.0)),
            Entries::Weights { fine, .. } => {
                let (columns, weights) = fine.row(i);
                columns.iter().zip(weights).for_each(|(&j, &w)| call(j, w));
            }
        }
    }
}

/// The rows of the prolongation of conforming linear functions to the means over the vertices of locations; `None` if a
/// location is empty or has a vertex that is not less than `n_vertices`.
pub(crate) fn rows_of_means<T: Real>(
    locations: &[DofLocation],
    n_vertices: usize,
) -> Option<RectangularMatrix<T>> {
    let is_inside = |i: usize| {
        let vertices = locations[i].vertices();
        !vertices.is_empty() && vertices.iter().all(|&v| (v as usize) < n_vertices)
    };
    let rows = |range| {
        RectangularMatrix::by_rows(range, |i, columns, values| {
            let vertices = locations[i].vertices();
            columns.extend(vertices);
            values.extend(vertices.iter().map(|_| T::lit(1.0 / vertices.len() as f64)));
        })
    };
    all(locations.len(), is_inside).then(|| RectangularMatrix::by_groups(locations.len(), &rows))
}
