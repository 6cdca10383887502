//! The sparse assembler against a slow and obvious dense one, for every layout and a non-symmetric
//! scheme, on small meshes with moved vertices; invariance under renumbering; the same bits for any
//! number of threads; facet identities.

use std::sync::Arc;

use crate::support::meshes::{Random, Raw, mixed_box};
use std::collections::BTreeMap;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::facet::{InteriorPenalty, OverPenalty, Symmetry, proven_bound};
use unilateral::mesh::{BoundaryCondition, Mesh};
use unilateral::prelude::*;
use unilateral::quadrature::Rule;
use unilateral::scheme::ConformingP2;

/// A function on one cell: its values at the cell's vertices.
type Piece = Vec<f64>;

/// The slow assembler: functions are lists of pieces, forms are integrated point by point.
struct Slow<'a, const D: usize> {
    mesh: &'a Mesh<D>,
    alpha: &'a dyn Fn(usize) -> f64,
    reaction: f64,
}

impl<const D: usize> Slow<'_, D> {
    fn corner(&self, c: usize, k: usize) -> Point<D> {
        self.mesh.vertices()[self.mesh.cell(c)[k] as usize]
    }
    /// The gradient of a piece from a linear system in its values.
    fn gradient(&self, c: usize, piece: &Piece) -> Point<D> {
        let edges =
            nalgebra::DMatrix::from_fn(D, D, |r, k| (self.corner(c, r + 1) - self.corner(c, 0))[k]);
        let rises = nalgebra::DVector::from_fn(D, |r, _| piece[r + 1] - piece[0]);
        let g = edges.lu().solve(&rises).unwrap();
        Point::from_fn(|k, _| g[k])
    }
    fn value(&self, c: usize, piece: &Piece, x: &Point<D>) -> f64 {
        piece[0] + self.gradient(c, piece).dot(&(x - self.corner(c, 0)))
    }
    fn volume(&self, c: usize) -> f64 {
        let edges =
            nalgebra::DMatrix::from_fn(D, D, |r, k| (self.corner(c, r + 1) - self.corner(c, 0))[k]);
        edges.determinant().abs() / (1..=D).map(|k| k as f64).product::<f64>()
    }
    fn measure(points: &[Point<D>]) -> f64 {
        match D {
            1 => 1.0,
            2 => (points[1] - points[0]).norm(),
            _ => {
                let (a, b) = (points[1] - points[0], points[2] - points[0]);
                0.5 * (a.norm_squared() * b.norm_squared() - a.dot(&b).powi(2)).sqrt()
            }
        }
    }
    fn facet_points(&self, c: usize, local: usize) -> Vec<Point<D>> {
        (0..=D).filter(|&k| k != local).map(|k| self.corner(c, k)).collect()
    }
    fn surface(&self, c: usize) -> f64 {
        (0..=D).map(|k| Self::measure(&self.facet_points(c, k))).sum()
    }
    /// Outward: the part of (facet - opposite corner) orthogonal to the facet.
    fn normal(&self, c: usize, local: usize) -> Point<D> {
        let p = self.facet_points(c, local);
        let mut n = p[0] - self.corner(c, local);
        let mut basis: Vec<Point<D>> = Vec::new();
        for q in &p[1..] {
            let mut t = q - p[0];
            basis.iter().for_each(|b: &Point<D>| t -= b * b.dot(&t));
            basis.push(t / t.norm());
        }
        basis.iter().for_each(|b| n -= b * b.dot(&n));
        n / n.norm()
    }
    fn cell_form(&self, c: usize, u: &Piece, v: &Piece) -> f64 {
        let stiff = (self.alpha)(c) * self.gradient(c, u).dot(&self.gradient(c, v));
        let mass: f64 = Rule::new(D, 2)
            .iter()
            .map(|(b, w)| {
                let at = |p: &Piece| (0..=D).map(|k| b[k] * p[k]).sum::<f64>();
                w * at(u) * at(v)
            })
            .sum();
        self.volume(c) * (stiff + self.reaction * mass)
    }
    /// All facets with one or two cells, found by comparing vertex sets.
    fn facets(&self) -> BTreeMap<Vec<u32>, Vec<(usize, usize)>> {
        let mut facets: BTreeMap<Vec<u32>, Vec<(usize, usize)>> = BTreeMap::new();
        for c in 0..self.mesh.n_cells() {
            for k in 0..=D {
                facets.entry(self.mesh.facet_vertices(c, k).collect()).or_default().push((c, k));
            }
        }
        facets
    }
    fn is_dirichlet(&self, c: usize, k: usize) -> bool {
        self.mesh.boundary().iter().any(|f| {
            (f.cell as usize, f.local as usize) == (c, k)
                && f.condition == BoundaryCondition::Dirichlet
        })
    }
    /// sigma [u][v] - {d_n u}[v] + theta {d_n v}[u], or eta h^-3 P[u] P[v], over one facet.
    fn facet_form(&self, form: Form, sides: &[(usize, usize)], u: &[&Piece], v: &[&Piece]) -> f64 {
        let points = self.facet_points(sides[0].0, sides[0].1);
        let measure = Self::measure(&points);
        let normal = self.normal(sides[0].0, sides[0].1);
        let a: Vec<f64> = sides.iter().map(|s| (self.alpha)(s.0)).collect();
        let harmonic = a.len() as f64 / a.iter().map(|a| 1.0 / a).sum::<f64>();
        let h = match D {
            1 => sides.iter().map(|s| self.volume(s.0)).sum::<f64>() / sides.len() as f64,
            _ => points
                .iter()
                .flat_map(|p| points.iter().map(move |q| (p - q).norm()))
                .fold(0.0, f64::max),
        };
        let jump = |w: &[&Piece], x: &Point<D>| {
            let first = self.value(sides[0].0, w[0], x);
            if sides.len() == 2 { first - self.value(sides[1].0, w[1], x) } else { first }
        };
        let flux = |w: &[&Piece]| {
            let sum: f64 =
                sides.iter().zip(w).map(|(s, w)| self.gradient(s.0, w).dot(&normal)).sum();
            harmonic * sum / sides.len() as f64
        };
        let rule = Rule::new(D - 1, 4);
        let at = |b: &[f64; 4]| {
            points.iter().enumerate().fold(Point::<D>::zeros(), |x, (k, p)| x + p * b[k])
        };
        match form {
            Form::Penalty { sigma, theta } => {
                let sigma = sigma.map(|s| s * harmonic / h).unwrap_or_else(|| {
                    let w = if sides.len() == 2 { 0.5 } else { 1.0 };
                    let worst = sides
                        .iter()
                        .zip(&a)
                        .map(|(s, a)| {
                            harmonic * harmonic / a * self.surface(s.0) / self.volume(s.0)
                        })
                        .fold(0.0, f64::max);
                    1.5 * w * worst
                });
                let point = |(b, w): (&[f64; 4], f64)| {
                    let x = at(b);
                    let (ju, jv) = (jump(u, &x), jump(v, &x));
                    w * (sigma * ju * jv - flux(u) * jv + theta * flux(v) * ju)
                };
                measure * rule.iter().map(point).sum::<f64>()
            }
            Form::Over { eta } => {
                let mean = |w: &[&Piece]| {
                    rule.iter().map(|(b, weight)| weight * jump(w, &at(b))).sum::<f64>()
                };
                eta * harmonic / (h * h * h) * measure * mean(u) * mean(v)
            }
        }
    }
}

