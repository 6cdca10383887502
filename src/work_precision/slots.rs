//! The cases of a study of work against precision, each with its own study, checked before anything runs.

use super::WorkPrecision;
use super::case::Candidate;
use super::measured::{Case, Failure, Measured};
use crate::error::Error;
use crate::inequality::{ActiveSet, in_precision};
use crate::linear::LinearMethod;
use crate::nested::Adaptivity;
use crate::real::Precision;
use crate::study::{Meshes, Study, Variant};

/// A case, its study, and its results so far.
pub(super) struct Slot<'s, const D: usize> {
    pub case: Case,
    pub study: Study<'s, D>,
    /// The case one level coarser, by its place in the list.
    pub coarser: Option<usize>,
    /// A row, or on adaptive meshes one for each step.
    pub measured: Vec<Measured>,
    pub failure: Option<Failure>,
}

impl<'a, const D: usize> WorkPrecision<'a, D> {
    /// All cases, variant by variant, each checked.
    pub(super) fn slots(&self) -> Result<Vec<Slot<'_, D>>, Error> {
        let mut slots: Vec<Slot<'_, D>> = Vec::new();
        for candidate in &self.candidates {
            for &linear in &self.linear {
                let mut coarser = None;
                let uniform = self.levels.iter().map(|&level| (level, None));
                let adaptive = self.adaptive.and_then(|of| Some((*self.levels.first()?, Some(of))));
                for meshes in uniform.chain(adaptive) {
                    let slot = self.slot(candidate, linear, meshes);
                    slot.study.check()?;
                    if slots.iter().any(|s| s.case == slot.case) {
                        return Err(Error::equal_schemes(slot.case.variant.label));
                    }
                    slots.push(Slot { coarser: coarser.filter(|_| meshes.1.is_none()), ..slot });
                    coarser = Some(slots.len() - 1);
                }
            }
        }
        if slots.is_empty() {
            let needs = "a study needs a scheme, a linear solver and a level";
            return Err(wrong("cases", "none".to_owned(), needs));
        }
        Ok(slots)
    }

    fn slot<'s>(
        &'s self,
        candidate: &Candidate<'s, D>,
        linear: LinearMethod,
        meshes: (usize, Option<Adaptivity>),
    ) -> Slot<'s, D> {
        let Candidate { scheme, set, shown } = candidate.clone();
        let (level, adaptivity) = meshes;
        let scene = self.scene.clone();
        let name = LinearMethod::NAMES.iter().find(|l| l.1 == linear).map_or("", |l| l.0);
        let in_force = set.as_deref().unwrap_or(scene.problem.constraint_set());
        let solver = in_precision(self.precision, ActiveSet::default().linear(linear));
        let variant = Variant {
            scene: scene.name.clone(),
            label: scheme.label_with(in_force, shown),
            solver: solver.name().to_owned(),
            linear_asked: Some(name.to_owned()),
            meshes: adaptivity.map_or(Meshes::Uniform, |of| Meshes::Adaptive { theta: of.theta }),
        };
        let mut study = Study::<D>::new(scene)
            .boxed_solver(solver)
            .shared_scheme(scheme, set, shown)
            .levels([level]);
        if let Some(adaptivity) = adaptivity {
            study = study.adaptive(adaptivity);
        }
        let level = if adaptivity.is_some() { 0 } else { level };
        let case = Case { variant, level };
        Slot { case, study, coarser: None, measured: Vec::new(), failure: None }
    }

    /// The study that measures every scheme on every level against the reference, checked; none where no
    /// reference is asked for.
    pub(super) fn study_against_reference(&self) -> Result<Option<Study<'_, D>>, Error> {
        let Some((reference, level)) = &self.reference else { return Ok(None) };
        let mut study = Study::<D>::new(self.scene.clone()).levels(self.levels.iter().copied());
        for candidate in &self.candidates {
            let Candidate { scheme, set, shown } = candidate.clone();
            study = study.shared_scheme(scheme, set, shown);
        }
        if self.precision == Precision::Single {
            let allowed = "against a reference every scheme is measured in f64: leave f32 out";
            return Err(wrong("precision", Precision::Single.name().to_owned(), allowed));
        }
        let (scheme, set) = (reference.scheme.clone(), reference.set.clone());
        let study = study.shared_reference(scheme, set, *level);
        study.check()?;
        Ok(Some(study))
    }

    /// The reason for which a case is not run.
    pub(super) fn obstacle_to(&self, slots: &[Slot<'_, D>], k: usize) -> Option<String> {
        if let Some(coarser) = slots[k].coarser.map(|c| &slots[c]) {
            let level = coarser.case.level;
            let Some(measured) = coarser.measured.last() else {
                return Some(format!("not run: level {level} was not, either"));
            };
            let seconds = measured.smallest.total;
            if seconds > self.limit {
                return Some(format!("not run: level {level} took {seconds:.1} s"));
            }
        }
        slots[k].study.check_memory().err().map(|why| format!("not run: {why}"))
    }
}

/// The error of an invalid request.
fn wrong(parameter: &'static str, value: String, allowed: &str) -> Error {
    Error::Parameter { parameter, value, allowed: allowed.to_owned() }
}
