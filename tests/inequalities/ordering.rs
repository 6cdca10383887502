//! Orders of elimination: permutations of whatever they are given, and of less fill than minimum
//! degree where they are chosen.

use std::time::Instant;

use proptest::prelude::*;
use unilateral::algebra::{Inequality, SparseMatrix};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{ActiveSet, InequalitySolver};
use unilateral::linear::{EliminationOrder, Factors, LinearMethod};
use unilateral::prelude::*;
use unilateral::real::Point;

use crate::problems::{Random, laplacian, sparse};

/// The inequality as it is assembled, and the points of all vertices.
fn with_vertices<const D: usize, S: Scheme<f64, D>>(
    scheme: &S,
    n: usize,
) -> (Inequality<f64>, Vec<[f32; 3]>) {
    let scene = scenes::radial::<D>(1.0);
    let mesh = scene.domain.mesh::<f64>(n).unwrap();
    let quadrature = DataQuadrature::default();
    let space = Discretisation::new(scheme, &scene.problem, &mesh, quadrature).unwrap();
    let point = |x: &Point<f64, D>| [0, 1, 2].map(|k| x.get(k).map_or(0.0, |&x| x as f32));
    (space.inequality().unwrap(), mesh.vertices().iter().map(point).collect())
}

/// An inequality that has points, also where it has no use for them.
fn assembled<const D: usize, S: Scheme<f64, D>>(scheme: &S, n: usize) -> Inequality<f64> {
    let (inequality, points) = with_vertices::<D, _>(scheme, n);
    inequality.with_points(points)
}

/// The unknowns that are not given.
fn kept(inequality: &Inequality<f64>) -> Vec<u32> {
    let is_open = |&i: &u32| inequality.bounds[i as usize].fixed_value().is_none();
    (0..inequality.size() as u32).filter(is_open).collect()
}

/// The barycentres of unknowns.
fn points(inequality: &Inequality<f64>) -> Vec<[f32; 3]> {
    let mean = |vertices: &[u32]| {
        let sum = |k| vertices.iter().map(|&v| inequality.points[v as usize][k]).sum::<f32>();
        [0, 1, 2].map(|k| sum(k) / vertices.len() as f32)
    };
    inequality.supports.iter().map(|place| mean(place.vertices())).collect()
}

/// A matrix with a heavy diagonal and the edges given, both ways.
fn graph(n: usize, edges: &[(usize, usize)]) -> SparseMatrix<f64> {
    let mut dense = vec![vec![0.0; n]; n];
    for &(i, j) in edges.iter().filter(|(i, j)| i != j) {
        (dense[i][j], dense[j][i]) = (-1.0, -1.0);
    }
    (0..n).for_each(|i| dense[i][i] = n as f64);
    sparse(&dense)
}

fn assert_permutation(order: &EliminationOrder, kept: &[u32]) {
    let mut sorted = order.unknowns().to_vec();
    sorted.sort_unstable();
    assert_eq!(sorted, kept);
}

fn dissect(matrix: &SparseMatrix<f64>, points: &[[f32; 3]]) -> Vec<u32> {
    let all: Vec<u32> = (0..matrix.size() as u32).collect();
    let order = EliminationOrder::by_dissection(matrix, &all, points);
    assert_permutation(&order, &all);
    order.unknowns().to_vec()
}

/// The solution for a load without structure.
fn solve(factors: &Factors<f64>) -> Vec<f64> {
    let mut random = Random::new(3);
    let mut x: Vec<f64> = (0..factors.size()).map(|_| random.signed()).collect();
    factors.solve_in_place(&mut x, 1);
    x
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the graph and wherever its nodes: a permutation, and factors of the same matrix.
    #[test]
    fn any_graph_is_permuted(
        n in 1_usize..150,
        edges in prop::collection::vec((0_usize..150, 0_usize..150), 0..600),
        lattice in prop::collection::vec([0_u8..4, 0_u8..4, 0_u8..4], 150),
        modulus in 1_usize..4,
    ) {
        let edges: Vec<_> = edges.into_iter().map(|(i, j)| (i % n, j % n)).collect();
        let matrix = graph(n, &edges);
        let points: Vec<[f32; 3]> = lattice.iter().map(|x| x.map(f32::from)).collect();
        dissect(&matrix, &points);
        let kept: Vec<u32> = (0..n as u32).filter(|i| !i.is_multiple_of(modulus as u32 + 1)).collect();
        let order = EliminationOrder::by_dissection(&matrix, &kept, &points);
        assert_permutation(&order, &kept);
        assert_permutation(&EliminationOrder::by_degree(&matrix, &kept).unwrap(), &kept);
        let free: Vec<u32> = (0..n as u32).filter(|i| i % 3 != 1).collect();
        let x = solve(&Factors::in_order(&matrix, &free, &order).unwrap());
        let y = solve(&Factors::new(&matrix, true, &free).unwrap());
        for (x, y) in x.iter().zip(&y) {
            prop_assert!((x - y).abs() <= 1e-12, "{x} {y}");
        }
    }
}

