//! Functions of space, and data that are constants or functions.

use std::fmt;
use std::sync::Arc;

use super::{BodyConstants, DiscreteFunction};
use crate::mesh::Mesh;
use crate::real::Point;

/// A scalar function of space, shared by the clones of a problem.
pub type Field<const D: usize> = Arc<dyn Fn(&Point<D>) -> f64 + Send + Sync>;
/// A vector function of space.
pub type VectorField<const D: usize> = Arc<dyn Fn(&Point<D>) -> Point<D> + Send + Sync>;
/// A scalar function of a boundary point and the outward unit normal there.
pub type BoundaryField<const D: usize> = Arc<dyn Fn(&Point<D>, &Point<D>) -> f64 + Send + Sync>;

/// A flux through the boundary: a constant, or a function of the point and the outward unit normal.
#[derive(Clone)]
#[non_exhaustive]
pub enum BoundaryFlux<const D: usize> {
    /// A constant.
    Constant(f64),
    /// A function that is smooth on every boundary facet, integrated by quadrature.
    Function(BoundaryField<D>),
    /// A function that is on every boundary facet a polynomial of at most this degree.
    Polynomial {
        /// The values.
        value: BoundaryField<D>,
        /// The degree.
        degree: usize,
    },
}

impl<const D: usize> BoundaryFlux<D> {
    /// The degree of a polynomial, where it is known.
    pub(crate) fn degree(&self) -> Option<usize> {
        match self {
            BoundaryFlux::Constant(_) => Some(0),
            BoundaryFlux::Polynomial { degree, .. } => Some(*degree),
            BoundaryFlux::Function(_) => None,
        }
    }
    /// The flux at a point with this outward unit normal.
    pub fn at(&self, x: &Point<D>, normal: &Point<D>) -> f64 {
        match self {
            BoundaryFlux::Constant(c) => *c,
            BoundaryFlux::Function(value) | BoundaryFlux::Polynomial { value, .. } => {
                value(x, normal)
            }
        }
    }
}

impl<const D: usize> fmt::Debug for BoundaryFlux<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BoundaryFlux::Constant(c) => f.debug_tuple("Constant").field(c).finish(),
            BoundaryFlux::Function(_) => f.write_str("Function(..)"),
            BoundaryFlux::Polynomial { degree, .. } => write!(f, "Polynomial({degree})"),
        }
    }
}

/// A datum in the domain: a constant, integrated exactly and without a quadrature loop, or a function.
#[derive(Clone)]
#[non_exhaustive]
pub enum Datum<const D: usize> {
    /// A constant.
    Constant(f64),
    /// A function of space that is smooth in every cell, integrated by quadrature.
    Function(Field<D>),
    /// A function of space that is in every cell a polynomial of at most this degree. The discretisation does not
    /// depend on the degree; [error bounds](crate::error_bound) are guaranteed by it.
    Polynomial {
        /// The values.
        value: Field<D>,
        /// The degree.
        degree: usize,
    },
    /// A function of space that may jump, or have a kink, where `level` changes its sign. Cells that
    /// the zero set of `level` cuts are divided along it, see
    /// [`Problem::piecewise_source`](super::Problem::piecewise_source).
    Piecewise {
        /// The values of the datum. Points of a rule on a cell that is divided do not lie on the zero set of `level`,
        /// except by rounding.
        value: Field<D>,
        /// Positive on one side, negative on the other.
        level: Field<D>,
    },
    /// A discrete function.
    Discrete(DiscreteFunction<D>),
    /// Another datum less the constants of bodies.
    Shifted(Shifted<D>),
    /// A sum of others, made by [`Datum::plus`].
    Sum(Sum<D>),
}

/// A sum of data.
#[derive(Clone)]
pub struct Sum<const D: usize> {
    /// None of them is a sum.
    terms: Arc<[Datum<D>]>,
    /// The common level of the terms on a mesh, once there is one.
    level: Option<Field<D>>,
}

impl<const D: usize> Sum<D> {
    // not inlined where data of other kinds are read
    #[inline(never)]
    fn of(&self, value: &dyn Fn(&Datum<D>) -> f64) -> f64 {
        self.terms.iter().map(value).sum()
    }
}

