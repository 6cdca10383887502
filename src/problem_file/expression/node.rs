//! The tree of an expression, and its value.

use super::functions::{One, Two, power, truth};

/// A node of the tree.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Number(f64),
    /// By its position in the list of variables.
    Variable(usize),
    Negative(Box<Node>),
    Arithmetic(Operator, Box<(Node, Node)>),
    One(One, Box<Node>),
    Two(Two, Box<(Node, Node)>),
    /// Condition, value if it is not zero, value if it is.
    If(Box<(Node, Node, Node)>),
}

/// An operation that makes polynomials of polynomials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operator {
    Plus,
    Minus,
    Times,
    Over,
    Power,
}

impl Operator {
    fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Plus => a + b,
            Self::Minus => a - b,
            Self::Times => a * b,
            Self::Over => a / b,
            Self::Power => power(a, b),
        }
    }
}

impl Node {
    /// An operation on two nodes.
    pub fn arithmetic(operator: Operator, a: Node, b: Node) -> Node {
        Node::Arithmetic(operator, Box::new((a, b)))
    }
    /// A function of two nodes.
    pub fn two(operation: Two, a: Node, b: Node) -> Node {
        Node::Two(operation, Box::new((a, b)))
    }

    /// The truth value of a node.
    fn truth(a: Node) -> Node {
        Node::two(|a, b| truth(a != b), a, Node::Number(0.0))
    }
    /// Whether both nodes are true; the second is not used if the first is false.
    pub fn and(a: Node, b: Node) -> Node {
        Node::If(Box::new((a, Self::truth(b), Node::Number(0.0))))
    }
    /// Whether a node or another is true; the other is not used if the first is true.
    pub fn or(a: Node, b: Node) -> Node {
        Node::If(Box::new((a, Node::Number(1.0), Self::truth(b))))
    }

    /// Whether a variable occurs, of those from this position of their list on.
    pub fn has_variables(&self, first: usize) -> bool {
        let has = |node: &Node| node.has_variables(first);
        match self {
            Node::Number(_) => false,
            Node::Variable(k) => *k >= first,
            Node::One(_, a) | Node::Negative(a) => has(a),
            Node::Two(_, ab) | Node::Arithmetic(_, ab) => has(&ab.0) || has(&ab.1),
            Node::If(three) => has(&three.0) || has(&three.1) || has(&three.2),
        }
    }

    /// The degree of the expression as a polynomial in the first `dimension` variables, the others being constants;
    /// none if it is no sum, product, quotient by a number or whole power of such.
    pub fn degree(&self, dimension: usize) -> Option<usize> {
        let of = |node: &Node| node.degree(dimension);
        match self {
            Node::Variable(k) => Some(usize::from(*k < dimension)),
            Node::Negative(a) => of(a),
            Node::Arithmetic(operator, ab) => {
                let (a, b) = &**ab;
                match operator {
                    Operator::Plus | Operator::Minus => Some(of(a)?.max(of(b)?)),
                    Operator::Times => of(a)?.checked_add(of(b)?),
                    Operator::Over => of(a).filter(|_| of(b) == Some(0)),
                    Operator::Power if b.has_variables(0) => None,
                    Operator::Power => {
                        let exponent = b.value(&[]);
                        let is_whole = exponent >= 0.0 && exponent.fract() == 0.0;
                        of(a)?.checked_mul(exponent as usize).filter(|_| is_whole)
                    }
                }
            }
            other => (!other.has_variables(0)).then_some(0),
        }
    }

    /// The value for values of the variables; NaN if an operand that is used is NaN. The branch of a condition that
    /// is not taken is not used.
    pub fn value(&self, variables: &[f64]) -> f64 {
        let at = |node: &Node| node.value(variables);
        match self {
            Node::Number(x) => *x,
            Node::Variable(k) => variables[*k],
            Node::Negative(a) => -at(a),
            // `max`, `pow`, comparisons and others would make a number of a NaN
            Node::One(f, a) => match at(a) {
                a if a.is_nan() => a,
                a => f(a),
            },
            Node::Arithmetic(operator, ab) => {
                of_numbers(at(&ab.0), at(&ab.1), |a, b| operator.value(a, b))
            }
            Node::Two(f, ab) => of_numbers(at(&ab.0), at(&ab.1), f),
            Node::If(three) => {
                let (condition, yes, no) = &**three;
                match at(condition) {
                    condition if condition.is_nan() => condition,
                    0.0 => at(no),
                    _ => at(yes),
                }
            }
        }
    }
}

/// A function of two values; NaN if one of them is.
fn of_numbers(a: f64, b: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
    match (a, b) {
        (a, _) if a.is_nan() => a,
        (_, b) if b.is_nan() => b,
        _ => f(a, b),
    }
}