#[test]
fn nothing_and_one_unknown() {
    let empty = graph(0, &[]);
    assert!(dissect(&empty, &[]).is_empty());
    assert!(EliminationOrder::new(&empty, &[], Some(&[])).unwrap().unknowns().is_empty());
    let order = EliminationOrder::by_dissection(&graph(3, &[(0, 1)]), &[], &[[0.0; 3]; 3]);
    assert!(order.unknowns().is_empty());
    let factors = Factors::in_order(&graph(3, &[]), &[], &order).unwrap();
    assert_eq!((factors.size(), factors.entries()), (0, 0));
    assert_eq!(dissect(&graph(1, &[]), &[[0.5; 3]]), [0]);
}

/// Coincident points, points that are no numbers, points on a line, and edges without regard to
/// points: fill may be what it will.
#[test]
fn points_that_tell_nothing() {
    let matrix = laplacian::<f64>(30, 30, 4.0);
    let mut random = Random::new(5);
    let all: Vec<u32> = (0..900).collect();
    let expected = solve(&Factors::new(&matrix, true, &all).unwrap());
    let scale = expected.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    let clouds: [Vec<[f32; 3]>; 5] = [
        vec![[0.5; 3]; 900],
        vec![[f32::NAN; 3]; 900],
        (0..900).map(|i| [i as f32, 0.0, 0.0]).collect(),
        (0..900).map(|i| [0.0, -(i as f32), i as f32]).collect(),
        (0..900).map(|_| [0; 3].map(|_| random.unit() as f32)).collect(),
    ];
    for points in clouds {
        dissect(&matrix, &points);
        let order = EliminationOrder::by_dissection(&matrix, &all, &points);
        let x = solve(&Factors::in_order(&matrix, &all, &order).unwrap());
        for (x, y) in x.iter().zip(&expected) {
            assert!((x - y).abs() <= 1e-12 * scale, "{x} {y}");
        }
    }
}

/// Two grids without an edge between them, side by side and one in the other.
#[test]
fn disconnected_graphs() {
    let grid = laplacian::<f64>(20, 20, 4.0);
    let mut two = grid.clone();
    let entries = *grid.row_starts.last().unwrap();
    two.row_starts.extend(grid.row_starts[1..].iter().map(|start| start + entries));
    two.columns.extend(grid.columns.iter().map(|j| j + 400));
    two.values.extend(&grid.values);
    for gap in [0.0, 0.5, 100.0] {
        let point =
            |i: usize| [(i % 20) as f32 + (i / 400) as f32 * gap, (i / 20 % 20) as f32, 0.0];
        dissect(&two, &(0..800).map(point).collect::<Vec<_>>());
    }
    // two planes of a grid cannot be told apart by order alone
    let all: Vec<u32> = (0..800).collect();
    let apart: Vec<[f32; 3]> = (0..800)
        .map(|i| [(i % 20) as f32 + (i / 400) as f32 * 100.0, (i / 20 % 20) as f32, 0.0])
        .collect();
    let half: Vec<u32> = (0..400).collect();
    let entries = |matrix: &SparseMatrix<f64>, all: &[u32], points: &[[f32; 3]]| {
        let order = EliminationOrder::by_dissection(matrix, all, points);
        Factors::in_order(matrix, all, &order).unwrap().entries()
    };
    assert_eq!(entries(&two, &all, &apart), 2 * entries(&grid, &half, &apart));
}

