//! The midpoints of divided edges.

/// The vertices of a mesh and the midpoints of its divided edges, each found by the ends of its edge.
pub(super) struct Midpoints {
    /// The two vertices whose midpoint a vertex is, ascending; twice the vertex itself where it is none.
    pub parents: Vec<[u32; 2]>,
    /// For each vertex the first midpoint of an edge to a vertex of higher number.
    first: Vec<u32>,
    /// For each midpoint the next one of an edge with the same lower vertex.
    next: Vec<u32>,
}

/// No midpoint.
const NONE: u32 = u32::MAX;

impl Midpoints {
    /// The vertices of a mesh, of which no edge is divided.
    pub fn new(n_vertices: usize) -> Self {
        let parents = (0..n_vertices as u32).map(|v| [v, v]).collect();
        Self { parents, first: vec![NONE; n_vertices], next: vec![NONE; n_vertices] }
    }
    /// The midpoint of the edge between two vertices, if the edge is divided.
    pub fn get(&self, a: u32, b: u32) -> Option<u32> {
        let (lower, upper) = (a.min(b), a.max(b));
        let mut found = self.first[lower as usize];
        while found != NONE && self.parents[found as usize][1] != upper {
            found = self.next[found as usize];
        }
        (found != NONE).then_some(found)
    }
    /// Divides the edge between two vertices, which no midpoint divides yet. The midpoint has the next
    /// number.
    pub fn add(&mut self, a: u32, b: u32) -> u32 {
        let (lower, upper) = (a.min(b), a.max(b));
        let number = self.parents.len() as u32;
        self.parents.push([lower, upper]);
        self.next.push(std::mem::replace(&mut self.first[lower as usize], number));
        self.first.push(NONE);
        number
    }
}
