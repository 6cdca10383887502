//! Totals of a result: energy, contact, penetration. Over the parts of a mesh they add up.

use std::collections::BTreeMap;

use super::Solved;
use crate::error::Error;
use crate::measure::{FoundValue, Penetration};
use crate::problem::ValueOf;

impl<const D: usize> Solved<'_, D> {
    /// The energy of the solution, by one formula for every scheme: see
    /// [`energy`](crate::assemble::Discretisation::energy). None without an iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn energy(&self) -> Result<Option<f64>, Error> {
        if !self.has_iterate {
            return Ok(None);
        }
        let own =
            self.discretisation().energy_of(&self.solution.values, &|cell| self.system.owns(cell));
        Ok(Some(self.system.sums([self.system.agreed(own)?])[0]))
    }
    /// The measure of the discrete contact set, see
    /// [`contact_measure`](crate::assemble::Discretisation::contact_measure); none for a problem without inequality and
    /// for an outcome without iterate.
    pub fn contact_measure(&self) -> Option<f64> {
        let counts = |cell| self.system.owns(cell);
        let (of, inequality) = (self.discretisation(), self.inequality());
        let measure = || of.contact_measure_of(inequality, &self.solution, &counts);
        let own = self.has_iterate.then(measure).flatten()?;
        Some(self.system.sums([own])[0])
    }
    /// The total contact force, positive where a lower bound pushes upward: see
    /// [`resultant`](crate::assemble::Discretisation::resultant); none for a problem without inequality and for an
    /// outcome without iterate.
    pub fn resultant(&self) -> Option<f64> {
        Some(self.resultant_of(&self.multiplier()?))
    }
    /// The sum of the multipliers of own unknowns over all parts.
    pub(crate) fn resultant_of(&self, multipliers: &[f64]) -> f64 {
        let own = multipliers.iter().enumerate().filter(|(i, _)| self.inequality().owns(*i));
        self.system.sums([own.map(|(_, force)| force).sum()])[0]
    }
    /// The resultant of each obstacle and each contact group, see
    /// [`resultants`](crate::assemble::Discretisation::resultants); none where there is no resultant.
    pub fn resultants(&self) -> Option<BTreeMap<String, f64>> {
        let (of, inequality) = (self.discretisation(), self.inequality());
        let own: [&dyn Fn(usize) -> bool; 2] =
            [&|i| inequality.owns(i), &|cell| self.system.owns(cell)];
        let resultants = || of.resultants_of(inequality, &self.solution, own);
        let mut resultants = self.has_iterate.then(resultants).flatten()?;
        // all parts have the groups of the whole mesh
        for of_all in resultants.values_mut() {
            *of_all = self.system.sums([*of_all])[0];
        }
        Some(resultants)
    }
    /// Numbers of the solution: see [`values_of`](crate::assemble::Discretisation::values_of). None without an iterate, and
    /// on parts of a mesh.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), Error> {
    /// let mesh = Mesh::<2>::kuhn_box(&BoxDomain::centred(1.0), [8, 8])?;
    /// let problem = Problem::new().constant_source(-1.0);
    /// let solved = solve(&problem, &mesh, &Sipg::default())?;
    /// let held = ValueOf::Reaction("default".to_owned());
    /// let values = solved.values_of(&[held, ValueOf::Smallest("default".to_owned())])?;
    /// // the sides hold the load
    /// assert!((values[0].value.unwrap() - 4.0).abs() < 1e-8);
    /// assert!(values[1].place.unwrap().norm() < 0.1);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownGroup`], [`Error::DataNotFinite`].
    pub fn values_of(&self, wanted: &[ValueOf<D>]) -> Result<Vec<FoundValue<D>>, Error> {
        match self.has_iterate && self.part().is_none() {
            true => self.discretisation().values_of(wanted, self.inequality(), &self.solution),
            false => Ok(vec![FoundValue { value: None, place: None }; wanted.len()]),
        }
    }
    /// How far the solution lies beyond obstacles and gaps, between its nodes too: see
    /// [`penetration`](crate::assemble::Discretisation::penetration). None without an inequality or an iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn penetration(&self) -> Result<Option<Penetration>, Error> {
        if !self.has_iterate {
            return Ok(None);
        }
        let counts = |cell| self.system.owns(cell);
        let own = self
            .discretisation()
            .penetration_of((&self.solution.values, self.solution().precision), &counts);
        let Some(own) = self.system.agreed(own)? else { return Ok(None) };
        let mut numbers = own.numbers();
        self.inequality().distribution().largest(&mut numbers);
        Ok(Some(Penetration::with_numbers(numbers)))
    }
}
