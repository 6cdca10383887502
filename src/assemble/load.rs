//! The load: source, Neumann data, weak Dirichlet data. What is absent costs nothing.

use std::ops::Range;

use super::local::{CellSide, FacetGeometry, traces};
use super::tables::{BasisAt, CellTable, FacetTable};
use super::{Discretisation, count, data, parallel};
use crate::element::ReferenceElement;
use crate::error::Error;
use crate::facet::{FacetForm, Sampling, Trace};
use crate::mesh::{BoundaryFacet, BoundaryPart, CellGeometry};
use crate::problem::{Datum, Field};
use crate::quadrature::{Rule, insert};
use crate::real::{Point, Real, point_f64};
use crate::scheme::{DirichletBy, Scheme};

impl<T: Real, const D: usize, S: Scheme<T, D>> Discretisation<'_, T, D, S> {
    /// The load of all unknowns.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn load(&self) -> Result<Vec<T>, Error> {
        let by_cell = self.load_by_cell()?;
        if Self::BROKEN && !by_cell.is_empty() {
            return Ok(by_cell);
        }
        let mut load = vec![T::lit(0.0); self.unknowns()];
        for (k, &value) in by_cell.iter().enumerate() {
            load[self.dofs.of(k / Self::N, k % Self::N)] += value;
        }
        Ok(load)
    }

    /// The load tested with each cell's basis functions; empty if there is none.
    fn load_by_cell(&self) -> Result<Vec<T>, Error> {
        let weak = S::DIRICHLET == DirichletBy::FacetForm
            && self.problem.has_dirichlet_data()
            && self.mesh.has_part(BoundaryPart::Dirichlet);
        let flux = self.problem.has_neumann_data() && self.mesh.has_part(BoundaryPart::Neumann);
        if self.problem.source.is_none() && !weak && !flux {
            return Ok(Vec::new());
        }
        let mut load = vec![T::lit(0.0); self.mesh.n_cells() * Self::N];
        match &self.problem.source {
            None => {}
            Some(Datum::Constant(f)) => self.add_constant_source(*f, &mut load)?,
            Some(Datum::Function(f)) => self.add_source(f, &mut load)?,
        }
        if weak {
            self.add_dirichlet(&mut load)?;
        }
        if flux {
            self.add_neumann(&mut load)?;
        }
        Ok(load)
    }

    fn add_constant_source(&self, f: f64, load: &mut [T]) -> Result<(), Error> {
        count::source(1);
        let f = T::lit(data::finite(f, "source", &Point::<f64, D>::zeros(), 0)?);
        let table = CellTable::new::<S::Element, D>(<S::Element as ReferenceElement<T, D>>::DEGREE);
        let mean = |i: usize| {
            let terms = table.basis.iter().zip(&table.weights);
            terms.fold(T::lit(0.0), |s, (basis, &w)| s + w * basis.values[i])
        };
        let means: Vec<T> = (0..Self::N).map(|i| f * mean(i)).collect();
        self.for_each_cell(load, &|cell, out| {
            let volume = self.mesh.geometry(cell).volume;
            for (value, &mean) in out.iter_mut().zip(&means) {
                *value += volume * mean;
            }
            Ok(())
        })
    }

    fn add_source(&self, f: &Field<D>, load: &mut [T]) -> Result<(), Error> {
        let table = CellTable::<T>::new::<S::Element, D>(self.quadrature.cell);
        self.for_each_cell(load, &|cell, out| {
            let volume = self.mesh.geometry(cell).volume;
            let samples = table.points.iter().zip(&table.basis).zip(&table.weights);
            for ((point, basis), &weight) in samples {
                count::source(1);
                let x = point_f64(&self.mesh.point(cell, &point[..=D]));
                let value = T::lit(data::finite(f(&x), "source", &x, cell)?);
                for (out, &phi) in out.iter_mut().zip(&basis.values) {
                    *out += weight * volume * value * phi;
                }
            }
            Ok(())
        })
    }

    /// Calls a function with each cell and its part of the load, in parallel.
    fn for_each_cell(
        &self,
        load: &mut [T],
        work: &(impl Fn(usize, &mut [T]) -> Result<(), Error> + Sync),
    ) -> Result<(), Error> {
        let piece = |cells: Range<usize>, entries: &mut [T]| {
            let parts = cells.zip(entries.chunks_exact_mut(Self::N));
            parts.into_iter().try_for_each(|(cell, out)| work(cell, out))
        };
        parallel::for_each(self.mesh.n_cells(), &|c| c * Self::N, load, &piece)
    }

    /// Dirichlet data as the trial trace of the facet form.
    fn add_dirichlet(&self, load: &mut [T]) -> Result<(), Error> {
        let degree = <S::Element as ReferenceElement<T, D>>::DEGREE;
        let sampling = <S::Facet as FacetForm<T, D>>::sampling(degree);
        let rule = Rule::of_degree(D - 1, self.quadrature.facet);
        let table = FacetTable::<T>::new::<S::Element, D>(match sampling {
            Sampling::Points(_) => Sampling::Points(self.quadrature.facet),
            Sampling::Means => Sampling::Means,
        });
        for facet in self.facets_of(BoundaryPart::Dirichlet) {
            let (cell, local) = (facet.cell as usize, facet.local as usize);
            let geometry = self.mesh.geometry(cell);
            let here = CellSide { cell, local, geometry: &geometry, coefficient: self.alpha(cell) };
            let view = FacetGeometry::new(self.mesh, &here, None);
            let penalty = self.form.penalty(&view.view);
            let values = self.dirichlet_samples(&rule, sampling, cell, local)?;
            let out = &mut load[cell * Self::N..(cell + 1) * Self::N];
            let samples = table.on(local).iter().zip(&table.weights).zip(values);
            for ((basis, &weight), value) in samples {
                let test =
                    traces::<T, D, S::Element, S::Facet>(&view, &geometry, T::lit(1.0), basis);
                let datum = Trace { jump: T::lit(value), flux: T::lit(0.0) };
                for (out, &v) in out.iter_mut().zip(&test) {
                    *out += weight * view.view.measure * self.form.integrand(v, datum, penalty);
                }
            }
        }
        Ok(())
    }

    fn add_neumann(&self, load: &mut [T]) -> Result<(), Error> {
        let rule = Rule::of_degree(D - 1, self.quadrature.facet);
        let table = FacetTable::<T>::new::<S::Element, D>(Sampling::Points(self.quadrature.facet));
        for facet in self.facets_of(BoundaryPart::Neumann) {
            let (cell, local) = (facet.cell as usize, facet.local as usize);
            let geometry: CellGeometry<T, D> = self.mesh.geometry(cell);
            let normal = point_f64(&geometry.normal(local));
            let measure = geometry.facet_measure(local);
            let out = &mut load[cell * Self::N..(cell + 1) * Self::N];
            let samples = rule.points.iter().zip(table.on(local)).zip(&table.weights);
            for ((point, basis), &weight) in samples {
                count::neumann(1);
                let x = self.facet_point(point, cell, local);
                let flux = match (&self.problem.neumann, &self.problem.exact) {
                    (Some(q), _) => q(&x, &normal),
                    (None, Some(exact)) => {
                        self.alpha(cell).to_f64() * (exact.gradient)(&x).dot(&normal)
                    }
                    (None, None) => 0.0,
                };
                let flux = T::lit(data::finite(flux, "neumann", &x, cell)?);
                let basis: &BasisAt<T> = basis;
                for (out, &phi) in out.iter_mut().zip(&basis.values) {
                    *out += weight * measure * flux * phi;
                }
            }
        }
        Ok(())
    }

    /// The boundary facets of a part.
    pub(super) fn facets_of(&self, part: BoundaryPart) -> impl Iterator<Item = &BoundaryFacet> {
        self.mesh.boundary().iter().filter(move |f| f.part == part)
    }
    /// A point of a facet in space.
    pub(super) fn facet_point(&self, point: &[f64; 4], cell: usize, local: usize) -> Point<f64, D> {
        let inserted = insert(point, local).map(T::lit);
        point_f64(&self.mesh.point(cell, &inserted[..=D]))
    }
    /// Dirichlet data at the points of a facet rule, or their mean.
    pub(super) fn dirichlet_samples(
        &self,
        rule: &Rule,
        sampling: Sampling,
        cell: usize,
        local: usize,
    ) -> Result<Vec<f64>, Error> {
        let at = |point| {
            count::dirichlet(1);
            let x = self.facet_point(point, cell, local);
            data::finite(self.problem.dirichlet_at(&x), "dirichlet", &x, cell)
        };
        match sampling {
            Sampling::Points(_) => rule.points.iter().map(at).collect(),
            Sampling::Means => {
                let terms = rule.iter().map(|(point, w)| at(point).map(|value| w * value));
                Ok(vec![terms.sum::<Result<f64, Error>>()?])
            }
        }
    }
}
