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
use winnow::prelude::*;

use crate::real::Point;
use grammar::{Left, sum};
use names::{SyntaxError, resolve};
use node::Node;

/// Longest expression, in characters, and deepest nesting of parentheses, powers and signs: the parser
/// descends into them.
const LONGEST: usize = 1000;
const DEEPEST: usize = 100;

/// An expression that has been read.
#[derive(Clone, Debug)]
pub(super) struct Expression(Node);

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
            // where the last complete operand ends
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

    /// The values are those of Python 3.11 with its module `math`, of the same formulas in its notation.
    #[test]
    fn expressions_have_the_values_of_another_program() {
        let x = [0.7, -1.3, 2.5];
        for (text, expected) in [
            ("x^3", 0.3429999999999999),
            ("x^2", 0.48999999999999994),
            ("x**4", 0.24009999999999995),
            ("y^3", -2.197),
            ("z^-3", 0.064),
            ("x^2.5", 0.409963413001697),
            ("2^x^y", 3.01030575027795),
            ("-x^3", -0.3429999999999999),
            ("x - y^3 / z", 1.5788),
            ("x * y - z / x", -4.481428571428571),
            ("1 / (x * y^2)", 0.8453085376162299),
            ("abs(y)", 1.3),
            ("acos(x)", 0.7953988301841436),
            ("asin(x)", 0.775397496610753),
            ("atan(y)", -0.9151007005533605),
            ("cbrt(y)", -1.091392883061106),
            ("ceil(y)", -1.0),
            ("ceil(x)", 1.0),
            ("cos(y)", 0.26749882862458735),
            ("cosh(z)", 6.132289479663686),
            ("exp(y)", 0.2725317930340126),
            ("floor(y)", -2.0),
            ("ln(z)", 0.9162907318741551),
            ("log(x)", -0.35667494393873245),
            ("log10(z)", 0.3979400086720376),
            ("log2(z)", 1.3219280948873624),
            ("round(x)", 1.0),
            ("round(y)", -1.0),
            ("sign(y)", -1.0),
            ("sin(z)", 0.5984721441039565),
            ("sinh(y)", -1.698382437292616),
            ("sqrt(z)", 1.5811388300841898),
            ("tan(y)", -3.6021024479679786),
            ("tanh(x)", 0.6043677771171636),
            ("atan2(y, x)", -1.0768549578753155),
            ("hypot(x, y)", 1.47648230602334),
            ("pow(z, x)", 1.8991444823309347),
            ("max(x, y, z)", 2.5),
            ("min(x, y, z)", -1.3),
            ("e^y * pi", 0.8561838788653079),
            ("if(x < y, sin(x), cos(x)) + if(z >= 2.5, 1, 2)", 1.7648421872844886),
            ("exp(-(x^2 + y^2) / 2) * cos(3 * pi * x)", 0.3197608872256973),
        ] {
            let found = at(text, x);
            assert!((found - expected).abs() <= 4e-15 * expected.abs(), "{text}: {found:?}");
        }
    }

    #[test]
    fn an_operand_that_is_not_a_number_leaves_no_number() {
        let x = [1.0, 3.0, 5.0];
        for text in [
            "min(0/0, 1)",
            "min(1, 0/0)",
            "max(log(x - 2), 1)",
            "max(1, y, log(x - 2))",
            "(0/0)^0",
            "1^(0/0)",
            "pow(0/0, 0)",
            "hypot(1/0, 0/0)",
            "atan2(0/0, 1)",
            "sign(0/0)",
            "log(x - 2) > 0",
            "0/0 != 0/0",
            "!(0/0)",
            "1 && 0/0",
            "0/0 || 1",
            "0/0 && 0",
            "if(log(x - 2) < 1, 1, 2)",
            "if(x < 2, log(x - 2), 2)",
        ] {
            assert!(at(text, x).is_nan(), "{text}: {}", at(text, x));
        }
        for (text, expected) in [
            ("if(x > 2, log(x - 2), -1)", -1.0),
            ("if(x < 2, 4, 0/0)", 4.0),
            ("x > 2 && log(x - 2) > 0", 0.0),
            ("x < 2 || log(x - 2) > 0", 1.0),
            ("x > 2 || y", 1.0),
            ("x < 2 && y - 3", 0.0),
            ("min(1/0, x)", 1.0),
        ] {
            assert_eq!(at(text, x), expected, "{text}");
        }
    }

    #[test]
    fn polynomials_have_their_degree() {
        let variables = ["x", "y", "nx", "ny"];
        for (text, degree) in [
            ("0.1 + 0.3 * x", Some(1)),
            ("-x^2 * y - (x + y)^3 / 2", Some(3)),
            ("(x * y)^2 * (x - 1)**3", Some(7)),
            ("x^0 + sqrt(2) * sin(pi)", Some(0)),
            ("x * nx + y * ny", Some(1)),
            ("nx / ny", Some(0)),
            ("x^(1 + 1)", Some(2)),
            ("(x^12)^2", Some(24)),
            ("x^(1e30) * y", None),
            ("x^-1", None),
            ("x^0.5", None),
            ("2^x", None),
            ("1 / x", None),
            ("abs(x)", None),
            ("sin(x) + y", None),
            ("if(x < 0.5, 0, 1)", None),
            ("min(x, y)", None),
            ("x > 0", None),
        ] {
            let found = Expression::parse(text, &variables).unwrap().degree(2);
            assert_eq!(found, degree, "{text}");
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
