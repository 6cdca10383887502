//! Patches of the plane whose cells lie side by side around the vertex: all fluxes follow from one.

use super::corners::Corner;
use super::linear::LinearCells;
use crate::arrays::map_entries;
use crate::mesh::{BoundaryCondition, Neighbour};

/// A cell of a fan, between two facets at its vertex.
#[derive(Clone, Copy)]
pub(super) struct CellOfFan {
    corner: Corner,
    /// The numbers of the facets on both sides.
    sides: [u8; 2],
}

impl<const D: usize> LinearCells<'_, '_, D> {
    /// Calls `set` with the numbers of a vertex of the plane if its cells form one fan, else false.
    ///
    /// With the flux `x` out of the first cell through its first facet all others are `p + x` through first and
    /// `q - x` through second facets: the two fluxes of a cell have its load as their sum, those of a facet
    /// cancel the jump. Where the fan is closed, or the fluxes at both ends are unknown, `x` is the number for which
    /// the norm is least. Let `a` and `b` be the vertices of a cell opposite its two facets, `m` its barycentre and
    /// `V` its volume. The flux with the integrals `1, -1` is the constant `(b - a) / (2 V)`; hence the derivative of
    /// the squared norm in the cell by `x` is that of `|(p + x) (m - a) + (q - x) (m - b)|^2 / (4 alpha V)`.
    pub(super) fn set_fan(
        &self,
        vertex: usize,
        fan: &mut Vec<CellOfFan>,
        set: impl Fn(Corner, usize, f64),
    ) -> bool {
        if !self.find_fan(vertex, fan) {
            return false;
        }
        let mesh = self.space.mesh;
        let carried: f64 = fan.iter().map(|of| self.carried(of.corner)).sum();
        let mut pressure = self.multipliers[vertex] / carried;
        let normal = |(corner, local): (Corner, u8)| self.through(corner.cell(), local.into());
        // what the fluxes of a cell through a facet and of the next one through it sum to
        let sum = |of: &CellOfFan, next: &CellOfFan| {
            -0.5 * (normal((of.corner, of.sides[1])) + normal((next.corner, next.sides[0])))
        };
        let given = |of: &CellOfFan, side: usize| {
            let local = of.sides[side];
            match self.neighbours.across(of.corner.cell(), usize::from(local)) {
                Neighbour::Boundary(BoundaryCondition::Dirichlet) | Neighbour::Cell { .. } => None,
                Neighbour::Boundary(_) | Neighbour::Cut => Some(-0.5 * normal((of.corner, local))),
            }
        };
        let (mut first, mut force, mut stiffness) = (0.0, 0.0, 0.0);
        for (k, of) in fan.iter().enumerate() {
            let second = self.load(of.corner, pressure) - first;
            let cell = of.corner.cell();
            let point = |local: usize| mesh.vertices()[mesh.cell(cell)[local] as usize];
            let [a, b] = map_entries(of.sides, |side| point(usize::from(side)));
            let (along, middle) = (b - a, (point(of.corner.own()) + a + b) / 3.0);
            let weight = 1.0 / (self.space.alpha(cell) * self.volume(cell));
            stiffness += weight * along.norm_squared();
            force -= weight * along.dot(&((middle - a) * first + (middle - b) * second));
            if let Some(next) = fan.get(k + 1) {
                first = sum(of, next) - second;
            }
        }
        let Some((begin, end)) = fan.first().zip(fan.last()) else { return true };
        let second = self.load(end.corner, pressure) - first;
        let is_closed = matches!(
            self.neighbours.across(begin.corner.cell(), usize::from(begin.sides[0])),
            Neighbour::Cell { .. }
        );
        // what the equation of the vertex leaves, rounding, is divided like the multiplier
        let (mut first, left) = match (given(begin, 0), given(end, 1)) {
            (Some(flux), Some(other)) => (flux, second - flux - other),
            (Some(flux), None) => (flux, 0.0),
            (None, Some(other)) => (second - other, 0.0),
            (None, None) if is_closed => (force / stiffness, second - sum(end, begin)),
            (None, None) => (force / stiffness, 0.0),
        };
        pressure += left / carried;
        for (k, of) in fan.iter().enumerate() {
            let second = self.load(of.corner, pressure) - first;
            let is_ascending = of.sides[0] < of.sides[1];
            set(of.corner, usize::from(!is_ascending), first);
            set(of.corner, usize::from(is_ascending), second);
            if let Some(next) = fan.get(k + 1) {
                first = sum(of, next) - second;
            }
        }
        true
    }

    /// The cells around a vertex of the plane, each with the next one behind its second facet: all of them, or the
    /// result is false. On the boundary the fan begins and ends with boundary facets.
    fn find_fan(&self, vertex: usize, fan: &mut Vec<CellOfFan>) -> bool {
        let number_in = |cell: usize| self.number_in(cell, vertex as u32);
        let (cell, count) = self.one_cell[vertex];
        let own = number_in(cell as usize);
        let of_cell = |cell: usize, own: u8, sides| CellOfFan {
            corner: Corner::new(cell, own.into()),
            sides,
        };
        let mut begin = of_cell(cell as usize, own, [(own + 1) % 3, (own + 2) % 3]);
        for _ in 0..2 {
            let mut last = begin;
            fan.clear();
            fan.push(last);
            while let Neighbour::Cell { cell, local } =
                self.neighbours.across(last.corner.cell(), usize::from(last.sides[1]))
                && fan.len() < count as usize
                && cell as usize != begin.corner.cell()
            {
                let cell = cell as usize;
                let own = number_in(cell);
                // the numbers of the vertex and of both facets sum to three
                last = of_cell(cell, own, [local, 3 - own - local]);
                fan.push(last);
            }
            if fan.len() == count as usize {
                return true;
            }
            begin = CellOfFan { sides: [last.sides[1], last.sides[0]], ..last };
        }
        false
    }
}
