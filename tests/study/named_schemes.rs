//! Schemes as users write them: labels, what is refused, one scheme several times in a report.

use crate::support::scratch::Scratch;
use unilateral::mesh::BoxDomain;
use unilateral::prelude::*;
use unilateral::study::file_name;

fn label(text: &str) -> String {
    text.parse::<NamedScheme>().unwrap().to_string()
}

#[test]
fn labels_leave_out_what_is_default() {
    for (written, expected) in [
        ("p1", "p1"),
        ("p1:vertices", "p1"),
        ("p2:nodes", "p2"),
        ("p2:midpoints", "p2:midpoints"),
        ("p2:bernstein", "p2:bernstein"),
        ("nipg-p2:bernstein@sigma=2", "nipg-p2:bernstein@sigma=2"),
        ("cr:facet-means", "cr"),
        ("wopsip:vertices@factor=1", "wopsip"),
        ("wopsip:facet-means@eta=1e2", "wopsip:facet-means@eta=100"),
        ("wopsip@weight=isotropic", "wopsip"),
        ("wopsip@weight=anisotropic,factor=1e-4", "wopsip@factor=1e-4,weight=anisotropic"),
        ("wopsip-p2:midpoints@eta=1e10", "wopsip-p2:midpoints@eta=1e10"),
        ("sipg@factor=1.5", "sipg"),
        ("sipg@factor=1.05", "sipg@factor=1.05"),
        ("sipg@factor=0.3", "sipg@factor=0.3"),
        ("sipg-p2@sigma=10", "sipg-p2@sigma=10"),
        ("nipg@sigma=1", "nipg"),
        ("nipg@factor=2", "nipg@factor=2"),
        ("ldg-switch@sigma=2,lifts=full", "ldg-switch@sigma=2,lifts=full"),
        ("br2@factor=1.5,lifts=reduced", "br2"),
        ("br2-p2@lifts=full,factor=1.7", "br2-p2@factor=1.7,lifts=full"),
        ("bmmpr@factor=2", "bmmpr@factor=2"),
    ] {
        assert_eq!(label(written), expected);
        assert_eq!(label(expected), expected, "a label is a way to write the scheme");
    }
    // a scheme that a program makes has the label that a user would write
    let label = |scheme: &dyn Scheme<3>| scheme.label_on(&Nodes);
    assert_eq!(label(&Sipg { penalty: PenaltyRule::Proven(0.05) }), "sipg@factor=1.05");
    assert_eq!(label(&Br2 { factor: 1.5, lifts: Lifts::Full }.on(P2)), "br2-p2@lifts=full");
}

#[test]
fn an_item_without_a_name_continues_the_scheme_before_it() {
    let list = |text: &str| -> Vec<String> {
        let schemes = NamedScheme::list(text.split(',')).unwrap();
        schemes.iter().map(ToString::to_string).collect()
    };
    assert_eq!(list("ldg@sigma=2,lifts=full,p1"), ["ldg@sigma=2,lifts=full", "p1"]);
    assert_eq!(
        list("p1,wopsip,wopsip@factor=10,p1,wopsip@factor=1"),
        ["p1", "wopsip", "wopsip@factor=10"]
    );
    assert_eq!(
        list("wopsip@factor=1,wopsip@factor=100,sipg@factor=1.5,nipg"),
        ["wopsip", "wopsip@factor=100", "sipg", "nipg"]
    );
    assert_eq!(list("all,sipg@factor=1.05").len(), SCHEMES.len() + 1);
    assert_eq!(list("all,all").len(), SCHEMES.len());
}

#[test]
fn what_a_scheme_does_not_take_is_refused_with_what_it_takes() {
    let is_refused = |text: &str, why: &str| {
        let message = text.parse::<NamedScheme>().unwrap_err().to_string();
        assert!(message.contains(why), "{text}: {message}");
    };
    is_refused("p7", "unknown scheme \"p7\"; there are: p1");
    is_refused("sipg:edges", "there is no placement \"edges\"; there are: vertices");
    for unfit in
        ["sipg:midpoints", "p1:bernstein", "cr:bernstein", "sipg:bernstein", "p2:facet-means"]
    {
        is_refused(unfit, "the element of the scheme has no such values; it has: ");
    }
    is_refused("wopsip@sigma=1", "wopsip does not take \"sigma\"; it takes: factor");
    is_refused("wopsip@", "wopsip does not take \"\"");
    for value in ["", "=-1", "=NaN", "=inf", "=much", "="] {
        is_refused(&format!("wopsip@eta{value}"), "must be a number, positive and finite");
    }
    is_refused("wopsip@eta=1,factor=1", "the keys eta and factor choose the same penalty");
    is_refused("ldg@lifts=full,lifts=full", "the keys lifts and lifts choose the same");
    // every key of every scheme is taken, and no other
    let values = [
        ("factor", "2"),
        ("eta", "2"),
        ("sigma", "2"),
        ("weight", "anisotropic"),
        ("lifts", "full"),
    ];
    for (name, _) in SCHEMES {
        for (key, value) in values {
            let text = format!("{name}@{key}={value}");
            match text.parse::<NamedScheme>() {
                Ok(scheme) => assert_eq!(scheme.to_string(), text, "the key changes the scheme"),
                Err(error) => {
                    assert!(!keys_of_scheme(name).contains(&key), "{error}");
                    assert!(error.to_string().contains("does not take"), "{error}");
                }
            }
        }
    }
}

