//! A report: what was run and what came out, and the files it is written to.

#[cfg(feature = "report")]
use super::csv;
#[cfg(feature = "plot")]
use super::plot::{convergence, work_precision};
use super::row::Row;
#[cfg(feature = "report")]
use crate::error::Error;
#[cfg(feature = "report")]
use std::path::{Path, PathBuf};

/// The program that made a report, and how it ran.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize))]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Version of the library.
    pub version: String,
    /// Number of threads.
    pub threads: usize,
    /// Scalar of assembly and solve: `f64` or `f32`.
    pub precision: String,
    /// Every time is the smallest of this many runs.
    pub repeat: usize,
    /// Architecture and the vector instructions it was compiled for.
    pub target_cpu: String,
}

impl Program {
    /// A program of this version of the library, compiled as it was.
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
/// This is a property of the executable. Instructions that the linear algebra picks at run time do
/// not show.
pub fn target_cpu() -> String {
    let mut features = Vec::new();
    macro_rules! list {
        ($($name:literal),*) => { $(if cfg!(target_feature = $name) { features.push($name); })* };
    }
    list!("avx2", "avx512f", "fma", "neon", "sve", "simd128", "v", "altivec", "vsx");
    // Every processor with AVX2 has what follows; it is news only where AVX2 is missing.
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
pub struct Report {
    /// The program.
    pub program: Program,
    /// One row for every scene, scheme and level.
    pub rows: Vec<Row>,
}

#[cfg(feature = "report")]
impl Report {
    /// The report as JSON. Numbers that do not apply, and numbers that are not finite, are null.
    pub fn to_json(&self) -> String {
        // `serde_json` writes every NaN and infinity as null: JSON has no other way. The value is
        // plain data with string keys, which is all it takes for the serialisation to succeed.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_else(|_| "null".to_owned());
        text.push('\n');
        text
    }

    /// The rows as comma-separated values: see [`to_csv`](super::to_csv).
    pub fn to_csv(&self) -> String {
        csv::to_csv(&self.rows)
    }

    /// Writes `report.json`, `report.csv` and the plots `convergence` and `work_precision`, each as
    /// `.svg` and `.png`, into a directory, which is made if need be. Returns the files in order.
    /// Without the feature `plot` there are no plots.
    ///
    /// # Errors
    /// [`Error::Write`] at the first file that cannot be written.
    pub fn write(&self, directory: impl AsRef<Path>) -> Result<Vec<PathBuf>, Error> {
        let directory = directory.as_ref();
        std::fs::create_dir_all(directory).map_err(|e| write_error(directory, e))?;
        let mut written = Vec::new();
        let mut put = |name: &str, file: &dyn Fn(&Path) -> Result<(), String>| {
            let path = directory.join(name);
            file(&path).map_err(|why| write_error(&path, why))?;
            written.push(path);
            Ok::<(), Error>(())
        };
        let text =
            |path: &Path, text: String| std::fs::write(path, text).map_err(|e| e.to_string());
        put("report.json", &|path| text(path, self.to_json()))?;
        put("report.csv", &|path| text(path, self.to_csv()))?;
        #[cfg(feature = "plot")]
        for (name, figure) in [
            ("convergence", convergence(&self.rows)),
            ("work_precision", work_precision(&self.rows)),
        ] {
            put(&format!("{name}.svg"), &|path| text(path, figure.to_svg()?))?;
            put(&format!("{name}.png"), &|path| figure.write_png(path))?;
        }
        Ok(written)
    }
}

/// What could not be written, and why.
#[cfg(feature = "report")]
pub(super) fn write_error(path: &Path, why: impl std::fmt::Display) -> Error {
    Error::Write { path: path.display().to_string(), why: why.to_string() }
}
