//! Pictures of solutions, looked at as a reader of their files would.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::svg::{FINE, areas, paths};
use crate::support::scratch::Scratch;
use unilateral::measure::Fields;
use unilateral::mesh::BoxDomain;
use unilateral::mesh::{BoundaryCondition, Mesh};
use unilateral::paraview::{VtuFile, write_pvd};
use unilateral::plot::Picture;
use unilateral::prelude::*;
use unilateral::scenes::Scene;

/// The fill of areas in contact.
const CONTACT: &str = "#96BEDE";
/// Whether a fill is a grey, as that of the sides of a domain in space behind what is in contact.
fn is_behind(fill: &str) -> bool {
    fill[1..3] == fill[3..5] && fill[3..5] == fill[5..7]
}
/// Units across the data of a panel where two stand in a row.
const ACROSS: f64 = 204.0;
/// Units across the data of a panel that stands alone in its row.
const ACROSS_ALONE: f64 = 358.0;

/// The picture of a scheme on a scene, with the mesh and what was found.
fn picture<const D: usize>(
    scene: &Scene<D>,
    scheme: &dyn Scheme<D>,
    level: usize,
) -> (Picture, Mesh<D>, Fields) {
    let meshes = Hierarchy::of_domain(&scene.domain, level).unwrap();
    let solved = solve(&scene.problem, &meshes, scheme).unwrap();
    assert!(solved.converged());
    let fields = solved.fields().unwrap();
    let picture = Picture::of("a & b", &scene.problem, solved.mesh(), &fields).unwrap();
    (picture, solved.mesh().clone(), fields)
}

fn cube<const D: usize>(n: usize) -> Mesh<D> {
    let sides = [[BoundaryCondition::Dirichlet; 2]; D];
    let domain = BoxDomain::new(Point::zeros(), Point::repeat(1.0), sides);
    Mesh::kuhn_box(&domain, [n; D]).unwrap()
}

/// A function with these values on the cells of a mesh.
fn function<const D: usize>(mesh: &Mesh<D>, value: impl Fn(usize) -> f64) -> Fields {
    let mut fields = Fields::default();
    fields.u = (0..mesh.cells().len()).map(value).collect();
    let contact = mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact);
    fields.contact_boundary = contact.map(|f| (f.cell as usize, usize::from(f.local))).collect();
    fields
}

fn volume<const D: usize>(mesh: &Mesh<D>, cells: &[usize]) -> f64 {
    cells.iter().map(|&cell| mesh.geometry(cell).volume).sum()
}

#[test]
fn the_area_painted_is_that_of_the_cells_in_contact() {
    let scene = scenes::radial::<2>(1.0);
    let (picture, mesh, fields) = picture(&scene, &Wopsip::default(), 16);
    let contact = volume(&mesh, &fields.discrete_contact.cells);
    // near that of the unit disc, which is the exact set
    assert!((contact - std::f64::consts::PI).abs() < 0.4, "{contact}");
    let painted = areas(&picture.to_svg().unwrap());
    let of_contact = painted.iter().filter(|(fill, _)| fill == CONTACT).map(|p| p.1);
    // the other area of this colour is the entry of the legend
    let largest = of_contact.fold(0.0, f64::max);
    let unit = FINE * ACROSS / 3.0;
    assert!((largest / unit.powi(2) / contact - 1.0).abs() < 2e-3, "{largest}");
}

/// The filled paths, all of which lie on the paper.
fn paths_on_paper(svg: &str) -> usize {
    let size = svg.split("viewBox=\"0 0 ").nth(1).unwrap().split('"').next().unwrap();
    let size: Vec<f64> = size.split(' ').map(|n| n.parse().unwrap()).collect();
    let paths = paths(svg);
    let n_paths = paths.len();
    for [x, y] in paths.into_iter().flat_map(|p| p.1).flatten() {
        assert!((0.0..=size[0]).contains(&x) && (0.0..=size[1]).contains(&y), "{x} {y}");
    }
    n_paths
}

