//! The algebraic variational inequality.

use super::{PenalisedMatrix, SparseMatrix};
use crate::real::Real;

/// What an unknown may be. Absent bounds are absent: there is no large number that means none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound<T> {
    /// Any value.
    Free,
    /// This value (a Dirichlet datum).
    Fixed(T),
    /// At least this value.
    Lower(T),
    /// At most this value.
    Upper(T),
    /// Between the two, lower first.
    Both(T, T),
}

impl<T: Real> Bound<T> {
    /// The bound from below, if there is one.
    pub fn lower(&self) -> Option<T> {
        match *self {
            Bound::Lower(l) | Bound::Both(l, _) => Some(l),
            _ => None,
        }
    }
    /// The bound from above, if there is one.
    pub fn upper(&self) -> Option<T> {
        match *self {
            Bound::Upper(u) | Bound::Both(_, u) => Some(u),
            _ => None,
        }
    }
    /// The only value left: a Dirichlet datum, or two bounds that coincide.
    pub fn only_value(&self) -> Option<T> {
        match *self {
            Bound::Fixed(v) => Some(v),
            Bound::Both(l, u) if l == u => Some(l),
            _ => None,
        }
    }
    /// The admissible value nearest to `x`.
    pub fn nearest(&self, x: T) -> T {
        match *self {
            Bound::Free => x,
            Bound::Fixed(v) => v,
            Bound::Lower(l) => {
                if x < l {
                    l
                } else {
                    x
                }
            }
            Bound::Upper(u) => {
                if x > u {
                    u
                } else {
                    x
                }
            }
            Bound::Both(l, u) => {
                if x < l {
                    l
                } else if x > u {
                    u
                } else {
                    x
                }
            }
        }
    }
    /// Whether an inequality, not an equation, binds the unknown.
    pub fn is_inequality(&self) -> bool {
        matches!(self, Bound::Lower(_) | Bound::Upper(_) | Bound::Both(..))
    }
}

/// Which bound an unknown rests on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Contact {
    /// None: inactive.
    #[default]
    Inactive,
    /// The lower bound is active.
    Lower,
    /// The upper bound is active.
    Upper,
}

/// What a solver starts from: an active set, best of a coarser level or a simpler scheme.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// Nothing known.
    #[default]
    Cold,
    /// A guess of the contact state of every unknown. States that a bound does not have, and
    /// unknowns beyond the end, count as open.
    Contact(Vec<Contact>),
}

/// Where an unknown lives: the vertices whose barycentre is its node, and the cell that owns it
/// where cells do not share it.
///
/// One vertex: a vertex value. Two: the value at the midpoint of an edge. `D` vertices: the mean over
/// a facet. `D + 1`: the mean over the cell. In a dimension in which two of these coincide, so do the
/// nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Support {
    cell: u32,
    vertices: [u32; 4],
}

impl Support {
    const NONE: u32 = u32::MAX;

    /// A place at one to four vertices, owned by a cell or shared.
    ///
    /// # Panics
    /// If there are more than four.
    #[inline(always)]
    pub fn new(cell: Option<u32>, vertices: &[u32]) -> Self {
        let mut v = [Self::NONE; 4];
        vertices.iter().enumerate().for_each(|(k, &vertex)| v[k] = vertex);
        Self { cell: cell.unwrap_or(Self::NONE), vertices: v }
    }
    /// The cell that owns the unknown, `None` if cells share it.
    pub fn cell(&self) -> Option<u32> {
        (self.cell != Self::NONE).then_some(self.cell)
    }
    /// The vertices whose barycentre is the unknown's node.
    pub fn vertices(&self) -> &[u32] {
        let n = self.vertices.iter().position(|&v| v == Self::NONE).unwrap_or(4);
        &self.vertices[..n]
    }
}

/// The mean of points.
pub(crate) fn barycentre(points: impl Iterator<Item = [f32; 3]>) -> [f32; 3] {
    let (mut sum, mut n) = ([0.0; 3], 0.0);
    for point in points {
        sum.iter_mut().zip(point).for_each(|(sum, x)| *sum += x);
        n += 1.0;
    }
    sum.map(|x| x / n)
}

