//! The load: source, Neumann data, weak Dirichlet data. What is absent costs nothing.
//!
//! Data are integrated in `f64` and rounded once.

use std::borrow::Cow;
use std::ops::Range;

use super::bodies::FreeBodies;
use super::count;
use super::cut_simplices::CutRule;
use super::local::{traces, view};
use super::owned_rows::lifted::{LiftTable, Lifting};
use super::space::metric::Metrics;
use super::space::tables::BasisAt;
use super::space::{INWARD, Place, Space, data};
use crate::error::Error;
use crate::facet::{FacetForm, Trace};
use crate::mesh::BoundaryPart;
use crate::parallel::vectors::zeros;
use crate::parallel::{cells, once};
use crate::quadrature::{OrthonormalPolynomials, Rule, facet_to_cell};
use crate::real::Point;

/// A cell, one of its facets and the moments of the Dirichlet datum on it.
pub(crate) type FacetDatum = (usize, (usize, Vec<f64>));

/// The data in the order of cells and facets; not generic, so that the sorting code is compiled once.
pub(super) fn by_facet(data: &[FacetDatum]) -> Vec<&FacetDatum> {
    let mut sorted: Vec<&FacetDatum> = data.iter().collect();
    sorted.sort_unstable_by_key(|(cell, (local, _))| (*cell, *local));
    sorted
}

/// What is added to a cell's part of the load.
type OfCell<'w> = &'w (dyn Fn(usize, &mut [f64]) -> Result<(), Error> + Sync);

impl<const D: usize> Space<'_, D> {
    /// Whether Dirichlet data enter through the facet form.
    fn has_weak_data(&self) -> bool {
        !self.pins
            && self.problem.has_dirichlet_data()
            && self.mesh.has_part(BoundaryPart::Dirichlet)
    }

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
        let flux = self.problem.has_neumann_data() && self.mesh.has_part(BoundaryPart::Neumann);
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
        let n = self.per_cell();
        let mut load = vec![0.0; self.dofs.size()];
        for (k, &value) in by_cell.iter().enumerate() {
            load[self.dofs.of(k / n, k % n)] += value;
        }
        load
    }

    fn add_constant_source(&self, f: f64, load: &mut [f64]) -> Result<(), Error> {
        count::source(1);
        let f = data::finite(f, "source", &Point::<D>::zeros(), 0)?;
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
                count::source(1);
                let value = weight * volume * data::finite(f.at(x), "source", x, cell)?;
                for (out, phi) in out.iter_mut().zip(&basis.values) {
                    *out += value * phi;
                }
                Ok(())
            };
            if let Some((level, rule)) = f.level().zip(cut_rule.as_ref()) {
                let mut outcome = Ok(());
                if rule.visit_if_cut(self.mesh, cell, level, &mut |point, x, weight| {
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

    /// Sets the load to zero and calls a function with each cell and its part of the load, in parallel.
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
        for (place, group) in self.grouped_facets_of(BoundaryPart::Neumann) {
            let (cell, local) = place;
            let measure = self.facet_measure((cell, local));
            let out = &mut load[cell * n..(cell + 1) * n];
            for (point, weight) in self.facet_rule.iter() {
                let flux = weight * measure * self.neumann_at(place, group, point)?;
                let basis = self.basis_at(&facet_to_cell(point, local));
                for (out, phi) in out.iter_mut().zip(&basis.values) {
                    *out += flux * phi;
                }
            }
        }
        Ok(())
    }

    /// The Neumann datum at a point of a facet.
    pub fn neumann_at(
        &self,
        (cell, local): Place,
        group: usize,
        point: &[f64; 4],
    ) -> Result<f64, Error> {
        count::neumann(1);
        let x = self.facet_point(point, cell, local);
        let normal = || self.mesh.geometry(cell).normal(local);
        let flux = match (self.data.neumann.of(group), &self.problem.exact) {
            (Some(q), _) => q.at(&x, &normal()),
            (None, Some(exact)) => {
                let middle = [1.0 / (D + 1) as f64; 4];
                let inward = x + (self.cell_point(&middle, cell) - x) * INWARD;
                self.alpha_at(cell, &inward) * (exact.gradient)(&x).dot(&normal())
            }
            (None, None) => 0.0,
        };
        data::finite(flux, "neumann", &x, cell)
    }

    /// Moments of Dirichlet data on a facet.
    pub fn dirichlet_moments(
        &self,
        moments: &FacetMoments<'_>,
        (cell, local): Place,
        group: usize,
    ) -> Result<Vec<f64>, Error> {
        let mut sums = vec![0.0; moments.polynomials.len()];
        for (point, w) in moments.rule.iter() {
            count::dirichlet(1);
            let x = self.facet_point(point, cell, local);
            let value = data::finite(self.dirichlet_at(group, &x), "dirichlet", &x, cell)?;
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += w * value * moments.polynomials.value(k, point);
            }
        }
        Ok(sums)
    }
}

