//! Edges of sections: where two cells meet in the picture.

use std::collections::BTreeMap;

use super::section::{Corner, PlanePoint, Section, View};
use crate::arrays::array_of;

/// An edge of sections, and the cells beside it with the edge's ends in each.
pub(crate) struct Edge {
    pub ends: [PlanePoint; 2],
    pub sides: Vec<Side>,
}

/// A cell beside an edge.
pub(crate) struct Side {
    pub cell: usize,
    /// The ends of the edge by barycentric coordinates in the cell.
    ends: [[f64; 4]; 2],
}

/// All edges, each once. Both cells of an edge compute its ends from the same numbers, so that the
/// same bits are the same place.
pub(crate) fn edges(sections: &[Section]) -> Vec<Edge> {
    let mut known: BTreeMap<[[u64; 2]; 2], Edge> = BTreeMap::new();
    let bits = |corner: &Corner| corner.at.map(f64::to_bits);
    for section in sections {
        let n = section.corners.len();
        for k in 0..n {
            let (mut a, mut b) = (&section.corners[k], &section.corners[(k + 1) % n]);
            if bits(a) > bits(b) {
                (a, b) = (b, a);
            }
            let side = Side { cell: section.cell, ends: [a.barycentric, b.barycentric] };
            let new = || Edge { ends: [a.at, b.at], sides: Vec::new() };
            known.entry([bits(a), bits(b)]).or_insert_with(new).sides.push(side);
        }
    }
    known.into_values().collect()
}

/// The size of the mean jump of the function across an edge; none at the boundary.
pub(crate) fn mean_jump<const D: usize>(view: &View<'_, D>, edge: &Edge) -> Option<f64> {
    let [one, other] = &edge.sides[..] else { return None };
    // Simpson's rule is exact for quadratics
    let mean = |side: &Side| {
        let middle = array_of(|k| 0.5 * (side.ends[0][k] + side.ends[1][k]));
        let at = |barycentric| view.value(side.cell, barycentric);
        (at(&side.ends[0]) + 4.0 * at(&middle) + at(&side.ends[1])) / 6.0
    };
    Some((mean(one) - mean(other)).abs())
}

#[cfg(test)]
mod tests {
    use super::super::section::{Slice, View};
    use super::edges;
    use crate::measure::Fields;
    use crate::mesh::{BoxDomain, Mesh};
    use crate::real::Point;

    /// In sums of differences of these coordinates the last digit is lost.
    #[test]
    fn sections_on_the_boundary_of_a_mesh_meet_at_its_vertices() {
        let cube = BoxDomain::<3>::dirichlet(Point::repeat(0.1), Point::repeat(0.7));
        let mesh = Mesh::<3>::kuhn_box(&cube, [3; 3]).unwrap();
        let fields = Fields::default();
        for at in [0.1, 0.7] {
            let view = View::new(&mesh, &fields, Some(Slice { axis: 2, at }));
            let sections = view.sections();
            assert_eq!(sections.len(), 18);
            let outer = edges(&sections).iter().filter(|edge| edge.sides.len() == 1).count();
            assert_eq!(outer, 12, "at {at}");
        }
    }
}
