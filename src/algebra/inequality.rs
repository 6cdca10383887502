//! The algebraic variational inequality.

use std::borrow::Cow;
use std::sync::Arc;

use super::NO_INDEX;
use super::bound::{Bound, Contact};
use super::dirichlet_energy::DirichletEnergy;
use super::distribution::{Distribution, OnePart, sum_over_parts};
use super::free_body::{FreeBody, Sum};
use super::kink::Kink;
use super::matrix::SparseMatrix;
use super::penalised_matrix::PenalisedMatrix;
use crate::parallel::vectors::{all, collect, indices};
use crate::real::Real;

/// The initial active set of a solver, for example that of a coarser mesh or a simpler scheme.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// No initial active set.
    #[default]
    Cold,
    /// A guess of the contact state of every unknown. A state without the bound it names, and the
    /// state of an unknown beyond the end of the list, is [`Contact::Inactive`].
    Contact(Vec<Contact>),
}

/// The location of an unknown: the vertices whose barycentre is its node, and the cell that owns it
/// in a broken space.
///
/// One vertex stands for a vertex value, two for the value at the midpoint of an edge, `D` for the
/// mean over a facet, `D + 1` for the mean over a cell, `D` the dimension of space. A vertex may occur
/// more than once: two times the first and once the second end of an edge stand for the value at a
/// third of the edge. A node that is the barycentre of no four vertices has four whose barycentre is
/// near to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DofLocation {
    cell: u32,
    vertices: [u32; 4],
}

impl DofLocation {
    /// The location with one to four vertices, owned by a cell, or shared by cells (`None`).
    ///
    /// # Panics
    /// If there are more than four vertices.
    #[inline(always)]
    #[must_use]
    pub fn new(cell: Option<u32>, vertices: &[u32]) -> Self {
        let mut v = [NO_INDEX; 4];
        vertices.iter().enumerate().for_each(|(k, &vertex)| v[k] = vertex);
        Self { cell: cell.unwrap_or(NO_INDEX), vertices: v }
    }
    /// The cell that owns the unknown; `None` if cells share it.
    pub fn cell(&self) -> Option<u32> {
        (self.cell != NO_INDEX).then_some(self.cell)
    }
    /// The vertices whose barycentre is the unknown's node.
    pub fn vertices(&self) -> &[u32] {
        let n = self.vertices.iter().position(|&v| v == NO_INDEX).unwrap_or(4);
        &self.vertices[..n]
    }
}

/// The variational inequality: `u` within the bounds with `(A u - b) . (v - u) >= 0` for all `v`
/// within the bounds.
///
/// If `A` is symmetric positive definite, `u` is the minimiser of `u.A u / 2 - b.u` within the bounds.
/// Every solver and every exporter takes this type, which is independent of dimension and scheme.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Inequality<T> {
    /// The matrix `A` on all unknowns, fixed ones included; assembled beside a penalised matrix too, for Krylov methods,
    /// diagonals and parts of the inequality.
    pub matrix: SparseMatrix<T>,
    /// Whether `A` is symmetric, as the scheme declares.
    pub symmetric: bool,
    /// The load of the data, for every solver and every measure: `b`, or with a penalised matrix `c`, without what the
    /// penalty makes of Dirichlet data ([`Inequality::assembled_load`]). A change of it changes the problem.
    pub load: Vec<T>,
    /// The admissible values of each unknown.
    pub bounds: Vec<Bound<T>>,
    /// The location of each unknown; empty if unknown. Iterative solvers need it.
    pub locations: Vec<DofLocation>,
    /// Whether unknown `i` is the value at vertex `i` of a conforming linear function.
    pub conforming_linear: bool,
    /// The initial active set.
    pub start: Start,
    /// `A` as the sum `K + M^T S M` with the Dirichlet data `g`, for schemes with such a penalty: then `b` is
    /// `c + M^T S g`, and residuals of the sums have smaller rounding errors. To do without it, first replace the
    /// load by the assembled one.
    pub penalised: Option<PenalisedMatrix<T>>,
    /// What weak Dirichlet data change in the energy `u.A u`; `None` if there are none, or if
    /// `penalised` has them.
    pub dirichlet_energy: Option<DirichletEnergy>,
    /// The kernel of `A` on functions that satisfy the Dirichlet data, as vectors without common
    /// unknowns, each by its nonzero entries: the constants on components of the domain that neither
    /// Dirichlet data nor a reaction hold. Only bounds stop them. Empty if the kernel is zero or unknown.
    pub kernel: Vec<Vec<(u32, T)>>,
    /// The kinks of the convex functions of unknowns, ascending; empty if there are none. Load and bounds are those of one
    /// side of each: [`Kink`].
    pub kinks: Vec<Kink<T>>,
    /// The bodies that bounds alone hold, with the resultants of their data. If there are none, each kernel vector
    /// is a body, and its resultant the sum of the load along it.
    pub bodies: Vec<FreeBody>,
    /// Whether theory or a test says that `A`, or its symmetric part, is positive definite on all
    /// unknowns that are not fixed, but for the kernel. Reset it after a change
    /// of the matrix or of fixed unknowns by hand.
    pub is_definite: bool,
    /// The other parts, if this inequality is that of one part of a mesh. Only [`ActiveSet`] with a
    /// preconditioner for distributed matrices solves such an inequality.
    ///
    /// [`ActiveSet`]: crate::inequality::ActiveSet
    pub distribution: Option<Arc<dyn Distribution>>,
}

