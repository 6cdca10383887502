//! Nothing depends on how vertices and cells are numbered.

use std::collections::HashMap;

use super::discrete::{Tested, assemble, solve};
use super::error::{KitError, Law};
use super::matrix::{Assembled, row_sizes};
use super::meshes::{Renumbered, Sample};
use super::report::InvarianceReport;
use super::{meshes, problems};
use crate::algebra::Support;
use crate::instances::compiled;

/// Rounding units by which entries of matrix and load may change.
const ENTRY_UNITS: f64 = 512.0;
/// Rounding units by which unknowns may change, which condition magnifies.
const SOLUTION_UNITS: f64 = 8192.0;

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<InvarianceReport, KitError> {
    compiled!(const D: fn(&Tested<'_, D>) -> Result<InvarianceReport, KitError>
            = check_scheme
    )(scheme)
}

fn check_scheme<const D: usize>(scheme: &Tested<'_, D>) -> Result<InvarianceReport, KitError> {
    let law = Law::Invariance;
    let sample = meshes::moved::<D>(law, &meshes::mixed(), meshes::subdivisions(D))?;
    let problem = problems::rich();
    let inequality = assemble(law, scheme, &problem, &sample.mesh)?;
    let u = solve(law, &inequality, &sample)?;
    let before = Numbered { assembled: Assembled::of(&inequality), solution: u.clone() };
    let mut report = InvarianceReport { matrix: 0.0, load: 0.0, solution: 0.0 };
    for seed in [1, 2] {
        let Renumbered { mesh, vertices, cells } = meshes::renumbered(law, &sample.mesh, seed)?;
        let other = Sample { name: "a renumbered box", mesh };
        let inequality = assemble(law, scheme, &problem, &other.mesh)?;
        let u = solve(law, &inequality, &other)?;
        let after = Numbered { assembled: Assembled::of(&inequality), solution: u.clone() };
        let new = after.numbers_of(&before, &vertices, &cells)?;
        let Numbered { assembled, .. } = &before;
        let tolerance = ENTRY_UNITS * f64::EPSILON;
        report.matrix = report.matrix.max(matrix(assembled, &after.assembled, &new, tolerance)?);
        report.load = report.load.max(before.load(&after, &new, tolerance)?);
        let tolerance = SOLUTION_UNITS * f64::EPSILON;
        report.solution = report.solution.max(before.solution(&after, &new, tolerance)?);
    }
    Ok(report)
}

/// A linear problem and its solution in one numbering.
struct Numbered {
    assembled: Assembled,
    solution: Vec<f64>,
}

/// The cell and the vertices of a support, in the numbers of the first mesh.
type Key = (Option<u32>, Vec<u32>);

fn key(support: &Support, vertex: impl Fn(u32) -> u32, cell: impl Fn(u32) -> u32) -> Key {
    let mut vertices: Vec<u32> = support.vertices().iter().map(|&v| vertex(v)).collect();
    vertices.sort_unstable();
    (support.cell().map(cell), vertices)
}

impl Numbered {
    /// The number here of every unknown there; vertices and cells have these numbers there.
    fn numbers_of(
        &self,
        there: &Self,
        vertices: &[u32],
        cells: &[u32],
    ) -> Result<Vec<usize>, KitError> {
        let supports = &self.assembled.supports;
        let mut here = HashMap::with_capacity(supports.len());
        for (second, support) in supports.iter().enumerate() {
            let key = key(support, |v| vertices[v as usize], |c| cells[c as usize]);
            if let Some(first) = here.insert(key, second) {
                let place = self.assembled.describe(second);
                return Err(KitError::UnknownsNotTold { first, second, place });
            }
        }
        // both meshes have the same supports, so that one that is not found is one that is there twice
        let find = |(first, support): (usize, &Support)| {
            here.remove(&key(support, |v| v, |c| c)).ok_or_else(|| {
                let place = there.assembled.describe(first);
                KitError::UnknownsNotTold { first, second: first, place }
            })
        };
        there.assembled.supports.iter().enumerate().map(find).collect()
    }

    fn load(&self, after: &Self, new: &[usize], tolerance: f64) -> Result<f64, KitError> {
        let (old, other) = (&self.assembled.load, &after.assembled.load);
        let (change, unknown) = largest_change(old, other, new);
        if change <= tolerance {
            return Ok(change);
        }
        let place = self.assembled.describe(unknown);
        let (before, after) = (old[unknown], other[new[unknown]]);
        Err(KitError::LoadDependsOnNumbering { unknown, place, before, after })
    }

    fn solution(&self, after: &Self, new: &[usize], tolerance: f64) -> Result<f64, KitError> {
        let (change, unknown) = largest_change(&self.solution, &after.solution, new);
        if change <= tolerance {
            return Ok(change);
        }
        let place = self.assembled.describe(unknown);
        let (before, after) = (self.solution[unknown], after.solution[new[unknown]]);
        Err(KitError::SolutionDependsOnNumbering { unknown, place, before, after })
    }
}

/// The largest change relative to the largest number, and where.
fn largest_change(before: &[f64], after: &[f64], new: &[usize]) -> (f64, usize) {
    let size = before.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    let mut largest = (0.0, 0);
    for (i, x) in before.iter().enumerate() {
        let change = (x - after[new[i]]).abs() / size;
        // written so that a number that is not finite is the largest
        if !(change <= largest.0 || largest.0.is_nan()) {
            largest = (change, i);
        }
    }
    largest
}

/// The largest change of an entry, relative to the size of its row and column.
fn matrix(
    before: &Assembled,
    after: &Assembled,
    new: &[usize],
    tolerance: f64,
) -> Result<f64, KitError> {
    let sizes = row_sizes(&before.matrix);
    let mut largest: f64 = 0.0;
    let mut compare = |row: usize, column: usize| {
        let entries = [before.matrix.get(row, column), after.matrix.get(new[row], new[column])];
        let change = (entries[0] - entries[1]).abs() / (sizes[row] * sizes[column]).sqrt();
        if change <= tolerance {
            largest = largest.max(change);
            return Ok(());
        }
        Err(KitError::EntryDependsOnNumbering {
            row,
            column,
            before: entries[0],
            after: entries[1],
            row_place: before.describe(row),
            column_place: before.describe(column),
        })
    };
    let mut old = vec![0; new.len()];
    for (i, &k) in new.iter().enumerate() {
        old[k] = i;
    }
    // entries of either pattern: one that only the other has must be zero
    for i in 0..new.len() {
        for &j in before.matrix.row(i).0 {
            compare(i, j as usize)?;
        }
        for &j in after.matrix.row(new[i]).0 {
            compare(i, old[j as usize])?;
        }
    }
    Ok(largest)
}
