//! Condition numbers of schemes and of the over-penalty's preconditioners against those of an
//! independent implementation, and the penalties from which interior penalty is coercive.

use crate::support::checks::Checks;
use crate::support::schemes::{sipg, wopsip};
use unilateral::algebra::{Inequality, SparseMatrix};
use unilateral::kit::spectrum::{MeanJump, extreme_eigenvalues};
use unilateral::linear::is_positive_definite;
use unilateral::mesh::BoxDomain;
use unilateral::mesh::Mesh;
use unilateral::prelude::*;

/// The unit cube, Dirichlet everywhere.
fn cube<const D: usize>(counts: [usize; D]) -> Mesh<D> {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Mesh::kuhn_box(&domain, counts).unwrap()
}

fn assemble<const D: usize, S: Scheme<D>>(scheme: &S, mesh: &Mesh<D>) -> Inequality<f64> {
    assemble_on(scheme, Nodes, mesh)
}

/// In the basis of a constraint set.
fn assemble_on<const D: usize, S: Scheme<D>>(
    scheme: &S,
    set: impl ConstraintSet + 'static,
    mesh: &Mesh<D>,
) -> Inequality<f64> {
    let problem = Problem::new().on(set);
    let quadrature = Default::default();
    unilateral::assemble::Discretisation::new(scheme, &problem, mesh, quadrature)
        .unwrap()
        .inequality()
        .unwrap()
}

/// The rows and columns of the unknowns that are not given.
fn free_part(inequality: &Inequality<f64>) -> SparseMatrix<f64> {
    let free = |i: usize| inequality.bounds[i].fixed_value().is_none();
    let mut number = vec![u32::MAX; inequality.size()];
    let kept = (0..inequality.size()).filter(|&i| free(i));
    kept.enumerate().for_each(|(k, i)| number[i] = k as u32);
    let mut out = SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() };
    for i in (0..inequality.size()).filter(|&i| free(i)) {
        let (columns, values) = inequality.matrix.row(i);
        for (&j, &a) in columns.iter().zip(values) {
            if number[j as usize] != u32::MAX {
                out.columns.push(number[j as usize]);
                out.values.push(a);
            }
        }
        out.row_starts.push(out.columns.len() as u32);
    }
    out
}

/// The block diagonal of a matrix in means and jumps: all of it among means, its diagonal among jumps.
fn block_diagonal(matrix: &SparseMatrix<f64>, means: usize) -> SparseMatrix<f64> {
    let mut out = SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() };
    for i in 0..matrix.size() {
        let (columns, values) = matrix.row(i);
        for (&j, &a) in columns.iter().zip(values) {
            if i.max(j as usize) < means || i == j as usize {
                out.columns.push(j);
                out.values.push(a);
            }
        }
        out.row_starts.push(out.columns.len() as u32);
    }
    out
}

/// The condition number of `B^-1 A`.
fn condition(a: &SparseMatrix<f64>, b: &SparseMatrix<f64>) -> f64 {
    // eigenvalues cluster about one where the blocks precondition well
    extreme_eigenvalues(a, b, 1e-8).unwrap().condition()
}

fn plain(matrix: &SparseMatrix<f64>) -> f64 {
    condition(matrix, &SparseMatrix::from_diagonal(vec![1.0; matrix.size()]))
}

/// Condition numbers of the over-penalised matrix: as it is in the basis of vertices, with the
/// diagonal in means and jumps, with the block diagonal.
fn over_penalised<const D: usize>(mesh: &Mesh<D>, eta: f64) -> [f64; 3] {
    let on_vertices = assemble(&wopsip(eta), mesh).matrix;
    let change = MeanJump::new(mesh);
    let matrix = change.transform(&assemble_on(&wopsip(eta), FacetMeans, mesh).matrix);
    let diagonal = SparseMatrix::from_diagonal(matrix.diagonal());
    let blocks = block_diagonal(&matrix, change.means());
    [plain(&on_vertices), condition(&matrix, &diagonal), condition(&matrix, &blocks)]
}

