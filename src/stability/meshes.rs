//! Difficult meshes: stretched, graded, with slivers.

use crate::error::Error;
use crate::kit::meshes::tagged;
use crate::mesh::{BoundaryCondition, BoxDomain, Mesh, TaggedFacet};
use crate::real::Point;

/// The unit square in `n` times `n ratio` rectangles, each cut in two.
pub(crate) fn stretched(n: usize, ratio: usize) -> Result<Mesh<2>, Error> {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Ok(Mesh::kuhn_box(&square, [n, n * ratio])?)
}

/// `(-1, 1) x (0, 1)` in `n` squares for each unit, graded to the origin by `t^power`; contact
/// below.
pub(crate) fn graded(n: usize, power: i32) -> Result<Mesh<2>, Error> {
    let mesh = Mesh::kuhn_box(&BoxDomain::above_contact(), [2 * n, n])?;
    let moved = |x: &Point<2>| x.map(|t| t.signum() * t.abs().powi(power));
    let vertices = mesh.vertices().iter().map(moved).collect();
    Ok(Mesh::new(vertices, mesh.cells().to_vec(), &tagged(&mesh, |v| v))?)
}

/// A mesh with Dirichlet data on the whole boundary.
pub(crate) fn clamped(mesh: &Mesh<3>) -> Result<Mesh<3>, Error> {
    let facets = tagged(mesh, |v| v).into_iter().map(|facet| facet.vertices).collect();
    with_dirichlet(mesh.vertices().to_vec(), mesh.cells().to_vec(), facets)
}

fn with_dirichlet(
    vertices: Vec<Point<3>>,
    cells: Vec<u32>,
    mut facets: Vec<[u32; 3]>,
) -> Result<Mesh<3>, Error> {
    facets.iter_mut().for_each(|facet| facet.sort_unstable());
    facets.sort_unstable();
    let tag = |vertices| TaggedFacet { vertices, condition: BoundaryCondition::Dirichlet };
    Ok(Mesh::new(vertices, cells, &facets.into_iter().map(tag).collect::<Vec<_>>())?)
}

/// The cube `(-half, half)^3` in `n^3` smaller ones, `n` even, each cut into five tetrahedra, with
/// a layer of slivers in the middle: tetrahedra on the four corners of a square that rise and fall
/// by turns, of height `flatness` times the side of the small cubes.
///
/// Cut into five, a cube has diagonals between every other corner. Below the layer these are the
/// corners that fall, above it those that rise: so the slivers fill the gap, and every sliver
/// shares its four facets with tetrahedra above and below. All other tetrahedra stay as they were
/// up to a shift of corners by half of that height.
/// The whole boundary has Dirichlet data.
///
/// # Errors
/// [`Error::Mesh`] for slivers without height.
pub fn slivers(half: f64, n: usize, flatness: f64) -> Result<Mesh<3>, Error> {
    let (side, stride, middle) = (2.0 * half / n as f64, n + 1, n / 2);
    let number = |i: [usize; 3]| (i[0] + stride * (i[1] + stride * i[2])) as u32;
    let is_even = |i: [usize; 3]| i.iter().sum::<usize>().is_multiple_of(2);
    let mut vertices = Vec::new();
    for v in 0..stride.pow(3) {
        let i = [v % stride, v / stride % stride, v / (stride * stride)];
        let mut x = Point::from_fn(|k, _| side * i[k] as f64 - half);
        if i[2] == middle {
            x[2] += if is_even(i) { -0.5 } else { 0.5 } * flatness * side;
        }
        vertices.push(x);
    }
    let mut cells = Vec::new();
    for c in 0..n.pow(3) {
        let at = [c % n, c / n % n, c / (n * n)];
        let corner = |k: usize| [at[0] + k % 2, at[1] + k / 2 % 2, at[2] + k / 4];
        // diagonals join the even corners below the layer, the odd ones above it
        let joins = |k: usize| is_even(corner(k)) == (at[2] < middle);
        let joined: Vec<usize> = (0..8).filter(|&k| joins(k)).collect();
        cells.extend(joined.iter().map(|&k| number(corner(k))));
        for k in (0..8).filter(|&k| !joins(k)) {
            cells.push(number(corner(k)));
            cells.extend([1, 2, 4].map(|bit| number(corner(k ^ bit))));
        }
        if at[2] == middle {
            cells.extend((0..4).map(|k| number(corner(k))));
        }
    }
    let index = |v: u32, axis: u32| v as usize / stride.pow(axis) % stride;
    let is_on_side = |facet: &[u32; 3]| {
        let ends = (0..3).flat_map(|axis| [(axis, 0), (axis, n)]);
        ends.into_iter().any(|(axis, end)| facet.iter().all(|&v| index(v, axis) == end))
    };
    let facets = |cell: &[u32]| {
        let [a, b, c, d] = [cell[0], cell[1], cell[2], cell[3]];
        [[b, c, d], [a, c, d], [a, b, d], [a, b, c]]
    };
    let sides = cells.chunks_exact(4).flat_map(facets).filter(is_on_side).collect();
    with_dirichlet(vertices, cells, sides)
}
