//! The text of drawings, read as a viewer of SVG does, and how it is written.

use crate::rows::{report, row};
use unilateral::plot::{Picture, convergence, work_precision};
use unilateral::prelude::*;
use unilateral::study::Row;

/// Units of the coordinates in a file for one unit of its size.
pub const FINE: f64 = 8.0;

/// A closed or an open part of a path, by its corners.
struct Part {
    corners: Vec<[f64; 2]>,
    is_closed: bool,
}

/// The parts of a path. Steps are relative but for the first; where no step leads away from the end of a part, the next
/// one begins there.
fn parts(path: &str) -> Vec<Part> {
    let numbers = |text: &str| -> Vec<f64> {
        text.replace('-', " -").split_whitespace().map(|n| n.parse().unwrap()).collect()
    };
    let starts: Vec<usize> = path.match_indices(char::is_alphabetic).map(|(k, _)| k).collect();
    let ends = starts.iter().skip(1).copied().chain([path.len()]);
    let mut parts: Vec<Part> = Vec::new();
    let mut at = [0.0; 2];
    for (&start, end) in starts.iter().zip(ends) {
        let (command, text) = path[start..end].split_at(1);
        let numbers = numbers(text);
        let step = match command {
            "z" => {
                let last = parts.last_mut().unwrap();
                (last.is_closed, at) = (true, last.corners[0]);
                continue;
            }
            "h" => [numbers[0], 0.0],
            "v" => [0.0, numbers[0]],
            _ => [numbers[0], numbers[1]],
        };
        let moves = command.eq_ignore_ascii_case("m");
        if !moves && parts.last().unwrap().is_closed {
            parts.push(Part { corners: vec![at], is_closed: false });
        }
        at = if command == "M" { step } else { [at[0] + step[0], at[1] + step[1]] };
        match moves {
            true => parts.push(Part { corners: vec![at], is_closed: false }),
            false => parts.last_mut().unwrap().corners.push(at),
        }
    }
    parts
}

fn attribute<'t>(line: &'t str, name: &str) -> Option<&'t str> {
    line.split(&format!(" {name}=\"")).nth(1)?.split('"').next()
}

/// Areas that meet: the colour of each path, and the corners of each polygon.
pub fn paths(svg: &str) -> Vec<(String, Vec<Vec<[f64; 2]>>)> {
    let filled = svg.lines().filter(|line| line.starts_with("<path shape-rendering"));
    let of = |line: &str| {
        let parts = parts(attribute(line, "d").unwrap());
        assert!(parts.iter().all(|part| part.is_closed), "{line}");
        let polygons = parts.into_iter().map(|part| part.corners).collect();
        (attribute(line, "fill").unwrap().to_owned(), polygons)
    };
    filled.map(of).collect()
}

