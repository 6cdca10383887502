//! Tables in each of their formats: what stands where, and what is escaped.

use crate::rows::{report, row};
use crate::support::scratch::Scratch;
use crate::work_precision::synthetic::{measured, synthetic};
use unilateral::inequality::Outcome;
use unilateral::measure::{ContactErrors, Errors};
use unilateral::study::Row;

/// A label with every character that is special in LaTeX or in Markdown.
const SPECIAL: &str = "a_b & 50% {x} \\ ~^ $1 #2 <|> *[`";

#[test]
fn a_latex_table_is_a_tabular_with_a_caption() {
    let mut report = synthetic();
    for row in &mut report.rows {
        row.scene = "Case: one_two".into();
        if row.label == "p1" {
            row.label = SPECIAL.into();
        }
    }
    let tables = report.work_tables();
    let costs = tables.iter().find(|table| table.to_text(100).contains(": costs at ")).unwrap();
    assert_eq!(
        costs.to_latex(),
        "\\begin{table}\n\\centering\n\\caption{Case: one\\_two: costs at an error of 5e-3 in L2}\
         \\label{tab:case-one-two-costs}\n\\begin{tabular}{lrrrr}\n\\toprule\n\
         scheme & seconds & spread & unknowns & entries \\\\\n\\midrule\n\
         a\\_b \\& 50\\% \\{x\\} \\textbackslash{} \\textasciitilde{}\\textasciicircum{} \\$1 \\#2 \
         \\textless{}\\textbar{}\\textgreater{} *[` & \\num{2.83e-3} (\\num{1.00}) & -- & \
         \\num{1200} & \\num{14000} \\\\\n\
         sipg & \\num{8.49e-3} (\\num{3.00}) & -- & \\num{1200} & \\num{14000} \\\\\n\
         wopsip & \\num{1.27e-2} (\\num{4.50}) & -- & \\num{1200} & \\num{14000} \\\\\n\
         \\bottomrule\n\\end{tabular}\n\\par\\smallskip{\\footnotesize \
         spread: the median time of repeated runs over the least; - for what ran once\\par}\n\
         \\end{table}\n"
    );
    let markdown = costs.to_markdown();
    assert!(markdown.starts_with("### Case: one\\_two: costs at an error of 5e-3 in L2\n\n"));
    assert!(markdown.contains("| :-- | --: | --: | --: | --: |\n"), "{markdown}");
    let label = "| a\\_b & 50% {x} \\\\ ~^ $1 #2 \\<\\|> \\*\\[\\` | 2.83e-3 (1.00) | - | 1200 |";
    assert!(markdown.contains(label), "{markdown}");
    assert!(markdown.ends_with(
        "\n\n- spread: the median time of repeated runs over the least; - for what ran once\n"
    ));
}

/// Numbers behind a sign are numbers, words are none.
#[test]
fn numbers_in_latex_are_told_from_words() {
    let mut report = synthetic();
    let elsewhere = ["p1", "sipg"].map(|scheme| [8, 16].map(|n| measured(scheme, n, 1e-6)));
    report.rows.extend(elsewhere.into_iter().flatten().map(|mut row| {
        row.scene = "signorini-2d".into();
        row
    }));
    let text = report.to_latex();
    assert!(text.contains("& \\textgreater{} \\num{1.84e-2} "), "{text}");
    assert!(text.contains("wopsip & not run & not run"), "{text}");
}

/// Three rows, of which one has no errors.
fn few(labels: [&str; 3]) -> Vec<Row> {
    let mut rows = labels.map(|label| {
        let mut row = row("t", "p1", 8);
        row.label = label.into();
        (row.error, row.contact) = (Errors::default(), ContactErrors::default());
        row
    });
    rows[0].error.l2 = Some(2e-3);
    rows[2].error.l2 = Some(1e-3);
    rows[2].order.l2 = Some(1.5);
    rows[2].warnings = vec!["100% of _all_".into()];
    rows[1].unknowns = None;
    rows.to_vec()
}

#[test]
fn words_stand_left_numbers_right_and_the_best_is_marked() {
    let report = report(few(["p1", "wopsip", "cr"]));
    let text = report.summary_to_text(100);
    let table = &text[text.find("\nt, level 8").unwrap()..];
    let expected = "
t, level 8
scheme  unknowns        L2 (order)       H1  seconds  status
                                    (order)
p1           384           2.00e-3        -   0.0128  converged
wopsip         -                 -        -   0.0128  converged
cr           384  \u{2022} 1.00e-3 (1.50)        -   0.0128  converged
  cr: 100% of _all_
";
    assert_eq!(table, expected);
    let markdown = report.to_markdown();
    let lines = "| :-- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n\
                 | p1 | 8 | 1.25e-1 | 384 | 2.00e-3 | - | 8 | 2.5e-15 | 4 | 2.0e-4 | 0.0125 |\n\
                 | wopsip | 8 | 1.25e-1 | - | - | - | 8 | 2.5e-15 | 4 | 2.0e-4 | 0.0125 |\n";
    assert!(markdown.contains(lines), "{markdown}");
    assert!(markdown.contains("- cr: 100% of \\_all\\_\n"), "{markdown}");
    let scratch = Scratch::new("table-formats");
    report.write(&scratch.0).unwrap();
    let latex = scratch.read("report.tex");
    assert!(latex.contains("& \\textbf{\\num{1.00e-3} (\\num{1.50})} &"), "{latex}");
}

#[test]
fn columns_of_words_are_broken_where_lines_are_too_long() {
    let mut rows = few(["p1", "wopsip:facet-means@factor=10", "cr"]);
    rows[1].status = Outcome::Stalled;
    rows[1].message = Some("the residual fell no more".into());
    let text = report(rows).summary_to_text(50);
    let table = &text[text.find("\nt, level 8").unwrap()..];
    let expected = "
t, level 8
scheme  unknowns       L2 (order)      H1 seconds status
                                  (order)
p1           384          2.00e-3       -  0.0128 converged
wopsip:        -                -       -  0.0128 stalled
facet-
means@
factor=
10
cr           384 \u{2022} 1.00e-3 (1.50)       -  0.0128 converged
  wopsip:facet-means@factor=10: stalled: the
    residual fell no more
  cr: 100% of _all_
";
    assert_eq!(table, expected);
}
