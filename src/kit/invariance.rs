//! Nothing depends on how vertices and cells are numbered.

use std::collections::HashMap;

use super::discrete::{Tested, assemble, solve};
use super::error::{Fault, KitErrorKind, Law};
use super::matrix::{describe, row_sizes};
use super::meshes::Sample;
use super::report::LawReport;
use super::{meshes, problems};
use crate::algebra::{DofLocation, Inequality};

/// Rounding units by which entries of matrix and load may change.
const ENTRY_UNITS: f64 = 512.0;
/// Rounding units by which unknowns may change, which condition magnifies.
const SOLUTION_UNITS: f64 = 8192.0;

/// When numbers change that must not.
const RENUMBERED: &str = "when vertices and cells are renumbered";

pub(super) fn check<const D: usize>(scheme: &Tested<'_, D>) -> Result<LawReport, Fault> {
    let sample = meshes::moved::<D>(&meshes::mixed(), meshes::subdivisions(D))?;
    let before = Numbered::new(scheme, &sample)?;
    let [mut matrix, mut load, mut solution]: [f64; 3] = [0.0; 3];
    for seed in [1, 2] {
        let (mesh, vertices, cells) = meshes::renumbered(&sample.mesh, seed)?;
        let after = Numbered::new(scheme, &Sample { name: "a renumbered box", mesh })?;
        let new = after.numbers_of(&before, &vertices, &cells)?;
        let tolerance = ENTRY_UNITS * f64::EPSILON;
        matrix = matrix.max(before.matrix(&after, &new, tolerance)?);
        let what = ("the load of", KitErrorKind::LoadDependsOnNumbering);
        let loads = [&before.load[..], &after.load];
        load = load.max(before.vector(what, loads, &new, tolerance)?);
        let tolerance = SOLUTION_UNITS * f64::EPSILON;
        let what = ("the solution at", KitErrorKind::SolutionDependsOnNumbering);
        let solutions = [&before.solution[..], &after.solution];
        solution = solution.max(before.vector(what, solutions, &new, tolerance)?);
    }
    let sentence = format!("matrix {matrix:.1e}, load {load:.1e}, solution {solution:.1e}");
    let figures = [("matrix", matrix), ("load", load), ("solution", solution)];
    Ok(LawReport::new(Law::Invariance, sentence, &figures))
}

/// A linear problem and its solution in one numbering.
struct Numbered {
    inequality: Inequality<f64>,
    load: Vec<f64>,
    solution: Vec<f64>,
}

/// The cell and the vertices of a location, in the numbers of the first mesh.
type Key = (Option<u32>, Vec<u32>);

fn key(location: &DofLocation, vertex: impl Fn(u32) -> u32, cell: impl Fn(u32) -> u32) -> Key {
    let mut vertices: Vec<u32> = location.vertices().iter().map(|&v| vertex(v)).collect();
    vertices.sort_unstable();
    (location.cell().map(cell), vertices)
}

impl Numbered {
    fn new<const D: usize>(scheme: &Tested<'_, D>, sample: &Sample<D>) -> Result<Self, Fault> {
        let inequality = assemble(scheme, &problems::rich(), &sample.mesh)?;
        let solution = solve(&inequality, sample)?;
        let load = inequality.assembled_load().into_owned();
        Ok(Self { inequality, load, solution })
    }

    /// The number here of every unknown there; vertices and cells have these numbers there.
    fn numbers_of(
        &self,
        there: &Self,
        vertices: &[u32],
        cells: &[u32],
    ) -> Result<Vec<usize>, Fault> {
        let error = |first, second, place| {
            let message = format!("unknowns {first} and {second} live at the same place, {place}");
            Fault::new(KitErrorKind::UnknownsNotTold, message)
        };
        let locations = &self.inequality.locations;
        let mut here = HashMap::with_capacity(locations.len());
        for (second, location) in locations.iter().enumerate() {
            let key = key(location, |v| vertices[v as usize], |c| cells[c as usize]);
            if let Some(first) = here.insert(key, second) {
                return Err(error(first, second, describe(&self.inequality, second)));
            }
        }
        // both meshes have the same locations, so that one that is not found is one that is there twice
        let find = |(first, location): (usize, &DofLocation)| {
            let number = here.remove(&key(location, |v| v, |c| c));
            number.ok_or_else(|| error(first, first, describe(&there.inequality, first)))
        };
        there.inequality.locations.iter().enumerate().map(find).collect()
    }

    /// The largest change of a vector, relative to its largest entry.
    fn vector(
        &self,
        (what, kind): (&str, KitErrorKind),
        [before, after]: [&[f64]; 2],
        new: &[usize],
        tolerance: f64,
    ) -> Result<f64, Fault> {
        let (change, unknown) = largest_change(before, after, new);
        if change <= tolerance {
            return Ok(change);
        }
        let message = format!(
            "{what} unknown {unknown} ({}) changes from {:.6e} to {:.6e} {RENUMBERED}",
            describe(&self.inequality, unknown),
            before[unknown],
            after[new[unknown]],
        );
        Err(Fault::new(kind, message))
    }

    /// The largest change of an entry of the matrix, relative to the size of its row and column.
    fn matrix(&self, after: &Self, new: &[usize], tolerance: f64) -> Result<f64, Fault> {
        let [before, other] = [self, after].map(|numbered| &numbered.inequality.matrix);
        let sizes = row_sizes(before);
        let mut largest: f64 = 0.0;
        let mut compare = |row: usize, column: usize| {
            let entries = [before.get(row, column), other.get(new[row], new[column])];
            let change = (entries[0] - entries[1]).abs() / (sizes[row] * sizes[column]).sqrt();
            if change <= tolerance {
                largest = largest.max(change);
                return Ok(());
            }
            let message = format!(
                "the entry at ({row}, {column}) changes from {:.6e} to {:.6e} {RENUMBERED}; row: {}; column: {}",
                entries[0],
                entries[1],
                describe(&self.inequality, row),
                describe(&self.inequality, column),
            );
            Err(Fault::new(KitErrorKind::EntryDependsOnNumbering, message))
        };
        let mut old = vec![0; new.len()];
        for (i, &k) in new.iter().enumerate() {
            old[k] = i;
        }
        // entries of either pattern: one that only the other has must be zero
        for i in 0..new.len() {
            for &j in before.row(i).0 {
                compare(i, j as usize)?;
            }
            for &j in other.row(new[i]).0 {
                compare(i, old[j as usize])?;
            }
        }
        Ok(largest)
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