/// Lines of a colour and a width: the corners of each. The ends of an outline are apart.
pub fn lines(svg: &str, colour: &str, width: usize) -> Vec<Vec<[f64; 2]>> {
    let start = format!("<path fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"");
    let drawn = svg.lines().filter(|line| line.starts_with(&start));
    drawn.flat_map(|line| parts(attribute(line, "d").unwrap())).map(|part| part.corners).collect()
}

/// The segments of lines of a colour and a width.
pub fn segments(svg: &str, colour: &str, width: usize) -> Vec<[[f64; 2]; 2]> {
    let lines = lines(svg, colour, width).into_iter();
    lines
        .flat_map(|line| line.windows(2).map(|ends| [ends[0], ends[1]]).collect::<Vec<_>>())
        .collect()
}

/// The length of a segment.
pub fn length([a, b]: [[f64; 2]; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Texts of a size that are aligned in a way, `start`, `middle` or `end`: the place of each, and what it says.
pub fn texts(svg: &str, size: usize, anchor: &str) -> Vec<([f64; 2], String)> {
    let size = size.to_string();
    let is_meant = |line: &&str| {
        line.starts_with("<text ")
            && attribute(line, "font-size") == Some(&size)
            && attribute(line, "text-anchor") == Some(anchor)
    };
    let text = |line: &str| {
        let at = ["x", "y"].map(|name| attribute(line, name).unwrap().parse().unwrap());
        let pieces = line.split('<').skip(1).filter_map(|piece| Some(piece.split_once('>')?.1));
        (at, pieces.collect())
    };
    svg.lines().filter(is_meant).map(text).collect()
}

pub fn area(polygon: &[[f64; 2]]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    0.5 * polygon.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
}

/// The area that each path of areas that meet covers, with its colour.
pub fn areas(svg: &str) -> Vec<(String, f64)> {
    let sum = |polygons: &Vec<Vec<[f64; 2]>>| polygons.iter().map(|p| area(p)).sum();
    paths(svg).iter().map(|(fill, polygons)| (fill.clone(), sum(polygons))).collect()
}

/// The unit square in two triangles for each of `n` by `n` squares.
pub fn square(n: usize) -> Mesh<2> {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    Mesh::kuhn_box(&domain, [n; 2]).unwrap()
}

/// The picture of a function that is linear on each cell of a mesh.
pub fn picture_of(mesh: &Mesh<2>, u: impl Fn(&Point<2>) -> f64) -> String {
    let mut fields = unilateral::measure::Fields::default();
    fields.u = mesh.cells().iter().map(|&v| u(&mesh.vertices()[v as usize])).collect();
    let picture = Picture::of("t", &Problem::new(), mesh, &fields).unwrap();
    picture.to_svg().unwrap()
}

/// Rows of one scheme on successive levels with these errors in L2 and these seconds.
pub fn rows_with(errors_and_seconds: &[[f64; 2]]) -> Vec<Row> {
    let row = |(k, &[error, seconds]): (usize, &[f64; 2])| {
        let mut row = row("radial-2d", "p1", 8 << k);
        row.error.l2 = Some(error);
        row.seconds.total = seconds;
        row
    };
    errors_and_seconds.iter().enumerate().map(row).collect()
}

/// The style of a path; none of another line.
fn style(line: &str) -> Option<&str> {
    line.strip_prefix("<path ")?.split_once(" d=\"").map(|(style, _)| style)
}

/// In a picture the areas of one colour that follow each other are one path, and so are lines of one style: in a square
/// of two by two, the eight triangles.
#[test]
fn neighbours_of_one_style_become_one_path() {
    let svg = picture_of(&square(2), |_| 1.0);
    let paths_of_lines: Vec<&str> = svg.lines().filter_map(style).collect();
    assert!(paths_of_lines.windows(2).any(|pair| pair[0] != pair[1]));
    for pair in svg.lines().collect::<Vec<_>>().windows(2) {
        let [one, next] = [pair[0], pair[1]].map(style);
        assert!(one.is_none() || one != next, "{pair:?}");
    }
    // 358 units of paper for the side, of which the upper left corner is at (66, 62)
    let (colour, triangles) = &paths(&svg)[0];
    assert_eq!(triangles.len(), 8);
    for triangle in triangles {
        assert_eq!((triangle.len(), area(triangle)), (3, 1432.0 * 1432.0 / 2.0));
        for [x, y] in triangle {
            assert!([528.0, 1960.0, 3392.0].contains(x), "{x}");
            assert!([496.0, 1928.0, 3360.0].contains(y), "{y}");
        }
    }
    let whole = |first: &str| {
        let line = svg.lines().find(|line| line.starts_with(first)).unwrap();
        attribute(line, "d").unwrap().to_owned()
    };
    assert_eq!(
        whole("<path shape-rendering"),
        "M528 3360h1432v-1432zv-1432h1432zm1432 0h1432v-1432zv-1432h1432zm-1432-1432h1432v-1432zv-1432\
         h1432zm1432 0h1432v-1432zv-1432h1432z"
    );
    assert_eq!(svg.matches(&format!("fill=\"{colour}\"")).count(), 2, "one is on the bar");
}

/// In a figure marks are paths of their own, since they may overlap. Lines become one path, with no step between two
/// marks at one place.
#[test]
fn marks_are_apart_and_lines_are_not() {
    let svg = convergence(&rows_with(&[[1e-1, 1.0], [1e-2, 2.0], [1e-3, 3.0]])).to_svg();
    let marks: Vec<&str> =
        svg.lines().filter(|line| line.starts_with("<path fill=\"#0072B2\" d=")).collect();
    assert_eq!(marks.len(), 2 * 3 + 1, "three in each panel, and the legend");
    for mark in marks {
        assert_eq!((mark.matches('M').count(), mark.matches('z').count()), (1, 1), "{mark}");
    }
    let curves = lines(&svg, "#0072B2", 11);
    assert_eq!(curves.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3, 2]);
    let twice = work_precision(&rows_with(&[[1e-1, 1.0], [1e-1, 1.0], [1e-3, 3.0]])).to_svg();
    assert_eq!(lines(&twice, "#0072B2", 11).iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
    assert!(!twice.contains("h0") && !twice.contains("v0"), "{twice}");
    // curves of other schemes have dashes and open marks
    let mut both = rows_with(&[[1e-1, 1.0], [1e-2, 2.0]]);
    both.extend(rows_with(&[[2e-1, 1.0], [2e-2, 2.0]]).into_iter().map(|mut row| {
        (row.scheme, row.label) = ("cr".into(), "cr".into());
        row
    }));
    let svg = work_precision(&both).to_svg();
    let dashed = "stroke=\"#D55E00\" stroke-width=\"11\" stroke-dasharray=\"56 24\" d=\"M";
    assert_eq!(svg.matches(dashed).count(), 2, "the curve, and the legend");
    let open = lines(&svg, "#D55E00", 10);
    assert_eq!(open.iter().map(Vec::len).collect::<Vec<_>>(), [4, 4, 4], "two, and the legend");
}

#[test]
fn text_is_escaped() {
    let mut rows = rows_with(&[[1e-9, 1e-5], [1e-1, 10.0]]);
    rows.iter_mut().for_each(|row| row.scene = "a & b <2>".into());
    let svg = work_precision(&rows).to_svg();
    assert!(svg.contains(">a &amp; b &lt;2&gt;</text>"), "{svg}");
    let power =
        "dy=\"39\" font-size=\"112\" text-anchor=\"end\" fill=\"#1E1E1E\">1e\u{2212}8</text>";
    assert_eq!(svg.matches(power).count(), 1, "{svg}");
    let upwards = svg.lines().find(|line| line.contains(">L2 error<")).unwrap();
    let place = ["x", "y"].map(|name| attribute(upwards, name).unwrap());
    assert!(upwards.contains(&format!("transform=\"rotate(-90 {} {})\"", place[0], place[1])));
    // reports show the same drawing
    assert!(report(rows).to_json().contains("a & b <2>"));
}