/// What moments of data on facets are computed with.
pub(crate) struct FacetMoments<'r> {
    polynomials: OrthonormalPolynomials,
    rule: &'r Rule,
}

impl<'r> FacetMoments<'r> {
    /// Moments up to a degree, by a rule on facets.
    pub fn new(dimension: usize, degree: usize, rule: &'r Rule) -> Self {
        Self { polynomials: OrthonormalPolynomials::new(dimension - 1, degree), rule }
    }
}

impl<const D: usize> Space<'_, D> {
    /// The load of all unknowns; the metrics of all cells are asked for only where jumps are lifted.
    pub fn load<'m>(
        &self,
        form: &dyn FacetForm<D>,
        metrics: &dyn Fn() -> &'m Metrics,
    ) -> Result<Vec<f64>, Error> {
        let bodies = self.free_bodies()?;
        Ok(self.load_and_data(form, metrics, &bodies, true)?.0)
    }

    /// The load of all unknowns, with or without the Dirichlet data that the facet form imposes, and these data. The
    /// loads of free bodies have their resultants.
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
        let mut data = Vec::new();
        if self.has_weak_data() {
            data = self.weak_data(form)?;
        }
        if with_data && !data.is_empty() {
            let by_cell = by_cell.to_mut();
            self.add_dirichlet(form, &data, by_cell);
            if form.is_lifted() {
                self.add_lifted(form, metrics(), &data, by_cell);
            }
        }
        Ok((self.gather_load(by_cell), data))
    }

    /// The moments of Dirichlet data that the facet form imposes, facet by facet.
    fn weak_data(&self, form: &dyn FacetForm<D>) -> Result<Vec<FacetDatum>, Error> {
        let degree = form.moments(self.basis_degree);
        let moments = FacetMoments::new(D, degree, &self.facet_rule);
        let of_facet = |((cell, local), group)| {
            Ok((cell, (local, self.dirichlet_moments(&moments, (cell, local), group)?)))
        };
        self.grouped_facets_of(BoundaryPart::Dirichlet).map(of_facet).collect()
    }

    /// Dirichlet data as the trial trace of the facet form.
    fn add_dirichlet(&self, form: &dyn FacetForm<D>, data: &[FacetDatum], load: &mut [f64]) {
        let n = self.per_cell();
        let table = self.facet_table(form.moments(self.basis_degree));
        for &(cell, (local, ref values)) in data {
            let metric = self.metric(cell);
            let here = self.side(cell, local, &metric);
            let facet = view(self.mesh, &here, None);
            let penalty = form.penalty(&facet);
            let out = &mut load[cell * n..(cell + 1) * n];
            for (k, (basis, &value)) in table.on(local).iter().zip(values).enumerate() {
                let weighted = self.flux_derivatives((cell, local), None, 1.0, k);
                let test = traces(form, &facet, &here, true, (basis, weighted.as_ref()), n);
                let datum = Trace { jump: value, flux: 0.0 };
                let penalty = penalty * form.moment_weight(table.degrees[k]);
                for (out, &v) in out.iter_mut().zip(&test) {
                    *out += facet.measure * form.integrand(&facet, v, datum, penalty);
                }
            }
        }
    }

    /// What the products of lifts make of Dirichlet data.
    fn add_lifted(
        &self,
        form: &dyn FacetForm<D>,
        metrics: &Metrics,
        data: &[FacetDatum],
        load: &mut [f64],
    ) {
        let table = LiftTable::new(self, form.lift_degree(self.basis_degree));
        let lifting = Lifting { space: self, form, metrics, table: &table };
        for (cell, datum) in data {
            lifting.add_load(self.coupled_neighbours(), *cell, datum, load);
        }
    }
}