#[derive(Clone, Copy)]
enum Form {
    Penalty { sigma: Option<f64>, theta: f64 },
    Over { eta: f64 },
}

/// Schemes of the test: any element with any form.
struct Any<E, F> {
    element: E,
    form: F,
}

impl<const D: usize, E, F> Scheme<D> for Any<E, F>
where
    E: Element<D> + Copy + 'static,
    F: FacetForm<D> + Clone + 'static,
{
    fn name(&self) -> &str {
        "any"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(self.element)
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(self.form.clone())
    }
    fn dirichlet(&self) -> DirichletBy {
        DirichletBy::FacetForm
    }
}

fn alpha_at<const D: usize>(x: &Point<D>) -> f64 {
    1.0 + 3.0 * x[0] * x[0]
}

/// Compares with the dense assembler, entry by entry.
fn check<const D: usize>(
    mesh: &Mesh<D>,
    element: impl Element<D> + Copy + 'static,
    form: impl FacetForm<D> + Clone + 'static,
    slow_form: Option<Form>,
    reaction: f64,
    // vertex values of the cell's basis function i
    basis: impl Fn(usize) -> Piece,
) {
    let mut problem = Problem::<D>::new().coefficient(alpha_at);
    if reaction > 0.0 {
        problem = problem.reaction(reaction);
    }
    let layout = element.layout();
    let scheme = Any { element, form };
    let space = Discretisation::new(&scheme, &problem, mesh, DataQuadrature::default()).unwrap();
    let matrix = space.matrix();
    // unknowns of each cell, from their locations
    let locations = space.locations();
    let find = |c: usize, i: usize| {
        let piece = basis(i);
        let node: Vec<u32> = if layout.vertex == 1 || (layout.is_broken() && piece[i] == 1.0) {
            vec![mesh.cell(c)[i]]
        } else {
            mesh.facet_vertices(c, i).collect()
        };
        let owner = layout.is_broken().then_some(c as u32);
        (0..locations.len())
            .find(|&k| locations[k].cell() == owner && locations[k].vertices() == node)
            .unwrap()
    };
    let dofs: Vec<Vec<usize>> =
        (0..mesh.n_cells()).map(|c| (0..=D).map(|i| find(c, i)).collect()).collect();

    let alpha = |c: usize| alpha_at(&mesh.barycentre(c));
    let slow = Slow { mesh, alpha: &alpha, reaction };
    let n = space.unknowns();
    let mut dense = vec![vec![0.0; n]; n];
    for c in 0..mesh.n_cells() {
        for i in 0..=D {
            for j in 0..=D {
                dense[dofs[c][i]][dofs[c][j]] += slow.cell_form(c, &basis(j), &basis(i));
            }
        }
    }
    if let Some(form) = slow_form {
        let zero: Piece = vec![0.0; D + 1];
        for sides in slow.facets().into_values() {
            if sides.len() == 1 && !slow.is_dirichlet(sides[0].0, sides[0].1) {
                continue;
            }
            for (s, &(c, _)) in sides.iter().enumerate() {
                for (t, &(d, _)) in sides.iter().enumerate() {
                    for i in 0..=D {
                        for j in 0..=D {
                            let (v, u) = (basis(i), basis(j));
                            let mut test = vec![&zero; sides.len()];
                            let mut trial = test.clone();
                            test[s] = &v;
                            trial[t] = &u;
                            dense[dofs[c][i]][dofs[d][j]] +=
                                slow.facet_form(form, &sides, &trial, &test);
                        }
                    }
                }
            }
        }
    }
    let scale = dense.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (i, row) in dense.iter().enumerate() {
        for (j, &entry) in row.iter().enumerate() {
            let ours = matrix.get(i, j);
            assert!(
                (ours - entry).abs() < 1e-14 * scale,
                "{D}-d ({i}, {j}): {ours:e} against {entry:e}"
            );
        }
    }
    let symmetric =
        (0..n).all(|i| (0..i).all(|j| (dense[i][j] - dense[j][i]).abs() < 1e-12 * scale));
    assert_eq!(symmetric, space.form().is_symmetric(), "symmetry is as declared");
}

