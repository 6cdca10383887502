//! One of the processes that share a mesh.

use std::sync::Arc;

use super::engine::Engine;
use crate::processes::Exchange;

/// One of the processes, or threads, that share a mesh: its number, the exchange with the others, the engine.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Process {
    /// The number of the part of the mesh that the process has.
    pub number: u32,
    /// The exchange with the other processes.
    pub exchange: Arc<dyn Exchange>,
    /// The engine of its linear solvers.
    pub engine: Arc<dyn Engine>,
}

impl Process {
    /// The process with this number.
    pub fn new(
        number: u32,
        exchange: impl Exchange + 'static,
        engine: impl Engine + 'static,
    ) -> Self {
        Self { number, exchange: Arc::new(exchange), engine: Arc::new(engine) }
    }
    /// How many processes there are.
    pub fn count(&self) -> usize {
        self.exchange.parts()
    }
}
