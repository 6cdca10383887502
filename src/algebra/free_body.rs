//! Bodies that bounds alone hold.

/// The multiple of machine epsilon times the sum of the absolute loads below which a resultant counts as none.
pub(crate) const RESULTANT_ROUNDING: f64 = 64.0;

/// A connected body of a mesh that neither Dirichlet data, Robin sides nor a reaction hold, so that bounds alone stop it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FreeBody {
    /// The position in [`Inequality::kernel`](super::Inequality::kernel) of the vector whose nonzero entries are the
    /// unknowns of the body; `None` if the body shares unknowns with one that is held, as the two sides of a vertex at
    /// which bodies touch.
    pub kernel: Option<usize>,
    /// The resultant of the data on the body: the integral of source and Neumann data.
    pub resultant: f64,
    /// The absolute value up to which the data, as integrated, do not tell the resultant from zero.
    pub uncertainty: f64,
    /// Whether lower bounds stop a motion downwards.
    pub stops_below: bool,
    /// Whether upper bounds stop a motion upwards.
    pub stops_above: bool,
    /// The sum of the assembled load along the kernel vector: what is added to the load since is a term of the
    /// resultant too.
    pub(crate) assembled: f64,
}

impl FreeBody {
    /// A body without load, bounds and kernel vector, to be completed.
    pub(crate) fn unloaded() -> Self {
        Self {
            kernel: None,
            resultant: 0.0,
            uncertainty: 0.0,
            stops_below: false,
            stops_above: false,
            assembled: 0.0,
        }
    }

    /// The resultant of the data, zero where they do not decide.
    pub(crate) fn decided_resultant(&self) -> f64 {
        if self.resultant.abs() <= self.uncertainty { 0.0 } else { self.resultant }
    }
}

/// A sum with the rounding errors of its additions (A. Neumaier, Z. Angew. Math. Mech. 54 (1974) 39-51): that of
/// many terms with a small sum is accurate to the rounding of the terms.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    sum: f64,
    errors: f64,
}

impl Sum {
    /// Adds a term.
    pub fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        self.errors += match self.sum.abs() >= term.abs() {
            true => (self.sum - sum) + term,
            false => (term - sum) + self.sum,
        };
        self.sum = sum;
    }
    /// The sum.
    pub fn value(self) -> f64 {
        self.sum + self.errors
    }
}
