//! The facets that carry the facet form, each with its one or two cells.

use super::Space;
use super::metric::Metrics;
use crate::facet::{FacetKind, FacetView, Side};
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbour};

/// A facet that carries the form: one between two cells, or one with Dirichlet data that the form imposes.
///
/// Of two cells the one with the lower number is *here*, the other *there*. The facet is counted with the cell here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FormFacet {
    /// The facet seen from the cell here.
    pub here: HalfFacet,
    /// The facet seen from the cell there; none on the boundary.
    pub there: Option<HalfFacet>,
}

impl FormFacet {
    /// Whether the facet lies between two cells or on the Dirichlet boundary.
    #[inline(always)]
    pub fn kind(&self) -> FacetKind {
        if self.there.is_some() { FacetKind::Interior } else { FacetKind::Dirichlet }
    }
    /// The facet seen from the other cell than the one of `own`; none on the boundary.
    #[inline(always)]
    pub fn other(&self, own: HalfFacet) -> Option<HalfFacet> {
        if own == self.here { self.there } else { Some(self.here) }
    }
}

impl<'a, const D: usize> Space<'a, D> {
    /// The facet of a half-facet if it carries the form; the cell of the half-facet is here or there.
    #[inline(always)]
    pub fn form_facet(&self, own: HalfFacet) -> Option<FormFacet> {
        match self.coupled_neighbours().across(own.0, own.1) {
            Neighbour::Cell { cell, local } => {
                let other = (cell as usize, usize::from(local));
                let (here, there) = if other.0 < own.0 { (other, own) } else { (own, other) };
                Some(FormFacet { here, there: Some(there) })
            }
            Neighbour::Boundary(BoundaryCondition::Dirichlet) if !self.pins => {
                Some(FormFacet { here: own, there: None })
            }
            Neighbour::Boundary(_) | Neighbour::Cut => None,
        }
    }
    /// The facet of a half-facet if it carries the form and is counted with the cell of the half-facet.
    #[inline(always)]
    pub fn counted_facet(&self, own: HalfFacet) -> Option<FormFacet> {
        self.form_facet(own).filter(|facet| facet.here.0 == own.0)
    }
    /// The facets that carry the form and are counted with a cell, by their numbers in it.
    #[inline(always)]
    pub fn form_facets_of(&self, cell: usize) -> impl Iterator<Item = FormFacet> {
        (0..D + 1).filter_map(move |local| self.counted_facet((cell, local)))
    }
    /// The facets that carry the form, in the order of the cells with which they are counted.
    pub fn form_facets(&self) -> impl Iterator<Item = FormFacet> {
        (0..self.mesh.n_cells()).flat_map(|cell| self.form_facets_of(cell))
    }
    /// The data of a facet and its cells that a form may see, with the metrics of all cells if they are kept.
    #[inline(always)]
    pub fn facet_view(&self, facet: FormFacet, kept: Option<&Metrics>) -> FacetView<'a, D> {
        let (measure, here) = self.side(facet.here, facet.there, kept);
        let there = facet.there.map(|there| self.side(there, Some(facet.here), kept).1);
        FacetView::new(self.mesh, facet.here, measure, here, there)
    }
    /// The measure of a facet and the cell from which it is seen.
    #[inline(always)]
    fn side(
        &self,
        half: HalfFacet,
        other: Option<HalfFacet>,
        kept: Option<&Metrics>,
    ) -> (f64, Side) {
        let of_normal = self.normal_component(half);
        let coefficient = of_normal * self.largest_coefficient(half);
        let bound_coefficient = of_normal * self.bound_coefficient(half, other);
        let metric;
        let (volume, measures) = match kept {
            Some(metrics) => metrics.measures::<D>(half.0),
            None => {
                metric = self.metric(half.0);
                (metric.volume, &metric.measures[..=D])
            }
        };
        let measure = measures[half.1];
        let height = (D as f64) * volume / measure;
        let surface = measures.iter().fold(0.0, |sum, &measure| sum + measure);
        (measure, Side { coefficient, bound_coefficient, volume, surface, height })
    }
}
