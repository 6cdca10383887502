//! Forms with lifts of jumps against a slow and obvious assembler, which solves for every lift as
//! it is defined; linears and quadratics, one to three dimensions, jumping coefficients.

use crate::support::meshes::{Random, Raw, mixed_box};
use nalgebra::{DMatrix, DVector};
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::mesh::{BoundaryCondition, Mesh, TaggedFacet};
use unilateral::prelude::*;
use unilateral::quadrature::Rule;

/// The barycentric coordinates in a cell of a point of the facet opposite vertex `local`.
fn facet_to_cell(point: &[f64; 4], local: usize) -> [f64; 4] {
    std::array::from_fn(|k| if k == local { 0.0 } else { point[k - usize::from(k > local)] })
}

/// A vector field on one cell by its values at the points of the cell rule.
type FieldAt<const D: usize> = Vec<Point<D>>;

/// What of a function the forms need: on every cell its gradient, on every facet its jump.
struct Function<const D: usize> {
    gradient: Vec<FieldAt<D>>,
    /// By facet, at the points of the facet rule.
    jump: Vec<Vec<f64>>,
    /// By facet and side, the lift of the jump on that facet alone.
    lifts: Vec<Vec<(usize, FieldAt<D>)>>,
}

/// A facet with its cells: cell, number of the facet in it.
type Sides = Vec<(usize, usize)>;

struct Slow<'a, const D: usize> {
    mesh: &'a Mesh<D>,
    alpha: &'a dyn Fn(&Point<D>) -> f64,
    facets: Vec<Sides>,
    lift_degree: usize,
}

