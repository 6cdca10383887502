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
    pub discretisation: Discretisation<'a, D>,
    pub inequality: Inequality<f64>,
}

impl<'a, const D: usize> Assembled<'a, D> {
    pub fn new(scheme: &dyn Scheme<D>, problem: &'a Problem<D>, mesh: &'a Mesh<D>) -> Self {
        let quadrature = DataQuadrature::default();
        let discretisation = Discretisation::new(scheme, problem, mesh, quadrature).unwrap();
        let inequality = discretisation.inequality().unwrap();
        Self { discretisation, inequality }
    }
    /// The number that each unknown of a part has here.
    pub fn numbers_of(&self, part: &Part<D>, on_part: &Discretisation<'_, D>) -> Vec<usize> {
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

/// The bits of a number, exactly converted to `f64`.
fn bits(x: f64) -> u64 {
    x.to_bits()
}

fn bits_of_bound(bound: &Bound<f64>) -> [Option<u64>; 3] {
    let fixed = if let Bound::Fixed(x) = bound { Some(bits(*x)) } else { None };
    [fixed, bound.lower().map(bits), bound.upper().map(bits)]
}

/// Compares all parts of a mesh with the whole.
pub fn differences<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    (parts, layers): (usize, Layers),
) -> Differences {
    let owners = mesh.partition(parts).unwrap();
    let part = |number| mesh.part(&owners, number, layers).unwrap();
    let parts: Vec<_> = (0..parts as u32).map(part).collect();
    differences_of(scheme, problem, mesh, &owners, &parts)
}

/// Compares parts of a mesh with the whole, given the owners of its cells.
pub fn differences_of<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    owners: &[u32],
    parts: &[Part<D>],
) -> Differences {
    let whole = Assembled::new(scheme, problem, mesh);
    let all = &whole.inequality;
    let owner_of = whole.discretisation.owners(owners);
    let x: Vec<f64> = some_values(all.size());
    let mut residual = vec![0.0; all.size()];
    all.residual_f64(&x, &mut residual);
    let mut found = Differences::default();
    for part in parts {
        let number = part.number;
        let Assembled { discretisation, inequality } = Assembled::new(scheme, problem, &part.mesh);
        let numbers = whole.numbers_of(part, &discretisation);
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
                found.values += usize::from(pairs().any(|(&a, &b)| bits(a) != bits(b)));
            }
            found.loads += usize::from(bits(inequality.load[i]) != bits(all.load[k]));
            found.residuals += usize::from(bits(on_part[i]) != bits(residual[k]));
            let bounds = [&inequality.bounds[i], &all.bounds[k]].map(bits_of_bound);
            found.bounds += usize::from(bounds[0] != bounds[1]);
        }
    }
    found
}

/// Holds all parts of a mesh to the bits of the whole, with the layers that the scheme asks for.
#[track_caller]
pub fn same_bits<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    parts: usize,
) {
    let layers = scheme.layers(mesh);
    let found = differences(scheme, problem, mesh, (parts, layers));
    let quadrature = DataQuadrature::default();
    let unknowns = Discretisation::new(scheme, problem, mesh, quadrature).unwrap().unknowns();
    let label = scheme.label_on(problem.constraint_set());
    assert_eq!(found, Differences::only_rows(unknowns), "{label}, {parts} parts, {layers:?}");
}
