//! Messages between the processes of an MPI job.

use std::ffi::c_int;

use super::shim::{check, ul_counts, ul_exchange, ul_largest, ul_sum};
use crate::processes::Exchange;
use crate::processes::ExchangeError;

/// The exchange over MPI.
#[derive(Debug)]
pub(super) struct MpiExchange {
    parts: usize,
}

impl MpiExchange {
    /// The exchange between so many processes.
    pub fn new(parts: usize) -> Self {
        Self { parts }
    }
    fn transport(code: c_int) -> Result<(), ExchangeError> {
        check(code, "a message of MPI").map_err(ExchangeError::Transport)
    }
}

/// The length of a list as MPI counts.
fn length(list: usize) -> Result<c_int, ExchangeError> {
    let why = || format!("{list} numbers in one message: at most {} are possible", c_int::MAX);
    c_int::try_from(list).map_err(|_| ExchangeError::Transport(why()))
}

impl Exchange for MpiExchange {
    fn parts(&self) -> usize {
        self.parts
    }
    fn exchange(&self, lists: Vec<Vec<u64>>) -> Result<Vec<Vec<u64>>, ExchangeError> {
        if lists.len() != self.parts {
            return Err(ExchangeError::lists(lists.len(), self.parts));
        }
        let to = lists.iter().map(|l| length(l.len())).collect::<Result<Vec<c_int>, _>>()?;
        let mut from = vec![0; self.parts];
        // SAFETY: both lists have a number for each process
        Self::transport(unsafe { ul_counts(to.as_ptr(), from.as_mut_ptr()) })?;
        let sent = lists.concat();
        let mut received = vec![0_u64; from.iter().map(|&n| n as usize).sum()];
        // SAFETY: the buffers have as many words as the counts state
        Self::transport(unsafe {
            ul_exchange(sent.as_ptr(), to.as_ptr(), received.as_mut_ptr(), from.as_ptr())
        })?;
        let mut rest = &received[..];
        let of_process = |&n: &c_int| {
            let (own, after) = rest.split_at(n as usize);
            rest = after;
            own.to_vec()
        };
        Ok(from.iter().map(of_process).collect())
    }
    fn sum(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
        let mut sums = values.to_vec();
        // SAFETY: the list has as many numbers as stated
        Self::transport(unsafe { ul_sum(sums.as_mut_ptr(), length(values.len())?) })?;
        Ok(sums)
    }
    fn largest(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
        // MPI does not say what the largest of a number and no number is
        let numbers = values.iter().map(|&x| if x.is_nan() { f64::NEG_INFINITY } else { x });
        let are_none = values.iter().map(|x| f64::from(u8::from(x.is_nan())));
        let mut both: Vec<f64> = numbers.chain(are_none).collect();
        // SAFETY: the list has as many numbers as stated
        Self::transport(unsafe { ul_largest(both.as_mut_ptr(), length(both.len())?) })?;
        let (numbers, are_none) = both.split_at(values.len());
        let number = |(&x, &is_none): (&f64, &f64)| if is_none == 0.0 { x } else { f64::NAN };
        Ok(numbers.iter().zip(are_none).map(number).collect())
    }
}