impl<T: Real> Inequality<T> {
    /// The inequality with a matrix, whether it is symmetric, a load and bounds; without locations,
    /// initial active set and penalised matrix.
    #[must_use]
    pub fn new(
        matrix: SparseMatrix<T>,
        symmetric: bool,
        load: Vec<T>,
        bounds: Vec<Bound<T>>,
    ) -> Self {
        let (locations, start) = (Vec::new(), Start::Cold);
        Self {
            matrix,
            symmetric,
            load,
            bounds,
            locations,
            conforming_linear: false,
            start,
            penalised: None,
            dirichlet_energy: None,
            kernel: Vec::new(),
            kinks: Vec::new(),
            bodies: Vec::new(),
            is_definite: false,
            distribution: None,
        }
    }
    /// How the unknowns are distributed.
    pub(crate) fn distribution(&self) -> &dyn Distribution {
        self.distribution.as_deref().unwrap_or(&OnePart)
    }
    /// Whether there are other parts.
    pub(crate) fn is_in_parts(&self) -> bool {
        self.distribution.is_some()
    }
    /// Whether an unknown belongs to this part.
    pub(crate) fn owns(&self, unknown: usize) -> bool {
        // in loops over unknowns, without a call where there is one part
        self.distribution.as_ref().is_none_or(|distribution| distribution.owns(unknown))
    }
    /// Number of unknowns, fixed ones included.
    pub fn size(&self) -> usize {
        self.load.len()
    }
    /// The unknowns that are not fixed, ascending: those with more than one admissible value.
    pub(crate) fn free_unknowns(&self) -> Vec<u32> {
        indices(self.bounds.len(), |i| self.bounds[i].fixed_value().is_none())
    }
    /// Whether matrix, load, bounds, penalised matrix and the locations, if there are any, have the same
    /// size, the two matrices are well formed, and the vertices of locations are below four times the number of
    /// unknowns: an array by vertices is not larger.
    /// Entries of the kernel, kinks and terms of Dirichlet data belong to unknowns, bodies to vectors of the kernel.
    pub fn is_well_formed(&self) -> bool {
        self.matrix.size() == self.size()
            && self.bounds.len() == self.size()
            && self.matrix.is_well_formed()
            && self.penalised.as_ref().is_none_or(|p| p.is_well_formed(self.size()))
            && (self.locations.is_empty() || self.locations.len() == self.size())
            && all(self.locations.len(), |i| {
                self.locations[i].vertices().iter().all(|&v| (v as usize) < 4 * self.size())
            })
            && self.kernel.iter().all(|w| self.is_kernel_vector(w))
            && self.has_sound_kinks()
            && self.bodies.iter().all(|body| body.kernel.is_none_or(|k| k < self.kernel.len()))
            && self.dirichlet_energy.as_ref().is_none_or(|e| e.is_well_formed(self.size()))
    }
    /// Whether a vector given by its nonzero entries has one, and all belong to unknowns.
    fn is_kernel_vector(&self, entries: &[(u32, T)]) -> bool {
        let is_valid = |&(i, value): &(u32, T)| {
            (i as usize) < self.size() && value.to_f64().is_finite() && value != T::lit(0.0)
        };
        !entries.is_empty() && entries.iter().all(is_valid)
    }
    /// The load `b` of the assembled matrix: with a penalised matrix `c + M^T S g`, of which `c` keeps only the digits
    /// above the rounding of `S g`.
    pub fn assembled_load(&self) -> Cow<'_, [T]> {
        let Some(penalised) = &self.penalised else { return Cow::Borrowed(&self.load) };
        // the residual of zero
        let mut load = vec![0.0; self.size()];
        penalised.residual(&self.load, |_| 0.0, &mut load);
        Cow::Owned(collect(load.len(), |i| T::lit(load[i])))
    }
    /// The residual `r = b - A u` in `f64`, of the penalised matrix where there is one.
    ///
    /// # Panics
    /// If `u` or `r` is shorter than the number of unknowns.
    pub fn residual_f64(&self, u: &[T], r: &mut [f64]) {
        self.residual_of(|i| u[i].to_f64(), r);
    }
    /// The residual `r = b - A u` in `f64` for values `u(i)` in `f64`, of the penalised matrix where
    /// there is one.
    ///
    /// # Panics
    /// If `r` is shorter than the number of unknowns.
    pub fn residual_of(&self, u: impl Fn(usize) -> f64 + Sync, r: &mut [f64]) {
        match &self.penalised {
            Some(penalised) => penalised.residual(&self.load, u, r),
            None => self.matrix.residual_of(&self.load, u, r),
        }
    }
    /// Whether every entry of matrix, load, Dirichlet data of a penalised matrix and bounds is finite. [`Bound::Free`]
    /// or a one-sided bound stands for a bound at infinity.
    pub fn is_finite(&self) -> bool {
        let finite = |x: T| x.to_f64().is_finite();
        let are_finite = |values: &[T]| all(values.len(), |k| finite(values[k]));
        are_finite(&self.matrix.values)
            && are_finite(&self.load)
            && self.penalised.as_ref().is_none_or(|penalised| are_finite(&penalised.jump_data))
            && all(self.bounds.len(), |i| match self.bounds[i] {
                Bound::Free => true,
                Bound::Fixed(x) | Bound::Lower(x) | Bound::Upper(x) => finite(x),
                Bound::Both(l, u) => finite(l) && finite(u),
            })
    }
    /// The sum of the load along the kernel vector at a position.
    pub(crate) fn load_along(&self, position: usize) -> f64 {
        let mut sum = Sum::default();
        for &(i, value) in &self.kernel[position] {
            sum.add(value.to_f64() * self.load[i as usize].to_f64());
        }
        sum.value()
    }
    /// Whether every unknown has an admissible value.
    pub fn is_feasible(&self) -> bool {
        all(self.bounds.len(), |i| !matches!(self.bounds[i], Bound::Both(l, u) if l > u))
    }
    /// The energy `u.A u / 2 - b.u`, with the functions of kinks, in `f64`; that of a penalised matrix by its jumps,
    /// because differences of products of its entries would have no digits where the penalty is large.
    ///
    /// # Panics
    /// If `u` is shorter than the number of unknowns.
    pub fn objective(&self, u: &[T]) -> f64 {
        let distribution = self.distribution();
        if let Some(penalised) = &self.penalised {
            let own = penalised.objective(&self.load, |i| u[i].to_f64(), |i| self.owns(i));
            return sum_over_parts(distribution, own - self.slopes_at_places());
        }
        let of_unknown = |i: usize| {
            let (columns, values) = self.matrix.row(i);
            let au: f64 =
                columns.iter().zip(values).map(|(&j, a)| a.to_f64() * u[j as usize].to_f64()).sum();
            u[i].to_f64() * (0.5 * au - self.load[i].to_f64())
        };
        let terms = collect(self.size(), |i| if self.owns(i) { of_unknown(i) } else { 0.0 });
        sum_over_parts(distribution, terms.iter().sum::<f64>() - self.slopes_at_places())
    }
}