fn vertex_basis<const D: usize>(i: usize) -> Piece {
    (0..=D).map(|k| f64::from(k == i)).collect()
}

fn mean_basis<const D: usize>(i: usize) -> Piece {
    (0..=D).map(|k| if k == i { 1.0 - D as f64 } else { 1.0 }).collect()
}

fn check_all<const D: usize>(n: usize) {
    let mut random = Random(3);
    let mesh = Raw::<D>::jittered(&mixed_box(), n, 0.5, &mut random).shuffled(&mut random).mesh();
    let penalty = |rule| InteriorPenalty { symmetry: Symmetry::Symmetric, rule, degree: 1 };
    let over =
        OverPenalty { eta: 0.7, degree: 1, rule: WeightRule::Isotropic, mesh_size: f64::NAN };
    check::<D>(&mesh, P1, NoFacets, None, 0.0, vertex_basis::<D>);
    check::<D>(&mesh, P1, NoFacets, None, 2.5, vertex_basis::<D>);
    if D > 1 {
        // in one dimension a facet mean is a vertex value and the test tells unknowns by place
        check::<D>(&mesh, CrouzeixRaviart, NoFacets, None, 2.5, mean_basis::<D>);
        let sym = Form::Penalty { sigma: Some(10.0), theta: -1.0 };
        check::<D>(
            &mesh,
            CrouzeixRaviart,
            penalty(PenaltyRule::Diameter(10.0)),
            Some(sym),
            0.0,
            mean_basis::<D>,
        );
        check::<D>(
            &mesh,
            Broken(CrouzeixRaviart),
            over,
            Some(Form::Over { eta: 0.7 }),
            0.0,
            mean_basis::<D>,
        );
    }
    let sym = |sigma| Some(Form::Penalty { sigma, theta: -1.0 });
    check::<D>(
        &mesh,
        Broken(P1),
        penalty(PenaltyRule::Diameter(10.0)),
        sym(Some(10.0)),
        0.0,
        vertex_basis::<D>,
    );
    check::<D>(
        &mesh,
        Broken(P1),
        penalty(PenaltyRule::Proven(0.5)),
        sym(None),
        1.0,
        vertex_basis::<D>,
    );
    check::<D>(&mesh, Broken(P1), over, Some(Form::Over { eta: 0.7 }), 0.0, vertex_basis::<D>);
    let non_symmetric = InteriorPenalty {
        symmetry: Symmetry::NonSymmetric,
        rule: PenaltyRule::Diameter(1.0),
        degree: 1,
    };
    let slow = Some(Form::Penalty { sigma: Some(1.0), theta: 1.0 });
    check::<D>(&mesh, Broken(P1), non_symmetric, slow, 0.0, vertex_basis::<D>);
    // a conforming space with a facet form: its jumps vanish, its fluxes do not
    check::<D>(
        &mesh,
        P1,
        penalty(PenaltyRule::Diameter(10.0)),
        sym(Some(10.0)),
        0.0,
        vertex_basis::<D>,
    );
}

