//! Gradients and fluxes in files of fields.

use std::path::Path;

use unilateral::mesh::{BoxDomain, Mesh};
use unilateral::paraview::VtuFile;
use unilateral::prelude::*;
use unilateral::real::Point;
use unilateral::study::file_name;

use crate::support::scratch::Scratch;
use crate::vtu_grid::{Grid, read};

fn unit_cube<const D: usize>() -> BoxDomain<D> {
    BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
}

/// The file of a problem on the unit cube.
fn file_of<const D: usize>(problem: &Problem<D>, scheme: &NamedScheme) -> Grid {
    let scratch = Scratch::new(&format!("vtu-flux-{D}-{}", file_name(&scheme.to_string())));
    let mesh = Mesh::<D>::kuhn_box(&unit_cube(), [3; D]).unwrap();
    let path = scratch.0.join("fields.vtu");
    solve(problem, &mesh, &*scheme.make()).unwrap().write_vtu(&path).unwrap();
    read(&path)
}

/// Gradient and flux of a linear function with the coefficient two are exact, and the flux through the boundary is the
/// load.
fn writes_fluxes<const D: usize>() {
    let slope = Point::<D>::from_fn(|k, _| 1.0 + k as f64);
    let linear = Problem::new().coefficient(|_| 2.0).dirichlet(move |x| slope.dot(x) - 7.0);
    for scheme in NamedScheme::list(["p1", "p2", "cr", "sipg", "sipg-p2"]).unwrap() {
        let grid = file_of(&linear, &scheme);
        let is_cell: Vec<bool> =
            grid.integers("CellData", "dimension").iter().map(|&d| d == D).collect();
        for (name, factor) in [("gradient", 1.0), ("flux", 2.0)] {
            let vectors = grid.floats("CellData", name);
            assert_eq!(vectors.len(), 3 * is_cell.len());
            for (found, is_cell) in vectors.chunks(3).zip(&is_cell) {
                let expected = |k: usize| if k < D { factor * slope[k] } else { 0.0 };
                let near = |k: usize| (found[k] - expected(k)).abs() < 1e-9;
                assert!(
                    if *is_cell { (0..3).all(near) } else { found[0].is_nan() },
                    "{name} {found:?}"
                );
            }
        }
        let is_linear = !scheme.to_string().contains("p2");
        assert_eq!(grid.names("PointData").contains(&"recovered_gradient"), is_linear);
        if is_linear {
            let vectors = grid.floats("PointData", "recovered_gradient");
            assert_eq!(vectors.len(), 3 * grid.points().len());
            assert!(vectors.chunks(3).all(|x| (x[D - 1] - slope[D - 1]).abs() < 1e-9));
        }
        let loaded = file_of::<D>(&Problem::new().constant_source(3.0), &scheme);
        let (points, through) = (loaded.points(), loaded.floats("CellData", "normal_flux"));
        let facets = loaded.cells().into_iter().zip(through).filter(|(_, q)| !q.is_nan());
        let total: f64 = facets.map(|(cell, q)| q * loaded.measure(&points, &cell, D - 1)).sum();
        assert!((total + 3.0).abs() < 1e-9, "{scheme}: {total}");
    }
}

#[test]
fn files_have_gradients_and_fluxes() {
    writes_fluxes::<1>();
    writes_fluxes::<2>();
    writes_fluxes::<3>();
}

#[test]
fn vectors_of_the_wrong_length_are_refused_by_name() {
    let mesh = Mesh::<2>::kuhn_box(&unit_cube(), [1, 1]).unwrap();
    let (u, vectors) = ([1.0; 6], [Point::zeros(); 3]);
    let path = Path::new("nowhere/fields.vtu");
    let said = |file: VtuFile<'_, 2>| file.write(path).unwrap_err().to_string();
    let wrong = said(VtuFile::new(&mesh, &u).vectors_on_cells("flux", &vectors));
    assert!(wrong.ends_with("field flux has 3 values, the mesh needs 2"), "{wrong}");
    let wrong = said(VtuFile::new(&mesh, &u).vectors_at_vertices("slope", &vectors));
    assert!(wrong.ends_with("field slope has 3 values, the mesh needs 4"), "{wrong}");
}
