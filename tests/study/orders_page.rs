//! The page docs/results/orders.md: observed orders beside those that theory promises, every scheme on every scene.

use std::fmt::Write;
use std::path::Path;

use unilateral::in_its_dimension;
use unilateral::prelude::*;
use unilateral::scenes::{Parameters, Scene, catalogue};
use unilateral::scheme::NamedScheme;
use unilateral::study::{ObservedOrder, OrderVerdict};

/// An order may fall below a promised one by so much, and half the spread of its fit.
const TOLERANCE: f64 = 0.1;

const HEAD: &str = "\
# Observed and promised orders

Written by `cargo test --release --test study -- --ignored needs_time_to_write_the_page_of_orders`. Every scheme on the
scenes of the catalogue with default penalties and constraint sets, each with its orders in L2 and in H1.
`docs/conventions.md` says how an order is judged.
";

/// The orders of these schemes of one degree on a scene, with the dimension.
fn observed<const D: usize>(
    scene: Scene<D>,
    schemes: &[NamedScheme],
    degree: usize,
) -> (usize, Vec<ObservedOrder>) {
    let levels: &[usize] = match (D, degree) {
        (1, _) => &[16, 32, 64, 128, 256],
        (2, 1) => &[4, 8, 16, 32, 64],
        (2, _) => &[2, 4, 8, 16, 32],
        (_, 1) => &[2, 4, 8, 16],
        _ => &[2, 4, 6, 8],
    };
    let study = Study::<D>::new(scene).levels(levels.iter().copied());
    (D, schemes.iter().fold(study, Study::named_scheme).run().unwrap().observed_orders(TOLERANCE))
}

/// The numbers of verdicts of each scheme.
fn counts(schemes: &[NamedScheme], found: &[ObservedOrder]) -> String {
    let heads = OrderVerdict::ALL.map(OrderVerdict::name).join(" | ");
    let mut table = format!("| scheme | {heads} |\n|---|--:|--:|--:|--:|--:|--:|\n");
    for scheme in schemes {
        let label = scheme.to_string();
        let of_scheme = found.iter().filter(|of| of.label == label);
        let verdicts: Vec<_> = of_scheme.map(|of| of.verdict).collect();
        let count = |wanted| verdicts.iter().filter(|found| **found == wanted).count().to_string();
        writeln!(table, "| {label} | {} |", OrderVerdict::ALL.map(count).join(" | ")).unwrap();
    }
    table
}

#[test]
#[ignore = "takes half an hour, and writes a page"]
fn needs_time_to_write_the_page_of_orders() {
    let schemes = NamedScheme::list(["all"]).unwrap();
    let mut found: [Vec<ObservedOrder>; 3] = Default::default();
    for entry in catalogue() {
        for degree in [1, 2] {
            let of_degree = |s: &&NamedScheme| s.name().ends_with("p2") == (degree == 2);
            let of_degree: Vec<NamedScheme> = schemes.iter().filter(of_degree).cloned().collect();
            let scene = entry.make(&Parameters::default()).unwrap();
            let (dimension, orders) =
                in_its_dimension!(scene, |scene| observed(scene, &of_degree, degree));
            assert_eq!(orders.len(), 2 * of_degree.len(), "{}", entry.name);
            found[dimension - 1].extend(orders);
        }
    }
    let mut text = HEAD.to_owned();
    for (title, found) in ["One dimension", "Two dimensions", "Three dimensions"].iter().zip(&found)
    {
        write!(text, "\n## {title}\n\n{}", counts(&schemes, found)).unwrap();
        use OrderVerdict::{Exact, Kept, NothingPromised};
        let missed = found.iter();
        let missed = missed.filter(|of| !matches!(of.verdict, Kept | Exact | NothingPromised));
        let missed: Vec<String> = missed.map(|missed| format!("* {missed}\n")).collect();
        if !missed.is_empty() {
            write!(text, "\nPromises that were not seen to be kept:\n\n{}", missed.concat())
                .unwrap();
        }
    }
    std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/results/orders.md"), text)
        .unwrap();
}
