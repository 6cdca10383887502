//! Schemes and scalars to choose from, and running one of them on one level.

use std::sync::Arc;

use crate::constraint::ConstraintSet;
use crate::error::Error;
use crate::mesh::{BoundaryFacet, Mesh, TaggedFacet};
use crate::real::Real;
use crate::scheme::{AnyScheme, NamedScheme, SchemeOptions};
use crate::study::{Row, Study, peak_memory_bytes};

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

/// A scheme over each scalar.
pub(crate) struct Candidate<'a, const D: usize> {
    pub double: Arc<dyn AnyScheme<f64, D> + 'a>,
    pub single: Arc<dyn AnyScheme<f32, D> + 'a>,
    /// Its constraint set, if that is not the problem's.
    pub set: Option<Arc<dyn ConstraintSet>>,
    /// The choices in its label, if those that are default are among them.
    pub shown: Option<SchemeOptions>,
}

impl<'a, const D: usize> Candidate<'a, D> {
    /// A scheme of either scalar.
    pub fn new(scheme: impl AnyScheme<f64, D> + AnyScheme<f32, D> + 'a) -> Self {
        let scheme = Arc::new(scheme);
        Self { double: scheme.clone(), single: scheme, set: None, shown: None }
    }
    /// A scheme as users write it.
    pub fn named(scheme: &NamedScheme) -> Self {
        let (double, single) = (scheme.make().into(), scheme.make().into());
        Self { double, single, set: scheme.constraint_set(), shown: scheme.shown_choices() }
    }
}

/// A study of one scheme on one level, over the scalar that was asked for.
pub(crate) enum OneStudy<'s, const D: usize> {
    Double(Study<'s, f64, D>),
    Single(Study<'s, f32, D>),
}

impl<const D: usize> OneStudy<'_, D> {
    /// Checks the study before anything is run.
    pub fn check(&self) -> Result<(), Error> {
        match self {
            Self::Double(study) => study.check(),
            Self::Single(study) => study.check(),
        }
    }
    /// Checks that the study fits into the memory.
    pub fn check_memory(&self) -> Result<(), Error> {
        match self {
            Self::Double(study) => study.check_memory(),
            Self::Single(study) => study.check_memory(),
        }
    }
    /// Runs the study with nothing known from before: the row, or those of all adaptive steps, and the phases of
    /// their times. The peak of memory is that of the process during the run, where the system tells.
    pub fn run(&self) -> Result<Vec<(Row, Phases)>, Error> {
        let is_reset = reset_peak_memory();
        let rows = match self {
            Self::Double(study) => study.run_alone()?,
            Self::Single(study) => study.run_alone()?,
        };
        let peak = peak_memory_bytes().filter(|_| is_reset);
        let of = |(row, coarse): (Row, f64)| {
            let phases = Phases::new(&row.seconds, coarse);
            (Row { peak_memory_bytes: peak, ..row }, phases)
        };
        Ok(rows.into_iter().map(of).collect())
    }
}

/// The mesh with its vertices rounded.
pub(crate) fn in_single_precision<const D: usize>(
    mesh: &Mesh<f64, D>,
) -> Result<Mesh<f32, D>, Error> {
    let tagged = |facet: &BoundaryFacet| {
        let mut vertices = [0; D];
        let own = mesh.facet_vertices(facet.cell as usize, facet.local as usize);
        vertices.iter_mut().zip(own).for_each(|(vertex, v)| *vertex = v);
        TaggedFacet { vertices, part: facet.part }
    };
    let boundary: Vec<_> = mesh.boundary().iter().map(tagged).collect();
    let rounded = Mesh::new(mesh.vertices().to_vec(), mesh.cells().to_vec(), &boundary)?;
    Ok(rounded.with_names_of(mesh))
}

/// The resident set of the process, where the system tells.
pub(crate) fn resident_memory_bytes() -> Option<u64> {
    peak_memory_bytes().filter(|_| reset_peak_memory()).and_then(|_| peak_memory_bytes())
}

/// Resets the peak of the resident set that the kernel records; `true` if it was reset. Linux only.
fn reset_peak_memory() -> bool {
    cfg!(target_os = "linux") && std::fs::write("/proc/self/clear_refs", "5").is_ok()
}