#[test]
fn all_that_is_drawn_lies_on_the_paper_and_the_legend_names_it() {
    let scene = scenes::radial::<2>(1.0);
    let (picture, ..) = picture(&scene, &Sipg::default(), 8);
    let svg = picture.to_svg().unwrap();
    let n_paths = paths_on_paper(&svg);
    assert!(n_paths > 20, "{n_paths}");
    for text in ["in contact", "free boundary, found", "free boundary, exact"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(svg.contains("a &amp; b") && svg.ends_with("</svg>\n"));
}

#[test]
fn jumps_are_drawn_as_they_are() {
    // one and two on the triangles of the square: one jump, across the diagonal
    let mesh = cube::<2>(1);
    let fields = function(&mesh, |k| if k < 3 { 1.0 } else { 2.0 });
    let problem = Problem::new();
    let picture = Picture::of("two", &problem, &mesh, &fields).unwrap();
    let halves = areas(&picture.to_svg().unwrap());
    let square = (FINE * ACROSS_ALONE).powi(2);
    let large: Vec<_> = halves.iter().filter(|(_, area)| *area > 0.4 * square).collect();
    assert_eq!(large.len(), 2, "{halves:?}");
    assert_ne!(large[0].0, large[1].0);
    assert!(large.iter().all(|(_, area)| (area / square - 0.5).abs() < 1e-3));
}

/// A picture of cells in contact in a cube of Dirichlet data: only their surface is drawn.
fn contact_in_cube(mesh: &Mesh<3>, is_in_contact: impl Fn(&Point<3>) -> bool) -> String {
    let mut fields = function(mesh, |_| 0.0);
    let touches = |cell: &usize| is_in_contact(&mesh.barycentre(*cell));
    fields.discrete_contact.cells = (0..mesh.n_cells()).filter(touches).collect();
    let problem = Problem::new().obstacle_below(|_| 0.0);
    Picture::of("cube", &problem, mesh, &fields).unwrap().to_svg().unwrap()
}

/// The area of each colour but those of the legend and of what is behind.
fn areas_by_colour(svg: &str) -> BTreeMap<String, f64> {
    let mut sums = BTreeMap::new();
    for (fill, area) in
        areas(svg).into_iter().filter(|(fill, _)| fill != CONTACT && !is_behind(fill))
    {
        *sums.entry(fill).or_insert(0.0) += area;
    }
    sums
}

#[test]
fn the_surface_of_a_set_of_cells_is_that_of_its_sides_towards_the_viewer() {
    let mesh = cube::<3>(4);
    let whole = areas_by_colour(&contact_in_cube(&mesh, |_| true));
    let lower_half = areas_by_colour(&contact_in_cube(&mesh, |x| x[2] < 0.5));
    let ratios: Vec<f64> = whole.iter().map(|(fill, area)| lower_half[fill] / area).collect();
    // all of the upper side, half of two others
    assert_eq!(ratios.len(), 3, "{whole:?}");
    for expected in [0.5, 1.0] {
        let n = ratios.iter().filter(|r| (**r - expected).abs() < 0.01).count();
        assert_eq!(n, if expected == 1.0 { 1 } else { 2 }, "{ratios:?}");
    }
    // the squares of the areas of a unit cube's projection have the sum one, whatever the direction; the lines of
    // sight have the direction (0.5, -0.8) seen from above, which makes the picture this wide
    let unit = FINE * ACROSS_ALONE * 0.5_f64.hypot(0.8) / (0.5 + 0.8);
    let sum = whole.values().map(|area| (area / unit.powi(2)).powi(2)).sum::<f64>();
    assert!((sum - 1.0).abs() < 0.01, "{sum}");
    assert!(contact_in_cube(&mesh, |_| false).contains("no cell is in contact"));
}

/// The colour on top at a point of a drawing.
fn colour_at(paths: &[(String, Vec<Vec<[f64; 2]>>)], [x, y]: [f64; 2]) -> Option<&str> {
    let is_inside = |polygon: &Vec<[f64; 2]>| {
        let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
        let signs: Vec<f64> =
            sides.map(|(a, b)| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])).collect();
        signs.iter().all(|s| *s > 0.0) || signs.iter().all(|s| *s < 0.0)
    };
    paths.iter().rev().find(|p| p.1.iter().any(is_inside)).map(|p| p.0.as_str())
}

