//! The meaning of names: variables, constants and functions.

use super::functions::{CONSTANTS, FUNCTIONS, FUNCTIONS_OF_MANY, FUNCTIONS_OF_TWO};
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
    let of_two = FUNCTIONS_OF_TWO.iter().chain(&FUNCTIONS_OF_MANY).map(|(name, _)| *name);
    let mut functions = FUNCTIONS.iter().map(|(name, _)| *name).chain(of_two).chain(["if"]);
    if VARIABLES.concat().contains(&name) {
        Some("that is a coordinate")
    } else if CONSTANTS.iter().any(|(known, _)| *known == name) {
        Some("every expression has this number")
    } else if functions.any(|known| known == name) {
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
    let n = arguments.len();
    let wrong_number = |expected: &str| Err(format!("{name} takes {expected}, not {n}"));
    let mut arguments = arguments.into_iter();
    let mut next = || arguments.next().unwrap_or(Node::Number(f64::NAN));
    if let Some((_, f)) = FUNCTIONS.iter().find(|(known, _)| *known == name) {
        return if n == 1 {
            Ok(Node::One(*f, Box::new(next())))
        } else {
            wrong_number("one argument")
        };
    }
    if let Some((_, f)) = FUNCTIONS_OF_TWO.iter().find(|(known, _)| *known == name) {
        return if n == 2 {
            Ok(Node::two(*f, next(), next()))
        } else {
            wrong_number("two arguments")
        };
    }
    if let Some((_, f)) = FUNCTIONS_OF_MANY.iter().find(|(known, _)| *known == name) {
        if n < 2 {
            return wrong_number("two or more arguments");
        }
        let first = next();
        return Ok(arguments.fold(first, |a, b| Node::two(*f, a, b)));
    }
    if name == "if" {
        return match n {
            3 => Ok(Node::If(Box::new((next(), next(), next())))),
            _ => wrong_number("a condition and two values"),
        };
    }
    let of_many = FUNCTIONS_OF_TWO.iter().chain(&FUNCTIONS_OF_MANY).map(|(name, _)| *name);
    let known: Vec<&str> =
        FUNCTIONS.iter().map(|(name, _)| *name).chain(of_many).chain(["if"]).collect();
    Err(format!("there is no function `{name}`; there are {}", known.join(", ")))
}
