//! The order of the vertices of a cell that says where bisection divides the cell and its descendants.

use crate::mesh::edges::edge_vertices;

/// The refinement edge of one of the two faces of a tetrahedron that do not contain the refinement
/// edge of the tetrahedron.
///
/// Face 0 has the vertices at the positions 0, 2, 3, face 1 those at the positions 1, 2, 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FaceEdge {
    /// From position 0 (1) to position 2.
    To2,
    /// From position 0 (1) to position 3.
    To3,
    /// From position 2 to position 3.
    Opposite,
}

/// A cell whose vertices are ordered for bisection: the edge between the first two vertices is the *refinement
/// edge*, at whose midpoint the cell is divided.
///
/// In two dimensions this is newest vertex bisection: the refinement edge of a child is the edge
/// opposite the new vertex. In three dimensions every face has a refinement edge too, that of the cell
/// where the face contains it (D. N. Arnold, A. Mukherjee, L. Pouly, SIAM J. Sci. Comput. 22 (2000),
/// 431-448). A face and its refinement edge are the same for both cells of the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct OrderedCell {
    /// The first `D + 1` are the vertices.
    pub vertices: [u32; 4],
    /// The refinement edges of faces 0 and 1; in space only.
    face_edges: [FaceEdge; 2],
    /// Distinguishes two kinds of cells whose three refinement edges lie in one face.
    is_flagged: bool,
}

impl OrderedCell {
    /// A cell of an initial mesh, by its `D + 1` vertices: the refinement edge of the cell and of each
    /// face is the longest one. `is_longer` is a strict order of all edges of the mesh, each given by
    /// its vertices in ascending order.
    pub fn new<const D: usize>(
        cell: &[u32],
        is_longer: impl Fn([u32; 2], [u32; 2]) -> bool,
    ) -> Self {
        let longest = |edges: &[[usize; 2]]| {
            let ends = |k: usize| {
                let [a, b] = edges[k].map(|i| cell[i]);
                [a.min(b), a.max(b)]
            };
            let longer = |best, k| if is_longer(ends(k), ends(best)) { k } else { best };
            (1..edges.len()).fold(0, longer)
        };
        let edges = edge_vertices(D);
        let [i, j] = edges[longest(edges)];
        let mut order = [i, j, 0, 0];
        let others = (0..D + 1).filter(|k| ![i, j].contains(k));
        order[2..].iter_mut().zip(others).for_each(|(position, k)| *position = k);
        let [_, _, p, q] = order;
        let face_edge = |k: usize| {
            [FaceEdge::To2, FaceEdge::To3, FaceEdge::Opposite][longest(&[[k, p], [k, q], [p, q]])]
        };
        let face_edges = if D == 3 { [i, j].map(face_edge) } else { [FaceEdge::To2; 2] };
        let mut vertices = [0; 4];
        vertices[..=D].iter_mut().zip(order).for_each(|(vertex, k)| *vertex = cell[k]);
        Self { vertices, face_edges, is_flagged: false }
    }

    /// Child `k` of the cell, which has the vertex at position `k` (0 or 1) of the cell and the midpoint
    /// of the refinement edge, at its own position `D`. The second result has the positions in the cell
    /// of the other `D` vertices of the child.
    ///
    /// The face of the cell that the child contains keeps its refinement edge, which is that of the
    /// child. The refinement edge of half a face is opposite the new vertex, and so is that of the face
    /// between the children, unless the cell is flagged: then it joins the new vertex and the end that
    /// the refinement edges of both children have in common.
    pub fn child<const D: usize>(&self, k: usize, midpoint: u32) -> (Self, [usize; 3]) {
        let positions = match self.face_edges[k] {
            FaceEdge::To2 => [k, 2, 3],
            FaceEdge::To3 => [k, 3, 2],
            FaceEdge::Opposite => [2, 3, k],
        };
        let mut vertices = [0; 4];
        vertices[..D].iter_mut().zip(positions).for_each(|(v, i)| *v = self.vertices[i]);
        vertices[D] = midpoint;
        let [one, other] = self.face_edges;
        let in_one_face = D == 3 && one == other && one != FaceEdge::Opposite;
        let of_middle = if in_one_face && self.is_flagged { FaceEdge::To3 } else { FaceEdge::To2 };
        let is_flagged = in_one_face && !self.is_flagged;
        (Self { vertices, face_edges: [FaceEdge::To2, of_middle], is_flagged }, positions)
    }
}
