//! Messages between parts, and the exchange between threads.

use std::sync::mpsc::{Receiver, Sender, channel};

/// How the parts of a mesh tell one another numbers: one for each process, or for each thread.
pub trait Exchange {
    /// How many parts there are.
    fn parts(&self) -> usize;
    /// Sends a list to every part and returns what every part sends to this one, both by the number of the
    /// part. All parts call it as often as one another, in the same order.
    fn exchange(&self, lists: Vec<Vec<u64>>) -> Vec<Vec<u64>>;
}

/// The exchange between threads of one process.
#[derive(Debug)]
pub struct InProcess {
    senders: Vec<Sender<Vec<u64>>>,
    receivers: Vec<Receiver<Vec<u64>>>,
}

impl Exchange for InProcess {
    fn parts(&self) -> usize {
        self.senders.len()
    }
    /// # Panics
    /// If the thread of another part has ended.
    fn exchange(&self, lists: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
        for (sender, list) in self.senders.iter().zip(lists) {
            sender.send(list).expect("every part takes part in every exchange");
        }
        let receive = |from: &Receiver<Vec<u64>>| from.recv();
        let received: Result<Vec<_>, _> = self.receivers.iter().map(receive).collect();
        received.expect("every part takes part in every exchange")
    }
}

/// Calls a function with the number of each part and its exchange, every part in a thread of its own, and
/// returns the results by the number of the part.
///
/// # Panics
/// If the function does.
pub fn in_process<R: Send>(parts: usize, of_part: impl Fn(u32, &InProcess) -> R + Sync) -> Vec<R> {
    let empty = || InProcess { senders: Vec::new(), receivers: Vec::new() };
    let mut exchanges: Vec<InProcess> = (0..parts).map(|_| empty()).collect();
    for from in 0..parts {
        for to in 0..parts {
            let (sender, receiver) = channel();
            exchanges[from].senders.push(sender);
            exchanges[to].receivers.push(receiver);
        }
    }
    let of_part = &of_part;
    std::thread::scope(|scope| {
        let start = |(number, exchange)| scope.spawn(move || of_part(number, &exchange));
        let threads: Vec<_> = (0..).zip(exchanges).map(start).collect();
        let result = |thread: std::thread::ScopedJoinHandle<'_, R>| match thread.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        threads.into_iter().map(result).collect()
    })
}
