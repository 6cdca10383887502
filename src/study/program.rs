//! The program that made a report, and the machine.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;

/// The program that made a report, and its settings.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
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
    /// The processor's name, on Linux.
    pub processor: Option<String>,
    /// The rest of the request, on which rows depend and which they do not state, by name: parameters of scenes, a mesh
    /// file.
    pub request: BTreeMap<String, String>,
    /// The command that makes the report again, for its page; files of rows do not have it.
    #[cfg_attr(feature = "report", serde(skip))]
    pub command: Option<String>,
    /// The label of the scheme that verdicts on times compare with the others; of none the fastest. Files do not have it.
    #[cfg_attr(feature = "report", serde(skip))]
    pub subject: Option<String>,
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
            processor: processor(),
            request: BTreeMap::new(),
            command: None,
            subject: None,
        }
    }
    /// Program and machine in one line.
    #[cfg(feature = "report")]
    pub(crate) fn words(&self) -> String {
        let Self { name, version, threads, precision, target_cpu, processor, .. } = self;
        let processor = processor.as_deref().unwrap_or("unknown");
        format!("{name} {version}; {target_cpu}, {processor}; {threads} threads; {precision}")
    }
    /// States something else on which the rows depend.
    #[must_use]
    pub fn with_request(mut self, name: &str, value: impl ToString) -> Self {
        self.request.insert(name.to_owned(), value.to_string());
        self
    }
    /// The words of a command in one line, as a shell reads them.
    #[must_use]
    pub fn quoted(words: impl Iterator<Item = String>) -> String {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,@+".contains(c);
        let quoted = |word: String| match !word.is_empty() && word.chars().all(is_plain) {
            true => word,
            false => format!("'{}'", word.replace('\'', "'\\''")),
        };
        words.map(quoted).collect::<Vec<_>>().join(" ")
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

/// The name of the first processor, which the system states among the first lines of a long file.
fn processor() -> Option<String> {
    const FIRST_LINES: u64 = 4096;
    let mut text = Vec::new();
    File::open("/proc/cpuinfo").ok()?.take(FIRST_LINES).read_to_end(&mut text).ok()?;
    let text = String::from_utf8_lossy(&text);
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