impl<const D: usize> Datum<D> {
    /// A function that may jump, or have a kink, where `level` changes its sign.
    pub fn piecewise(
        value: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
        level: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Datum::Piecewise { value: Arc::new(value), level: Arc::new(level) }
    }
    /// A function that is in every cell a polynomial of at most this degree.
    pub fn polynomial(
        degree: usize,
        value: impl Fn(&Point<D>) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Datum::Polynomial { value: Arc::new(value), degree }
    }
    /// The value at a point; of a discrete function the mean over the cells that contain it.
    #[inline(always)]
    pub fn at(&self, x: &Point<D>) -> f64 {
        match self {
            Datum::Constant(c) => *c,
            Datum::Function(value)
            | Datum::Polynomial { value, .. }
            | Datum::Piecewise { value, .. } => value(x),
            Datum::Discrete(u) => u.value_at(x).unwrap_or(f64::NAN),
            Datum::Shifted(datum) => datum.at(x),
            Datum::Sum(sum) => sum.of(&|term| term.at(x)),
        }
    }
    /// The sum of two data. It may jump where one of them does.
    #[must_use]
    pub fn plus(&self, other: Self) -> Self {
        if let (Datum::Constant(a), Datum::Constant(b)) = (self, &other) {
            return Datum::Constant(a + b);
        }
        Datum::Sum(Sum { terms: [self.terms(), other.terms()].concat().into(), level: None })
    }
    /// The datum with the level of a sum on a mesh: see [`common_level`].
    pub(super) fn on_mesh(&self, mesh: &Mesh<D>) -> Self {
        match self {
            Datum::Sum(Sum { terms, .. }) => {
                let level = common_level(terms.iter().filter_map(Datum::level), mesh);
                Datum::Sum(Sum { terms: terms.clone(), level })
            }
            other => other.clone(),
        }
    }
    /// The terms of a sum; of others themselves.
    fn terms(&self) -> &[Self] {
        match self {
            Datum::Sum(sum) => &sum.terms,
            term => std::slice::from_ref(term),
        }
    }
    /// The value at a point of a cell of a mesh: of a discrete function on this mesh, or on one of which this is a
    /// uniform refinement, from the side of the cell.
    #[inline(always)]
    pub fn in_cell(&self, mesh: &Mesh<D>, cell: usize, x: &Point<D>) -> f64 {
        match self {
            Datum::Discrete(u) => u.value_in(mesh, cell, x),
            Datum::Sum(sum) => sum.of(&|term| term.in_cell(mesh, cell, x)),
            Datum::Shifted(datum) => datum.in_cell(mesh, cell, x),
            _ => self.at(x),
        }
    }
    /// As [`Datum::at`], less the constant of the body of a cell where constants were taken.
    #[inline(always)]
    pub(crate) fn of_body(&self, cell: usize, x: &Point<D>) -> f64 {
        match self {
            Datum::Shifted(datum) => datum.of_body(cell, x),
            _ => self.at(x),
        }
    }
    /// The value of a constant.
    pub(crate) fn constant(&self) -> Option<f64> {
        match self {
            Datum::Constant(c) => Some(*c),
            _ => None,
        }
    }
    /// The degree in the cells of a mesh, where it is known. `stated` is that of all functions without a degree of
    /// their own.
    pub(crate) fn degree_on(&self, mesh: &Mesh<D>, stated: Option<usize>) -> Option<usize> {
        match self {
            Datum::Constant(_) => Some(0),
            Datum::Polynomial { degree, .. } => Some(*degree),
            Datum::Function(_) | Datum::Piecewise { .. } => stated,
            Datum::Discrete(u) => u.is_polynomial_on(mesh).then(|| u.degree()),
            Datum::Shifted(datum) => datum.degree_on(mesh, stated),
            Datum::Sum(sum) => sum
                .terms
                .iter()
                .try_fold(0, |largest, term| Some(term.degree_on(mesh, stated)?.max(largest))),
        }
    }
    /// The discrete functions that it is made of.
    pub(crate) fn discrete(&self) -> Vec<&DiscreteFunction<D>> {
        match self {
            Datum::Discrete(u) => vec![u],
            Datum::Sum(sum) => sum.terms.iter().flat_map(Datum::discrete).collect(),
            Datum::Shifted(datum) => datum.parts().flat_map(Datum::discrete).collect(),
            _ => Vec::new(),
        }
    }
    /// Whether it is made of discrete functions, among others.
    pub(crate) fn is_discrete(&self) -> bool {
        match self {
            Datum::Discrete(_) => true,
            Datum::Sum(sum) => sum.terms.iter().any(Datum::is_discrete),
            Datum::Shifted(datum) => datum.parts().any(Datum::is_discrete),
            _ => false,
        }
    }
    /// A unit of rounding in values from which a constant was taken; zero in others.
    pub(crate) fn rounding(&self) -> f64 {
        match self {
            Datum::Shifted(datum) => datum.rounding(),
            _ => 0.0,
        }
    }
    /// The function whose zero set divides cells, if there is one.
    pub(crate) fn level(&self) -> Option<&Field<D>> {
        match self {
            Datum::Piecewise { level, .. } => Some(level),
            Datum::Shifted(datum) => datum.level(),
            Datum::Sum(sum) => sum.level.as_ref(),
            _ => None,
        }
    }
}

impl<const D: usize> From<f64> for Datum<D> {
    fn from(c: f64) -> Self {
        Datum::Constant(c)
    }
}

impl<const D: usize> From<DiscreteFunction<D>> for Datum<D> {
    fn from(u: DiscreteFunction<D>) -> Self {
        Datum::Discrete(u)
    }
}

impl<const D: usize, F> From<F> for Datum<D>
where
    F: Fn(&Point<D>) -> f64 + Send + Sync + 'static,
{
    fn from(f: F) -> Self {
        Datum::Function(Arc::new(f))
    }
}