impl<const D: usize> Slow<'_, D> {
    fn corners(&self, c: usize) -> Vec<Point<D>> {
        self.mesh.cell(c).iter().map(|&v| self.mesh.vertices()[v as usize]).collect()
    }
    fn volume(&self, c: usize) -> f64 {
        let p = self.corners(c);
        let edges = DMatrix::from_fn(D, D, |r, k| (p[r + 1] - p[0])[k]);
        edges.determinant().abs() / (1..=D).map(|k| k as f64).product::<f64>()
    }
    fn alpha_of(&self, c: usize) -> f64 {
        (self.alpha)(&self.mesh.barycentre(c))
    }
    /// Gradients of the barycentric coordinates.
    fn gradients(&self, c: usize) -> Vec<Point<D>> {
        let p = self.corners(c);
        let system = DMatrix::from_fn(D + 1, D + 1, |i, k| if k < D { p[i][k] } else { 1.0 });
        let inverse = system.try_inverse().unwrap();
        (0..=D).map(|i| Point::from_fn(|k, _| inverse[(k, i)])).collect()
    }
    fn normal(&self, side: (usize, usize)) -> Point<D> {
        let g = self.gradients(side.0)[side.1];
        -g / g.norm()
    }
    fn measure(&self, side: (usize, usize)) -> f64 {
        if D == 1 {
            1.0
        } else {
            D as f64 * self.volume(side.0) * self.gradients(side.0)[side.1].norm()
        }
    }
    fn diameter(&self, sides: &Sides) -> f64 {
        if D == 1 {
            return sides.iter().map(|s| self.volume(s.0)).sum::<f64>() / sides.len() as f64;
        }
        let (c, l) = sides[0];
        let p: Vec<_> =
            self.corners(c).into_iter().enumerate().filter(|(k, _)| *k != l).map(|x| x.1).collect();
        p.iter().flat_map(|a| p.iter().map(move |b| (a - b).norm())).fold(0.0, f64::max)
    }
    /// The weight of each side's `alpha grad` in the mean, for shares of the derivatives.
    fn weights(&self, sides: &Sides, share: f64) -> Vec<f64> {
        if sides.len() == 1 {
            return vec![1.0];
        }
        let (a, b) = (self.alpha_of(sides[0].0), self.alpha_of(sides[1].0));
        let sum = share / a + (1.0 - share) / b;
        vec![share / a / sum, (1.0 - share) / b / sum]
    }
    /// The polynomials lifts are made of, at a point of a cell.
    fn lift_basis(&self, lambda: &[f64; 4]) -> Vec<f64> {
        let products = |i: usize| (i..=D).map(move |j| lambda[i] * lambda[j]);
        match self.lift_degree {
            0 => vec![1.0],
            1 => lambda[..=D].to_vec(),
            _ => (0..=D).flat_map(products).collect(),
        }
    }

    /// A basis function, zero outside of its cell.
    fn function(
        &self,
        element: &dyn Element<D>,
        cell: usize,
        i: usize,
        share: &dyn Fn(&Sides) -> f64,
    ) -> Function<D> {
        let rule = Rule::new(D, 4);
        let facet_rule = Rule::new(D - 1, 4);
        let zero = || vec![Point::<D>::zeros(); rule.points.len()];
        let mut gradient: Vec<FieldAt<D>> = (0..self.mesh.n_cells()).map(|_| zero()).collect();
        let g = self.gradients(cell);
        for (point, out) in rule.points.iter().zip(&mut gradient[cell]) {
            let mut d = [[0.0; 4]; 10];
            element.derivatives(&point[..=D], &mut d);
            *out = (0..=D).fold(Point::zeros(), |s, k| s + g[k] * d[i][k]);
        }
        let mut jump = Vec::new();
        let mut lifts = Vec::new();
        for sides in &self.facets {
            let at = |point: &[f64; 4]| {
                let mut sum = 0.0;
                for (k, &(c, local)) in sides.iter().enumerate() {
                    if c == cell {
                        let mut v = [0.0; 10];
                        element.values(&facet_to_cell(point, local)[..=D], &mut v);
                        sum += if k == 0 { v[i] } else { -v[i] };
                    }
                }
                sum
            };
            let jumps: Vec<f64> = facet_rule.points.iter().map(at).collect();
            let normal = self.normal(sides[0]);
            let weights = self.weights(sides, share(sides));
            let lift = |(&(c, local), &weight): (&(usize, usize), &f64)| {
                let n = self.lift_basis(&[0.25; 4]).len();
                let mut mass = DMatrix::<f64>::zeros(n, n);
                for (point, w) in rule.iter() {
                    let q = DVector::from_vec(self.lift_basis(point));
                    mass += &q * q.transpose() * (w * self.volume(c));
                }
                let mut right = DVector::<f64>::zeros(n);
                for ((point, w), j) in facet_rule.iter().zip(&jumps) {
                    let q = DVector::from_vec(self.lift_basis(&facet_to_cell(point, local)));
                    right -= q * (w * self.measure(sides[0]) * j * weight);
                }
                let s = mass.lu().solve(&right).unwrap();
                let value =
                    |point: &[f64; 4]| normal * s.dot(&DVector::from_vec(self.lift_basis(point)));
                (c, rule.points.iter().map(value).collect())
            };
            lifts.push(sides.iter().zip(&weights).map(lift).collect());
            jump.push(jumps);
        }
        Function { gradient, jump, lifts }
    }

    fn product(&self, c: usize, u: &FieldAt<D>, v: &FieldAt<D>) -> f64 {
        let rule = Rule::new(D, 4);
        let sum: f64 =
            rule.weights.iter().zip(u.iter().zip(v)).map(|(w, (u, v))| w * u.dot(v)).sum();
        self.alpha_of(c) * self.volume(c) * sum
    }
    /// The sum of all lifts on each cell.
    fn lift(&self, u: &Function<D>) -> Vec<FieldAt<D>> {
        let n = Rule::new(D, 4).points.len();
        let mut sum = vec![vec![Point::zeros(); n]; self.mesh.n_cells()];
        for (c, lift) in u.lifts.iter().flatten() {
            sum[*c].iter_mut().zip(lift).for_each(|(s, l)| *s += l);
        }
        sum
    }
    fn form(&self, which: Method, u: &Function<D>, v: &Function<D>) -> f64 {
        let (ru, rv) = (self.lift(u), self.lift(v));
        let mut sum = 0.0;
        for c in 0..self.mesh.n_cells() {
            sum += self.product(c, &u.gradient[c], &v.gradient[c])
                + self.product(c, &ru[c], &v.gradient[c])
                + self.product(c, &u.gradient[c], &rv[c]);
            if !matches!(which, Method::Br2(_)) {
                sum += self.product(c, &ru[c], &rv[c]);
            }
        }
        for (f, sides) in self.facets.iter().enumerate() {
            sum += match which {
                Method::Br2(eta) | Method::Bmmpr(eta) => {
                    let pairs = u.lifts[f].iter().zip(&v.lifts[f]);
                    eta * pairs.map(|((c, a), (_, b))| self.product(*c, a, b)).sum::<f64>()
                }
                Method::Ldg(eta) => {
                    let alpha = sides.len() as f64
                        / sides.iter().map(|s| 1.0 / self.alpha_of(s.0)).sum::<f64>();
                    let rule = Rule::new(D - 1, 4);
                    let jumps = u.jump[f].iter().zip(&v.jump[f]);
                    let mean: f64 =
                        rule.weights.iter().zip(jumps).map(|(w, (a, b))| w * a * b).sum();
                    eta * alpha / self.diameter(sides) * self.measure(sides[0]) * mean
                }
            };
        }
        sum
    }
}