/// What stands for all schemes stands for those only that were named without it.
#[test]
fn choices_for_all_schemes_leave_those_alone_that_have_their_own() {
    let of = |text: &str| {
        let penalty =
            SchemeOptions { sigma: Some(10.0), eta: Some(3.0), ..SchemeOptions::default() };
        let scheme: NamedScheme = text.parse().unwrap();
        scheme.or_penalty(&penalty).or_placement("facet-means").to_string()
    };
    assert_eq!(of("sipg"), "sipg:facet-means@sigma=10");
    assert_eq!(of("sipg:vertices@factor=2"), "sipg@factor=2");
    assert_eq!(of("wopsip@weight=anisotropic"), "wopsip:facet-means@eta=3,weight=anisotropic");
    assert_eq!(of("p1"), "p1");
}

/// A factor is a multiple of the scale of the scheme.
#[test]
fn factors_are_multiples_of_the_scale_of_the_scheme() {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<2>::kuhn_box(&square, [2, 2]).unwrap();
    let parameters =
        |text: &str| text.parse::<NamedScheme>().unwrap().make::<2>().parameters(&mesh);
    let rule = |text: &str| parameters(text).rule.unwrap();
    assert_eq!(rule("sipg@factor=1.05"), "proven bound times 1.05");
    assert_eq!(parameters("br2@factor=2").eta, Some(6.0));
    assert_eq!(parameters("bmmpr@factor=2").eta, Some(2.0));
    assert!((parameters("wopsip@factor=3").eta.unwrap() - 6.0).abs() < 1e-14, "3 diam^2");
    assert!((parameters("wopsip-p2@factor=3").eta.unwrap() - 12.0).abs() < 1e-14, "3 diam^4");
}

/// A factor of the proven bound below one is below the bound.
#[test]
fn penalties_below_the_bound_are_told() {
    let run = |text: &str| {
        let study = Study::<2>::new(scenes::radial(1.0)).named_scheme(&text.parse().unwrap());
        study.levels([4]).run().unwrap().rows.swap_remove(0)
    };
    assert!(run("sipg@factor=0.9").warnings.iter().any(|w| w.contains("bound")));
    assert!(run("sipg@factor=1").warnings.is_empty() && run("nipg@factor=0.1").warnings.is_empty());
}

#[test]
fn one_scheme_stands_in_a_report_once_for_every_label() {
    let scratch = Scratch::new("labels");
    let written = "wopsip,wopsip@factor=10,wopsip:facet-means@factor=10";
    let schemes = NamedScheme::list(written.split(',')).unwrap();
    let study = Study::<2>::new(scenes::radial(1.0)).levels([4, 8]).fields_to(&scratch.0);
    let report = schemes.iter().fold(study, Study::named_scheme).run().unwrap();
    let labels: Vec<&str> = report.rows.iter().step_by(2).map(|row| &row.label[..]).collect();
    assert_eq!(labels, written.split(',').collect::<Vec<_>>());
    assert!(report.rows.iter().all(|row| row.scheme == "wopsip"));
    let errors: Vec<f64> = report.rows.iter().filter_map(|row| row.error.h1).collect();
    assert!(errors[1] != errors[3] && errors[3] != errors[5]);
    // each label has orders and a file of its own
    let has_order: Vec<bool> = report.rows.iter().map(|row| row.order.h1.is_some()).collect();
    assert_eq!(has_order, [false, true, false, true, false, true]);
    for label in labels {
        assert!(scratch.0.join(format!("radial-2d-{}.vtu", file_name(label))).exists(), "{label}");
        assert!(report.details_to_text(100).contains(&format!("\n{label} ")), "{report}");
    }
}
