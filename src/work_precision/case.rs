//! Schemes and scalars to choose from, and running one of them on one level.

use crate::error::Error;
use crate::nested::AnyScheme;
use crate::real::Real;
use crate::study::{MemoryEstimate, Row, SchemeOptions, Study, peak_memory_bytes, scheme_by_name};

use super::measured::Phases;

/// The scalar of assembly and solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// `f64`.
    #[default]
    Double,
    /// `f32`.
    Single,
}

impl Precision {
    /// Both by the names users type.
    pub const NAMES: [(&'static str, Self); 2] = [("f64", Self::Double), ("f32", Self::Single)];

    /// The name users type and reports state.
    pub fn name(self) -> &'static str {
        match self {
            Self::Double => <f64 as Real>::NAME,
            Self::Single => <f32 as Real>::NAME,
        }
    }
}

/// A scheme that can be made for either scalar as often as it is needed.
pub trait Candidate<const D: usize> {
    /// The scheme in `f64`; none if its name is unknown.
    fn double(&self) -> Option<Box<dyn AnyScheme<f64, D> + '_>>;
    /// The scheme in `f32`.
    fn single(&self) -> Option<Box<dyn AnyScheme<f32, D> + '_>>;
}

impl<const D: usize, S: AnyScheme<f64, D> + AnyScheme<f32, D> + Clone> Candidate<D> for S {
    fn double(&self) -> Option<Box<dyn AnyScheme<f64, D> + '_>> {
        Some(Box::new(self.clone()))
    }
    fn single(&self) -> Option<Box<dyn AnyScheme<f32, D> + '_>> {
        Some(Box::new(self.clone()))
    }
}

/// A registered scheme.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Its name.
    pub name: String,
    /// What was chosen about it.
    pub options: SchemeOptions,
}

impl<const D: usize> Candidate<D> for Named {
    fn double(&self) -> Option<Box<dyn AnyScheme<f64, D> + '_>> {
        scheme_by_name(&self.name, &self.options)
    }
    fn single(&self) -> Option<Box<dyn AnyScheme<f32, D> + '_>> {
        scheme_by_name(&self.name, &self.options)
    }
}

/// A study of one scheme on one level, whatever its scalar.
pub(crate) trait Single {
    /// Checks it before anything is run.
    fn check(&self) -> Result<(), Error>;
    /// The memory it will need.
    fn memory_estimate(&self) -> Option<MemoryEstimate>;
    /// Runs it with nothing known from before: the row, and the phases of its time. The peak of
    /// memory is that of the process while it ran, where the system tells.
    fn run(&self) -> Result<(Row, Phases), Error>;
}

impl<T: Real, const D: usize> Single for Study<'_, T, D> {
    fn check(&self) -> Result<(), Error> {
        Study::check(self)
    }
    fn memory_estimate(&self) -> Option<MemoryEstimate> {
        Study::memory_estimate(self)
    }
    fn run(&self) -> Result<(Row, Phases), Error> {
        let is_reset = reset_peak_memory();
        let (mut row, coarse) = self.run_alone()?;
        row.peak_memory_bytes = peak_memory_bytes().filter(|_| is_reset);
        let phases = Phases::new(&row.seconds, coarse);
        Ok((row, phases))
    }
}

/// Makes the kernel forget the largest resident set so far; tells whether it did. Linux only.
fn reset_peak_memory() -> bool {
    cfg!(target_os = "linux") && std::fs::write("/proc/self/clear_refs", "5").is_ok()
}