/// Find `u` within the bounds with `(A u - b) . (v - u) >= 0` for all `v` within the bounds.
///
/// If `A` is symmetric positive definite this is the minimum of `u.A u / 2 - b.u` over the bounds.
/// This is the one value every solver and exporter takes; it knows neither dimension nor scheme.
#[derive(Clone, Debug)]
pub struct Inequality<T> {
    /// The matrix on all unknowns, Dirichlet ones included.
    pub matrix: SparseMatrix<T>,
    /// Whether the form is symmetric, as its scheme declares.
    pub symmetric: bool,
    /// The load.
    pub load: Vec<T>,
    /// What each unknown may be.
    pub bounds: Vec<Bound<T>>,
    /// Where each unknown lives.
    pub supports: Vec<Support>,
    /// Where each vertex of the mesh is, missing coordinates zero; empty if that is not known. Direct
    /// solvers derive an order of elimination from it, and nothing else.
    pub points: Vec<[f32; 3]>,
    /// What a solver starts from.
    pub start: Start,
    /// Matrix and load once more, not multiplied out, where that is more exact.
    pub factored: Option<PenalisedMatrix<T>>,
}

impl<T: Real> Inequality<T> {
    /// The same inequality with another start.
    #[must_use]
    pub fn with_start(mut self, start: Start) -> Self {
        self.start = start;
        self
    }
    /// Number of unknowns, Dirichlet ones included.
    pub fn size(&self) -> usize {
        self.load.len()
    }
    /// The unknowns that have more than one admissible value, ascending.
    pub(crate) fn not_given(&self) -> Vec<u32> {
        let is_open = |&i: &u32| self.bounds[i as usize].only_value().is_none();
        (0..self.bounds.len() as u32).filter(is_open).collect()
    }
    /// Whether matrix, load and bounds belong together: equal sizes, a matrix as its type
    /// promises it. Places and points are not looked at; no solver needs them.
    pub fn is_well_formed(&self) -> bool {
        self.matrix.size() == self.size()
            && self.bounds.len() == self.size()
            && self.matrix.is_well_formed()
            && self.factored.as_ref().is_none_or(|f| f.is_well_formed(self.size()))
    }
    /// The point of each unknown, the barycentre of the vertices of its place; `None` if some are not
    /// known.
    pub(crate) fn points_of_unknowns(&self) -> Option<Vec<[f32; 3]>> {
        let point = |place: &Support| {
            let known = place.vertices().iter().filter_map(|&v| self.points.get(v as usize));
            (known.clone().count() == place.vertices().len()).then(|| barycentre(known.copied()))
        };
        let is_known = self.supports.len() == self.size() && !self.points.is_empty();
        is_known.then(|| self.supports.iter().map(point).collect()).flatten()
    }
    /// `r = b - A u` in `f64`, of the matrix as exact as it is known.
    ///
    /// # Panics
    /// If `u` or `r` is shorter than the number of unknowns.
    pub fn residual_f64(&self, u: &[T], r: &mut [f64]) {
        match &self.factored {
            Some(factored) => factored.residual(|i| u[i].to_f64(), r),
            None => self.matrix.residual_f64(&self.load, u, r),
        }
    }
    /// The same of unknowns that are not stored in the scalar.
    ///
    /// # Panics
    /// If `r` is shorter than the number of unknowns.
    pub fn residual_of(&self, u: &(dyn Fn(usize) -> f64 + Sync), r: &mut [f64]) {
        match &self.factored {
            Some(factored) => factored.residual(u, r),
            None => self.matrix.residual_of(&self.load, u, r),
        }
    }
    /// Whether every number is finite. A bound at infinity is not: leave it out instead.
    pub fn is_finite(&self) -> bool {
        let finite = |x: T| x.to_f64().is_finite();
        self.matrix.values.iter().chain(&self.load).all(|&x| finite(x))
            && self.bounds.iter().all(|bound| match *bound {
                Bound::Free => true,
                Bound::Fixed(x) | Bound::Lower(x) | Bound::Upper(x) => finite(x),
                Bound::Both(l, u) => finite(l) && finite(u),
            })
    }
    /// Whether some value is admissible for every unknown.
    pub fn is_feasible(&self) -> bool {
        self.bounds.iter().all(|bound| !matches!(*bound, Bound::Both(l, u) if l > u))
    }
    /// `u.A u / 2 - b.u`, in `f64`.
    ///
    /// # Panics
    /// If `u` is shorter than the number of unknowns.
    pub fn objective(&self, u: &[T]) -> f64 {
        (0..self.size())
            .map(|i| {
                let (columns, values) = self.matrix.row(i);
                let au: f64 = columns
                    .iter()
                    .zip(values)
                    .map(|(&j, a)| a.to_f64() * u[j as usize].to_f64())
                    .sum();
                u[i].to_f64() * (0.5 * au - self.load[i].to_f64())
            })
            .sum()
    }
}