/// A row of the table of the independent implementation: over-penalty with factor one as it is,
/// with its two preconditioners, interior penalty with `10 / h_F`, Crouzeix-Raviart.
fn row<const D: usize>(checks: &mut Checks, n: usize, printed: [&str; 5]) {
    let mesh = cube([n; D]);
    let [a, b1, b2] = over_penalised(&mesh, 1.0);
    let interior = plain(&assemble(&sipg(10.0), &mesh).matrix);
    let means = plain(&free_part(&assemble(&NonconformingP1, &mesh)));
    let ours = [a, b1, b2, interior, means];
    let names = ["over-penalty", "diagonal", "block diagonal", "interior penalty", "means"];
    for ((name, ours), printed) in names.into_iter().zip(ours).zip(printed) {
        checks.printed(&format!("{D}D, n = {n}, {name}"), ours, printed, 0.5);
    }
}

#[test]
fn on_intervals() {
    let mut checks = Checks::default();
    row::<1>(&mut checks, 16, ["2.687e4", "1.035e2", "1.1552", "1.040e3", "1.031e2"]);
    row::<1>(&mut checks, 64, ["6.804e6", "1.660e3", "1.0367", "1.660e4", "1.659e3"]);
    row::<1>(&mut checks, 256, ["1.741e9", "2.656e4", "1.0091", "2.656e5", "2.656e4"]);
    checks.finish();
}

#[test]
fn on_squares() {
    let mut checks = Checks::default();
    row::<2>(&mut checks, 8, ["2.323e3", "1.083e2", "1.6959", "3.945e2", "1.162e2"]);
    row::<2>(&mut checks, 16, ["3.479e4", "4.194e2", "1.3133", "1.561e3", "4.664e2"]);
    // the other implementation prints 1.1481 for the third, which is 1.148157: definiteness below
    // says the same
    row::<2>(&mut checks, 32, ["5.472e5", "1.664e3", "1.1482", "6.230e3", "1.867e3"]);
    checks.finish();
}

#[test]
#[ignore = "takes long"]
fn on_a_fine_square() {
    let mut checks = Checks::default();
    row::<2>(&mut checks, 64, ["8.718e6", "6.644e3", "1.0720", "2.490e4", "7.470e3"]);
    checks.finish();
}

#[test]
fn on_cubes() {
    let mut checks = Checks::default();
    row::<3>(&mut checks, 2, ["1.782e1", "5.665e1", "15.41", "4.493e1", "1.639e1"]);
    row::<3>(&mut checks, 4, ["1.249e2", "9.734e1", "5.461", "1.182e2", "6.613e1"]);
    checks.finish();
}

#[test]
#[ignore = "takes long"]
fn on_a_fine_cube() {
    let mut checks = Checks::default();
    row::<3>(&mut checks, 8, ["1.290e3", "2.716e2", "2.537", "4.130e2", "2.654e2"]);
    checks.finish();
}

/// The preconditioned numbers are bounded in the factor, that of the matrix is not.
#[test]
fn over_factors() {
    let mut checks = Checks::default();
    let mesh = cube([16; 2]);
    for (eta, printed) in [
        (1e-4, ["9.36e3", "3.31e4", "930"]),
        (1e-2, ["6.91e2", "8.28e2", "10.0"]),
        (1.0, ["3.48e4", "4.19e2", "1.313"]),
        (1e2, ["3.44e6", "4.14e2", "1.028"]),
        (1e4, ["3.44e8", "4.14e2", "1.0027"]),
    ] {
        let names = ["over-penalty", "diagonal", "block diagonal"];
        for ((name, ours), printed) in names.iter().zip(over_penalised(&mesh, eta)).zip(printed) {
            checks.printed(&format!("eta = {eta}, {name}"), ours, printed, 0.5);
        }
    }
    checks.finish();
}

