//! Expressions in problem files: what they mean, which are polynomials, where mistakes are.

use std::f64::consts::{E, PI};
use std::path::Path;

use super::problem_files::problem;
use crate::support::scratch::Scratch;
use unilateral::prelude::*;
use unilateral::problem::BoundaryFlux;
use unilateral::problem_file::{ProblemFileError, read};
use unilateral::scenes::AnyScene;

/// Half the side of the cubes around the points at which expressions are evaluated.
const HALF: f64 = 0.1;

/// The problem in a small cube around a point whose load is an expression.
fn with_load(folder: &Scratch, text: &str, x: [f64; 3]) -> Result<Scene<3>, Box<ProblemFileError>> {
    let [lower, upper] = [-HALF, HALF].map(|shift| x.map(|x| x + shift));
    let text = format!(
        "box = [{lower:?}, {upper:?}]\n[boundary.default]\nkind = \"dirichlet\"\n\
         [source]\ndefault = {text:?}\n"
    );
    match read(Path::new(&folder.file("cube.toml", &text)))?.scene {
        AnyScene::Three(own) => Ok(own),
        _ => panic!("a problem in space"),
    }
}

fn at(folder: &Scratch, text: &str, x: [f64; 3]) -> f64 {
    let own = with_load(folder, text, x).unwrap_or_else(|error| panic!("{text}: {error}"));
    own.problem.source.everywhere.as_ref().unwrap().at(&Point::from(x))
}

#[test]
fn expressions_mean_what_they_mean_on_paper() {
    let folder = Scratch::new("expressions-on-paper");
    let x = [2.0, 3.0, 5.0];
    for (text, expected) in [
        ("-x^2", -4.0),
        ("2^3^2", 512.0),
        ("2**3", 8.0),
        ("2**3**2", 512.0),
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
        ("1 || 0 && 0", 1.0),
        ("2 && 3", 1.0),
        ("(2 <= x) + (x >= 2) + (x < 2) + (x > 2)", 2.0),
        ("!(x > y) + (x > 1)", 2.0),
        ("x + 1 > y - 1", 1.0),
        ("sign(-x) + sign(0) + sign(z)", 0.0),
        ("abs(-x) + sqrt(4) + exp(0) + ln(e) + log10(100)", 8.0),
        ("  ( ( x ) )\n + 1 ", 3.0),
        ("-10 * sin(pi * x) * y", -30.0 * (2.0 * PI).sin()),
    ] {
        let found = at(&folder, text, x);
        assert!((found - expected).abs() <= 1e-14 * expected.abs(), "{text}: {found}");
    }
}

/// The values are those of Python 3.11 with its module `math`, of the same formulas in its notation.
#[test]
fn expressions_have_the_values_of_another_program() {
    let folder = Scratch::new("expressions-elsewhere");
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
        let found = at(&folder, text, x);
        assert!((found - expected).abs() <= 4e-15 * expected.abs(), "{text}: {found:?}");
    }
}

/// Such data are refused.
#[test]
fn an_operand_that_is_not_a_number_leaves_no_number() {
    let folder = Scratch::new("expressions-nan");
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
        let message = with_load(&folder, text, x).err().map(|error| error.to_string());
        let is_nan = |message: String| message.contains("source.default is NaN at ");
        assert!(message.is_some_and(is_nan), "{text}");
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
        assert_eq!(at(&folder, text, x), expected, "{text}");
    }
}

#[test]
fn polynomials_have_their_degree() {
    let folder = Scratch::new("expressions-degree");
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
        let text = format!(
            "box = [[0.5, 0.5], [1, 1]]\n[boundary.default]\nkind = \"dirichlet\"\n\
             [boundary.bottom]\nkind = \"neumann\"\nflux = {text:?}\n"
        );
        let own = problem(&folder, &text).unwrap();
        let found = match &own.problem.neumann.named[0].1 {
            BoundaryFlux::Polynomial { degree, .. } => Some(*degree),
            BoundaryFlux::Function(_) => None,
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(found, degree, "{text}");
    }
}

#[test]
fn errors_have_their_place() {
    let folder = Scratch::new("expressions-place");
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
        let error = with_load(&folder, text, [1.0; 3]).unwrap_err();
        // the expression begins behind `default = "`, on the fifth line
        assert_eq!(error.place, Some([5, 12 + offset]), "{text}: {error}");
        assert!(error.to_string().contains(words), "{text}: {error}");
    }
}

#[test]
fn long_and_deep_expressions_are_refused() {
    let folder = Scratch::new("expressions-deep");
    let deep = "(".repeat(500) + "x" + &")".repeat(500);
    for (text, words) in [
        (deep, "has at most 1000 characters"),
        ("(".repeat(499) + "x" + &")".repeat(499), "nested 100 deep at most"),
        ("x^".repeat(300) + "x", "nested 100 deep at most"),
        ("x**".repeat(300) + "x", "nested 100 deep at most"),
        ("-".repeat(300) + "x", "nested 100 deep at most"),
        ("x+".repeat(2000) + "x", "has at most 1000 characters"),
    ] {
        let error = with_load(&folder, &text, [1.0; 3]).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let sum = "x+".repeat(450) + "x";
    assert_eq!(at(&folder, &sum, [1.0; 3]), 451.0);
}
