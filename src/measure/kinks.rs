//! Functions whose zeros are kinks of the exact solution, and the one along which a cell is divided.

use std::borrow::Cow;
use std::sync::Arc;

use super::evaluation::Reference;
use crate::arrays::array_of;
use crate::assemble::cut_simplices::CutRule;
use crate::assemble::space::Space;
use crate::mesh::Mesh;
use crate::parallel::vectors::collect;
use crate::problem::{Exact, Field};
use crate::real::Point;

/// The functions of a region whose zeros are kinks of the exact solution.
pub(super) struct Kinks<const D: usize> {
    pub levels: Vec<Field<D>>,
}

/// Whether a function seems far from zero in a simplex with these corners: the values at the corners and at the
/// barycentre have one sign, and differ by less than the least of them. `at_corners` has the values at the corners
/// where they are known. This is no proof: zeros are missed of a function that varies more between these points. A
/// function that is constant at these points may jump between them.
pub(super) fn is_far<const D: usize>(
    level: &Field<D>,
    corners: &[Point<D>],
    at_corners: Option<[f64; 4]>,
) -> bool {
    let barycentre = corners.iter().sum::<Point<D>>() / corners.len() as f64;
    let at = |k: usize| at_corners.map_or_else(|| level(&corners[k]), |values| values[k]);
    let values = (0..corners.len()).map(at).chain([level(&barycentre)]);
    let limits = |(least, most): (f64, f64), value: f64| (least.min(value), most.max(value));
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), limits);
    let distance = if least > 0.0 { least } else { -most };
    0.0 < most - least && most - least < distance
}

impl<const D: usize> Kinks<D> {
    /// Whether all zeros are far from a simplex with these corners, by the values of the first function there if they
    /// are known.
    pub fn are_far(&self, corners: &[Point<D>], of_first: Option<[f64; 4]>) -> bool {
        let known = |k: usize| of_first.filter(|_| k == 0);
        self.levels.iter().enumerate().all(|(k, level)| is_far(level, corners, known(k)))
    }

    /// The function along whose zeros a cell is divided; `None` if no function is known. Of functions that have the
    /// same zeros in the cell it is the first one: in some scenes the free boundary and jumps of load and coefficient
    /// coincide. Of functions with different zeros it is the product.
    pub fn level_in(
        &self,
        rule: &CutRule,
        mesh: &Mesh<D>,
        cell: usize,
    ) -> Option<Cow<'_, Field<D>>> {
        if let [level] = &self.levels[..] {
            return Some(Cow::Borrowed(level));
        }
        let cuts = |level: &Field<D>| rule.cuts(mesh, cell, level);
        // The sign of a product changes at the zeros of each function, but not where zeros coincide. At common zeros a
        // product without a change of sign may still seem to cut a cell, since `CutRule::cuts` asks for values above
        // zero beside others; the negative product does not then.
        let have_other_zeros = |one: &Field<D>, other: &Field<D>| {
            [1.0, -1.0].into_iter().all(|sign| {
                let [one, other] = [one.clone(), other.clone()];
                let product: Field<D> = Arc::new(move |x| sign * one(x) * other(x));
                cuts(&product)
            })
        };
        let mut found: Vec<&Field<D>> = Vec::new();
        for level in self.levels.iter().filter(|level| cuts(level)) {
            if found.iter().all(|other| have_other_zeros(other, level)) {
                found.push(level);
            }
        }
        match found[..] {
            [] => None,
            [level] => Some(Cow::Borrowed(level)),
            _ => {
                let found: Vec<Field<D>> = found.into_iter().cloned().collect();
                let product: Field<D> =
                    Arc::new(move |x| found.iter().map(|level| level(x)).product());
                Some(Cow::Owned(product))
            }
        }
    }
}

impl<const D: usize> Space<'_, D> {
    /// The values at the vertices of the function whose zeros are the exact free boundary, where there is an obstacle. It
    /// is the first one of the kinks of every region.
    pub(super) fn contact_at_vertices(&self, exact: &Reference<'_, D>) -> Option<Vec<f64>> {
        let Reference::Exact(exact) = exact else { return None };
        let set = exact.contact.as_ref().filter(|_| self.problem.has_obstacle())?;
        let vertices = self.mesh.vertices();
        Some(collect(vertices.len(), |v| (set.indicator)(&vertices[v])))
    }

    /// The values of a function at the corners of a cell, from its values at all vertices.
    pub(super) fn at_corners(&self, at_vertices: &[f64], cell: usize) -> [f64; 4] {
        let vertices = self.mesh.cell(cell);
        array_of(|k| vertices.get(k).map_or(0.0, |&v| at_vertices[v as usize]))
    }

    /// The functions whose zeros are the exact free boundary, where there is an obstacle, and the levels of load,
    /// coefficient and reaction of a region: first or second derivatives of the exact solution jump there.
    pub(super) fn kinks(&self, exact: &Reference<'_, D>, region: usize) -> Kinks<D> {
        let Reference::Exact(Exact { contact, .. }) = exact else {
            return Kinks { levels: Vec::new() };
        };
        let contact = contact.as_ref().filter(|_| self.problem.has_obstacle());
        let indicator = contact.map(|set| set.indicator.clone());
        let data = [&self.data.source, &self.data.coefficient, &self.data.reaction];
        let of_data = data.map(|data| data.of(region).and_then(|f| f.level()).cloned());
        Kinks { levels: indicator.into_iter().chain(of_data.into_iter().flatten()).collect() }
    }
}
