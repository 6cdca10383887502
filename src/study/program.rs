//! The program that made a report, and the machine.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::time::{SystemTime, UNIX_EPOCH};

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
    /// When the study began: the system's clock, in universal time; none where the system does not tell.
    pub date: Option<String>,
    /// The processor's name, on Linux.
    pub processor: Option<String>,
    /// The rest of the request, on which rows depend and which they do not state, by name: parameters of scenes, a mesh
    /// file.
    pub request: BTreeMap<String, String>,
    /// The command that makes the report again, for its page; files of rows do not have it.
    #[cfg_attr(feature = "report", serde(skip))]
    pub command: Option<String>,
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
            date: date_of(SystemTime::now()),
            processor: processor(),
            request: BTreeMap::new(),
            command: None,
        }
    }
    /// States when the study began, where that is not when this program was described. A time before 1970 is not
    /// stated.
    #[must_use]
    pub fn begun_at(mut self, time: SystemTime) -> Self {
        self.date = date_of(time);
        self
    }
    /// Program, date and machine in one line.
    #[cfg(feature = "report")]
    pub(crate) fn words(&self) -> String {
        let Self { name, version, threads, precision, target_cpu, date, processor, .. } = self;
        let known = |text: &Option<String>| text.clone().unwrap_or_else(|| "unknown".to_owned());
        let (date, processor) = (known(date), known(processor));
        format!(
            "{name} {version}, {date}; {target_cpu}, {processor}; {threads} threads; {precision}"
        )
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
    processor_of(&String::from_utf8_lossy(&text))
}

/// The first processor's name in the text the kernel gives.
fn processor_of(text: &str) -> Option<String> {
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Date and time of day; none before 1970.
fn date_of(time: SystemTime) -> Option<String> {
    let seconds = time.duration_since(UNIX_EPOCH).ok()?.as_secs();
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // years begin in March here, so that the day that comes and goes is their last
    let day = days + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    let year = 400 * era + year + next;
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    Some(format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z"))
}
