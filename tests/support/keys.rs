//! What scripts rely on.

/// The keys of a row, in order.
pub const ROW_KEYS: [&str; 24] = [
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
    "multiplier_l1",
    "multiplier_l2",
    "contact_area_error",
    "free_boundary_distance",
    "order",
    "expected_order",
    "objective",
    "active",
    "iterations",
    "certificate",
    "seconds",
    "peak_memory_bytes",
];
