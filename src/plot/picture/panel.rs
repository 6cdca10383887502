//! A panel of a picture.

use super::graph::Graph;
use super::map::Map;

/// A panel: a map of the domain, or a graph over one coordinate.
#[derive(Clone, Debug)]
pub(crate) enum Panel {
    Map(Map),
    Graph(Graph),
}

impl Panel {
    /// Height on paper.
    pub fn height(&self, width: f64) -> f64 {
        match self {
            Panel::Map(map) => map.height(width),
            Panel::Graph(graph) => graph.height(width),
        }
    }

    /// Number of lines and areas.
    pub fn shapes(&self) -> usize {
        match self {
            Panel::Map(map) => map.fills.len() + map.lines.len(),
            Panel::Graph(graph) => graph.lines.len(),
        }
    }
}
