//! Small inequalities with known properties, and slow solvers that are easy to believe.

use unilateral::algebra::{Bound, Contact, Inequality, SparseMatrix};

/// The minimal standard generator: a few lines, the same numbers everywhere.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }
    /// Uniform in (0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    /// Uniform in (-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
}

/// A sparse matrix from dense rows.
pub fn sparse(dense: &[Vec<f64>]) -> SparseMatrix<f64> {
    let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
    for row in dense {
        for (j, &a) in row.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            matrix.columns.push(j as u32);
            matrix.values.push(a);
        }
        matrix.row_starts.push(matrix.columns.len() as u32);
    }
    matrix
}

pub fn inequality(
    matrix: SparseMatrix<f64>,
    load: &[f64],
    bounds: Vec<Bound<f64>>,
) -> Inequality<f64> {
    let load = load.to_vec();
    Inequality::new(matrix, true, load, bounds)
}

/// The five-point matrix of minus the Laplacian times `h^2` on `n x m` nodes.
pub fn laplacian(n: usize, m: usize, diagonal: f64) -> SparseMatrix<f64> {
    let mut matrix = SparseMatrix { row_starts: vec![0], columns: vec![], values: vec![] };
    for j in 0..m {
        for i in 0..n {
            let k = j * n + i;
            let neighbours = [
                (j > 0).then(|| k - n),
                (i > 0).then(|| k - 1),
                Some(k),
                (i + 1 < n).then_some(k + 1),
                (j + 1 < m).then_some(k + n),
            ];
            for column in neighbours.into_iter().flatten() {
                matrix.columns.push(column as u32);
                matrix.values.push(if column == k { diagonal } else { -1.0 });
            }
            matrix.row_starts.push(matrix.columns.len() as u32);
        }
    }
    matrix
}

/// A membrane on the unit square under load `-force`, `n x n` inner nodes, above an obstacle.
pub fn membrane(n: usize, force: f64, obstacle: impl Fn(f64, f64) -> f64) -> Inequality<f64> {
    let h = 1.0 / (n + 1) as f64;
    let node = |k: usize| ((k % n + 1) as f64 * h, (k / n + 1) as f64 * h);
    let bounds = (0..n * n)
        .map(|k| {
            let (x, y) = node(k);
            Bound::Lower(obstacle(x, y))
        })
        .collect();
    inequality(laplacian(n, n, 4.0), &vec![-force * h * h; n * n], bounds)
}

/// A random symmetric positive definite matrix, far from an M-matrix: of the given rank, and a
/// multiple of the identity.
pub fn random_definite(n: usize, rank: usize, shift: f64, random: &mut Random) -> Vec<Vec<f64>> {
    let b: Vec<Vec<f64>> = (0..n).map(|_| (0..rank).map(|_| random.signed()).collect()).collect();
    let entry = |i: usize, j: usize| {
        let product: f64 = (0..rank).map(|k| b[i][k] * b[j][k]).sum();
        product + if i == j { shift } else { 0.0 }
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// A random matrix dominant by rows, not symmetric: a P-matrix.
pub fn random_dominant(n: usize, random: &mut Random) -> Vec<Vec<f64>> {
    (0..n)
        .map(|i| {
            let mut row: Vec<f64> = (0..n).map(|_| random.signed()).collect();
            row[i] = 1.1 * row.iter().map(|a| a.abs()).sum::<f64>();
            row
        })
        .collect()
}

/// Piecewise linear functions on `cells` intervals of (0, 1), two values a cell, tied together and
/// to zero at the ends by `penalty` times the squared jump: badly conditioned, not an M-matrix.
pub fn penalised_string(cells: usize, penalty: f64) -> SparseMatrix<f64> {
    let stiffness = cells as f64;
    let n = 2 * cells;
    let mut dense = vec![vec![0.0; n]; n];
    for (k, row) in dense.iter_mut().enumerate() {
        let (inside, across) = match k % 2 {
            0 => (k + 1, k.checked_sub(1)),
            _ => (k - 1, Some(k + 1)),
        };
        row[k] = stiffness + penalty;
        row[inside] = -stiffness;
        if let Some(j) = across.filter(|&j| j < n) {
            row[j] = -penalty;
        }
    }
    sparse(&dense)
}

/// Bounds of all kinds.
pub fn random_bounds(n: usize, random: &mut Random) -> Vec<Bound<f64>> {
    (0..n)
        .map(|_| {
            let (a, b) = (random.signed(), random.unit());
            match (random.unit() * 6.0) as usize {
                0 => Bound::Free,
                1 => Bound::Fixed(a),
                2 => Bound::Lower(a),
                3 => Bound::Upper(a),
                4 => Bound::Both(a, a),
                _ => Bound::Both(a, a + b),
            }
        })
        .collect()
}

/// Projected Gauss-Seidel until nothing moves: converges for symmetric positive definite matrices
/// and for those dominant by rows.
pub fn projected_gauss_seidel(inequality: &Inequality<f64>) -> Vec<f64> {
    let n = inequality.size();
    let load = inequality.assembled_load();
    let mut u: Vec<f64> = inequality.bounds.iter().map(|bound| bound.nearest(0.0)).collect();
    for _ in 0..200_000 {
        let mut moved = 0.0_f64;
        for i in 0..n {
            let residual = inequality.matrix.row_dot(i, &u) - load[i];
            let x = inequality.bounds[i].nearest(u[i] - residual / inequality.matrix.get(i, i));
            moved = moved.max((x - u[i]).abs());
            u[i] = x;
        }
        if moved < 1e-15 {
            break;
        }
    }
    u
}

/// Gaussian elimination with partial pivoting.
fn eliminate(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let (above, below) = a.split_at_mut(i);
            let factor = below[0][k] / above[k][k];
            for (x, pivot) in below[0].iter_mut().zip(&above[k]).skip(k) {
                *x -= factor * pivot;
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        b[k] -= (k + 1..n).map(|j| a[k][j] * b[j]).sum::<f64>();
        b[k] /= a[k][k];
    }
    b
}

/// Whether the textbook active set method, `u >= 0`, cold, returns to a state it has left.
pub fn textbook_cycles(a: &[Vec<f64>], b: &[f64]) -> bool {
    let n = b.len();
    let mut state = vec![Contact::Inactive; n];
    let mut seen = vec![state.clone()];
    loop {
        let open: Vec<usize> = (0..n).filter(|&i| state[i] == Contact::Inactive).collect();
        let block = open.iter().map(|&i| open.iter().map(|&j| a[i][j]).collect()).collect();
        let solution = eliminate(block, open.iter().map(|&i| b[i]).collect());
        let mut u = vec![0.0; n];
        open.iter().zip(solution).for_each(|(&i, x)| u[i] = x);
        let next: Vec<Contact> = (0..n)
            .map(|i| {
                let force: f64 = (0..n).map(|j| a[i][j] * u[j]).sum::<f64>() - b[i];
                if if state[i] == Contact::Inactive { u[i] < 0.0 } else { force >= 0.0 } {
                    Contact::Lower
                } else {
                    Contact::Inactive
                }
            })
            .collect();
        if next == state {
            return false;
        }
        if seen.contains(&next) {
            return true;
        }
        seen.push(next.clone());
        state = next;
    }
}

/// The largest difference.
pub fn distance(u: &[f64], v: &[f64]) -> f64 {
    u.iter().zip(v).map(|(u, v)| (u - v).abs()).fold(0.0, f64::max)
}
