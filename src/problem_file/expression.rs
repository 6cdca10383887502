//! Expressions in x, y, z, as one writes them on paper: `-x^2` is `-(x^2)`, `2^3^2` is `2^(3^2)`.

use winnow::ascii::multispace0;
use winnow::combinator::{
    Infix, Prefix, alt, cut_err, delimited, expression, opt, preceded, separated,
};
use winnow::error::{ModalError, ParserError};
use winnow::prelude::*;
use winnow::token::{literal, one_of, take_while};

/// Longest expression, in characters, and deepest nesting of parentheses, powers and signs: the parser
/// descends into them.
const LONGEST: usize = 1000;
const DEEPEST: usize = 100;

/// A function of one number.
type One = fn(f64) -> f64;
/// A function of two numbers.
type Two = fn(f64, f64) -> f64;

const FUNCTIONS: [(&str, One); 21] = [
    ("abs", f64::abs),
    ("acos", f64::acos),
    ("asin", f64::asin),
    ("atan", f64::atan),
    ("cbrt", f64::cbrt),
    ("ceil", f64::ceil),
    ("cos", f64::cos),
    ("cosh", f64::cosh),
    ("exp", f64::exp),
    ("floor", f64::floor),
    ("ln", f64::ln),
    ("log", f64::ln),
    ("log10", f64::log10),
    ("log2", f64::log2),
    ("round", f64::round),
    ("sign", sign),
    ("sin", f64::sin),
    ("sinh", f64::sinh),
    ("sqrt", f64::sqrt),
    ("tan", f64::tan),
    ("tanh", f64::tanh),
];

const FUNCTIONS_OF_TWO: [(&str, Two); 3] =
    [("atan2", f64::atan2), ("hypot", f64::hypot), ("pow", f64::powf)];

/// Functions of two and more numbers.
const FUNCTIONS_OF_MANY: [(&str, Two); 2] = [("max", f64::max), ("min", f64::min)];

const CONSTANTS: [(&str, f64); 2] = [("e", std::f64::consts::E), ("pi", std::f64::consts::PI)];

/// The sign of a number, zero for zero.
fn sign(x: f64) -> f64 {
    if x == 0.0 { x } else { x.signum() }
}

/// An expression that has been read.
#[derive(Clone, Debug)]
pub(super) struct Expression(Node);

#[derive(Clone, Debug)]
enum Node {
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

/// Why an expression cannot be read, and where: an offset in bytes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SyntaxError {
    pub offset: usize,
    pub message: String,
}

/// An error of the parser.
#[derive(Debug)]
struct Left {
    /// The number of bytes that were left.
    bytes: usize,
    /// Whether no other branch can read them.
    is_final: bool,
}

