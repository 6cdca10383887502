//! A scheme on a part, and on the whole mesh.

use unilateral::algebra::{Bound, Inequality};
use unilateral::assemble::DataQuadrature;
use unilateral::mesh::{Layers, Part};
use unilateral::prelude::*;

/// Values of unknowns without any regularity.
pub fn some_values(n: usize) -> Vec<f64> {
    (0..n).map(|i| ((i * 7919 % 1013) as f64 / 1013.0 * 6.0).sin()).collect()
}

/// A discretisation with its inequality.
pub struct Assembled<'a, const D: usize> {
    pub discretisation: Discretisation<'a, f64, D>,
    pub inequality: Inequality<f64>,
}

impl<'a, const D: usize> Assembled<'a, D> {
    pub fn new(
        scheme: &dyn AnyScheme<f64, D>,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<f64, D>,
    ) -> Self {
        let quadrature = DataQuadrature::default();
        let discretisation = Discretisation::new(scheme, problem, mesh, quadrature).unwrap();
        let inequality = discretisation.inequality().unwrap();
        Self { discretisation, inequality }
    }
    /// The number that each unknown of a part has here.
    pub fn numbers_of(
        &self,
        part: &Part<f64, D>,
        on_part: &Discretisation<'_, f64, D>,
    ) -> Vec<usize> {
        let mut numbers = vec![usize::MAX; on_part.unknowns()];
        for (cell, &whole) in part.cells.iter().enumerate() {
            let own = on_part.unknowns_of(cell);
            for (own, whole) in own.zip(self.discretisation.unknowns_of(whole as usize)) {
                assert!([usize::MAX, whole].contains(&numbers[own]));
                numbers[own] = whole;
            }
        }
        numbers
    }
}

/// Numbers of rows of own unknowns with other columns or bits than on the whole mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Differences {
    /// Rows compared.
    pub rows: usize,
    pub columns: usize,
    pub values: usize,
    pub loads: usize,
    pub bounds: usize,
    pub residuals: usize,
}

impl Differences {
    pub fn only_rows(rows: usize) -> Self {
        Self { rows, ..Self::default() }
    }
}

fn bits(bound: &Bound<f64>) -> [Option<u64>; 3] {
    let fixed = if let Bound::Fixed(x) = bound { Some(x.to_bits()) } else { None };
    [fixed, bound.lower().map(f64::to_bits), bound.upper().map(f64::to_bits)]
}

/// Compares all parts of a mesh with the whole.
pub fn differences<const D: usize>(
    scheme: &dyn AnyScheme<f64, D>,
    problem: &Problem<D>,
    mesh: &Mesh<f64, D>,
    (parts, layers): (usize, Layers),
) -> Differences {
    let owners = mesh.partition(parts).unwrap();
    let whole = Assembled::new(scheme, problem, mesh);
    let all = &whole.inequality;
    let owner_of = whole.discretisation.owners(&owners);
    let x = some_values(all.size());
    let mut residual = vec![0.0; all.size()];
    all.residual_f64(&x, &mut residual);
    let mut found = Differences::default();
    for number in 0..parts as u32 {
        let part = mesh.part(&owners, number, layers).unwrap();
        let Assembled { discretisation, inequality } = Assembled::new(scheme, problem, &part.mesh);
        let numbers = whole.numbers_of(&part, &discretisation);
        let values: Vec<f64> = numbers.iter().map(|&k| x[k]).collect();
        let mut on_part = vec![0.0; values.len()];
        inequality.residual_f64(&values, &mut on_part);
        for (i, owner) in discretisation.owners(&part.owners).into_iter().enumerate() {
            if owner != number {
                continue;
            }
            let k = numbers[i];
            found.rows += usize::from(owner_of[k] == number);
            let (columns, entries) = inequality.matrix.row(i);
            let (whole_columns, whole_entries) = all.matrix.row(k);
            let columns = columns.iter().map(|&j| numbers[j as usize]);
            if !columns.eq(whole_columns.iter().map(|&j| j as usize)) {
                found.columns += 1;
            } else {
                let pairs = || entries.iter().zip(whole_entries);
                found.values += usize::from(pairs().any(|(a, b)| a.to_bits() != b.to_bits()));
            }
            let other = |a: f64, b: f64| usize::from(a.to_bits() != b.to_bits());
            found.loads += other(inequality.load[i], all.load[k]);
            found.residuals += other(on_part[i], residual[k]);
            let same_bounds = bits(&inequality.bounds[i]) == bits(&all.bounds[k]);
            found.bounds += usize::from(!same_bounds);
        }
    }
    found
}

/// Holds all parts of a mesh to the bits of the whole, with the layers that the scheme asks for.
#[track_caller]
pub fn same_bits<const D: usize>(
    scheme: &dyn AnyScheme<f64, D>,
    problem: &Problem<D>,
    mesh: &Mesh<f64, D>,
    parts: usize,
) {
    let layers = scheme.layers(mesh);
    let found = differences(scheme, problem, mesh, (parts, layers));
    let quadrature = DataQuadrature::default();
    let unknowns = Discretisation::new(scheme, problem, mesh, quadrature).unwrap().unknowns();
    let label = scheme.label_on(problem.constraint_set());
    assert_eq!(found, Differences::only_rows(unknowns), "{label}, {parts} parts, {layers:?}");
}