#[derive(Clone, Copy)]
enum Method {
    Br2(f64),
    Bmmpr(f64),
    Ldg(f64),
}

/// Interior and Dirichlet facets, by comparing vertices.
fn facets<const D: usize>(mesh: &Mesh<D>) -> Vec<Sides> {
    let mut all: std::collections::BTreeMap<Vec<u32>, Sides> = Default::default();
    for c in 0..mesh.n_cells() {
        for l in 0..=D {
            all.entry(mesh.facet_vertices(c, l).collect()).or_default().push((c, l));
        }
    }
    let dirichlet = |sides: &Sides| {
        mesh.boundary().iter().any(|f| {
            (f.cell as usize, f.local as usize) == sides[0]
                && f.condition == BoundaryCondition::Dirichlet
        })
    };
    all.into_values().filter(|sides| sides.len() == 2 || dirichlet(sides)).collect()
}

fn check<const D: usize>(
    which: Method,
    (scheme, lifts): (&dyn Scheme<D>, Lifts),
    n: usize,
    share: &dyn Fn(&Point<D>) -> f64,
) {
    let mut random = Random(17);
    let mesh = Raw::<D>::jittered(&mixed_box(), n, 0.4, &mut random).shuffled(&mut random).mesh();
    check_on(&mesh, which, (scheme, lifts), share);
}

fn check_on<const D: usize>(
    mesh: &Mesh<D>,
    which: Method,
    (scheme, lifts): (&dyn Scheme<D>, Lifts),
    share: &dyn Fn(&Point<D>) -> f64,
) {
    // a constant in each cell, by the side of its barycentre
    let cells = mesh.clone();
    let contains = move |cell: usize, x: &Point<D>| {
        let (geometry, corners) = (cells.geometry(cell), cells.cell(cell));
        let from = |k: usize| x - cells.vertices()[corners[k] as usize];
        (0..=D).all(|k| geometry.gradient(k).dot(&from(k)) > -1.0 - 1e-12)
    };
    let cells = mesh.clone();
    let alpha = move |x: &Point<D>| {
        let cell = (0..cells.n_cells()).find(|&cell| contains(cell, x)).unwrap();
        if cells.barycentre(cell)[0] < 0.5 { 3.0 } else { 0.25 }
    };
    let problem =
        Problem::<D>::new().coefficient(alpha.clone()).dirichlet(|x| 1.0 + x[0] * x[D - 1]);
    let space = Discretisation::new(scheme, &problem, mesh, DataQuadrature::default()).unwrap();
    let matrix = space.matrix();
    assert!(matrix.is_well_formed());
    let element = scheme.element();
    let (lift_degree, n) = (lifts.degree(element.degree()), element.per_cell());
    let slow = Slow { mesh, alpha: &alpha, facets: facets(mesh), lift_degree };
    let of_sides = |sides: &Sides| share(&slow.normal(sides[0]));
    let function = |k| slow.function(&*element, k / n, k % n, &of_sides);
    let functions: Vec<Function<D>> = (0..space.unknowns()).map(function).collect();
    let scale = matrix.diagonal().into_iter().fold(0.0, f64::max);
    let mut worst = 0.0_f64;
    for (i, v) in functions.iter().enumerate() {
        for (j, u) in functions.iter().enumerate() {
            worst = worst.max((matrix.get(i, j) - slow.form(which, u, v)).abs());
        }
    }
    assert!(worst <= 1e-14 * scale, "{}: {worst:e} of {scale:e}", scheme.name());
}

