//! The judgement of values that another program found.

use super::Study;
use super::rows::with_level;
use crate::error::Error;
use crate::instances::compiled;
use crate::nested::NestedIteration;
use crate::study::row::{Iterations, Row};

impl<const D: usize> Study<'_, D> {
    /// The row of the first scheme on the first level for values of its unknowns that another program
    /// found: their certificate, errors and totals. Solver and linear solver of the row are `none`.
    ///
    /// Where `constants` are given, those of the problem are to be added to the values, one for each unknown, or an empty
    /// list for zeros: see [`read_constants`](crate::exchange::read_constants).
    ///
    /// # Errors
    /// Those of [`Study::run`], and [`Error::Parameter`] for another number of values than of unknowns.
    pub fn judge(&self, values: &[f64], constants: Option<&[f64]>) -> Result<Row, Error> {
        compiled!(const D: fn(&Study<'_, D>, &[f64], Option<&[f64]>) -> Result<Row, Error>
                = |study, values, constants| study.judge_values(values, constants)
        )(self, values, constants)
    }
    fn judge_values(&self, values: &[f64], constants: Option<&[f64]>) -> Result<Row, Error> {
        self.check_for(1)?;
        if self.levels.is_empty() {
            let allowed = "the level of the mesh that the values belong to";
            return Err(Error::parameter("levels", "none", allowed));
        }
        let (entry, level) = (&self.entries[0], self.first_level());
        let hierarchies = self.hierarchies(None)?;
        let on = |h| NestedIteration::new(&entry.problem, h).quadrature(self.quadrature);
        let mut nested: Vec<_> = hierarchies.iter().map(on).collect();
        let (position, nested) = with_level(&mut nested, level);
        let solved = nested.judge_beside(position, &*entry.scheme, (values, constants))?;
        let reference = self.find_reference(&hierarchies);
        let row = self.row_of(entry, (level, "none"), &solved, reference.as_ref())?;
        let iterations = Iterations { outer: None, ..row.iterations };
        Ok(Row { iterations, peak_memory_bytes: None, ..row })
    }
}
