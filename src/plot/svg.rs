//! Shapes of an SVG file made fewer.

/// Makes one path of lines that follow each other in the same style, which is shorter. Where `areas_meet`,
/// polygons are merged too, without the hair lines that viewers leave between neighbours they smooth one by
/// one.
pub(crate) fn merge_shapes(text: &str, areas_meet: bool) -> String {
    let mut merged = String::with_capacity(text.len() / 2);
    let mut open: Option<(bool, &str)> = None;
    let mut pen = None;
    for line in text.lines() {
        let parts = shape(line).filter(|(is_area, ..)| areas_meet || !is_area);
        let style = parts.map(|(is_area, style, _)| (is_area, style));
        if open.is_some() && open != style {
            merged += "\"/>\n";
            open = None;
        }
        let Some((is_area, style, points)) = parts else {
            merged += line;
            merged.push('\n');
            continue;
        };
        if open.is_none() {
            let kind = if is_area {
                "shape-rendering=\"crispEdges\" fill"
            } else {
                "fill=\"none\" stroke"
            };
            merged += &format!("<path {kind}=\"{style} d=\"");
            (open, pen) = (Some((is_area, style)), None);
        }
        pen = push_path(points, is_area, pen, &mut merged);
    }
    if open.is_some() {
        merged += "\"/>\n";
    }
    merged
}

/// Whether a line is an area, its style from the colour on, and its points; none if it is anything
/// but an opaque polygon or polyline.
fn shape(line: &str) -> Option<(bool, &str, &str)> {
    let area = line.strip_prefix("<polygon opacity=\"1\" fill=\"");
    let stroke = || line.strip_prefix("<polyline fill=\"none\" opacity=\"1\" stroke=\"");
    let (style, points) = area.or_else(stroke)?.split_once(" points=\"")?;
    Some((area.is_some(), style, points.strip_suffix("\"/>")?.trim()))
}

/// A path through points, each relative to the one before, the first to where the pen is; closed if it is that of
/// an area. Returns where the pen is then.
fn push_path(
    points: &str,
    is_area: bool,
    mut pen: Option<(i64, i64)>,
    path: &mut String,
) -> Option<(i64, i64)> {
    let mut first = None;
    for point in points.split_whitespace() {
        let Some((x, y)) = point.split_once(',') else { continue };
        let (Ok(x), Ok(y)) = (x.parse::<i64>(), y.parse::<i64>()) else { continue };
        let step = pen.map(|(a, b)| (x - a, y - b));
        match (first, step) {
            (None, None) => push_pair('M', x, y, path),
            (None, Some((0, 0))) => {}
            (None, Some((dx, dy))) => push_pair('m', dx, dy, path),
            (Some(_), Some((dx, 0))) => *path += &format!("h{dx}"),
            (Some(_), Some((0, dy))) => *path += &format!("v{dy}"),
            (Some(_), Some((dx, dy))) => push_pair('l', dx, dy, path),
            (Some(_), None) => {}
        }
        first = first.or(Some((x, y)));
        pen = Some((x, y));
    }
    if is_area {
        path.push('z');
        return first;
    }
    pen
}

/// A command of a path; a sign separates numbers as well as a space does.
fn push_pair(command: char, x: i64, y: i64, path: &mut String) {
    let space = if y < 0 { "" } else { " " };
    *path += &format!("{command}{x}{space}{y}");
}

#[cfg(test)]
mod tests {
    use super::merge_shapes;

    #[test]
    fn neighbours_of_one_style_become_one_path() {
        let text = "<svg>\n\
            <polygon opacity=\"1\" fill=\"#0072B2\" points=\"0,0 8,0 0,8 \"/>\n\
            <polygon opacity=\"1\" fill=\"#0072B2\" points=\"8,0 8,8 0,8 \"/>\n\
            <polygon opacity=\"1\" fill=\"#FFFFFF\" points=\"8,8 9,9 8,9 \"/>\n\
            <polyline fill=\"none\" opacity=\"1\" stroke=\"#1E1E1E\" stroke-width=\"6\" points=\"0,1 2,3 \"/>\n\
            <polyline fill=\"none\" opacity=\"1\" stroke=\"#1E1E1E\" stroke-width=\"6\" points=\"5,5 2,3 \"/>\n\
            <polyline fill=\"none\" opacity=\"1\" stroke=\"#1E1E1E\" stroke-width=\"4\" points=\"0,1 2,3 \"/>\n\
            <line/>\n</svg>\n";
        let wanted = "<svg>\n\
            <path shape-rendering=\"crispEdges\" fill=\"#0072B2\" d=\"M0 0h8l-8 8zm8 0v8h-8z\"/>\n\
            <path shape-rendering=\"crispEdges\" fill=\"#FFFFFF\" d=\"M8 8l1 1h-1z\"/>\n\
            <path fill=\"none\" stroke=\"#1E1E1E\" stroke-width=\"6\" d=\"M0 1l2 2m3 2l-3-2\"/>\n\
            <path fill=\"none\" stroke=\"#1E1E1E\" stroke-width=\"4\" d=\"M0 1l2 2\"/>\n\
            <line/>\n</svg>\n";
        assert_eq!(merge_shapes(text, true), wanted);
        let of_lines = merge_shapes(text, false);
        assert_eq!(of_lines.matches("<polygon").count(), 3);
        assert_eq!(of_lines.matches("<path").count(), 2);
    }
}
