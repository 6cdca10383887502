//! Smoothers on more unknowns than a chunk has, between which an iteration is one of Jacobi.

use super::*;
use std::sync::Arc;
use unilateral::linear::{CoarseLevel, P1Level, Prolongation};

/// The least number of unknowns of a chunk.
pub const LENGTH: usize = 1 << 12;

/// The coupling of each unknown with all others at a distance of some chunks: so strong that Jacobi's iteration between
/// chunks diverges.
const COUPLING: f64 = 0.9;

/// The matrix of unknowns that are coupled across `n_chunks` chunks.
pub fn coupled_across(n_chunks: usize) -> Vec<BTreeMap<u32, f64>> {
    let entries = |i: usize| (0..n_chunks).map(move |chunk| chunk * LENGTH + i % LENGTH);
    let entry = |i: usize, j: usize| (j as u32, if i == j { 1.0 } else { COUPLING });
    (0..n_chunks * LENGTH).map(|i| entries(i).map(|j| entry(i, j)).collect()).collect()
}

/// Without a coarser level the preconditioner of so many unknowns is the smoother. Then no correction is longer than the
/// solution.
#[test]
fn strong_couplings_between_chunks_leave_the_smoother_positive() {
    let n_chunks = 6;
    let inequality = with_locations(from_rows(coupled_across(n_chunks)), Vec::new());
    let n = inequality.size();
    let spaces = CoarseSpaces::Unknown;
    let mut smoother = preconditioner(&inequality, &spaces).unwrap();
    smoother.set_fixed(&vec![false; n]).unwrap();
    check_symmetry(&mut *smoother, &vec![false; n]);
    let all = 1.0 + (n_chunks - 1) as f64 * COUPLING;
    for z in apply(&mut *smoother, &vec![1.0; n]) {
        assert!(z > 0.0 && z < 1.001 / all, "{z} {all}");
    }
    let r = residual(&vec![false; n], 5);
    let sum = |i: usize| (0..n_chunks).map(|chunk| r[chunk * LENGTH + i % LENGTH]).sum::<f64>();
    let solution: Vec<f64> =
        (0..n).map(|i| (r[i] - COUPLING / all * sum(i)) / (1.0 - COUPLING)).collect();
    let (found, most) = (dot(&r, &apply(&mut *smoother, &r)), dot(&r, &solution));
    assert!(found > 0.01 * most && found < 1.001 * most, "{found} {most}");
}

/// The coarser level has the same functions: its correction is symmetric if the forward iteration leaves the residual.
/// Chunks have different scales, because iterations and corrections that commute are symmetric whatever the residual is.
#[test]
fn the_residual_of_strong_couplings_between_chunks_is_that_of_the_values() {
    let mut rows = coupled_across(3);
    let scale = |i: usize| [1.0, 2.0, 0.5][i / LENGTH];
    for (i, row) in rows.iter_mut().enumerate() {
        row.iter_mut().for_each(|(&j, a)| *a *= scale(i) * scale(j as usize));
    }
    let matrix = from_rows(rows);
    let n = matrix.size();
    let level = Arc::new(P1Level::new(matrix.clone(), vec![false; n], None).unwrap());
    let all = Prolongation::midpoints(&(0..n as u32).map(|i| [i, i]).collect::<Vec<_>>(), n);
    let spaces = CoarseSpaces::CoarseLevel(CoarseLevel::new(level, Arc::new(all)).unwrap());
    let inequality = with_locations(matrix, Vec::new());
    let mut multigrid = preconditioner(&inequality, &spaces).unwrap();
    multigrid.set_fixed(&vec![false; n]).unwrap();
    check_symmetry(&mut *multigrid, &vec![false; n]);
}

/// Second differences with couplings of unknowns that are far from each other.
fn with_far_couplings(n: usize) -> SparseMatrix<f64> {
    let row = |i: usize| {
        let mut row = BTreeMap::from([(i as u32, 4.0), (((i + n / 2) % n) as u32, -0.5)]);
        row.insert(((i + n - n / 2) % n) as u32, -0.5);
        row.extend(i.checked_sub(1).map(|j| (j as u32, -1.0)));
        row.extend((i + 1 < n).then_some((i as u32 + 1, -1.0)));
        row
    };
    from_rows((0..n).map(row).collect())
}

