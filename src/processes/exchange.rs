//! Messages between parts, and the exchange between threads.

use std::fmt::Debug;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

use super::error::ExchangeError;

/// How the parts of a mesh tell one another numbers: one for each process, or for each thread.
///
/// All parts call all methods as often as one another, in the same order.
pub trait Exchange: Debug + Send + Sync {
    /// How many parts there are.
    fn parts(&self) -> usize;
    /// Sends a list to every part and returns what every part sends to this one, both by the number of the
    /// part.
    ///
    /// # Errors
    /// [`ExchangeError::Lists`] unless there is one list for each part; [`ExchangeError::Ended`] or
    /// [`ExchangeError::Transport`] if a part is out of reach.
    fn exchange(&self, lists: Vec<Vec<u64>>) -> Result<Vec<Vec<u64>>, ExchangeError>;
    /// The sums of the numbers of all parts, place by place. They are added up in the order of the parts, so that
    /// all parts have the same bits; an implementation with another order has this property, too.
    ///
    /// # Errors
    /// Those of [`Exchange::exchange`]; [`ExchangeError::Length`] if a part has another number of values.
    fn sum(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
        fold(self, values, |a, b| a + b)
    }
    /// The largest of the numbers of all parts, place by place; not a number if one of them is not a number.
    ///
    /// # Errors
    /// Those of [`Exchange::sum`].
    fn largest(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
        fold(self, values, |a, b| if a >= b || a.is_nan() { a } else { b })
    }
}

/// The values of all parts, place by place joined in the order of the parts.
fn fold<E: Exchange + ?Sized>(
    exchange: &E,
    values: &[f64],
    join: fn(f64, f64) -> f64,
) -> Result<Vec<f64>, ExchangeError> {
    let lists = numbers_of_all(exchange, values)?;
    let join = |mut all: Vec<f64>, of_part: Vec<f64>| {
        all.iter_mut().zip(of_part).for_each(|(a, b)| *a = join(*a, b));
        all
    };
    Ok(lists.into_iter().reduce(join).unwrap_or_default())
}

/// The numbers of every part, of which all have equally many.
fn numbers_of_all<E: Exchange + ?Sized>(
    exchange: &E,
    numbers: &[f64],
) -> Result<Vec<Vec<f64>>, ExchangeError> {
    let bits: Vec<u64> = numbers.iter().map(|x| x.to_bits()).collect();
    let lists = exchange.exchange(vec![bits; exchange.parts()])?;
    check_lengths(&lists, |_| numbers.len())?;
    Ok(lists.iter().map(|list| list.iter().map(|&bits| f64::from_bits(bits)).collect()).collect())
}

/// Refuses lists of other lengths than those expected of each part.
pub(super) fn check_lengths(
    lists: &[Vec<u64>],
    expected: impl Fn(usize) -> usize,
) -> Result<(), ExchangeError> {
    for (part, list) in lists.iter().enumerate() {
        let (found, expected) = (list.len(), expected(part));
        if found != expected {
            return Err(ExchangeError::Length(format!(
                "part {part} sent {found} numbers in place of {expected}: all parts call the same functions in the same order"
            )));
        }
    }
    Ok(())
}

impl<E: Exchange + ?Sized> Exchange for Arc<E> {
    fn parts(&self) -> usize {
        (**self).parts()
    }
    fn exchange(&self, lists: Vec<Vec<u64>>) -> Result<Vec<Vec<u64>>, ExchangeError> {
        (**self).exchange(lists)
    }
    fn sum(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
        (**self).sum(values)
    }
    fn largest(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
        (**self).largest(values)
    }
}

/// The exchange between threads of one process.
#[derive(Debug)]
pub struct InProcess {
    senders: Vec<Sender<Vec<u64>>>,
    receivers: Vec<Mutex<Receiver<Vec<u64>>>>,
}

impl Exchange for InProcess {
    fn parts(&self) -> usize {
        self.senders.len()
    }
    fn exchange(&self, lists: Vec<Vec<u64>>) -> Result<Vec<Vec<u64>>, ExchangeError> {
        if lists.len() != self.parts() {
            return Err(ExchangeError::lists(lists.len(), self.parts()));
        }
        let ended = |part: u32| {
            let message =
                format!("part {part} has ended without this exchange: look for its error");
            ExchangeError::Ended(message)
        };
        for (part, (sender, list)) in (0..).zip(self.senders.iter().zip(lists)) {
            sender.send(list).map_err(|_| ended(part))?;
        }
        let receive = |(part, from): (u32, &Mutex<Receiver<_>>)| {
            let from = from.lock().unwrap_or_else(PoisonError::into_inner);
            from.recv().map_err(|_| ended(part))
        };
        (0..).zip(&self.receivers).map(receive).collect()
    }
}

/// Calls a function with the number of each part and its exchange, every part in a thread of its own, and
/// returns the results by the number of the part. A thread that ends early ends the exchanges of the others
/// with an error.
///
/// # Panics
/// If the function does.
pub fn in_process<R: Send>(
    parts: usize,
    of_part: impl Fn(u32, &Arc<InProcess>) -> R + Sync,
) -> Vec<R> {
    let empty = || InProcess { senders: Vec::new(), receivers: Vec::new() };
    let mut exchanges: Vec<InProcess> = (0..parts).map(|_| empty()).collect();
    for from in 0..parts {
        for to in 0..parts {
            let (sender, receiver) = channel();
            exchanges[from].senders.push(sender);
            exchanges[to].receivers.push(Mutex::new(receiver));
        }
    }
    let of_part = &of_part;
    std::thread::scope(|scope| {
        let start = |(number, exchange)| scope.spawn(move || of_part(number, &Arc::new(exchange)));
        let threads: Vec<_> = (0..).zip(exchanges).map(start).collect();
        let result = |thread: std::thread::ScopedJoinHandle<'_, R>| match thread.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        threads.into_iter().map(result).collect()
    })
}
