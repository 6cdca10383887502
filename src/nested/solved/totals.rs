//! Totals of a result: energy, contact, penetration. Over the parts of a mesh they add up.

use std::collections::BTreeMap;

use super::Solved;
use crate::error::Error;
use crate::measure::Penetration;

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
        let own = self.discretisation().energy_of(self.values(), &|cell| self.system.owns(cell));
        Ok(Some(self.system.sums([self.system.agreed(own)?])[0]))
    }
    /// The measure of the discrete contact set: the volume of the cells in contact where there are obstacles, else the
    /// area of the facets in contact (the number of points in one dimension), with the definitions of
    /// [`Solved::contact_errors`]; none for a problem without inequality and for an outcome without iterate.
    pub fn contact_measure(&self) -> Option<f64> {
        let counts = |cell| self.system.owns(cell);
        let (of, inequality) = (self.discretisation(), self.inequality());
        let measure = || of.contact_measure(inequality, &self.solution, &counts);
        let own = self.has_iterate.then(measure).flatten()?;
        Some(self.system.sums([own])[0])
    }
    /// The total contact force, of all obstacles and gaps: the multiplier tested with the function one, which is the
    /// sum of the entries of `A u - b` at the constrained unknowns in contact, because every unknown is the value or a
    /// mean of the function. It is positive where a lower bound pushes upward. None without an inequality or an
    /// iterate, and where rounding leaves no digit. Nodes with weakly imposed Dirichlet data do not count: where an
    /// obstacle equals the datum, their entries contain the flux through the boundary.
    ///
    /// Where only contact holds the body, without Dirichlet boundary and reaction, it is the negative of the
    /// total load, for every scheme: constants have no energy. It approximates the integral of the
    /// multiplier over domain and contact boundary.
    pub fn resultant(&self) -> Option<f64> {
        let multipliers = self.multiplier()?.iter().enumerate();
        let own = multipliers.filter(|(i, _)| self.inequality().owns(*i));
        Some(self.system.sums([own.map(|(_, force)| force).sum()])[0])
    }
    /// The resultant of each obstacle (`lower`, `upper`) and of each contact group by its name; their sum is that of
    /// all ([`Solved::resultant`]). The multiplier of an unknown belongs to the datum that gives its active bound:
    /// where obstacle and gap are equal to the obstacle, where gaps of several groups are, to each by the measure of
    /// its facets there. None where there is no resultant.
    pub fn resultants(&self) -> Option<BTreeMap<String, f64>> {
        let (multipliers, inequality) = (self.multiplier()?, self.inequality());
        let own: [&dyn Fn(usize) -> bool; 2] =
            [&|i| inequality.owns(i), &|cell| self.system.owns(cell)];
        let of = self.discretisation();
        let mut resultants = of.resultants((inequality, &self.solution), multipliers, own);
        // all parts have the groups of the whole mesh
        for of_all in resultants.values_mut() {
            *of_all = self.system.sums([*of_all])[0];
        }
        Some(resultants)
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
            .penetration_of((self.values(), self.solution().precision), &counts);
        let Some(own) = self.system.agreed(own)? else { return Ok(None) };
        let mut numbers = own.numbers();
        if let Some(distribution) = self.inequality().distribution() {
            distribution.largest(&mut numbers);
        }
        Ok(Some(own.with_numbers(numbers)))
    }
}