#[test]
fn what_is_nearer_hides_what_is_behind() {
    // the viewer is above: nothing of the lower layer hides the upper one
    let mesh = cube::<3>(4);
    let upper = paths(&contact_in_cube(&mesh, |x| x[2] > 0.5));
    let both = paths(&contact_in_cube(&mesh, |x| x[2] > 0.5 || x[2] < 0.25));
    let lower = paths(&contact_in_cube(&mesh, |x| x[2] < 0.25));
    let mut overlap = 0;
    for polygon in
        upper.iter().filter(|(fill, _)| fill != CONTACT && !is_behind(fill)).flat_map(|p| &p.1)
    {
        let middle = [0, 1].map(|k| polygon.iter().map(|c| c[k]).sum::<f64>() / 3.0);
        assert_eq!(colour_at(&both, middle), colour_at(&upper, middle), "{middle:?}");
        overlap += usize::from(colour_at(&lower, middle).is_some_and(|fill| !is_behind(fill)));
    }
    assert!(overlap > 0);
}

#[test]
fn a_contact_boundary_in_space_is_seen_flat_beside_the_solution_on_the_surface() {
    let scene = scenes::signorini_line_3d();
    let (picture, mesh, fields) = picture(&scene, &ConformingP1, 4);
    let facets = fields.discrete_contact.facets.iter();
    let area: f64 = facets.map(|&(cell, k)| mesh.geometry(cell).facet_measure(k)).sum();
    assert!(area > 1.0, "{area}");
    let svg = picture.to_svg().unwrap();
    let painted = areas(&svg);
    let of_contact = painted.iter().filter(|(fill, _)| fill == CONTACT).map(|p| p.1);
    let unit = FINE * ACROSS / 2.0;
    let largest = of_contact.fold(0.0, f64::max);
    assert!((largest / unit.powi(2) / area - 1.0).abs() < 2e-3, "{largest} {area}");
    for text in ["solution on the surface", "free boundary, exact"] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn a_contact_boundary_may_close_or_be_absent() {
    for condition in [BoundaryCondition::Contact, BoundaryCondition::Dirichlet] {
        let domain = BoxDomain::<3>::new(Point::zeros(), Point::repeat(1.0), [[condition; 2]; 3]);
        let mesh = Mesh::kuhn_box(&domain, [2; 3]).unwrap();
        let problem = Problem::new().signorini(|_| 0.0);
        let picture = Picture::of("", &problem, &mesh, &function(&mesh, |k| k as f64)).unwrap();
        let svg = picture.to_svg().unwrap();
        assert!(paths_on_paper(&svg) > 0);
        assert_eq!(svg.contains("contact set"), condition == BoundaryCondition::Contact);
    }
}

#[test]
fn density_and_midpoints_are_those_of_the_solution() {
    let scene = scenes::radial::<2>(1.0);
    let (_, mesh, fields) = picture(&scene, &ConformingP1, 16);
    let inside = |x: &Point<2>| x.norm() < 0.6;
    let cells = (0..mesh.n_cells()).filter(|&cell| inside(&mesh.barycentre(cell)));
    let density: Vec<f64> = cells.map(|cell| fields.multiplier[cell]).collect();
    assert!(density.len() > 20);
    // the load alone holds the membrane down there
    assert!(density.iter().all(|d| (d - 2.0).abs() < 1e-9), "{density:?}");
    assert!(fields.midpoints.is_empty());

    let (_, mesh, fields) = picture(&scene, &ConformingP2, 16);
    let exact = &scene.problem.exact.as_ref().unwrap().value;
    let edges = [[0, 1], [0, 2], [1, 2]];
    assert_eq!(fields.midpoints.len(), edges.len() * mesh.n_cells());
    for (k, u) in fields.midpoints.iter().enumerate() {
        let cell = mesh.cell(k / edges.len());
        let ends = edges[k % edges.len()].map(|v| mesh.vertices()[cell[v] as usize]);
        let error = (u - exact.at(&(0.5 * (ends[0] + ends[1])))).abs();
        assert!(error < 5e-3, "{error}");
    }
}

#[test]
fn a_string_is_drawn_as_a_curve_over_its_obstacle() {
    let (picture, mesh, fields) = picture(&scenes::radial::<1>(1.0), &Wopsip::default(), 16);
    let contact = volume(&mesh, &fields.discrete_contact.cells);
    assert!((1.5..2.5).contains(&contact), "{contact}");
    let svg = picture.to_svg().unwrap();
    // a bar below the curve
    let largest =
        areas(&svg).iter().filter(|(fill, _)| fill == CONTACT).map(|p| p.1).fold(0.0, f64::max);
    let bar = 9.0 * FINE.powi(2) * ACROSS_ALONE * contact / 3.0;
    assert!((largest / bar - 1.0).abs() < 2e-3, "{largest} {bar}");
    for text in ["obstacle", "free boundary, exact"] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn pictures_are_the_same_bytes_for_any_number_of_threads() {
    let scene = scenes::signorini_2d();
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (picture, ..) = picture(&scene, &Wopsip::default(), 8);
            let scratch = Scratch::new(&format!("pictures-{threads}"));
            std::fs::read(picture.write(&scratch.0, "same").unwrap()).unwrap()
        })
    };
    assert!(bytes(1) == bytes(3));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let problem = Problem::<2>::new();
    let mesh = cube::<2>(2);
    let message =
        |fields: &Fields| Picture::of("", &problem, &mesh, fields).unwrap_err().to_string();
    assert!(message(&Fields::default()).contains("this mesh of 8 cells"));
    let mut beyond = function(&mesh, |_| 0.0);
    beyond.discrete_contact.cells = vec![8];
    assert!(message(&beyond).contains("this mesh of 8 cells"));

    let no_level = Hierarchy::<2>::of_domain(&scenes::radial(1.0).domain, 0).map(drop);
    assert!(no_level.unwrap_err().to_string().contains("at least one subdivision"));

    let (problem, mesh) = (Problem::<2>::new(), cube::<2>(100));
    let steep = function(&mesh, |k| (k % 3) as f64);
    let large = Picture::of("", &problem, &mesh, &steep).unwrap().to_svg();
    assert!(large.unwrap_err().to_string().contains("choose a coarser level"));
}

