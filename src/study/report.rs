//! A report: rows, and the program that ran them.

use super::extrapolate::{Extrapolated, extrapolate};
use super::program::Program;
use super::row::Row;
use super::series::{Series, series_of};

/// Rows in the order run, and the program that ran them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Deserialize))]
#[non_exhaustive]
pub struct Report {
    /// The program.
    pub program: Program,
    /// Whether every row that was asked for is there; false in the report of a run that was interrupted.
    pub complete: bool,
    /// One row for every scene, scheme and level.
    pub rows: Vec<Row>,
}

impl Report {
    /// A report of rows that a program ran.
    #[must_use]
    pub fn new(program: Program, rows: Vec<Row>) -> Self {
        Self { program, complete: true, rows }
    }
    /// The series of the report, in the order in which they first occur: the rows of one scheme with one solver on one
    /// scene, those of uniform and of adaptive meshes apart. Tables, orders, limits and plots go by them.
    ///
    /// ```
    /// use unilateral::prelude::*;
    /// # fn main() -> Result<(), Error> {
    /// let study = || Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1);
    /// let mut report = study().levels([8, 4]).run()?;
    /// report.rows.extend(study().adaptive(Adaptivity::default().steps(2)).run()?.rows);
    /// let series = report.series();
    /// assert_eq!([series[0].variant.theta, series[1].variant.theta], [None, Some(0.5)]);
    /// assert_eq!([series[0].rows[0].level, series[1].rows.len()], [4, 3]);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn series(&self) -> Vec<Series<'_>> {
        series_of(&self.rows)
    }
    /// The limits of energy, contact measure and resultant of every series with three levels that converged,
    /// from the three finest of them. Adaptive meshes have no limits: their sizes are not those of one family.
    ///
    /// A limit is that of three figures, coarsest mesh first, whose error is `C h^p`: Richardson extrapolation
    /// with the order that the figures themselves show. None where they do not tend to a limit like a power of
    /// the mesh size: where the differences change their sign or do not fall.
    #[must_use]
    pub fn extrapolated(&self) -> Vec<Extrapolated> {
        extrapolate(&self.rows)
    }
}

/// The fields, and the limits of the rows as `extrapolated`.
#[cfg(feature = "report")]
impl serde::Serialize for Report {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct;
        let mut report = serializer.serialize_struct("Report", 4)?;
        report.serialize_field("program", &self.program)?;
        report.serialize_field("complete", &self.complete)?;
        report.serialize_field("rows", &self.rows)?;
        report.serialize_field("extrapolated", &self.extrapolated())?;
        report.end()
    }
}
