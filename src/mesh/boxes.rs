//! Kuhn triangulations of boxes.
