//! The unknowns of a discretisation over all parts, as solvers of an inequality see them.

use std::sync::Arc;

use super::error::ExchangeError;
use super::exchange::Exchange;
use super::numbering::Numbering;
use crate::algebra::{Contact, Distribution};

/// The numbers of the unknowns with the exchange between the parts.
#[derive(Debug)]
pub(crate) struct OverParts {
    pub numbering: Numbering,
    pub exchange: Arc<dyn Exchange>,
    /// The number of this part.
    pub number: u32,
    is_own: Vec<bool>,
}

impl OverParts {
    pub fn new(number: u32, numbering: Numbering, exchange: Arc<dyn Exchange>) -> Self {
        let mut is_own = vec![false; numbering.numbers().len()];
        numbering.own().iter().for_each(|&unknown| is_own[unknown as usize] = true);
        Self { numbering, exchange, number, is_own }
    }

    /// The number of unknowns of all parts.
    pub fn n_unknowns(&self) -> u64 {
        self.numbering.first().last().copied().unwrap_or(0)
    }

    /// Gives ghosts the contact states that their owners have.
    pub fn update_contact(&self, contact: &mut [Contact]) {
        let number = |state: Contact| match state {
            Contact::Inactive => 0.0,
            Contact::Lower => 1.0,
            Contact::Upper => 2.0,
        };
        let state = |number: f64| match number {
            1.0 => Contact::Lower,
            2.0 => Contact::Upper,
            _ => Contact::Inactive,
        };
        (self as &dyn Distribution).update_by(contact, number, state);
    }
}

/// Replaces numbers of this part by their sums or maxima over all parts; by NaN where messages fail.
fn replace(of_all: Result<Vec<f64>, ExchangeError>, numbers: &mut [f64]) {
    match of_all {
        Ok(of_all) => numbers.copy_from_slice(&of_all),
        Err(_) => numbers.fill(f64::NAN),
    }
}

impl Distribution for OverParts {
    fn owns(&self, unknown: usize) -> bool {
        self.is_own[unknown]
    }
    fn number(&self, unknown: usize) -> u64 {
        self.numbering.numbers()[unknown]
    }
    fn exchange(&self, value: &dyn Fn(usize) -> f64, receive: &mut dyn FnMut(usize, f64)) {
        if self.numbering.exchange_values(value, receive, &*self.exchange).is_err() {
            self.numbering.ghosts().for_each(|unknown| receive(unknown, f64::NAN));
        }
    }
    fn sum(&self, numbers: &mut [f64]) {
        replace(self.exchange.sum(numbers), numbers);
    }
    fn largest(&self, numbers: &mut [f64]) {
        replace(self.exchange.largest(numbers), numbers);
    }
}