/// Unknowns with the same row stay together.
#[test]
fn cells_are_not_taken_apart() {
    let inequality = assembled::<2, _>(&Sipg::default(), 16);
    let order = dissect(&inequality.matrix, &points(&inequality));
    for cell in order.chunks(3) {
        assert_eq!(cell, [0, 1, 2].map(|k| cell[0] + k));
    }
}

/// Numbers that factors of a matrix store in the two orders.
fn fill(inequality: &Inequality<f64>) -> [usize; 2] {
    let (matrix, kept) = (&inequality.matrix, kept(inequality));
    let dissection = EliminationOrder::by_dissection(matrix, &kept, &points(inequality));
    let degree = EliminationOrder::by_degree(matrix, &kept).unwrap();
    let factors =
        [dissection, degree].map(|order| Factors::in_order(matrix, &kept, &order).unwrap());
    let scale = solve(&factors[0]).iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    for (x, y) in solve(&factors[0]).iter().zip(solve(&factors[1])) {
        assert!((x - y).abs() <= 1e-10 * scale, "{x} {y}");
    }
    factors.map(|factors| factors.entries())
}

/// In the plane as much fill as with minimum degree, in space a fifth less at 3375 unknowns.
#[test]
fn fill_is_less_in_space() {
    let [dissection, degree] = fill(&assembled::<2, _>(&ConformingP1, 64));
    assert!(dissection as f64 <= 1.03 * degree as f64, "{dissection} {degree}");
    let [dissection, degree] = fill(&assembled::<3, _>(&ConformingP1, 16));
    assert!(dissection as f64 <= 0.85 * degree as f64, "{dissection} {degree}");
}

/// Points are there where an order is found by them.
#[test]
fn points_are_assembled_where_they_are_used() {
    let (in_space, vertices) = with_vertices::<3, _>(&ConformingP1, 3);
    assert_eq!(in_space.points, vertices);
    let (broken, vertices) = with_vertices::<2, _>(&Sipg::default(), 3);
    assert_eq!(broken.points, vertices);
    assert!(with_vertices::<2, _>(&ConformingP1, 3).0.points.is_empty());
}

/// What an order knows of a larger matrix is passed over, and too few points are none.
#[test]
fn orders_and_points_of_other_matrices() {
    let [large, small] = [60, 50].map(|m| laplacian::<f64>(50, m, 4.0));
    let [all, some] = [3000, 2500].map(|n| (0..n).collect::<Vec<u32>>());
    let order = EliminationOrder::by_degree(&large, &all).unwrap();
    let x = solve(&Factors::in_order(&small, &some, &order).unwrap());
    let y = solve(&Factors::new(&small, true, &some).unwrap());
    let scale = y.iter().fold(0.0, |s: f64, y| s.max(y.abs()));
    for (x, y) in x.iter().zip(&y) {
        assert!((x - y).abs() <= 1e-12 * scale, "{x} {y}");
    }
    // depth that tells nothing of the matrix makes it one in space
    let points: Vec<_> = (0..2500).map(|i| [i % 50, i / 50, i % 7].map(|x| x as f32)).collect();
    let order = |points| EliminationOrder::new(&small, &some, points).unwrap().unknowns().to_vec();
    assert_eq!(order(Some(&points[1..])), order(None));
    assert_ne!(order(Some(&points)), order(None));
}

/// Dissection is chosen in space and for broken spaces, for systems large enough and with points.
#[test]
fn the_choice() {
    let is_dissected = |inequality: &Inequality<f64>, known: bool| {
        let (matrix, kept, points) = (&inequality.matrix, kept(inequality), points(inequality));
        let order = EliminationOrder::new(matrix, &kept, known.then_some(&points)).unwrap();
        let dissected = EliminationOrder::by_dissection(matrix, &kept, &points);
        let by_degree = EliminationOrder::by_degree(matrix, &kept).unwrap();
        assert_ne!(dissected.unknowns(), by_degree.unknowns());
        let is_dissected = order.unknowns() == dissected.unknowns();
        assert!(is_dissected || order.unknowns() == by_degree.unknowns());
        is_dissected
    };
    assert!(is_dissected(&assembled::<3, _>(&ConformingP1, 16), true));
    assert!(!is_dissected(&assembled::<3, _>(&ConformingP1, 16), false));
    assert!(!is_dissected(&assembled::<3, _>(&ConformingP1, 8), true));
    assert!(is_dissected(&assembled::<2, _>(&Sipg::default(), 32), true));
    assert!(!is_dissected(&assembled::<2, _>(&ConformingP1, 64), true));
}

