//! The numbers at the axes of figures and pictures.

use super::svg::{FINE, rows_with, texts};
use unilateral::plot::{Picture, work_precision};
use unilateral::prelude::*;

/// Sizes of the numbers at axes, in a figure and in a picture.
const IN_FIGURE: usize = 112;
const IN_PICTURE: usize = 124;

/// Two numbers around which a logarithmic axis has these ends, exponents of ten: there is room of 0.07 of their distance
/// on either side of them, more where the axis would show less than a decade.
fn around([low, high]: [f64; 2]) -> [f64; 2] {
    let room = match high - low > 1.0 + 1e-9 {
        true => 0.07 / 1.14 * (high - low),
        false => 0.25,
    };
    [low + room, high - room].map(|exponent| 10.0_f64.powf(exponent))
}

/// The numbers at the axes of seconds and of errors that have these ends.
fn numbers(seconds: [f64; 2], errors: [f64; 2]) -> [Vec<String>; 2] {
    let [[before, after], [fine, coarse]] = [seconds, errors].map(around);
    let svg = work_precision(&rows_with(&[[coarse, before], [fine, after]])).to_svg();
    ["middle", "end"]
        .map(|anchor| texts(&svg, IN_FIGURE, anchor).into_iter().map(|text| text.1).collect())
}

fn of_errors(low: f64, high: f64) -> Vec<String> {
    let [_, errors] = numbers([-0.5, 0.5], [low, high]);
    errors
}

#[test]
fn powers_of_ten_are_labelled_and_thinned_out() {
    assert_eq!(of_errors(-3.2, 1.1), ["0.001", "0.01", "0.1", "1", "10"]);
    assert_eq!(of_errors(1.5, 3.9), ["100", "1000"]);
    let [seconds, errors] = numbers([-5.3, 3.3], [-16.3, 0.3]);
    assert_eq!(seconds, ["1e−4", "1e−2", "1e0", "1e2"]);
    assert_eq!(errors, ["1e−15", "1e−12", "1e−9", "1e−6", "1e−3", "1e0"]);
}

#[test]
fn a_short_axis_labels_digits_too() {
    assert_eq!(of_errors(-1.45, -0.45), ["0.05", "0.1", "0.2"]);
    assert_eq!(of_errors(0.6, 1.6), ["5", "10", "20"]);
    assert_eq!(of_errors(-6.4, -5.4), ["5e−7", "1e−6", "2e−6"]);
}

#[test]
fn a_single_value_gets_a_decade_around_it() {
    let svg = work_precision(&rows_with(&[[0.1, 1.0], [0.1, 2.0]])).to_svg();
    let texts = texts(&svg, IN_FIGURE, "end");
    let height = |number: &str| texts.iter().find(|text| text.1 == number).unwrap().0[1];
    // the area of the data is 222 units high, its upper edge is 40 units below that of the paper
    assert!((height("0.1") - FINE * (40.0 + 111.0)).abs() <= 1.0, "{texts:?}");
    let apart = height("0.05") - height("0.2");
    assert!((apart - FINE * 222.0 * 4.0_f64.log10()).abs() <= 1.0, "{texts:?}");
    // no value at all
    let none = work_precision(&rows_with(&[[f64::NAN, 1.0]])).to_svg();
    assert!(none.contains("no exact solution: no errors") && !none.contains("NaN"), "{none}");
}

/// The picture of a line over this interval, from zero to a value.
fn line([low, high]: [f64; 2], value: f64) -> String {
    let interval = BoxDomain::dirichlet(Point::from([low]), Point::from([high]));
    let mesh = Mesh::<1>::kuhn_box(&interval, [1]).unwrap();
    let mut fields = unilateral::measure::Fields::default();
    fields.u = vec![0.0, value];
    Picture::of("t", &Problem::new(), &mesh, &fields).unwrap().to_svg().unwrap()
}

/// The numbers below a line over this interval, and what stands under them.
fn below(ends: [f64; 2]) -> (Vec<String>, String) {
    let svg = line(ends, 1.0);
    let said = |size: usize| texts(&svg, size, "middle").into_iter().map(|text| text.1);
    let name = said(132).find(|text| text.starts_with('x')).unwrap();
    (said(IN_PICTURE).collect(), name)
}

#[test]
fn numbers_that_vanish_have_labels() {
    for value in [0.0, f64::from_bits(1), 1e-300] {
        let svg = line([0.0, 1.0], value);
        assert!(texts(&svg, IN_PICTURE, "end").iter().any(|text| text.1 == "0"), "{value:e}");
    }
}

#[test]
fn numbers_are_written_short_and_share_a_power() {
    assert_eq!(below([0.0, 1.0]).0, ["0.0", "0.5", "1.0"]);
    assert_eq!(below([0.0, 0.8]).0, ["0.0", "0.2", "0.4", "0.6", "0.8"]);
    assert_eq!(below([-1.5, 1.5]), (["\u{2212}1", "0", "1"].map(str::to_owned).into(), "x".into()));
    let (small, name) = below([0.0, 4.2e-5]);
    assert_eq!((small.join(" ").as_str(), &name[..]), ("0 1 2 3 4", "x / 1e\u{2212}5"));
    let (large, name) = below([0.0, 42_000.0]);
    assert_eq!((large.join(" ").as_str(), &name[..]), ("0 1 2 3 4", "x / 1e4"));
    // numbers at the other axis have their power in its name
    let svg = line([0.0, 1.0], 4e-5);
    assert!(svg.contains(">u / 1e\u{2212}5</text>"), "{svg}");
}
