//! The meaning of names: variables, constants and functions.

use super::functions::{CONSTANTS, FUNCTIONS, Function};
use super::node::Node;

/// Why an expression cannot be read, and where: an offset in bytes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SyntaxError {
    pub offset: usize,
    pub message: String,
}

/// What names in an expression may mean, besides functions and the constants of all expressions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Names<'n> {
    pub variables: &'n [&'n str],
    /// The constants of the file.
    pub constants: &'n [(String, f64)],
    /// Constants of the file that this expression cannot use: its own, and those below it.
    pub below: &'n [String],
}

/// The coordinates, then the components of the normal.
pub(crate) const VARIABLES: [[&str; 3]; 2] = [["x", "y", "z"], ["nx", "ny", "nz"]];

/// Why a constant of a file cannot have this name, if it cannot.
pub(crate) fn use_of_name(name: &str) -> Option<&'static str> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if VARIABLES.concat().contains(&name) {
        Some("that is a coordinate")
    } else if CONSTANTS.iter().any(|(known, _)| *known == name) {
        Some("every expression has this number")
    } else if FUNCTIONS.iter().any(|(known, _)| *known == name) {
        Some("that is a function")
    } else if !starts || !name.chars().all(is_plain) {
        Some("a name has letters, digits and _, no digit first")
    } else {
        None
    }
}

impl Names<'_> {
    /// The meaning of a name.
    pub(super) fn node(&self, name: &str) -> Result<Node, String> {
        if let Some(k) = self.variables.iter().position(|variable| *variable == name) {
            return Ok(Node::Variable(k));
        }
        let own = self.constants.iter().map(|(name, value)| (&name[..], *value));
        let mut numbers = CONSTANTS.into_iter().chain(own);
        let known = self.variables.iter().copied().chain(numbers.clone().map(|(name, _)| name));
        match numbers.find(|(constant, _)| *constant == name) {
            Some((_, value)) => Ok(Node::Number(value)),
            None if self.below.iter().any(|other| other == name) => {
                Err(format!("`{name}` is not known here: a constant uses those above it"))
            }
            None => {
                let known: Vec<&str> = known.collect();
                Err(format!("there is no `{name}`; there are {}", known.join(", ")))
            }
        }
    }
}

/// A function with its arguments.
pub(super) fn call(name: &str, arguments: Vec<Node>) -> Result<Node, String> {
    let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
        let known = FUNCTIONS.map(|(name, _)| name).join(", ");
        return Err(format!("there is no function `{name}`; there are {known}"));
    };
    let n = arguments.len();
    let (fits, expected) = match function {
        Function::One(_) => (n == 1, "one argument"),
        Function::Two(_) => (n == 2, "two arguments"),
        Function::Many(_) => (n >= 2, "two or more arguments"),
        Function::If => (n == 3, "a condition and two values"),
    };
    if !fits {
        return Err(format!("{name} takes {expected}, not {n}"));
    }
    let mut arguments = arguments.into_iter();
    let mut next = || arguments.next().expect("so many arguments were counted");
    let first = next();
    Ok(match *function {
        Function::One(f) => Node::One(f, Box::new(first)),
        Function::Two(f) | Function::Many(f) => arguments.fold(first, |a, b| Node::two(f, a, b)),
        Function::If => Node::If(Box::new((first, next(), next()))),
    })
}
