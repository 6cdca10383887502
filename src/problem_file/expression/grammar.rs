//! The grammar: precedence of operators, numbers, names and calls.

use winnow::ascii::multispace0;
use winnow::combinator::{Infix, Prefix, alt, cut_err, delimited, expression, opt, separated};
use winnow::error::{ModalError, ParserError};
use winnow::prelude::*;
use winnow::stream::{Stateful, Stream};
use winnow::token::{literal, one_of, take_while};

use super::functions::truth;
use super::names::{Names, call};
use super::node::{Node, Operator};

/// What is left of an expression, and the names that it may use.
pub(super) type Input<'i, 'n> = Stateful<&'i str, Names<'n>>;

/// An error of the parser.
#[derive(Debug)]
pub(super) struct Left {
    /// The number of bytes that were left.
    pub bytes: usize,
    /// What is wrong, where it is more than something unexpected.
    pub message: Option<String>,
    /// Whether no other branch can read them.
    is_final: bool,
}

impl<'i, 'n> ParserError<Input<'i, 'n>> for Left {
    type Inner = Self;
    fn from_input(input: &Input<'i, 'n>) -> Self {
        Left { bytes: input.eof_offset(), message: None, is_final: false }
    }
    fn is_backtrack(&self) -> bool {
        !self.is_final
    }
    fn into_inner(self) -> Result<Self, Self> {
        Ok(self)
    }
}

impl ModalError for Left {
    fn cut(self) -> Self {
        Left { is_final: true, ..self }
    }
    fn backtrack(self) -> Self {
        Left { is_final: false, ..self }
    }
}

type Parsed<O> = Result<O, Left>;

/// An operation on two numbers, as an infix operator applies it to nodes.
macro_rules! of_two {
    ($operation:expr) => {
        |_: &mut _, a, b| Ok(Node::two($operation, a, b))
    };
}

/// An operation that makes polynomials of polynomials, as an infix operator applies it to nodes.
macro_rules! arithmetic {
    ($operator:ident) => {
        |_: &mut _, a, b| Ok(Node::arithmetic(Operator::$operator, a, b))
    };
}

/// An expression of any precedence, and the white space after it.
pub(super) fn sum(input: &mut Input<'_, '_>) -> Parsed<Node> {
    let sign = alt((
        ('-', multispace0).value(Prefix(9, |_: &mut _, a| Ok(Node::Negative(Box::new(a))))),
        ('+', multispace0).value(Prefix(9, |_: &mut _, a| Ok(a))),
        ('!', multispace0)
            .value(Prefix(9, |_: &mut _, a| Ok(Node::One(|a| truth(a == 0.0), Box::new(a))))),
    ));
    let operator = |text: &'static str| (literal(text), multispace0);
    let logic = alt((
        operator("||").value(Infix::Left(2, |_: &mut _, a, b| Ok(Node::or(a, b)))),
        operator("&&").value(Infix::Left(3, |_: &mut _, a, b| Ok(Node::and(a, b)))),
        operator("<=").value(Infix::Neither(4, of_two!(|a, b| truth(a <= b)))),
        operator(">=").value(Infix::Neither(4, of_two!(|a, b| truth(a >= b)))),
        operator("==").value(Infix::Neither(4, of_two!(|a, b| truth(a == b)))),
        operator("!=").value(Infix::Neither(4, of_two!(|a, b| truth(a != b)))),
        operator("<").value(Infix::Neither(4, of_two!(|a, b| truth(a < b)))),
        operator(">").value(Infix::Neither(4, of_two!(|a, b| truth(a > b)))),
    ));
    let arithmetic = alt((
        operator("+").value(Infix::Left(6, arithmetic!(Plus))),
        operator("-").value(Infix::Left(6, arithmetic!(Minus))),
        operator("**").value(Infix::Right(11, arithmetic!(Power))),
        operator("*").value(Infix::Left(8, arithmetic!(Times))),
        operator("/").value(Infix::Left(8, arithmetic!(Over))),
        operator("^").value(Infix::Right(11, arithmetic!(Power))),
    ));
    expression(operand).prefix(sign).infix(alt((logic, arithmetic))).parse_next(input)
}

fn operand(input: &mut Input<'_, '_>) -> Parsed<Node> {
    let parentheses = delimited(('(', multispace0), cut_err(sum), cut_err(')'));
    (alt((number, call_or_name, parentheses)), multispace0).map(|(node, _)| node).parse_next(input)
}

fn number(input: &mut Input<'_, '_>) -> Parsed<Node> {
    let digits = |c: char| c.is_ascii_digit();
    let mantissa = alt((
        (take_while(1.., digits), opt(('.', take_while(0.., digits)))).take(),
        ('.', take_while(1.., digits)).take(),
    ));
    let exponent = (one_of(['e', 'E']), opt(one_of(['+', '-'])), take_while(1.., digits));
    (mantissa, opt(exponent)).take().parse_to().map(Node::Number).parse_next(input)
}

/// A name, with the arguments of a function where a parenthesis follows.
fn call_or_name(input: &mut Input<'_, '_>) -> Parsed<Node> {
    let is_first = |c: char| c.is_ascii_alphabetic() || c == '_';
    let is_other = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let bytes = input.eof_offset();
    let name: &str = (one_of(is_first), take_while(0.., is_other)).take().parse_next(input)?;
    let wrong = |message| Left { bytes, message: Some(message), is_final: true };
    if !input.input.trim_ascii_start().starts_with('(') {
        return input.state.node(name).map_err(wrong);
    }
    let list = separated(0.., sum, (',', multispace0));
    let arguments: Vec<Node> =
        delimited((multispace0, '(', multispace0), list, cut_err(')')).parse_next(input)?;
    call(name, arguments).map_err(wrong)
}
