//! Shapes of an SVG file made fewer.

/// Makes one path of polygons, or of lines, that follow each other in the same style: shorter, and
/// without the hair lines that viewers leave between neighbours they smooth one by one.
pub(crate) fn merge_shapes(text: &str) -> String {
    let mut merged = String::with_capacity(text.len() / 2);
    let mut open: Option<(bool, &str)> = None;
    for line in text.lines() {
        let parts = shape(line);
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
            open = Some((is_area, style));
        }
        push_path(points, &mut merged);
        if is_area {
            merged.push('z');
        }
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

/// A path through points: the first as it is, the others relative to the one before.
fn push_path(points: &str, path: &mut String) {
    let mut last: Option<(i64, i64)> = None;
    for point in points.split_whitespace() {
        let Some((x, y)) = point.split_once(',') else { continue };
        let (Ok(x), Ok(y)) = (x.parse::<i64>(), y.parse::<i64>()) else { continue };
        match last {
            None => *path += &format!("M{x} {y}"),
            Some((a, b)) => *path += &format!("l{} {}", x - a, y - b),
        }
        last = Some((x, y));
    }
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
            <path shape-rendering=\"crispEdges\" fill=\"#0072B2\" d=\"M0 0l8 0l-8 8zM8 0l0 8l-8 0z\"/>\n\
            <path shape-rendering=\"crispEdges\" fill=\"#FFFFFF\" d=\"M8 8l1 1l-1 0z\"/>\n\
            <path fill=\"none\" stroke=\"#1E1E1E\" stroke-width=\"6\" d=\"M0 1l2 2M5 5l-3 -2\"/>\n\
            <path fill=\"none\" stroke=\"#1E1E1E\" stroke-width=\"4\" d=\"M0 1l2 2\"/>\n\
            <line/>\n</svg>\n";
        assert_eq!(merge_shapes(text), wanted);
    }
}
