//! What scripts rely on.

/// The keys of a row, in order.
pub const ROW_KEYS: [&str; 20] = [
    "scene",
    "dimension",
    "scheme",
    "constraint",
    "level",
    "parameters",
    "cells",
    "unknowns",
    "nonzeros",
    "mesh_size",
    "status",
    "error",
    "order",
    "expected_order",
    "objective",
    "active",
    "iterations",
    "certificate",
    "seconds",
    "peak_memory_bytes",
];