/// Eigenvalues against the definiteness of `A - t B`, a method that has nothing in common with the
/// other: `t` just below the smallest leaves a definite matrix, just above it does not; so does
/// `t B - A` at the largest.
#[test]
fn eigenvalues_are_where_definiteness_ends() {
    fn on<const D: usize>(checks: &mut Checks, mesh: &Mesh<D>, accuracy: f64) {
        let change = MeanJump::new(mesh);
        let matrix = change.transform(&assemble_on(&wopsip(1.0), FacetMeans, mesh).matrix);
        let blocks = block_diagonal(&matrix, change.means());
        let found = extreme_eigenvalues(&matrix, &blocks, 1e-10).unwrap();
        // the blocks have the pattern of the matrix or less
        let definite = |sign: f64, shift: f64| {
            let mut shifted = matrix.clone();
            for i in 0..matrix.size() {
                for k in matrix.row_starts[i] as usize..matrix.row_starts[i + 1] as usize {
                    let b = blocks.get(i, matrix.columns[k] as usize);
                    shifted.values[k] = sign * (matrix.values[k] - shift * b);
                }
            }
            definite(&shifted)
        };
        let (below, above) = (1.0 - accuracy, 1.0 + accuracy);
        let [smallest, largest] = [found.smallest, found.largest];
        let what = format!("{D}D, {} unknowns, {found:?}", matrix.size());
        checks.that(definite(1.0, smallest * below), || format!("{what}: smallest too large"));
        checks.that(!definite(1.0, smallest * above), || format!("{what}: smallest too small"));
        checks.that(definite(-1.0, largest * above), || format!("{what}: largest too small"));
        checks.that(!definite(-1.0, largest * below), || format!("{what}: largest too large"));
    }
    let mut checks = Checks::default();
    on(&mut checks, &cube([256]), 1e-8);
    on(&mut checks, &cube([32; 2]), 1e-8);
    on(&mut checks, &cube([4; 3]), 1e-8);
    checks.finish();
}

fn definite(matrix: &SparseMatrix<f64>) -> bool {
    let all: Vec<u32> = (0..matrix.size() as u32).collect();
    is_positive_definite(matrix, true, &all).unwrap()
}

/// The number from which interior penalty with a rule is positive definite, to a relative 1e-6.
fn threshold<const D: usize>(mesh: &Mesh<D>, rule: impl Fn(f64) -> PenaltyRule) -> f64 {
    let enough = |x: f64| definite(&assemble(&Sipg { penalty: rule(x) }, mesh).matrix);
    let (mut below, mut above) = (0.0, 1.0);
    while !enough(above) {
        (below, above) = (above, 2.0 * above);
    }
    while above - below > 1e-6 * above {
        let middle = 0.5 * (below + above);
        if enough(middle) { above = middle } else { below = middle }
    }
    above
}

/// Thresholds of `factor / h_F`, and of the proven bound in units of itself.
#[test]
fn interior_penalty_is_coercive_from_a_threshold_on() {
    fn on<const D: usize>(checks: &mut Checks, mesh: &Mesh<D>, printed: [&str; 2], n: &str) {
        let factor = threshold(mesh, PenaltyRule::Diameter);
        let share = threshold(mesh, |share| PenaltyRule::Proven(share - 1.0));
        checks.printed(&format!("{D}D, n = {n}, factor"), factor, printed[0], 0.5);
        checks.printed(&format!("{D}D, n = {n}, share"), share, printed[1], 0.5);
        // what is proven to be enough is enough
        checks.that(share <= 1.0 + 1e-6, || format!("{D}D, n = {n}: {share} of the bound"));
    }
    let mut checks = Checks::default();
    on(&mut checks, &cube([16]), ["1.3333", "1.0000"], "16");
    on(&mut checks, &cube([10; 2]), ["3.00", "0.6955"], "10");
    on(&mut checks, &cube([3; 3]), ["5.00", "0.383"], "3");
    // stretched cells: the factor grows with the aspect ratio, the share tends to one; the other
    // implementation prints 2.97 for the first factor, which is 2.9648
    on(&mut checks, &cube([4, 4]), ["2.965", "0.648"], "4 x 4");
    on(&mut checks, &cube([4, 16]), ["9.14", "0.859"], "4 x 16");
    on(&mut checks, &cube([4, 64]), ["36.4", "0.963"], "4 x 64");
    on(&mut checks, &cube([2, 128]), ["132.9", "0.987"], "2 x 128");
    checks.finish();
}
