use super::*;
use std::f64::consts::PI;
use std::sync::Arc;

/// The unit simplex.
fn corners<const D: usize>() -> [Point<D>; 4] {
    let mut corners = [Point::<D>::zeros(); 4];
    (0..D).for_each(|k| corners[k + 1][k] = 1.0);
    corners
}

/// The mean over the unit simplex of a function where the level is positive, zero elsewhere.
fn mean<const D: usize>(degree: usize, level: &Field<D>, value: impl Fn(&Point<D>) -> f64) -> f64 {
    let [mut all, mut within] = [0.0; 2];
    CutRule::new(D, degree).visit(&corners(), level, &mut |point, weight| {
        let x = in_space(point, &corners());
        all += weight;
        within += if level(&x) > 0.0 { weight * value(&x) } else { 0.0 };
    });
    assert!((all - 1.0_f64).abs() < 1e-13, "the weights sum to one");
    within
}

#[test]
fn a_sphere_is_resolved() {
    fn share<const D: usize>() -> f64 {
        mean::<D>(5, &(Arc::new(|x: &Point<D>| 0.5 - x.norm()) as Field<D>), |_| 1.0)
    }
    assert!((share::<1>() - 0.5).abs() < 1e-15);
    assert!((share::<2>() - PI / 8.0).abs() < 5e-4, "{:e}", share::<2>() - PI / 8.0);
    assert!((share::<3>() - PI / 8.0).abs() < 1.2e-2, "{:e}", share::<3>() - PI / 8.0);
}

#[test]
fn polynomials_between_planes_are_exact() {
    fn check<const D: usize>() {
        let level: Field<D> =
            Arc::new(|x| (0..D).map(|k| (k + 1) as f64 * x[k]).sum::<f64>() - 0.6);
        let cube = |x: &Point<D>| level(x).powi(3);
        let volume = mean::<D>(3, &level, cube);
        // the function less its negative part, which is -0.6 at the origin and fills the simplex
        // around it: the mean of a cube of a barycentric coordinate is 3! D! / (3 + D)!
        let corner = 0.6_f64.powi(3 + D as i32) / (1..=D).map(|k| k as f64).product::<f64>()
            * [0.0, 0.25, 0.1, 0.05][D];
        let all =
            Rule::new(D, 3).iter().map(|(b, w)| w * cube(&in_space(b, &corners()))).sum::<f64>();
        assert!((volume - all - corner).abs() < 1e-14, "{D}: {:e}", volume - all - corner);
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

/// The second rule is exact between planes, where it has fewer points, and bisects at jumps as the first one does.
#[test]
fn nearly_plane_zero_sets_need_no_bisections() {
    fn check<const D: usize>() {
        let points = |rule: CutRule, level: &Field<D>| {
            let (mut n, mut sums) = (0, [0.0; 2]);
            rule.visit(&corners(), level, &mut |point, weight| {
                let height = level(&in_space(point, &corners()));
                n += 1;
                sums[0] += weight;
                sums[1] += weight * height.max(0.0).powi(3);
            });
            (n, sums)
        };
        let rule = || CutRule::new(D, 9);
        let plane: Field<D> =
            Arc::new(|x| (0..D).map(|k| (k + 1) as f64 * x[k]).sum::<f64>() - 0.6);
        let (n, sums) = points(rule(), &plane);
        let (n_second, of_second) = points(rule().without_needless_bisections(), &plane);
        assert!(4 * n_second < n, "{n_second} {n}");
        for (a, b) in sums.iter().zip(of_second) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
        let jump: Field<D> = Arc::new(|x| if x[0] < 0.3 { -1.0 } else { 1.0 });
        assert_eq!(points(rule(), &jump), points(rule().without_needless_bisections(), &jump));
        let rule = rule().without_needless_bisections();
        assert_eq!(rule.sign_of_uncut(&corners(), &plane), None);
        let far: Field<D> = Arc::new(|x| x[0] - 2.0);
        assert_eq!(rule.sign_of_uncut(&corners(), &far), Some(false));
    }
    check::<2>();
    check::<3>();
}

#[test]
fn zeros_are_found_at_jumps_too_and_in_pairs() {
    let jump: Field<1> = Arc::new(|x| if x[0] < 0.123 { -1.0 } else { 1.0 });
    assert!((mean(1, &jump, |_| 1.0) - 0.877).abs() < 1e-14);
    let flat: Field<1> = Arc::new(|x| (x[0] - 0.3).powi(5));
    assert!((mean(1, &flat, |_| 1.0) - 0.7).abs() < 1e-14);
    let pair: Field<1> = Arc::new(|x| (x[0] - 0.6) * (x[0] - 0.3));
    assert!((mean(1, &pair, |_| 1.0) - 0.7).abs() < 1e-14);
}
