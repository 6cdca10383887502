//! Checks with an absolute tolerance.

use super::checks::Checks;

impl Checks {
    /// Ours and theirs differ by at most this.
    pub fn close(&mut self, what: &str, ours: f64, theirs: f64, tolerance: f64) {
        self.that((ours - theirs).abs() <= tolerance, || {
            format!("{what}: {ours:e} against {theirs:e}, off by {:.2e}", ours - theirs)
        });
    }
}