impl<const D: usize> fmt::Debug for Datum<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Datum::Constant(c) => f.debug_tuple("Constant").field(c).finish(),
            Datum::Function(_) => f.write_str("Function(..)"),
            Datum::Polynomial { degree, .. } => write!(f, "Polynomial({degree})"),
            Datum::Piecewise { .. } => f.write_str("Piecewise(..)"),
            Datum::Discrete(u) => u.fmt(f),
            Datum::Shifted(_) => f.write_str("Shifted(..)"),
            Datum::Sum(sum) => f.debug_list().entries(&*sum.terms).finish(),
        }
    }
}

/// A function that changes its sign on a mesh where one of some levels does: their product, without those whose signs at
/// vertices and barycentres are those of another one, or the opposite ones. The product of two with the same zeros would
/// change its sign nowhere.
fn common_level<'l, const D: usize>(
    levels: impl Iterator<Item = &'l Field<D>>,
    mesh: &Mesh<D>,
) -> Option<Field<D>> {
    let mut different: Vec<&Field<D>> = Vec::new();
    for level in levels {
        let points = || {
            let barycentres = (0..mesh.n_cells()).map(|cell| mesh.barycentre(cell));
            mesh.vertices().iter().copied().chain(barycentres)
        };
        let has_sides_of = |other: &&Field<D>| {
            let agrees = |x: &Point<D>| (level(x) > 0.0) == (other(x) > 0.0);
            points().all(|x| agrees(&x)) || points().all(|x| !agrees(&x))
        };
        if !different.iter().any(has_sides_of) {
            different.push(level);
        }
    }
    match &different[..] {
        [] => None,
        [level] => Some((*level).clone()),
        _ => {
            let factors: Vec<Field<D>> = different.into_iter().cloned().collect();
            Some(Arc::new(move |x| factors.iter().map(|level| level(x)).product()))
        }
    }
}

/// A datum in the cells of one mesh, less the constant of the body of each cell, or less the constant times a factor. The
/// assembly makes them.
#[derive(Clone)]
pub struct Shifted<const D: usize> {
    /// Zero where absent.
    datum: Option<Box<Datum<D>>>,
    /// One where absent.
    factor: Option<Box<Datum<D>>>,
    constants: Arc<BodyConstants>,
    level: Option<Field<D>>,
}

impl<const D: usize> Shifted<D> {
    /// A datum, zero where absent, less the constants times a factor, one where absent.
    pub(super) fn datum(
        datum: Option<&Datum<D>>,
        factor: Option<&Datum<D>>,
        (constants, mesh): (&Arc<BodyConstants>, &Mesh<D>),
    ) -> Datum<D> {
        let constant = |of: Option<&Datum<D>>, absent| of.map_or(Some(absent), Datum::constant);
        let known = (constant(datum, 0.0), constant(factor, 1.0), constants.of_all());
        if let (Some(datum), Some(factor), Some(constant)) = known {
            return Datum::Constant(datum - constant * factor);
        }
        let levels = [datum, factor].into_iter().flatten().filter_map(Datum::level);
        let level = common_level(levels, mesh);
        let [datum, factor] = [datum, factor].map(|of| of.cloned().map(Box::new));
        Datum::Shifted(Self { datum, factor, constants: constants.clone(), level })
    }
    /// The value at a point of a cell of the mesh.
    fn in_cell(&self, mesh: &Mesh<D>, cell: usize, x: &Point<D>) -> f64 {
        let of = |datum: &Datum<D>| datum.in_cell(mesh, cell, x);
        let constant = self.constants.of_cell(cell);
        let value = self.datum.as_deref().map_or(0.0, of);
        value - self.factor.as_deref().map_or(constant, |factor| constant * of(factor))
    }
    /// The value at a point, less the constant of the body of a cell: see [`Datum::at`].
    fn of_body(&self, cell: usize, x: &Point<D>) -> f64 {
        self.less(self.constants.of_cell(cell), x)
    }
    /// The value at a point where all bodies have the same constant; not a number where they differ.
    fn at(&self, x: &Point<D>) -> f64 {
        self.less(self.constants.of_all().unwrap_or(f64::NAN), x)
    }
    fn less(&self, constant: f64, x: &Point<D>) -> f64 {
        let value = self.datum.as_deref().map_or(0.0, |datum| datum.at(x));
        value - self.factor.as_deref().map_or(constant, |factor| constant * factor.at(x))
    }
    fn level(&self) -> Option<&Field<D>> {
        self.level.as_ref()
    }
    /// Datum and factor, as far as they are given.
    fn parts(&self) -> impl Iterator<Item = &Datum<D>> {
        [&self.datum, &self.factor].into_iter().flatten().map(|part| &**part)
    }
    /// The larger degree of datum and factor, where both are known.
    fn degree_on(&self, mesh: &Mesh<D>, stated: Option<usize>) -> Option<usize> {
        let degree = |largest: usize, of: &Datum<D>| Some(largest.max(of.degree_on(mesh, stated)?));
        self.parts().try_fold(0, degree)
    }
    /// A unit of rounding in values that are the difference of a datum and a constant.
    fn rounding(&self) -> f64 {
        self.constants.rounding()
    }
}
