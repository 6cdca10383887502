//! Colours of pictures: what they say of a function, the lines between them, and the exact free boundary.

use super::svg::{FINE, area, areas, length, paths, picture_of, segments, square, texts};
use unilateral::mesh::{BoundaryCondition, TaggedFacet};
use unilateral::plot::Picture;
use unilateral::prelude::*;

/// The upper left corner of the data of the first panel, and of the second beside it, in units of the file.
const CORNERS: [[f64; 2]; 2] = [[66.0 * FINE, 62.0 * FINE], [342.0 * FINE, 62.0 * FINE]];
/// The width of the data of a panel that stands alone, and of one of two in a row, in units of the file.
const WIDE: f64 = 358.0 * FINE;
const NARROW: f64 = 204.0 * FINE;

/// A mesh of triangles in the plane with Dirichlet data on these facets.
fn triangles(vertices: &[[f64; 2]], cells: Vec<u32>, boundary: &[[u32; 2]]) -> Mesh<2> {
    let condition = BoundaryCondition::Dirichlet;
    let facets: Vec<_> =
        boundary.iter().map(|&vertices| TaggedFacet { vertices, condition }).collect();
    let vertices = vertices.iter().map(|&x| Point::from(x)).collect();
    Mesh::new(vertices, cells, &facets).unwrap()
}

/// The bands of a function end at 0, 0.05 ... 1. Each paints the part on which the function is not below it.
#[test]
fn bands_end_at_round_numbers_and_hold_all_values() {
    let (low, high) = (0.013, 0.97);
    let svg = picture_of(&square(1), |x| low + (high - low) * x[0]);
    let painted = areas(&svg);
    for (band, (colour, area)) in painted[..20].iter().enumerate() {
        let share = ((high - 0.05 * band as f64) / (high - low)).min(1.0);
        assert!((area / WIDE.powi(2) - share).abs() < 2e-3, "{band}: {area}");
        // the bar shows the colours once more, from left to right
        assert_eq!(&painted[20 + band].0, colour);
        assert_eq!(painted.iter().filter(|other| other.0 == *colour).count(), 2);
    }
    assert_eq!(painted.len(), 40);
}

/// The function is constant: one band, from half of the value to one and a half of it.
#[test]
fn a_constant_has_one_band_around_it_and_no_number_has_none() {
    let svg = picture_of(&square(1), |_| 2.0);
    assert_eq!(areas(&svg).len(), 2, "the square, and the bar");
    let said: Vec<String> = texts(&svg, 124, "middle").into_iter().map(|text| text.1).collect();
    assert!(said.ends_with(&["1.0", "1.5", "2.0", "2.5", "3.0"].map(str::to_owned)), "{said:?}");
    let name = |svg: &str| texts(svg, 132, "middle").iter().filter(|text| text.1 == "u").count();
    let none = picture_of(&square(1), |_| f64::NAN);
    assert_eq!((name(&svg), name(&none), areas(&none).len()), (1, 0, 0));
}

#[test]
fn lightness_grows_evenly() {
    // the weights of channels of which the helix keeps the sum
    let grey = |colour: &str| {
        let channel = |k: usize| f64::from(u8::from_str_radix(&colour[k..k + 2], 16).unwrap());
        (0.30 * channel(1) + 0.59 * channel(3) + 0.11 * channel(5)) / 255.0
    };
    let painted = areas(&picture_of(&square(1), |x| x[0] * 0.97 + 0.013 * (1.0 - x[0])));
    for (band, (colour, _)) in painted[..20].iter().enumerate() {
        let expected = 0.12 + 0.82 * (band as f64 + 0.5) / 20.0;
        let grey = grey(colour);
        assert!((grey - expected).abs() < 0.003, "{band}: {grey} {expected}");
    }
}

