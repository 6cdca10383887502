//! The page docs/results/orders.md: observed orders beside those that theory promises, every scheme on every scene.

use std::fmt::Write;
use std::path::Path;

use unilateral::in_its_dimension;
use unilateral::measure::ErrorNorm;
use unilateral::prelude::*;
use unilateral::scenes::{Parameters, Scene, catalogue};
use unilateral::scheme::NamedScheme;
use unilateral::study::ObservedOrders;

/// An order may fall below a promised one by so much, and half the spread of its fit.
const TOLERANCE: f64 = 0.1;

const HEAD: &str = "\
# Observed and promised orders

Written by `cargo test --release --test study -- --ignored needs_time_to_write_the_page_of_orders`. Every scheme on the
scenes of the catalogue with default penalties and constraint sets, on four coarse levels. `docs/conventions.md` says how
an order is judged.

| scene | scheme | levels | L2 | promised | H1 | promised | verdict |
|---|---|---|--:|--:|--:|--:|---|
";

/// The orders of these schemes of one degree on a scene.
fn observed<const D: usize>(
    scene: Scene<D>,
    schemes: &[NamedScheme],
    degree: usize,
) -> Vec<ObservedOrders> {
    let levels: &[usize] = match (D, degree) {
        (1, _) => &[8, 16, 32, 64],
        (2, 1) => &[4, 8, 16, 32],
        (2, _) => &[2, 4, 8, 16],
        _ => &[1, 2, 3, 4],
    };
    let study = Study::<D>::new(scene).levels(levels.iter().copied());
    schemes.iter().fold(study, Study::named_scheme).run().unwrap().observed_orders()
}

/// A line of the table.
fn line(of: &ObservedOrders) -> String {
    let norms = [ErrorNorm::L2, ErrorNorm::H1];
    let mut line = format!("| {} | {} | {:?} |", of.scene, of.label, of.levels);
    for norm in norms {
        let fitted =
            of.fitted(norm).map_or("-".to_owned(), |fitted| format!("{:.2}", fitted.order));
        let promised = of.promised(norm).map_or("-".to_owned(), |order| order.to_string());
        write!(line, " {fitted} | {promised} |").unwrap();
    }
    let [l2, h1] = norms.map(|norm| of.verdict(norm, TOLERANCE).name());
    line + &if l2 == h1 { format!(" {l2} |\n") } else { format!(" L2 {l2}, H1 {h1} |\n") }
}

#[test]
#[ignore = "takes minutes, and writes a page"]
fn needs_time_to_write_the_page_of_orders() {
    let schemes = NamedScheme::list(["all"]).unwrap();
    let mut text = HEAD.to_owned();
    let mut missed = Vec::new();
    for entry in catalogue() {
        for degree in [1, 2] {
            let of_degree = |s: &&NamedScheme| s.name().ends_with("p2") == (degree == 2);
            let of_degree: Vec<NamedScheme> = schemes.iter().filter(of_degree).cloned().collect();
            let scene = entry.make(&Parameters::default()).unwrap();
            let found = in_its_dimension!(scene, |scene| observed(scene, &of_degree, degree));
            assert_eq!(found.len(), of_degree.len(), "{}", entry.name);
            found.iter().for_each(|of| text += &line(of));
            missed.extend(found.iter().flat_map(|of| of.missed(TOLERANCE)));
        }
    }
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/results/orders.md");
    std::fs::write(page, text).unwrap();
    let missed: Vec<String> = missed.iter().map(ToString::to_string).collect();
    println!("{} promises were not seen to be kept:\n{}", missed.len(), missed.join("\n"));
}
