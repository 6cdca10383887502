//! The load: source, Neumann data, weak Dirichlet data. What is absent costs nothing.

use std::borrow::Cow;
use std::convert::Infallible;
use std::ops::Range;
use std::slice::from_ref;

use super::bodies::FreeBodies;
use super::cut_simplices::CutRule;
use super::shared_rows::places::for_each_place;
use super::space::metric::Metrics;
use super::space::tables::BasisAt;
use super::space::tables::FacetDatum;
use super::space::{INWARD, Space, checks};
use crate::error::Error;
use crate::facet::FacetForm;
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::parallel::vectors::zeros;
use crate::parallel::{cells, once};
use crate::problem::Exact;
use crate::quadrature::{Rule, facet_to_cell};
use crate::real::Point;

/// A term that is added to the load of a cell.
type OfCell<'w> = &'w (dyn Fn(usize, &mut [f64]) -> Result<(), Error> + Sync);

impl<const D: usize> Space<'_, D> {
    /// Source and Neumann data tested with each cell's basis functions; empty if neither they nor
    /// weak Dirichlet data are there. Integrals of a source that varies are kept for cells that share unknowns:
    /// load, energy and bound ask for them.
    pub fn load_by_cell(&self) -> Result<Cow<'_, [f64]>, Error> {
        let varies = self.data.source.any(&|f| f.constant().is_none());
        if self.broken || !varies {
            return self.integrate_load().map(Cow::Owned);
        }
        let load = match self.load_by_cell.get() {
            Some(load) => load,
            None => {
                let load = self.integrate_load()?;
                once(&self.load_by_cell, || load)
            }
        };
        Ok(Cow::Borrowed(load))
    }

    fn integrate_load(&self) -> Result<Vec<f64>, Error> {
        let flux =
            self.problem.has_neumann_data() && self.mesh.has_condition(BoundaryCondition::Neumann);
        let source = &self.data.source;
        if !source.is_given() && !self.has_weak_data() && !flux {
            return Ok(Vec::new());
        }
        let mut load = zeros(self.mesh.n_cells() * self.per_cell());
        let constant = source.all().next().and_then(|f| f.constant());
        match constant.filter(|_| !source.has_names()) {
            Some(f) => self.add_constant_source(f, &mut load)?,
            None if source.is_given() => self.add_source(&mut load)?,
            None => {}
        }
        if flux {
            self.add_neumann(&mut load)?;
        }
        Ok(load)
    }

    /// Adds up what the cells of each unknown hold.
    fn gather_load(&self, by_cell: Cow<'_, [f64]>) -> Vec<f64> {
        if self.broken && !by_cell.is_empty() {
            return by_cell.into_owned();
        }
        let mut load = zeros(self.dofs.size());
        if !by_cell.is_empty() {
            let n = self.per_cell();
            let add = |sum: &mut f64, (cell, i): (usize, usize)| {
                *sum += by_cell[n * cell + i];
                Ok::<_, Infallible>(())
            };
            let Ok(()) = for_each_place::<D, _, _>(&self.dofs, &mut load, add);
        }
        load
    }

    fn add_constant_source(&self, f: f64, load: &mut [f64]) -> Result<(), Error> {
        let f = checks::finite(f, "source", &Point::<D>::zeros(), 0)?;
        let means: Vec<f64> = self.basis_means().iter().map(|mean| f * mean).collect();
        self.fill_each_cell(load, &|cell, out| {
            let volume = self.mesh.geometry(cell).volume;
            for (value, mean) in out.iter_mut().zip(&means) {
                *value += volume * mean;
            }
            Ok(())
        })
    }

    /// The means of the basis functions over a cell.
    pub fn basis_means(&self) -> Vec<f64> {
        let table = self.cell_table(Rule::new(D, self.basis_degree));
        let mean = |i: usize| -> f64 {
            table.basis.iter().zip(&table.weights).map(|(basis, w)| w * basis.values[i]).sum()
        };
        (0..self.per_cell()).map(mean).collect()
    }

    fn add_source(&self, load: &mut [f64]) -> Result<(), Error> {
        let table = self.cell_table(self.cell_rule.clone());
        let has_level = self.data.source.any(&|f| f.level().is_some());
        let cut_rule = has_level.then(|| CutRule::new(D, self.cell_degree));
        self.fill_each_cell(load, &|cell, out| {
            let Some(f) = self.data.source.of(self.mesh.region(cell)) else { return Ok(()) };
            let volume = self.mesh.geometry(cell).volume;
            let mut add = |x: &Point<D>, weight: f64, basis: &BasisAt| {
                let value = checks::finite(self.at(f, cell, x), "source", x, cell)?;
                let value = weight * volume * value;
                for (out, phi) in out.iter_mut().zip(&basis.values) {
                    *out += value * phi;
                }
                Ok(())
            };
            if let Some((level, rule)) = f.level().zip(cut_rule.as_ref()) {
                let mut outcome = Ok(());
                if rule.visit_if_cut(self.mesh, cell, from_ref(level), &mut |point, x, weight| {
                    if outcome.is_ok() {
                        outcome = add(x, weight, &self.basis_at(point));
                    }
                }) {
                    return outcome;
                }
            }
            let samples = table.points.iter().zip(&table.basis).zip(&table.weights);
            for ((point, basis), weight) in samples {
                add(&self.cell_point(point, cell), *weight, basis)?;
            }
            Ok(())
        })
    }

    /// Sets the load to zero and calls a function with each cell and its share of the load, in parallel.
    fn fill_each_cell(&self, load: &mut [f64], work: OfCell<'_>) -> Result<(), Error> {
        let n = self.per_cell();
        let add_cells = |mut cells: Range<usize>, entries: &mut [f64]| {
            // the first access to memory of zeros is a write: reading first takes two page faults, and the second
            // page fault interrupts all other threads
            entries.fill(0.0);
            entries.chunks_exact_mut(n).try_for_each(|out| match cells.next() {
                Some(cell) => work(cell, out),
                None => Ok(()),
            })
        };
        cells::for_each(self.mesh.n_cells(), &|c| c * n, load, &add_cells)
    }

    fn add_neumann(&self, load: &mut [f64]) -> Result<(), Error> {
        let n = self.per_cell();
        for (facet, group) in self.grouped_facets_of(BoundaryCondition::Neumann) {
            let ((cell, local), measure) = (facet, self.facet_measure(facet));
            let out = &mut load[cell * n..(cell + 1) * n];
            for (point, weight) in self.facet_rule.iter() {
                let flux = weight * measure * self.neumann_at(facet, group, point, None)?;
                let basis = self.basis_at(&facet_to_cell(point, local));
                for (out, phi) in out.iter_mut().zip(&basis.values) {
                    *out += flux * phi;
                }
            }
        }
        Ok(())
    }

    /// The Neumann datum at a point of a facet; on a Robin side `k (g - u)` with a discrete function, zero without one.
    pub fn neumann_at(
        &self,
        (cell, local): HalfFacet,
        group: usize,
        point: &[f64; 4],
        u: Option<&[f64]>,
    ) -> Result<f64, Error> {
        let x = self.facet_point(point, cell, local);
        if let Some(side) = self.data.robin.of(group) {
            let basis = || self.basis_at(&facet_to_cell(point, local));
            let own = u.map_or(0.0, |u| basis().value(&self.local_values(cell, u)));
            let [coefficient, value] = side.data().map(|datum| self.at(datum, cell, &x));
            return checks::finite(coefficient * (value - own), "robin", &x, cell);
        }
        let exact = self.problem.exact.as_ref();
        // friction is no load
        let exact = exact.filter(|_| self.data.friction.of(group).is_none());
        let flux = match (self.data.neumann.of(group), exact) {
            (Some(q), _) => q.at(&x, &self.mesh.geometry(cell).normal(local)),
            (None, Some(exact)) => self.exact_flux(exact, (cell, local), point),
            (None, None) => 0.0,
        };
        checks::finite(flux, "neumann", &x, cell)
    }

    /// The integral of the Neumann datum over a facet, on a Robin side with the discrete function.
    pub fn neumann_flux(&self, facet: HalfFacet, group: usize, u: &[f64]) -> Result<f64, Error> {
        let measure = self.facet_measure(facet);
        let mut sum = 0.0;
        for (point, weight) in self.facet_rule.iter() {
            sum += weight * measure * self.neumann_at(facet, group, point, Some(u))?;
        }
        Ok(sum)
    }

    /// The normal flux of an exact solution at a point of a facet.
    pub fn exact_flux(&self, exact: &Exact<D>, (cell, local): HalfFacet, point: &[f64; 4]) -> f64 {
        let x = self.facet_point(point, cell, local);
        let middle = [1.0 / (D + 1) as f64; 4];
        let inward = x + (self.cell_point(&middle, cell) - x) * INWARD;
        let gradient = (exact.gradient)(&x);
        let tensor = self.tensor_at(cell, &inward);
        let flux = tensor.map_or(gradient, |tensor| tensor.flux(&gradient));
        self.alpha_at(cell, &inward) * flux.dot(&self.mesh.geometry(cell).normal(local))
    }

    /// The load of all unknowns, with or without the Dirichlet data that the facet form imposes, and these data. The
    /// loads of free bodies have their resultants. The metrics of all cells are asked for only where jumps are lifted.
    pub fn load_and_data<'m>(
        &self,
        form: &dyn FacetForm<D>,
        metrics: &dyn Fn() -> &'m Metrics,
        bodies: &FreeBodies,
        with_data: bool,
    ) -> Result<(Vec<f64>, Vec<FacetDatum>), Error> {
        let mut by_cell = self.load_by_cell()?;
        if !bodies.bodies.is_empty() && !by_cell.is_empty() {
            self.correct_resultants(bodies, by_cell.to_mut());
        }
        let data = self.weak_data(form)?;
        if with_data && !data.is_empty() {
            self.add_weak_data(form, metrics, &data, by_cell.to_mut());
        }
        Ok((self.gather_load(by_cell), data))
    }
}