#[test]
fn dense_oracle_in_one_dimension() {
    check_all::<1>(5);
}
#[test]
fn dense_oracle_in_two_dimensions() {
    check_all::<2>(3);
}
#[test]
fn dense_oracle_in_three_dimensions() {
    check_all::<3>(2);
}

/// A function that does not know numbers: of the cell's barycentre and the vertex.
fn wild<const D: usize>(mesh: &Mesh<D>) -> Vec<f64> {
    let mut u = Vec::new();
    for c in 0..mesh.n_cells() {
        let b = mesh.barycentre(c);
        for &v in mesh.cell(c) {
            let x = mesh.vertices()[v as usize];
            let s: f64 = (0..D).map(|k| (3.7 + k as f64) * b[k] + (7.1 - k as f64) * x[k]).sum();
            u.push((5.0 * s).sin());
        }
    }
    u
}

#[test]
fn forms_do_not_depend_on_numbering_or_orientation() {
    fn check<const D: usize>() {
        let mut random = Random(11);
        let raw = Raw::<D>::jittered(&mixed_box(), 3, 0.4, &mut random);
        let problem = Problem::<D>::new()
            .coefficient(alpha_at)
            .source(|x| x[0] * x[0])
            .dirichlet(|x| x.sum());
        let objective = |mesh: &Mesh<D>, scheme: &dyn Scheme<D>| {
            let inequality = scheme.inequality(&problem, mesh, DataQuadrature::default()).unwrap();
            let u = wild(mesh);
            // the value, and the size of the terms that cancel in it
            let load = inequality.assembled_load();
            let size: f64 = load.iter().zip(&u).map(|(b, u)| (b * u).abs()).sum();
            (inequality.objective(&u), size)
        };
        let schemes: [&dyn Scheme<D>; 3] = [
            &Sipg::default(),
            &Wopsip::default(),
            &Any {
                element: Broken(P1),
                form: InteriorPenalty {
                    symmetry: Symmetry::NonSymmetric,
                    rule: PenaltyRule::Diameter(2.0),
                    degree: 1,
                },
            },
        ];
        for scheme in schemes {
            let (first, size) = objective(&raw.mesh(), scheme);
            for _ in 0..5 {
                let (again, _) = objective(&raw.shuffled(&mut random).mesh(), scheme);
                assert!((first - again).abs() < 1e-12 * size, "{} {first} {again}", scheme.name());
            }
        }
    }
    check::<1>();
    check::<2>();
    check::<3>();
}