#[test]
fn a_series_lists_every_level_and_its_files_are_there() {
    let scratch = Scratch::new("pictures-series");
    let directory = &scratch.0;
    let levels = [1, 2, 4];
    let series: Vec<(f64, PathBuf)> = levels
        .iter()
        .map(|&level| {
            let mesh = cube::<2>(level);
            let path = directory.join(format!("square-{level}.vtu"));
            VtuFile::new(&mesh, &vec![1.0; 3 * mesh.n_cells()]).write(&path).unwrap();
            (level as f64, path)
        })
        .collect();
    let path = directory.join("square.pvd");
    write_pvd(&path, &series).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("<VTKFile type=\"Collection\""));
    let attribute = |line: &str, name: &str| -> String {
        line.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap().to_owned()
    };
    let sets: Vec<&str> = text.lines().filter(|l| l.starts_with("<DataSet")).collect();
    assert_eq!(sets.len(), levels.len());
    for (line, level) in sets.iter().zip(levels) {
        assert_eq!(attribute(line, "timestep"), level.to_string());
        // relative to the list itself
        assert_eq!(attribute(line, "file"), format!("square-{level}.vtu"));
        let piece = std::fs::read(directory.join(attribute(line, "file"))).unwrap();
        // triangles and edges of the boundary
        let cells = format!("NumberOfCells=\"{}\"", 2 * level * level + 4 * level);
        assert!(String::from_utf8_lossy(&piece).contains(&cells), "{cells}");
    }
    assert!(write_pvd(&directory.join("square-1.vtu/square.pvd"), &series).is_err());
}