/// The cycle is symmetric if the forward iteration leaves the residual of the values that it returns.
#[test]
fn smoothing_by_unknowns_between_chunks_leaves_the_cycle_symmetric() {
    let n = 2 * LENGTH + 1001;
    let parents = parents_in_a_row(n);
    let matrix = with_far_couplings(n);
    let n_coarse = n / 2 + 1;
    let level = galerkin(&matrix, &midpoints(&parents), n_coarse);
    let level = Arc::new(P1Level::new(level, vec![false; n_coarse], None).unwrap());
    let prolongation = Arc::new(Prolongation::midpoints(&parents, n_coarse));
    let spaces = CoarseSpaces::CoarseLevel(CoarseLevel::new(level, prolongation).unwrap());
    let inequality = with_locations(matrix, Vec::new());
    let mut multigrid = preconditioner(&inequality, &spaces).unwrap();
    for fixed in [vec![false; n], (0..n).map(|i| i % 7 == 3).collect()] {
        multigrid.set_fixed(&fixed).unwrap();
        assert!(check_symmetry(&mut *multigrid, &fixed) > 0.1);
        check_reduction(&inequality.matrix, &mut *multigrid, &fixed);
    }
}

/// Asserts that a correction leaves little of a residual.
fn check_reduction(
    matrix: &SparseMatrix<f64>,
    preconditioner: &mut dyn Preconditioner<f64>,
    fixed: &[bool],
) {
    let r = residual(fixed, 3);
    let mut after = r.clone();
    matrix.residual_f64(&r, &apply(preconditioner, &r), &mut after);
    after.iter_mut().zip(fixed).filter(|(_, fixed)| **fixed).for_each(|(r, _)| *r = 0.0);
    let norms = [&r, &after].map(|r| dot(r, r).sqrt());
    assert!(norms[1] < 0.3 * norms[0], "{norms:?}");
}

/// Cells of three unknowns, coupled to the next cell and to a far one.
fn by_cells(n_cells: usize) -> SparseMatrix<f64> {
    let coupling = |i: usize, j: usize| 0.3 * i as f64 - 0.2 * j as f64 - 0.1;
    let row = |row: usize| {
        let (cell, i) = (row / 3, row % 3);
        let mut cells = vec![cell, (cell + n_cells / 2) % n_cells];
        cells.extend(cell.checked_sub(1));
        cells.extend((cell + 1 < n_cells).then_some(cell + 1));
        let entry = |other: usize, j: usize| match other {
            _ if other == cell && i == j => 6.0,
            _ if other == cell => 0.5,
            _ if other < cell => coupling(i, j),
            _ => coupling(j, i),
        };
        let of_cell = |other: usize| (0..3).map(move |j| ((3 * other + j) as u32, entry(other, j)));
        cells.into_iter().flat_map(of_cell).collect()
    };
    from_rows((0..3 * n_cells).map(row).collect())
}

#[test]
fn smoothing_by_cells_between_chunks_leaves_the_cycle_symmetric() {
    let n_cells = 6000;
    let location =
        |i: usize| DofLocation::new(Some(i as u32 / 3), &[((i / 3 + i % 3) % n_cells) as u32]);
    let locations: Vec<DofLocation> = (0..3 * n_cells).map(location).collect();
    let matrix = by_cells(n_cells);
    let level = galerkin(&matrix, &means(&locations), n_cells);
    let level = P1Level::new(level, vec![false; n_cells], None).unwrap();
    let spaces = CoarseSpaces::SameMesh(Arc::new(level));
    let inequality = with_locations(matrix, locations);
    let n = inequality.size();
    let mut multigrid = preconditioner(&inequality, &spaces).unwrap();
    // the inverses of blocks for an earlier set of fixed unknowns must be replaced
    for fixed in [vec![false; n], (0..n).map(|i| i % 7 == 3).collect()] {
        multigrid.set_fixed(&fixed).unwrap();
        check_symmetry(&mut *multigrid, &fixed);
        check_reduction(&inequality.matrix, &mut *multigrid, &fixed);
    }
}
