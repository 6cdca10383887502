//! The file of figures: one line a row, in the order of requests.

use std::collections::BTreeMap;
use std::fs;

use super::columns::{COLUMNS, Column, Kind};
use serde_json::Value;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/figures.csv");

/// On another machine a figure may differ by this share of itself: of direct solves, of iterative ones, whose tolerance
/// it is, and of solves in single precision.
const SHARES: [f64; 3] = [1e-9, 1e-6, 1e-3];

/// On another machine counts of degenerate rows may differ by this much.
const LARGEST_DIFFERENCE: f64 = 2.0;

/// Scenes in which gap and multiplier vanish together on a set: rounding decides which unknowns are active there.
const DEGENERATE: [&str; 7] = [
    "biactive",
    "degenerate",
    "grazing",
    "oscillating",
    "signorini-smooth",
    "signorini-halves",
    "pyramid-full",
];

/// The figures of rows by request, scene, scheme and level.
#[derive(Clone, Default)]
pub struct Figures {
    /// The texts of the columns.
    pub rows: BTreeMap<String, Vec<String>>,
    /// What rows that were found state as their rounding errors, by column.
    rounding: BTreeMap<String, Vec<f64>>,
}

/// Processor and system, on which the last bits of elementary functions and factorisations depend.
pub fn machine() -> String {
    let value = |file: &str, key: &str| {
        let text = fs::read_to_string(file).unwrap_or_default();
        let line = text.lines().find(|line| line.starts_with(key)).unwrap_or_default();
        line.split_once([':', '=']).map_or("", |(_, value)| value).trim().replace('"', "")
    };
    let processor = ["model name", "cpu family", "model\t"].map(|key| value("/proc/cpuinfo", key));
    let flags = value("/proc/cpuinfo", "flags");
    let vectors = ["avx2", "fma", "avx512f"].into_iter();
    let vectors: Vec<&str> = vectors.filter(|v| flags.split(' ').any(|flag| flag == *v)).collect();
    let (processor, vectors) = (processor.join(" "), vectors.join(" "));
    format!("{processor}; {vectors}; {}", value("/etc/os-release", "PRETTY_NAME"))
}

impl Figures {
    /// The figures of the rows of a request; violations of a certificate are held against a limit.
    pub fn of(request: &str, limit: f64, rows: &[Value]) -> Self {
        let mut found = Self::default();
        for row in rows {
            let word = |key: &str| row[key].as_str().unwrap().to_owned();
            let key = format!("{request},{},{},{:03}", word("scene"), word("label"), row["level"]);
            let texts = COLUMNS.iter().map(|column| column.text(row, limit)).collect();
            let rounding = COLUMNS.iter().map(|column| column.rounding(row)).collect();
            found.rounding.insert(key.clone(), rounding);
            assert!(found.rows.insert(key.clone(), texts).is_none(), "two rows of {key}");
        }
        assert!(!found.rows.is_empty(), "{request} has no rows");
        found
    }

    pub fn extend(&mut self, other: Self) {
        self.rows.extend(other.rows);
        self.rounding.extend(other.rounding);
    }

    /// The machine of the file, and its figures.
    pub fn read() -> (String, Self) {
        let text = fs::read_to_string(FILE).unwrap();
        let mut lines = text.lines();
        let machine = lines.next().and_then(|line| line.strip_prefix("# of ")).unwrap().to_owned();
        assert_eq!(lines.next(), Some(&head()[..]), "the columns of the file are others");
        let mut figures = Self::default();
        for line in lines {
            let cells: Vec<&str> = line.split(',').collect();
            let (key, texts) = cells.split_at(4);
            figures.rows.insert(key.join(","), texts.iter().map(|&t| t.to_owned()).collect());
        }
        (machine, figures)
    }

    pub fn write(&self) {
        let mut text = format!("# of {}\n{}\n", machine(), head());
        for (key, texts) in &self.rows {
            text += &format!("{key},{}\n", texts.join(","));
        }
        fs::write(FILE, text).unwrap();
    }

    /// Where these figures are not those expected for some requests, a line each.
    pub fn differences(
        &self,
        expected: &Self,
        requests: &[&str],
        has_same_bits: bool,
    ) -> Vec<String> {
        let is_asked = |key: &&String| requests.contains(&key.split(',').next().unwrap());
        let mut found = Vec::new();
        for (key, old) in expected.rows.iter().filter(|(key, _)| is_asked(key)) {
            let Some(new) = self.rows.get(key) else {
                found.push(format!("{key}: the row is missing"));
                continue;
            };
            let rounding = self.rounding.get(key);
            for (k, column) in COLUMNS.iter().enumerate() {
                let rounding = rounding.map_or(0.0, |rounding| rounding[k]);
                let is_same = old[k] == new[k]
                    || !has_same_bits && is_near(key, column, [&old[k], &new[k]], (new, rounding));
                if !is_same {
                    found.push(format!("{key}: {} was {}, is {}", column.name, old[k], new[k]));
                }
            }
        }
        let is_new = |key: &&String| is_asked(key) && !expected.rows.contains_key(*key);
        found.extend(self.rows.keys().filter(is_new).map(|key| format!("{key}: the row is new")));
        found
    }
}

fn head() -> String {
    let names: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
    format!("request,scene,scheme,level,{}", names.join(","))
}

/// Whether a figure differs from another one as figures of two machines do.
fn is_near(
    key: &str,
    column: &Column,
    [old, new]: [&str; 2],
    (row, rounding): (&[String], f64),
) -> bool {
    let is_degenerate = DEGENERATE.iter().any(|scene| key.contains(scene));
    let stages = COLUMNS.iter().position(|column| column.name == "stages").unwrap();
    let share = match key.split(',').next() {
        Some("single-precision") => SHARES[2],
        _ if row[stages] != "direct-active-set" => SHARES[1],
        _ => SHARES[0],
    };
    let numbers = |text: &str| {
        let cut = |c: char| c == ' ' || c == '=';
        text.split(cut).map(|part| part.parse::<f64>().ok()).collect::<Vec<_>>()
    };
    let pairs = || numbers(old).into_iter().zip(numbers(new));
    let differ_by = |most: &dyn Fn(f64) -> f64| {
        numbers(old).len() == numbers(new).len()
            && pairs().all(|pair| match pair {
                (Some(old), Some(new)) => (old - new).abs() <= most(old.abs()),
                (old, new) => old == new,
            })
    };
    match column.kind {
        Kind::Word => false,
        Kind::Count => is_degenerate && differ_by(&|_| LARGEST_DIFFERENCE),
        Kind::Figure(_) if is_degenerate && column.name == "contact" => true,
        Kind::Figure(_) => differ_by(&|size| share * size + 2.0 * rounding),
    }
}