impl<'i> ParserError<&'i str> for Left {
    type Inner = Self;
    fn from_input(input: &&'i str) -> Self {
        Left { bytes: input.len(), is_final: false }
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

impl Expression {
    /// Reads an expression in these variables.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, SyntaxError> {
        let at = |offset: usize, message: String| SyntaxError { offset, message };
        if text.chars().count() > LONGEST {
            return Err(at(0, format!("an expression has at most {LONGEST} characters")));
        }
        if nesting(text) > DEEPEST {
            return Err(at(0, format!("parentheses and powers are nested {DEEPEST} deep at most")));
        }
        let mut rest = text;
        let node = preceded(multispace0, sum).parse_next(&mut rest);
        let offset = match &node {
            Ok(_) if rest.is_empty() => text.len(),
            // where the last complete part ends
            Ok(_) => text.len() - rest.len(),
            Err(Left { bytes, .. }) => text.len() - bytes,
        };
        match node {
            Ok(node) if rest.is_empty() => Ok(Self(resolve(node, text.len(), variables)?)),
            _ if offset == text.len() => Err(at(
                offset,
                "the expression ends where a number, a name or a parenthesis is expected"
                    .to_owned(),
            )),
            _ => {
                let found: String = text[offset..].chars().take(12).collect();
                Err(at(offset, format!("`{found}` is not expected here")))
            }
        }
    }

    /// The value for values of the variables.
    pub fn value(&self, variables: &[f64]) -> f64 {
        value(&self.0, variables)
    }
    /// The value of an expression without variables.
    pub fn constant(&self) -> Option<f64> {
        (!has_variables(&self.0)).then(|| value(&self.0, &[]))
    }
}

fn has_variables(node: &Node) -> bool {
    match node {
        Node::Number(_) => false,
        Node::Variable(_) | Node::Name(..) | Node::Call(..) => true,
        Node::One(_, a) => has_variables(a),
        Node::Two(_, ab) => has_variables(&ab.0) || has_variables(&ab.1),
        Node::If(parts) => [&parts.0, &parts.1, &parts.2].into_iter().any(has_variables),
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

fn two(operation: Two, a: Node, b: Node) -> Node {
    Node::Two(operation, Box::new((a, b)))
}

/// A truth value as a number.
fn truth(condition: bool) -> f64 {
    f64::from(u8::from(condition))
}

/// An expression of any precedence, and the white space after it.
fn sum(input: &mut &str) -> Parsed<Node> {
    let sign = alt((
        ('-', multispace0).value(Prefix(9, |_: &mut _, a| Ok(Node::One(|a| -a, Box::new(a))))),
        ('+', multispace0).value(Prefix(9, |_: &mut _, a| Ok(a))),
        ('!', multispace0)
            .value(Prefix(9, |_: &mut _, a| Ok(Node::One(|a| truth(a == 0.0), Box::new(a))))),
    ));
    let operator = |text: &'static str| (literal(text), multispace0);
    let infix = alt((
        operator("||").value(Infix::Left(2, |_: &mut _, a, b| {
            Ok(two(|a, b| truth(a != 0.0 || b != 0.0), a, b))
        })),
        operator("&&").value(Infix::Left(3, |_: &mut _, a, b| {
            Ok(two(|a, b| truth(a != 0.0 && b != 0.0), a, b))
        })),
        operator("<=")
            .value(Infix::Neither(4, |_: &mut _, a, b| Ok(two(|a, b| truth(a <= b), a, b)))),
        operator(">=")
            .value(Infix::Neither(4, |_: &mut _, a, b| Ok(two(|a, b| truth(a >= b), a, b)))),
        operator("==")
            .value(Infix::Neither(4, |_: &mut _, a, b| Ok(two(|a, b| truth(a == b), a, b)))),
        operator("!=")
            .value(Infix::Neither(4, |_: &mut _, a, b| Ok(two(|a, b| truth(a != b), a, b)))),
        operator("<")
            .value(Infix::Neither(4, |_: &mut _, a, b| Ok(two(|a, b| truth(a < b), a, b)))),
        operator(">")
            .value(Infix::Neither(4, |_: &mut _, a, b| Ok(two(|a, b| truth(a > b), a, b)))),
    ));
    let arithmetic = alt((
        operator("+").value(Infix::Left(6, |_: &mut _, a, b| Ok(two(|a, b| a + b, a, b)))),
        operator("-").value(Infix::Left(6, |_: &mut _, a, b| Ok(two(|a, b| a - b, a, b)))),
        operator("**").value(Infix::Right(11, |_: &mut _, a, b| Ok(two(power, a, b)))),
        operator("*").value(Infix::Left(8, |_: &mut _, a, b| Ok(two(|a, b| a * b, a, b)))),
        operator("/").value(Infix::Left(8, |_: &mut _, a, b| Ok(two(|a, b| a / b, a, b)))),
        operator("^").value(Infix::Right(11, |_: &mut _, a, b| Ok(two(power, a, b)))),
    ));
    expression(operand).prefix(sign).infix(alt((infix, arithmetic))).parse_next(input)
}

/// A power; products for small whole exponents, which are faster and no less accurate.
fn power(a: f64, b: f64) -> f64 {
    match b {
        2.0 => a * a,
        3.0 => a * a * a,
        _ => a.powf(b),
    }
}

fn operand(input: &mut &str) -> Parsed<Node> {
    let parentheses = delimited(('(', multispace0), cut_err(sum), cut_err(')'));
    (alt((number, call_or_name, parentheses)), multispace0).map(|(node, _)| node).parse_next(input)
}

fn number(input: &mut &str) -> Parsed<Node> {
    let digits = |c: char| c.is_ascii_digit();
    let mantissa = alt((
        (take_while(1.., digits), opt(('.', take_while(0.., digits)))).take(),
        ('.', take_while(1.., digits)).take(),
    ));
    let exponent = (one_of(['e', 'E']), opt(one_of(['+', '-'])), take_while(1.., digits));
    (mantissa, opt(exponent)).take().parse_to().map(Node::Number).parse_next(input)
}

/// A name, with the arguments of a function where a parenthesis follows.
fn call_or_name(input: &mut &str) -> Parsed<Node> {
    let is_first = |c: char| c.is_ascii_alphabetic() || c == '_';
    let is_other = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let start = input.len();
    let name = (one_of(is_first), take_while(0.., is_other)).take().parse_next(input)?.to_owned();
    if preceded(multispace0::<&str, Left>, '(').parse_next(&mut &**input).is_err() {
        return Ok(Node::Name(name, start));
    }
    let comma = (',', multispace0);
    let list = separated(0.., sum, comma);
    let arguments = delimited((multispace0, '(', multispace0), list, cut_err(')'));
    arguments.map(|arguments| Node::Call(name.clone(), start, arguments)).parse_next(input)
}

/// Gives names their meaning.
fn resolve(node: Node, length: usize, variables: &[&str]) -> Result<Node, SyntaxError> {
    let of = |node| resolve(node, length, variables);
    Ok(match node {
        Node::One(f, a) => Node::One(f, Box::new(of(*a)?)),
        Node::Two(f, ab) => {
            let (a, b) = *ab;
            two(f, of(a)?, of(b)?)
        }
        Node::Name(name, left) => {
            if let Some(k) = variables.iter().position(|variable| *variable == name) {
                return Ok(Node::Variable(k));
            }
            match CONSTANTS.iter().find(|(constant, _)| *constant == name) {
                Some((_, value)) => Node::Number(*value),
                None => {
                    let known = variables.iter().chain(CONSTANTS.iter().map(|(name, _)| name));
                    let known: Vec<&str> = known.copied().collect();
                    let message = format!("there is no `{name}`; there are {}", known.join(", "));
                    return Err(SyntaxError { offset: length - left, message });
                }
            }
        }
        Node::Call(name, left, arguments) => {
            let arguments = arguments.into_iter().map(of).collect::<Result<Vec<_>, _>>()?;
            call(&name, arguments)
                .map_err(|message| SyntaxError { offset: length - left, message })?
        }
        other => other,
    })
}

/// A function with its arguments.
fn call(name: &str, arguments: Vec<Node>) -> Result<Node, String> {
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
        return if n == 2 { Ok(two(*f, next(), next())) } else { wrong_number("two arguments") };
    }
    if let Some((_, f)) = FUNCTIONS_OF_MANY.iter().find(|(known, _)| *known == name) {
        if n < 2 {
            return wrong_number("two or more arguments");
        }
        let first = next();
        return Ok(arguments.fold(first, |a, b| two(*f, a, b)));
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

fn value(node: &Node, variables: &[f64]) -> f64 {
    let at = |node| value(node, variables);
    match node {
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

#[cfg(test)]
mod tests {
    use super::Expression;
    use std::f64::consts::{E, PI};

    const VARIABLES: [&str; 3] = ["x", "y", "z"];

    fn at(text: &str, x: [f64; 3]) -> f64 {
        match Expression::parse(text, &VARIABLES) {
            Ok(expression) => expression.value(&x),
            Err(error) => panic!("{text}: {error:?}"),
        }
    }

    #[test]
    fn expressions_mean_what_they_mean_on_paper() {
        let x = [2.0, 3.0, 5.0];
        for (text, expected) in [
            ("-x^2", -4.0),
            ("2^3^2", 512.0),
            ("2**3", 8.0),
            ("x^-1", 0.5),
            ("2^-x*3", 0.75),
            ("-x*y", -6.0),
            ("x - y - z", -6.0),
            ("x / y / z", 2.0 / 15.0),
            ("1 - -x", 3.0),
            ("- (x + y) * z", -25.0),
            ("1e-3 * x", 2e-3),
            ("1.5E+2", 150.0),
            (".5 + 2. + 1e2", 102.5),
            ("2 * e", 2.0 * E),
            ("sin(pi / x)", (PI / 2.0).sin()),
            ("-sin(x)^2", -(2.0_f64.sin().powi(2))),
            ("min(x, y, z) + max(x,y)", 5.0),
            ("atan2(y, x)", 3.0_f64.atan2(2.0)),
            ("pow(x, 3) + hypot(3, 4)", 13.0),
            ("if(x < y, 1, 2)", 1.0),
            ("if(x >= y || z == 5, 1, 2)", 1.0),
            ("if(x <= y && z != 5, 1, 2)", 2.0),
            ("!(x > y) + (x > 1)", 2.0),
            ("x + 1 > y - 1", 1.0),
            ("sign(-x) + sign(0) + sign(z)", 0.0),
            ("abs(-x) + sqrt(4) + exp(0) + ln(e) + log10(100)", 8.0),
            ("  ( ( x ) )\n + 1 ", 3.0),
            ("-10 * sin(pi * x) * y", -30.0 * (2.0 * PI).sin()),
        ] {
            let found = at(text, x);
            assert!((found - expected).abs() <= 1e-14 * expected.abs(), "{text}: {found}");
        }
    }

    #[test]
    fn errors_have_their_place() {
        for (text, offset, words) in [
            ("", 0, "ends"),
            ("x +", 3, "ends"),
            ("2x", 1, "`x` is not expected"),
            ("x + * y", 4, "`* y` is not expected"),
            ("(x + y", 6, "ends"),
            ("x)", 1, "`)` is not expected"),
            ("1 + foo(x)", 4, "there is no function `foo`"),
            ("1 + w", 4, "there is no `w`; there are x, y, z, e, pi"),
            ("x + sin(x, y)", 4, "sin takes one argument, not 2"),
            ("if(x, 1)", 0, "a condition and two values"),
            ("max(x)", 0, "two or more"),
            ("x < y < z", 6, "`< z` is not expected"),
            ("x = 1", 2, "`= 1` is not expected"),
            ("x $ 1", 2, "`$ 1` is not expected"),
            ("inf", 0, "there is no `inf`"),
        ] {
            let error = Expression::parse(text, &VARIABLES).unwrap_err();
            assert_eq!(error.offset, offset, "{text}: {error:?}");
            assert!(error.message.contains(words), "{text}: {error:?}");
        }
    }

    #[test]
    fn long_and_deep_expressions_are_refused() {
        let deep = "(".repeat(500) + "x" + &")".repeat(500);
        for text in [
            deep,
            "x^".repeat(300) + "x",
            "x**".repeat(300) + "x",
            "-".repeat(300) + "x",
            "x+".repeat(2000) + "x",
        ] {
            assert!(Expression::parse(&text, &VARIABLES).is_err());
        }
        let sum = "x+".repeat(450) + "x";
        assert_eq!(at(&sum, [1.0; 3]), 451.0);
    }
}
