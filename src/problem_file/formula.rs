//! Numbers and expressions as data.

use std::sync::Arc;

use super::expression::Expression;
use crate::mesh::{BoxSearch, HalfFacet, Mesh, Shape, normal_of};
use crate::problem::{BoundaryField, BoundaryFlux, Datum, Field};
use crate::real::{Point, box_around};

/// Normals that differ by less are one.
const SAME_NORMAL: f64 = 1e-12;
/// A point lies in a facet up to this share of a cell, or as far as a mesh rounded to 32 bits may be off.
const IN_FACET: f64 = 1e-6;

/// A number or an expression.
#[derive(Clone, Debug)]
pub(super) enum Formula {
    Number(f64),
    Expression(Expression),
}

impl Formula {
    /// The formula as a flux: a constant, a polynomial on every facet, or a function of the point and of the normal.
    pub fn flux<const D: usize>(&self) -> BoundaryFlux<D> {
        match self.clone() {
            Self::Number(c) => BoundaryFlux::Constant(c),
            Self::Expression(expression) => {
                let degree = expression.degree(D);
                let value: BoundaryField<D> = Arc::new(move |x, n| expression.on_boundary(x, n));
                match degree {
                    Some(degree) => BoundaryFlux::Polynomial { value, degree },
                    None => BoundaryFlux::Function(value),
                }
            }
        }
    }
    /// The formula as a datum: a constant, a polynomial, or a function of the point.
    pub fn datum<const D: usize>(&self) -> Datum<D> {
        // no variable of the formula is a component of a normal
        self.datum_with(Point::zeros())
    }
    /// The formula as a datum, with this normal where it contains one.
    fn datum_with<const D: usize>(&self, normal: Point<D>) -> Datum<D> {
        match self.clone() {
            Self::Number(c) => Datum::Constant(c),
            Self::Expression(expression) => {
                let degree = expression.degree(D);
                let value: Field<D> = Arc::new(move |x| expression.on_boundary(x, &normal));
                match degree {
                    Some(degree) => Datum::Polynomial { value, degree },
                    None => Datum::Function(value),
                }
            }
        }
    }
    /// The formula as a datum of the point and of the outward normal on facets of a boundary group: of the normal of the
    /// shape of the group, else of those of the facets; where facets with different normals meet, the largest of
    /// their values. None where facets lie on both sides of the shape.
    pub fn datum_on<const D: usize>(
        &self,
        mesh: &Mesh<D>,
        facets: Vec<HalfFacet>,
        shape: Option<&Self>,
    ) -> Option<Datum<D>> {
        let expression = match self {
            Self::Expression(expression) if expression.has_variables(D) => expression.clone(),
            _ => return Some(self.datum()),
        };
        let normal = |&(cell, local): &HalfFacet| mesh.geometry(cell).normal(local);
        let normals: Vec<Point<D>> = facets.iter().map(normal).collect();
        let middle = |&(cell, local): &HalfFacet| mesh.facet_barycentre(cell, local);
        if let Some(shape) = shape {
            let (shape, length) = (shape.datum::<D>(), mesh.mesh_size());
            let shape: Shape<D> = Arc::new(move |x| shape.at(x));
            let side = |(facet, normal)| normal_of(&shape, &middle(facet), length).dot(normal);
            let mut sides = facets.iter().zip(&normals).map(side).map(f64::signum);
            let side = sides.next().unwrap_or(1.0);
            return sides.all(|other| other == side).then(|| {
                let normal = move |x: &Point<D>| normal_of(&shape, x, length) * side;
                Datum::Function(Arc::new(move |x| expression.on_boundary(x, &normal(x))))
            });
        }
        let first = normals.first().copied().unwrap_or_else(Point::zeros);
        if normals.iter().all(|other| (other - first).norm() <= SAME_NORMAL) {
            return Some(self.datum_with(first));
        }
        let size = mesh.vertices().iter().map(|x| x.amax()).fold(0.0, f64::max);
        let share = IN_FACET.max(2.0 * f64::from(f32::EPSILON) * size / mesh.shortest_edge());
        let around = |&(cell, local): &HalfFacet| {
            let [low, high] =
                box_around(mesh.facet_vertices(cell, local).map(|v| &mesh.vertices()[v as usize]));
            let near = share * mesh.cell_diameter(cell);
            [low.add_scalar(-near), high.add_scalar(near)]
        };
        let search = BoxSearch::new(middle(&facets[0]), facets.iter().map(around));
        let mesh = mesh.clone();
        Some(Datum::Function(Arc::new(move |x| {
            let contains = |k: &usize| {
                let (cell, local) = facets[*k];
                let barycentric = mesh.barycentric(cell, x);
                barycentric[local] <= share && barycentric[..=D].iter().all(|b| *b >= -share)
            };
            let of_facets = search.candidates(x).filter(contains);
            of_facets.map(|k| expression.on_boundary(x, &normals[k])).fold(f64::NAN, f64::max)
        })))
    }
}
