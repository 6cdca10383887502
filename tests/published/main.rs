//! Figures in print, and tables of an independent implementation.

mod american_put;
mod ball;
mod compare;
mod kinks;
mod obstacles;
mod oscillating;
mod reaction;
mod signorini;
mod strings;

#[path = "../support"]
mod support {
    pub mod checks;
    pub mod rows;
    pub mod schemes;
    pub mod tables;
    pub mod tolerances;
}