/// A triangle with the values 0, 1 and 0.4 at its corners, and one with 0, 0.4 and 0.1. The value is 0.4 on a line through
/// a corner of both.
#[test]
fn bands_are_nested_parts_of_triangles_and_contour_lines_end_them() {
    let corners = [[0.0, 0.0], [2.0, 0.0], [0.5, 1.5], [0.0, 1.5]];
    let value = |x: &Point<2>| match (x[0], x[1]) {
        (0.0, 0.0) => 0.0,
        (2.0, _) => 1.0,
        (0.5, _) => 0.4,
        _ => 0.1,
    };
    let unit = WIDE / 2.0;
    let place = |[x, y]: [f64; 2]| [CORNERS[0][0] + unit * x, CORNERS[0][1] + unit * (1.5 - y)];
    let one = triangles(&corners[..3], vec![0, 1, 2], &[[0, 1], [1, 2], [0, 2]]);
    let two = [[0, 1], [1, 2], [2, 3], [0, 3]];
    let two = triangles(&corners, vec![0, 1, 2, 0, 2, 3], &two);
    let of_one = areas(&picture_of(&one, value));
    for (band, (_, area)) in of_one[..10].iter().enumerate() {
        let level = 0.1 * band as f64;
        let share = match level < 0.4 {
            true => 1.0 - level * level / 0.4,
            false => (1.0 - level).powi(2) / 0.6,
        };
        assert!((area / (1.5 * unit * unit) - share).abs() < 2e-3, "{band}: {area}");
    }
    assert_eq!(of_one.len(), 20);
    for svg in [picture_of(&one, value), picture_of(&two, value)] {
        // no part of a triangle whose largest value is the lower end of a band is in the band
        for polygon in paths(&svg).into_iter().flat_map(|path| path.1) {
            assert!(polygon.len() >= 3 && area(&polygon) > 0.0, "{polygon:?}");
        }
        // of four levels each two are drawn in white and in black
        let is_end = |found: [f64; 2], end: [f64; 2]| {
            let [x, y] = place(end);
            (found[0] - x).abs() <= 1.0 && (found[1] - y).abs() <= 1.0
        };
        let is_line = |&[from, to]: &[[f64; 2]; 2], [a, b]: [[f64; 2]; 2]| {
            (is_end(from, a) && is_end(to, b)) || (is_end(from, b) && is_end(to, a))
        };
        let [white, black] = ["#FFFFFF", "#1E1E1E"].map(|colour| segments(&svg, colour, 5));
        let at = |t: f64| [2.0 * t, 0.0];
        let right = |t: f64| {
            let share = (1.0 - t) / 0.6;
            [2.0 - 1.5 * share, 1.5 * share]
        };
        let left = |t: f64| [0.5 * t / 0.4, 1.5 * t / 0.4];
        for (found, ends) in [
            (&white, [at(0.2), left(0.2)]),
            (&white, [at(0.4), corners[2]]),
            (&black, [at(0.6), right(0.6)]),
            (&black, [at(0.8), right(0.8)]),
        ] {
            assert_eq!(found.iter().filter(|line| is_line(line, ends)).count(), 1, "{ends:?}");
        }
        assert_eq!(black.len(), 2, "{black:?}");
    }
    // of the second triangle the line of 0.2; 0.4 only touches it
    let [of_one, of_two] =
        [&one, &two].map(|mesh| segments(&picture_of(mesh, value), "#FFFFFF", 5).len());
    assert_eq!([of_one, of_two], [2, 3]);
}

/// The exact free boundary is the unit circle in a square of side three, found from the sign of a function.
#[test]
fn a_circle_is_found_from_its_inside_alone() {
    let scene = scenes::radial::<2>(1.0);
    let meshes = Hierarchy::of_domain(&scene.domain, 2).unwrap();
    let solved = solve(&scene.problem, &meshes, &ConformingP1).unwrap();
    let fields = solved.fields().unwrap();
    let svg = Picture::of("t", &scene.problem, solved.mesh(), &fields).unwrap().to_svg().unwrap();
    let unit = NARROW / 3.0;
    let centre = CORNERS[1].map(|edge| edge + 0.5 * NARROW);
    let radius = |x: [f64; 2]| (x[0] - centre[0]).hypot(x[1] - centre[1]);
    // the legend has a line of this style too, further away
    let is_inside = |[from, _]: &[[f64; 2]; 2]| radius(*from) < 0.5 * NARROW;
    let found: Vec<_> = segments(&svg, "#D55E00", 14).into_iter().filter(is_inside).collect();
    for end in found.as_flattened() {
        assert!((radius(*end) - unit).abs() <= 1.0, "{end:?}");
    }
    let length: f64 = found.into_iter().map(length).sum();
    let whole = std::f64::consts::TAU * unit;
    assert!((length / whole - 1.0).abs() < 5e-3, "{length} {whole}");
}