#[test]
fn a_form_is_invariant_under_reversing_the_axes() {
    // the map x -> 1 - x reverses every facet's orientation in one dimension
    let domain = unilateral::mesh::BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let raw = Raw::<1>::jittered(&domain, 6, 0.5, &mut Random(5));
    let mut mirrored = Raw {
        vertices: raw.vertices.clone(),
        cells: raw.cells.clone(),
        boundary: raw.boundary.clone(),
    };
    mirrored.vertices.iter_mut().for_each(|x| x[0] = 1.0 - x[0]);
    let problem = Problem::<1>::new();
    let matrix = |mesh: &Mesh<1>| {
        Discretisation::new(&Sipg::default(), &problem, mesh, DataQuadrature::default())
            .unwrap()
            .matrix()
    };
    let (a, b) = (matrix(&raw.mesh()), matrix(&mirrored.mesh()));
    assert!(a.values.iter().zip(&b.values).all(|(x, y)| (x - y).abs() < 1e-12));
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    fn check<const D: usize>(n: usize) {
        let mesh = Raw::<D>::jittered(&mixed_box(), n, 0.3, &mut Random(2)).mesh();
        let problem = Problem::<D>::new()
            .coefficient(alpha_at)
            .reaction(1.5)
            .source(|x| x[0].sin())
            .dirichlet(|x| x[0])
            .neumann(|x, n| x[0] * n[0])
            .obstacle_below(|x| x[0] - 1.0)
            .obstacle_above(|x| x[0] + x[0].cos());
        let schemes: [&dyn Scheme<D>; 5] =
            [&ConformingP1, &ConformingP2, &NonconformingP1, &Sipg::default(), &Wopsip::default()];
        for scheme in schemes {
            let run = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    scheme.inequality(&problem, &mesh, DataQuadrature::default()).unwrap()
                })
            };
            let one = run(1);
            for threads in [2, 8] {
                let many = run(threads);
                assert_eq!(one.matrix, many.matrix, "{} with {threads} threads", scheme.name());
                assert_eq!(one.load, many.load);
                assert_eq!(one.bounds, many.bounds);
                assert_eq!(one.locations, many.locations);
            }
        }
    }
    check::<1>(9000);
    check::<2>(60);
    check::<3>(12);
}

/// Data that are not finite in many cells: the message names the same cell for any number of threads.
#[test]
fn the_same_error_for_any_number_of_threads() {
    let mesh = Raw::<2>::jittered(&mixed_box(), 60, 0.3, &mut Random(3)).mesh();
    let nan_beyond = |x: &Point<2>| if x[0] > 0.2 { f64::NAN } else { 0.0 };
    let problems = [Problem::new().obstacle_below(nan_beyond), Problem::new().source(nan_beyond)];
    for problem in &problems {
        let error = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let scheme: &dyn Scheme<2> = &Sipg::default();
            let inequality =
                || scheme.inequality(problem, &mesh, DataQuadrature::default()).map(|_| ());
            pool.install(inequality).unwrap_err().to_string()
        };
        let one = error(1);
        assert!((0..20).all(|_| error(4) == one), "{one}");
    }
}

