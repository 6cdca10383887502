//! Expressions in x, y, z, as one writes them on paper: `-x^2` is `-(x^2)`, `2^3^2` is `2^(3^2)`.
//!
//! | file | content |
//! |---|---|
//! | `mod` | [`Expression`]: reading and values |
//! | `grammar` | the parser |
//! | `names` | the meaning of names |
//! | `functions` | functions and constants |
//! | `node` | the tree of an expression |

mod functions;
mod grammar;
mod names;
mod node;

use winnow::ascii::multispace0;
use winnow::combinator::preceded;
use winnow::error::ParserError;
use winnow::prelude::*;

use crate::real::Point;
use grammar::{Input, Left, sum};
use names::SyntaxError;
pub(super) use names::{Names, VARIABLES, use_of_name};
use node::Node;

/// Longest expression, in characters, and deepest nesting of parentheses, powers and signs: the parser
/// descends into them.
const LONGEST: usize = 1000;
const DEEPEST: usize = 100;

/// An expression that has been read.
#[derive(Clone, Debug)]
pub(super) struct Expression(Node);

impl Expression {
    /// Reads an expression in these names.
    pub fn parse(text: &str, names: Names<'_>) -> Result<Self, SyntaxError> {
        let at = |offset: usize, message: String| SyntaxError { offset, message };
        if text.chars().count() > LONGEST {
            return Err(at(0, format!("an expression has at most {LONGEST} characters")));
        }
        if nesting(text) > DEEPEST {
            return Err(at(0, format!("parentheses and powers are nested {DEEPEST} deep at most")));
        }
        let mut rest = Input { input: text, state: names };
        let left = match preceded(multispace0, sum).parse_next(&mut rest) {
            Ok(node) if rest.is_empty() => return Ok(Self(node)),
            // where the last complete operand ends
            Ok(_) => Left::from_input(&rest),
            Err(left) => left,
        };
        let offset = text.len() - left.bytes;
        Err(at(
            offset,
            left.message.unwrap_or_else(|| match &text[offset..] {
                "" => "the expression ends where a number, a name or a parenthesis is expected"
                    .to_owned(),
                rest => {
                    let found: String = rest.chars().take(12).collect();
                    format!("`{found}` is not expected here")
                }
            }),
        ))
    }

    /// The value for values of the variables.
    pub fn value(&self, variables: &[f64]) -> f64 {
        self.0.value(variables)
    }
    /// The degree of a polynomial in the first `dimension` variables, the others being constants.
    pub fn degree(&self, dimension: usize) -> Option<usize> {
        self.0.degree(dimension)
    }
    /// The value of an expression without variables.
    pub fn constant(&self) -> Option<f64> {
        (!self.has_variables(0)).then(|| self.0.value(&[]))
    }
    /// Whether a variable occurs, of those from this position of their list on.
    pub fn has_variables(&self, first: usize) -> bool {
        self.0.has_variables(first)
    }
    /// The value at a point of the boundary with this outward normal.
    pub fn on_boundary<const D: usize>(&self, x: &Point<D>, normal: &Point<D>) -> f64 {
        let mut variables = [0.0; 6];
        variables[..D].copy_from_slice(x.as_slice());
        variables[D..2 * D].copy_from_slice(normal.as_slice());
        self.value(&variables[..2 * D])
    }
}

/// A bound of the depth to which the parser descends.
fn nesting(text: &str) -> usize {
    let (mut depth, mut deepest, mut powers, mut signs, mut most_signs) =
        (0_usize, 0, 0, 0_usize, 0);
    for c in text.chars().filter(|c| !c.is_whitespace()) {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            '^' => powers += 1,
            _ => {}
        }
        signs = if matches!(c, '+' | '-' | '!') { signs + 1 } else { 0 };
        most_signs = most_signs.max(signs);
        deepest = deepest.max(depth);
    }
    deepest + powers + text.matches("**").count() + most_signs
}
