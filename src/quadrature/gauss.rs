//! Gauss-Jacobi rules on the unit interval.

/// Nodes and weights of the rule with `n` points for the weight function `(a + 1) (1 - t)^a` on
/// (0, 1), exact to degree `2 n - 1`. The weights sum to one.
///
/// The nodes are found by Newton's method from Chebyshev points, on the Jacobi polynomial divided by
/// the roots found before; the weights follow from its derivative. Source: P. J. Davis, P. Rabinowitz, Methods of Numerical
/// Integration, 2nd ed., 1984, sections 2.7 and 6.
pub(super) fn gauss_jacobi(n: usize, a: usize) -> (Vec<f64>, Vec<f64>) {
    let a = a as f64;
    let mut roots: Vec<f64> = Vec::with_capacity(n);
    for k in 0..n {
        let mut x = ((2 * k + 1) as f64 * std::f64::consts::PI / (2 * n) as f64).cos();
        if let Some(previous) = roots.last() {
            x = 0.5 * (x + previous);
        }
        for _ in 0..100 {
            let (p, dp) = jacobi(n, a, x);
            let deflation: f64 = roots.iter().map(|r| 1.0 / (x - r)).sum();
            let step = p / (dp - p * deflation);
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        roots.push(x);
    }
    let raw: Vec<f64> = roots
        .iter()
        .map(|&x| {
            let derivative = jacobi(n, a, x).1;
            1.0 / ((1.0 - x * x) * derivative * derivative)
        })
        .collect();
    let total: f64 = raw.iter().sum();
    let nodes = roots.iter().rev().map(|x| 0.5 * (1.0 + x)).collect();
    let weights = raw.iter().rev().map(|w| w / total).collect();
    (nodes, weights)
}

/// The Jacobi polynomial `P_n^(a, 0)` and its derivative, by the three-term recurrence.
fn jacobi(n: usize, a: f64, x: f64) -> (f64, f64) {
    let (mut p0, mut d0) = (1.0, 0.0);
    let (mut p1, mut d1) = (0.5 * (a + (a + 2.0) * x), 0.5 * (a + 2.0));
    if n == 0 {
        return (p0, d0);
    }
    for k in 1..n {
        let m = k as f64;
        let s = 2.0 * m + a;
        let c1 = 2.0 * (m + 1.0) * (m + a + 1.0) * s;
        let c2 = (s + 1.0) * a * a;
        let c3 = s * (s + 1.0) * (s + 2.0);
        let c4 = 2.0 * (m + a) * m * (s + 2.0);
        let p2 = ((c2 + c3 * x) * p1 - c4 * p0) / c1;
        let d2 = ((c2 + c3 * x) * d1 + c3 * p1 - c4 * d0) / c1;
        (p0, d0, p1, d1) = (p1, d1, p2, d2);
    }
    (p1, d1)
}
