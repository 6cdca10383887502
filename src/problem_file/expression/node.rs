//! The tree of an expression, and its value.

use super::functions::{One, Two};

/// A node of the tree.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Number(f64),
    /// By its position in the list of variables.
    Variable(usize),
    One(One, Box<Node>),
    Two(Two, Box<(Node, Node)>),
    /// Condition, value if it is not zero, value if it is.
    If(Box<(Node, Node, Node)>),
    /// A name that has no meaning yet: where it ends, counted from the end of the text.
    Name(String, usize),
    /// A function with its arguments, before it is looked up.
    Call(String, usize, Vec<Node>),
}

impl Node {
    /// A function of two nodes.
    pub fn two(operation: Two, a: Node, b: Node) -> Node {
        Node::Two(operation, Box::new((a, b)))
    }

    /// Whether a variable occurs.
    pub fn has_variables(&self) -> bool {
        match self {
            Node::Number(_) => false,
            Node::Variable(_) | Node::Name(..) | Node::Call(..) => true,
            Node::One(_, a) => a.has_variables(),
            Node::Two(_, ab) => ab.0.has_variables() || ab.1.has_variables(),
            Node::If(parts) => [&parts.0, &parts.1, &parts.2].into_iter().any(Node::has_variables),
        }
    }

    /// The value for values of the variables.
    pub fn value(&self, variables: &[f64]) -> f64 {
        let at = |node: &Node| node.value(variables);
        match self {
            Node::Number(x) => *x,
            Node::Variable(k) => variables[*k],
            Node::One(f, a) => f(at(a)),
            Node::Two(f, ab) => f(at(&ab.0), at(&ab.1)),
            Node::If(parts) => {
                let (condition, yes, no) = &**parts;
                if at(condition) != 0.0 { at(yes) } else { at(no) }
            }
            // names are resolved when an expression is read
            Node::Name(..) | Node::Call(..) => f64::NAN,
        }
    }
}
