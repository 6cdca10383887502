//! Figures in print, and tables of an independent implementation.

#[path = "published/ball.rs"]
mod ball;
#[path = "published/compare.rs"]
mod compare;
#[path = "published/kinks.rs"]
mod kinks;
#[path = "published/obstacles.rs"]
mod obstacles;
#[path = "published/oscillating.rs"]
mod oscillating;
#[path = "published/reaction.rs"]
mod reaction;
#[path = "published/signorini.rs"]
mod signorini;
#[path = "published/strings.rs"]
mod strings;
mod support;
