//! Rows of the parts of a mesh, compared bit for bit with those of the whole mesh.

use std::sync::Arc;

use crate::algebra::{Bound, Inequality};
use crate::arrays::map_entries;
use crate::assemble::{DataQuadrature, Discretisation};
use crate::error::Error;
use crate::mesh::{Mesh, Part};
use crate::nested::Solved;
use crate::processes::{OverParts, agree};
use crate::scheme::Scheme;

/// Counts of own rows of all parts: those compared with the whole mesh, and those in which a bit differs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Differences {
    /// Rows that were compared: the unknowns of all parts.
    pub compared: u64,
    /// Rows of the matrix with other columns or values.
    pub rows: u64,
    /// Entries of the load.
    pub loads: u64,
    /// Bounds.
    pub bounds: u64,
    /// Entries of the residual of the solution.
    pub residuals: u64,
}

impl Differences {
    /// Whether no bit differs.
    pub fn are_none(&self) -> bool {
        [self.rows, self.loads, self.bounds, self.residuals] == [0; 4]
    }
    /// Compares the own rows of all parts with those of the whole mesh. Every process assembles the whole mesh for this,
    /// and all parts must call the function. A solution on a whole mesh has no rows to compare.
    ///
    /// # Errors
    /// [`Error::Processes`] with the error of assembly, and those of the exchange.
    pub fn from_whole<const D: usize>(
        solved: &Solved<'_, D>,
        scheme: &dyn Scheme<D>,
        whole: &Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        let Some((part, over_parts)) = solved.part().zip(solved.system().over_parts()) else {
            return Ok(Self::default());
        };
        let problem = solved.discretisation().problem();
        // parts take no constants off their data
        let data = (problem, Arc::default());
        let of = Discretisation::with_constants(scheme, data, whole, quadrature);
        let assembled = of.and_then(|of| {
            let inequality = of.inequality()?;
            Ok((of, inequality))
        });
        let (of, all) = agree::<_, Error>(assembled, &*over_parts.exchange)?;
        let own = Self::of_part(solved, (part, over_parts), &of, &all);
        let numbers = [own.compared, own.rows, own.loads, own.bounds, own.residuals];
        let sums = over_parts.exchange.sum(&numbers.map(|x| x as f64))?;
        let [compared, rows, loads, bounds, residuals] =
            map_entries([0, 1, 2, 3, 4], |k| sums[k] as u64);
        Ok(Self { compared, rows, loads, bounds, residuals })
    }

    /// The differences of this part.
    fn of_part<const D: usize>(
        solved: &Solved<'_, D>,
        (part, over_parts): (&Part<D>, &OverParts),
        of: &Discretisation<'_, D>,
        all: &Inequality<f64>,
    ) -> Self {
        let (inequality, values) = (solved.inequality(), &solved.solution().values[..]);
        let mut numbers = vec![0; inequality.size()];
        for (cell, &whole) in part.cells.iter().enumerate() {
            let own = solved.discretisation().unknowns_of(cell);
            own.zip(of.unknowns_of(whole as usize)).for_each(|(own, whole)| numbers[own] = whole);
        }
        let mut residual = vec![0.0; values.len()];
        inequality.residual_f64(values, &mut residual);
        // the values of unknowns that this part does not have enter no row of its own
        let mut all_values = vec![0.0; all.size()];
        numbers.iter().zip(values).for_each(|(&number, &value)| all_values[number] = value);
        let mut all_residuals = vec![0.0; all.size()];
        all.residual_f64(&all_values, &mut all_residuals);
        let loads = [inequality, all].map(|of| of.assembled_load());
        let mut found = Self::default();
        for &i in over_parts.numbering.own() {
            let i = i as usize;
            let number = numbers[i];
            let (columns, entries) = inequality.matrix.row(i);
            let (all_columns, all_entries) = all.matrix.row(number);
            let is_same =
                columns.iter().map(|&j| numbers[j as usize] as u32).eq(all_columns.iter().copied())
                    && entries.iter().zip(all_entries).all(|(a, b)| a.to_bits() == b.to_bits());
            found.compared += 1;
            found.rows += u64::from(!is_same);
            let differ = |one: f64, other: f64| u64::from(one.to_bits() != other.to_bits());
            found.loads += differ(loads[0][i], loads[1][number]);
            found.residuals += differ(residual[i], all_residuals[number]);
            let bounds = map_entries([&inequality.bounds[i], &all.bounds[number]], bits);
            found.bounds += u64::from(bounds[0] != bounds[1]);
        }
        found
    }
}

/// The bits of a bound.
fn bits(bound: &Bound<f64>) -> [Option<u64>; 3] {
    let fixed = if let Bound::Fixed(value) = bound { Some(*value) } else { None };
    map_entries([fixed, bound.lower(), bound.upper()], |value| value.map(f64::to_bits))
}
