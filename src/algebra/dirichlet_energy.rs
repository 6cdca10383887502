//! The terms that weak Dirichlet data add to the energy of a function.

/// The quadratic function that turns `u.A u` into the squared energy norm of a scheme with weak
/// Dirichlet data `u_D`.
///
/// `A` contains the penalty and consistency terms of the trace of `u` on Dirichlet facets. With
/// `u - u_D` in place of this trace in both arguments of these terms, the form at `(u, u)` is
/// `E^2 = u.A u - l.u + q`. In contrast to `u.A u`, which contains `penalty * |u_D|^2`, the energy `E^2` of
/// a function that satisfies the data does not grow with the penalty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DirichletEnergy {
    /// The terms of the unknowns next to Dirichlet facets.
    pub terms: Vec<DirichletTerm>,
}

impl DirichletEnergy {
    /// `q`: the form at `(u_D, u_D)`.
    pub fn constant(&self) -> f64 {
        self.terms.iter().map(|term| term.constant).sum()
    }
    /// Whether all terms belong to one of `size` unknowns.
    pub fn is_well_formed(&self, size: usize) -> bool {
        self.terms.iter().all(|term| (term.unknown as usize) < size)
    }
    /// Sorts the terms by their unknowns and adds those of one unknown.
    pub(crate) fn merge_terms(&mut self) {
        self.terms.sort_by_key(|term| term.unknown);
        self.terms.dedup_by(|next, term| {
            let is_same = next.unknown == term.unknown;
            if is_same {
                term.load += next.load;
                term.linear += next.linear;
                term.constant += next.constant;
            }
            is_same
        });
    }
}

/// The contribution of Dirichlet data to one unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirichletTerm {
    /// The unknown.
    pub unknown: u32,
    /// The load that comes from the data.
    pub load: f64,
    /// The coefficient `l_i`, twice `load` for a symmetric form.
    pub linear: f64,
    /// The share of `q`, the form at `(u_D, u_D)`, that counts with the unknown: that of a facet counts with one
    /// unknown of its cell.
    pub constant: f64,
}
