//! Findings of single parts, merged over all parts.

use super::error::ExchangeError;
use super::exchange::{Exchange, numbers_of_all};
use crate::inequality::Violations;
use crate::measure::SquaredErrors;
use crate::mesh::Extent;

/// Findings of single parts of a mesh, as numbers that an exchange can send.
///
/// For [`Violations`], of which the certificate is made, [`SquaredErrors`] and [`Extent`].
pub trait Merge: Sized {
    /// All of it as numbers, as many in every part.
    fn to_numbers(&self) -> Vec<f64>;
    /// What these numbers are; none if they are not as many as [`Merge::to_numbers`] returns.
    fn from_numbers(numbers: &[f64]) -> Option<Self>;
    /// That of both.
    #[must_use]
    fn merge(self, other: Self) -> Self;
}

/// Merges what all parts have found, in the order of the parts, so that all have the same bits; all parts call it.
///
/// ```
/// use unilateral::processes::{in_process, merge_all};
/// use unilateral::mesh::{Extent, Layers};
/// use unilateral::prelude::*;
///
/// let square = BoxDomain::dirichlet(Point::from([0.0, 0.0]), Point::from([1.0, 1.0]));
/// let whole = Mesh::<2>::kuhn_box(&square, [8, 8])?;
/// let owners = whole.partition(3)?;
/// let layers = Layers::across_facets(1);
/// let fine = in_process(3, |number, exchange| {
///     let part = whole.part(&owners, number, layers).unwrap().refine(layers).unwrap().0;
///     // the mesh size of the whole
///     let extent = merge_all(&Extent::of(&part.mesh), exchange).unwrap();
///     part.with_extent(extent)
/// });
/// assert_eq!(fine[0].mesh.mesh_size(), whole.refine()?.0.mesh_size());
/// # Ok::<(), unilateral::mesh::MeshError>(())
/// ```
///
/// # Errors
/// Those of the exchange; [`ExchangeError::Length`] if parts merge different things.
pub fn merge_all<M: Merge>(own: &M, exchange: &dyn Exchange) -> Result<M, ExchangeError> {
    let numbers = own.to_numbers();
    let lists = numbers_of_all(exchange, &numbers)?;
    let merged = lists.iter().filter_map(|list| M::from_numbers(list)).reduce(M::merge);
    merged.ok_or(ExchangeError::lists(0, exchange.parts()))
}

/// For a type that has the methods itself, with its generic parameters.
macro_rules! merge {
    ($type:ty, $($parameters:tt)*) => {
        impl<$($parameters)*> Merge for $type {
            fn to_numbers(&self) -> Vec<f64> {
                <$type>::to_numbers(self)
            }
            fn from_numbers(numbers: &[f64]) -> Option<Self> {
                <$type>::from_numbers(numbers)
            }
            fn merge(self, other: Self) -> Self {
                <$type>::merge(self, other)
            }
        }
    };
}

merge!(Violations,);
merge!(SquaredErrors,);
merge!(Extent<D>, const D: usize);
