//! Polygons of an SVG file made fewer.

/// Makes one path of polygons that follow each other in the same colour: shorter, and without the
/// hair lines that viewers leave between neighbours they smooth one by one.
pub(super) fn merge_polygons(text: &str) -> String {
    let mut merged = String::with_capacity(text.len() / 2);
    let mut open: Option<&str> = None;
    for line in text.lines() {
        let parts = polygon(line);
        if open.is_some() && open != parts.map(|p| p.0) {
            merged += "\"/>\n";
            open = None;
        }
        match parts {
            None => {
                merged += line;
                merged.push('\n');
            }
            Some((fill, points)) => {
                if open.is_none() {
                    merged += "<path shape-rendering=\"crispEdges\" fill=\"";
                    merged += fill;
                    merged += "\" d=\"";
                    open = Some(fill);
                }
                push_path(points, &mut merged);
            }
        }
    }
    if open.is_some() {
        merged += "\"/>\n";
    }
    merged
}

/// Fill and points of a line that is an opaque polygon and nothing else.
fn polygon(line: &str) -> Option<(&str, &str)> {
    let rest = line.strip_prefix("<polygon opacity=\"1\" fill=\"")?;
    let (fill, rest) = rest.split_once('"')?;
    let points = rest.strip_prefix(" points=\"")?.strip_suffix("\"/>")?;
    Some((fill, points.trim()))
}

/// A closed path through points: the first as it is, the others relative to the one before.
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
    path.push('z');
}

#[cfg(test)]
mod tests {
    use super::merge_polygons;

    #[test]
    fn neighbours_of_one_colour_become_one_path() {
        let text = "<svg>\n\
            <polygon opacity=\"1\" fill=\"#0072B2\" points=\"0,0 8,0 0,8 \"/>\n\
            <polygon opacity=\"1\" fill=\"#0072B2\" points=\"8,0 8,8 0,8 \"/>\n\
            <polygon opacity=\"1\" fill=\"#FFFFFF\" points=\"8,8 9,9 8,9 \"/>\n\
            <line/>\n</svg>\n";
        let wanted = "<svg>\n\
            <path shape-rendering=\"crispEdges\" fill=\"#0072B2\" d=\"M0 0l8 0l-8 8zM8 0l0 8l-8 0z\"/>\n\
            <path shape-rendering=\"crispEdges\" fill=\"#FFFFFF\" d=\"M8 8l1 1l-1 0z\"/>\n\
            <line/>\n</svg>\n";
        assert_eq!(merge_polygons(text), wanted);
    }
}