fn every_method<const D: usize, E: Element<D> + Copy + 'static>(element: E, n: usize) {
    let mean = |_: &Point<D>| 0.5;
    for lifts in [Lifts::Reduced, Lifts::Full] {
        let br2 = Br2 { factor: 4.5 / (D + 1) as f64, lifts }.on(element);
        check(Method::Br2(4.5), (&br2, lifts), n, &mean);
        let bmmpr = Bmmpr { factor: 0.7, lifts }.on(element);
        check(Method::Bmmpr(0.7), (&bmmpr, lifts), n, &mean);
        let ldg = Ldg { eta: 1.3, switch: false, lifts }.on(element);
        check(Method::Ldg(1.3), (&ldg, lifts), n, &mean);
        // the direction is part of the scheme's definition
        let direction = [1.0, 0.377, 0.142];
        let one_sided = |normal: &Point<D>| {
            f64::from(normal.iter().zip(direction).map(|(n, d)| n * d).sum::<f64>() > 0.0)
        };
        let switched = Ldg { eta: 1.0, switch: true, lifts }.on(element);
        check(Method::Ldg(1.0), (&switched, lifts), n, &one_sided);
    }
}

#[test]
fn linears() {
    every_method::<1, _>(P1, 5);
    every_method::<2, _>(P1, 2);
    every_method::<3, _>(P1, 1);
}

#[test]
fn quadratics() {
    every_method::<1, _>(P2, 4);
    every_method::<2, _>(P2, 2);
    every_method::<3, _>(P2, 1);
}

/// A simplex cut at its barycentre: every cell is the neighbour of every other.
fn cut_at_barycentre<const D: usize>() -> Mesh<D> {
    let mut vertices = vec![Point::<D>::zeros()];
    vertices.extend((0..D).map(|k| Point::from_fn(|j, _| f64::from(j == k))));
    vertices.push(Point::repeat(1.0 / (D + 1) as f64));
    let others = |k: usize| (0..=D as u32).filter(move |&v| v != k as u32);
    let cells = (0..=D).flat_map(|k| others(k).chain([D as u32 + 1])).collect();
    let side = |k: usize| {
        let v: Vec<u32> = others(k).collect();
        TaggedFacet {
            vertices: std::array::from_fn(|i| v[i]),
            condition: BoundaryCondition::Dirichlet,
        }
    };
    Mesh::new(vertices, cells, &(0..=D).map(side).collect::<Vec<_>>()).unwrap()
}

#[test]
fn cells_that_are_all_neighbours_of_each_other() {
    fn on<const D: usize>() {
        let mesh = cut_at_barycentre::<D>();
        let mean = |_: &Point<D>| 0.5;
        for lifts in [Lifts::Reduced, Lifts::Full] {
            let bmmpr = Bmmpr { factor: 0.7, lifts };
            check_on(&mesh, Method::Bmmpr(0.7), (&bmmpr, lifts), &mean);
            check_on(&mesh, Method::Bmmpr(0.7), (&bmmpr.on(P2), lifts), &mean);
        }
    }
    on::<2>();
    on::<3>();
}

/// Lifts of the element's own degree bound the whole jump: with them BMMPR has the errors of SIPG, with
/// means alone those of Crouzeix-Raviart elements. On the graded mesh of an independent program the
/// errors of both degrees agree with that program to three digits.
#[test]
fn full_lifts_bound_the_whole_jump() {
    let written = ["br2", "br2@lifts=full", "bmmpr", "bmmpr@lifts=full", "sipg"];
    let schemes = NamedScheme::list(written).unwrap();
    let study = Study::<2>::new(scenes::hertz_2d()).levels([16]);
    let report = schemes.iter().fold(study, Study::named_scheme).run().unwrap();
    let expected = [
        (4.59e-4, 1.82e-2),
        (1.64e-4, 1.61e-2),
        (4.79e-4, 1.90e-2),
        (1.40e-4, 1.45e-2),
        (1.42e-4, 1.49e-2),
    ];
    for (row, (l2, h1)) in report.rows.iter().zip(expected) {
        let close = |found: Option<f64>, figure: f64| (found.unwrap() / figure - 1.0).abs() < 5e-3;
        assert!(row.converged() && close(row.error.l2, l2) && close(row.error.h1, h1), "{row:?}");
    }
}
