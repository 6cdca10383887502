//! A look at an inexact iterate: what should change, and how far it is from a solution.

use super::ActiveSet;
use super::inexact::Inexact;
use crate::algebra::{Bound, Contact, Inequality};
use crate::inequality::initial_guess::InitialGuess;
use crate::linear::CoarseSpaces;
use crate::parallel::vectors::{for_each_chunk, map_chunks, map_chunks_mut};
use crate::real::Real;

/// What a look at the whole iterate tells.
#[derive(Default)]
pub(crate) struct Look {
    /// What should change its state, and to which.
    pub flips: Vec<(u32, Contact)>,
    /// Largest violation of a bound.
    pub violation: f64,
    /// Largest displacement.
    pub scale: f64,
    /// Dual norm of the multipliers of wrong sign, and of the residual off contact.
    pub wrong: f64,
    pub off_contact: f64,
    /// Energy norm.
    pub energy: f64,
}

impl Look {
    /// Whether bounds and signs of multipliers hold to a tolerance.
    pub fn holds_to(&self, tolerance: f64) -> bool {
        self.violation <= tolerance * self.scale && self.wrong <= tolerance * self.energy
    }

    /// How far the active set is from a solution.
    pub fn merit(&self) -> f64 {
        self.violation / self.scale + self.wrong / self.energy
    }
}

/// Systems solved inexactly that may pass for each with factors, which costs several times as much.
const FACTORS_OVER_INEXACT: usize = 4;

/// The residual of an unknown, in `f64`: what is more exact than the matrix, if there is such.
fn residual_at<'v, T: Real>(
    inequality: &'v Inequality<T>,
    values: &'v [T],
    exact: Option<&'v [f64]>,
) -> impl Fn(usize) -> f64 + Sync + 'v {
    let Inequality { matrix, load, .. } = inequality;
    move |i| match exact {
        Some(exact) => exact[i],
        None => load[i].to_f64() - matrix.row_dot_f64(i, values),
    }
}

impl<T: Real> Inexact<'_, T> {
    /// How many systems may pass without progress where `hesitation` exact ones may: longer where
    /// what would take over is neither multigrid nor an elimination that halves the unknowns.
    pub fn patience(&self, settings: &ActiveSet, nearby: &InitialGuess<T>) -> usize {
        let is_nested = matches!(nearby.functions, CoarseSpaces::CoarseLevel(_));
        let is_cheap = is_nested || self.inequality.penalised.is_some();
        settings.hesitation * if is_cheap { 1 } else { FACTORS_OVER_INEXACT }
    }

    /// Computes the residual anew and judges every unknown.
    pub fn look(&mut self, band: f64) -> Look {
        let load = &self.inequality.load;
        let values = &self.values;
        let exact = self.exact_residual();
        let residual_at = residual_at(self.inequality, values, exact.as_deref());
        let sizes = map_chunks_mut(&mut self.residual, |range, r| {
            let (mut energy, mut scale) = (0.0, 0.0_f64);
            for (i, r) in range.zip(r) {
                let (x, b) = (values[i].to_f64(), load[i].to_f64());
                let residual = residual_at(i);
                *r = T::lit(residual);
                energy += x * (b - residual);
                scale = scale.max(x.abs());
            }
            (energy, scale)
        });
        let mut look = Look::default();
        for (energy, scale) in sizes {
            look.energy += energy;
            look.scale = look.scale.max(scale);
        }
        look.scale = if look.scale > 0.0 { look.scale } else { 1.0 };
        let noise = band * T::EPSILON * look.scale;
        let parts = map_chunks(values.len(), |range| {
            let mut part = Look::default();
            range.for_each(|i| self.judge(i, noise, band, &mut part));
            part
        });
        for part in parts {
            look.flips.extend(part.flips);
            look.violation = look.violation.max(part.violation);
            look.wrong += part.wrong;
            look.off_contact += part.off_contact;
        }
        look.wrong = look.wrong.sqrt();
        look.off_contact = look.off_contact.sqrt();
        look.energy = if look.energy > 0.0 { look.energy.sqrt() } else { self.load_energy() };
        look
    }

    /// Computes the residual anew.
    pub(crate) fn renew_residual(&mut self) {
        let exact = self.exact_residual();
        let residual_at = residual_at(self.inequality, &self.values, exact.as_deref());
        for_each_chunk(&mut self.residual, |range, r| {
            range.zip(r).for_each(|(i, r)| *r = T::lit(residual_at(i)));
        });
    }

    /// The residual where the matrix is kept factored.
    fn exact_residual(&self) -> Option<Vec<f64>> {
        let factored = self.inequality.penalised.as_ref()?;
        let mut residual = vec![0.0; self.values.len()];
        factored.residual(|i| self.values[i].to_f64(), &mut residual);
        Some(residual)
    }

    /// Adds what one unknown contributes.
    #[inline(always)]
    fn judge(&self, i: usize, noise: f64, band: f64, look: &mut Look) {
        let bound = &self.inequality.bounds[i];
        if let Bound::Fixed(_) = bound {
            return;
        }
        let (x, r) = (self.values[i].to_f64(), self.residual[i].to_f64());
        let d = self.diagonal[i].to_f64();
        let pull = match self.state[i] {
            Contact::Inactive => {
                look.off_contact += r * r / d;
                let below = bound.lower().map_or(0.0, |l| l.to_f64() - x);
                let above = bound.upper().map_or(0.0, |u| x - u.to_f64());
                if below > noise {
                    look.flips.push((i as u32, Contact::Lower));
                    look.violation = look.violation.max(below);
                } else if above > noise {
                    look.flips.push((i as u32, Contact::Upper));
                    look.violation = look.violation.max(above);
                }
                return;
            }
            _ if bound.fixed_value().is_some() => return,
            Contact::Lower => r,
            Contact::Upper => -r,
        };
        if pull > 0.0 {
            look.wrong += pull * pull / d;
            if pull > self.force_noise(i, band) {
                look.flips.push((i as u32, Contact::Inactive));
            }
        }
    }

    /// The size of rounding in the force on an unknown.
    fn force_noise(&self, i: usize, band: f64) -> f64 {
        let (columns, entries) = self.inequality.matrix.row(i);
        let mut sum = self.inequality.load[i].to_f64().abs();
        for (&j, a) in columns.iter().zip(entries) {
            sum += (a.to_f64() * self.values[j as usize].to_f64()).abs();
        }
        band * T::EPSILON * sum
    }

    /// The energy that the load could raise, roughly: a scale where nothing else gives one.
    fn load_energy(&self) -> f64 {
        let terms = self.inequality.load.iter().zip(&self.diagonal);
        let sum: f64 =
            terms.map(|(b, d)| b.to_f64().powi(2) / d.to_f64().abs().max(f64::MIN_POSITIVE)).sum();
        if sum > 0.0 { sum.sqrt() } else { 1.0 }
    }
}
