//! A report: rows, and the program that ran them.

use super::row::Row;

/// The program that made a report, and its settings.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Program {
    /// Name of the program.
    pub name: String,
    /// Version of the library.
    pub version: String,
    /// Number of threads.
    pub threads: usize,
    /// Scalar of assembly and solve: `f64` or `f32`.
    pub precision: String,
    /// Every time is the smallest of this many runs.
    pub repeat: usize,
    /// Architecture and vector instructions for which the program was compiled.
    pub target_cpu: String,
}

impl Program {
    /// A program linked with this version of the library and compiled for the processor that the
    /// library was compiled for.
    #[must_use]
    pub fn new(name: &str, precision: &str, threads: usize, repeat: usize) -> Self {
        Program {
            name: name.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            threads,
            precision: precision.to_owned(),
            repeat,
            target_cpu: target_cpu(),
        }
    }
}

/// The architecture and the vector instructions the compiler was allowed to use: `x86_64 (sse2)`
/// by default on common machines, `x86_64 (avx2, avx512f, fma)` with `-C target-cpu=native` on a
/// recent one.
///
/// The text describes the executable. Instructions that the linear algebra selects at run time are
/// not listed.
fn target_cpu() -> String {
    let mut features = Vec::new();
    macro_rules! list {
        ($($name:literal),*) => { $(if cfg!(target_feature = $name) { features.push($name); })* };
    }
    list!("avx2", "avx512f", "fma", "neon", "sve", "simd128", "v", "altivec", "vsx");
    // processors with AVX2 have the following features: listed only without AVX2
    if features.is_empty() {
        list!("avx", "sse4.2", "sse2");
        features.truncate(1);
    }
    match features.as_slice() {
        [] => std::env::consts::ARCH.to_owned(),
        some => format!("{} ({})", std::env::consts::ARCH, some.join(", ")),
    }
}

/// Rows in the order run, and the program that ran them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// The program.
    pub program: Program,
    /// One row for every scene, scheme and level.
    pub rows: Vec<Row>,
}

impl Report {
    /// A report of rows that a program ran.
    #[must_use]
    pub fn new(program: Program, rows: Vec<Row>) -> Self {
        Self { program, rows }
    }
}