#[test]
fn refilling_a_pattern_gives_the_same_matrix() {
    fn check<S: Scheme<2>>(scheme: &S) {
        let mesh = Raw::<2>::jittered(&mixed_box(), 7, 0.3, &mut Random(4)).mesh();
        let problem = Problem::<2>::new();
        let discretise =
            || Discretisation::new(scheme, &problem, &mesh, DataQuadrature::default()).unwrap();
        let space = discretise();
        let first = space.matrix();
        // also where another discretisation made the pattern
        for space in [space, discretise()] {
            let mut again = first.clone();
            again.values.fill(f64::NAN);
            space.fill(&mut again);
            assert_eq!(first, again, "{}", scheme.name());
        }
    }
    check(&Sipg::default());
    check(&ConformingP1);
    check(&ConformingP2);
    check(&NonconformingP1);
}

#[test]
fn continuous_functions_have_no_jump_and_constants_no_energy() {
    // pure Neumann and contact boundary: the form of a constant vanishes for every scheme
    let sides =
        [[BoundaryCondition::Neumann; 2], [BoundaryCondition::Contact, BoundaryCondition::Neumann]];
    let domain = unilateral::mesh::BoxDomain::<2>::new(Point::zeros(), Point::repeat(1.0), sides);
    let mesh = Raw::<2>::jittered(&domain, 4, 0.4, &mut Random(9)).mesh();
    let problem = Problem::<2>::new();
    let linear: Vec<f64> =
        mesh.cells().iter().map(|&v| 2.0 * mesh.vertices()[v as usize][0] - 1.0).collect();
    let schemes: [&dyn Scheme<2>; 2] = [&Sipg::default(), &Wopsip::default()];
    for scheme in schemes {
        let inequality = scheme.inequality(&problem, &mesh, DataQuadrature::default()).unwrap();
        let one = vec![1.0; inequality.size()];
        assert!(
            inequality.objective(&one).abs() < 1e-9 * inequality.matrix.nonzeros() as f64 * 1e-3
        );
        let worst =
            (0..one.len()).map(|i| inequality.matrix.row_dot(i, &one).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-9, "{}: {worst:e}", scheme.name());
        // grad = (2, 0) on the unit square, no jumps: half the form is two
        assert!((inequality.objective(&linear) - 2.0).abs() < 1e-9, "{}", scheme.name());
    }
}

#[test]
fn the_proven_bound_is_what_the_default_penalty_is_made_of() {
    let mesh = Mesh::<2>::kuhn_box(&mixed_box(), [4, 4]).unwrap();
    let problem = Problem::<2>::new();
    let below_bound = |sigma| {
        let scheme = Sipg { penalty: PenaltyRule::Diameter(sigma) };
        Discretisation::new(&scheme, &problem, &mesh, DataQuadrature::default())
            .unwrap()
            .penalty_below_bound()
    };
    // right isosceles cells: |dK|/|K| = (4 + 2 sqrt 2)/h, on a Dirichlet leg sigma must reach that
    let least = 4.0 + 2.0 * 2_f64.sqrt();
    assert_eq!(below_bound(least * 1.0001), None);
    let found = below_bound(least * 0.999).unwrap();
    assert!((found.needed - 4.0 * least).abs() < 1e-9 && found.weight < found.needed);
    assert!(below_bound(1.0).unwrap().facets > found.facets);
    let default =
        Discretisation::new(&Sipg::default(), &problem, &mesh, DataQuadrature::default()).unwrap();
    assert_eq!(default.penalty_below_bound(), None);
    let side = unilateral::facet::Side {
        coefficient: 2.0,
        bound_coefficient: 2.0,
        volume: 0.5,
        surface: 3.0,
        height: 1.0,
    };
    let view = FacetView::new(&mesh, (0, 0), 1.0, side, Some(side));
    assert_eq!(proven_bound::<2>(1, &view), 0.5 * 2.0 * 6.0);
    let varying = unilateral::facet::Side { bound_coefficient: 0.5, ..side };
    let view = FacetView::new(&mesh, (0, 0), 1.0, side, Some(varying));
    assert_eq!(proven_bound::<2>(1, &view), 0.5 * (2.0 * 2.0 / 0.5) * 6.0);
}