/// The active set ends in the same solution with points and without, and twice in the same bits.
#[test]
fn the_same_solution_in_any_order() {
    fn compare<const D: usize, S: Scheme<f64, D>>(scheme: &S, n: usize) {
        let (inequality, _) = with_vertices::<D, _>(scheme, n);
        let (matrix, kept) = (&inequality.matrix, kept(&inequality));
        let order = |points| EliminationOrder::new(matrix, &kept, points).unwrap();
        let points = points(&inequality);
        assert_ne!(order(Some(&points)).unknowns(), order(None).unknowns());
        let solver = ActiveSet::default().linear(LinearMethod::Direct);
        let solution = solver.solve(&inequality);
        assert_eq!(solution.values, solver.solve(&inequality).values);
        let other = solver.solve(&inequality.with_points(vec![]));
        assert_eq!((solution.outcome, solution.outer), (other.outcome, other.outer));
        assert_eq!(solution.contact, other.contact);
        for (x, y) in solution.values.iter().zip(&other.values) {
            assert!((x - y).abs() <= 1e-12, "{x} {y}");
        }
    }
    compare::<3, _>(&ConformingP1, 14);
    compare::<2, _>(&Sipg::default(), 20);
    compare::<3, _>(&Wopsip::default(), 6);
}

/// Milliseconds and fill of both orders, without contact and in contact, the least of several.
///
/// `cargo test --release --test inequalities ordering:: -- --ignored --nocapture`
#[test]
#[ignore = "a table of times for release builds"]
fn times() {
    println!("order once, factors in every step (ms); stored numbers");
    table::<2, _>(&ConformingP1, &[32, 64, 128, 256]);
    table::<2, _>(&NonconformingP1, &[64, 128]);
    table::<2, _>(&Sipg::default(), &[16, 64, 128]);
    table::<3, _>(&ConformingP1, &[8, 16, 32]);
    table::<3, _>(&NonconformingP1, &[8, 12]);
    table::<3, _>(&Sipg::default(), &[4, 8, 12]);
}

fn table<const D: usize, S: Scheme<f64, D>>(scheme: &S, sizes: &[usize]) {
    for &n in sizes {
        let inequality = assembled::<D, _>(scheme, n);
        let (matrix, all, points) = (&inequality.matrix, kept(&inequality), points(&inequality));
        let solution = ActiveSet::default().solve(&inequality);
        let is_free = |&&i: &&u32| solution.contact[i as usize] == Default::default();
        let free: Vec<u32> = all.iter().filter(is_free).copied().collect();
        let mut least = [f64::INFINITY; 8];
        let mut stored = [0; 6];
        for _ in 0..5 {
            let mut time = |k: usize, work: &mut dyn FnMut()| {
                let start = Instant::now();
                work();
                least[k] = least[k].min(1e3 * start.elapsed().as_secs_f64());
            };
            let [mut degree, mut dissection] = [None, None];
            time(0, &mut || degree = EliminationOrder::by_degree(matrix, &all).ok());
            time(1, &mut || {
                dissection = Some(EliminationOrder::by_dissection(matrix, &all, &points));
            });
            for (k, free) in [&all, &free].into_iter().enumerate() {
                for (j, order) in [None, degree.as_ref(), dissection.as_ref()].iter().enumerate() {
                    let place = 3 * k + j;
                    time(2 + place, &mut || {
                        let factors = match order {
                            None => Factors::new(matrix, true, free),
                            Some(order) => Factors::in_order(matrix, free, order),
                        };
                        stored[place] = factors.unwrap().entries();
                    });
                }
            }
        }
        println!(
            "{D}d {} n = {n}: degree {:.1}, dissection {:.1}",
            scheme.name(),
            least[0],
            least[1]
        );
        for (k, free) in [all.len(), free.len()].into_iter().enumerate() {
            let [anew, degree, dissection] =
                [0, 1, 2].map(|j| (least[2 + 3 * k + j], stored[3 * k + j]));
            println!(
                "  {free:7} free: degree anew {anew:.1?}, once {degree:.1?}, dissection {dissection:.1?}"
            );
        }
    }
}
