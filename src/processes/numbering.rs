//! The numbers of the unknowns of all parts together.

use super::agree::agree;
use super::error::ExchangeError;
use super::exchange::{Exchange, check_lengths};
use crate::assemble::Discretisation;
use crate::mesh::Part;

/// The number of an unknown whose owner has not answered yet, or does not know it either.
const UNKNOWN: u64 = u64::MAX;
/// The answer of a part that does not own the cell.
const NOT_OWNED: u64 = u64::MAX - 1;

/// The numbers of the unknowns of all parts of a mesh together: those of a part, ascending, follow those of the
/// part before.
///
/// No part has a table of all unknowns. An unknown is named by one of its cells, the number of the cell in the
/// whole mesh, and its place in the cell, and the owner of a cell knows the unknowns of the cell. So two
/// questions are enough: what is in own cells and belongs to a lower part is asked of that part; then the
/// rest of the owner of any cell that has it.
#[derive(Clone, Debug)]
pub struct Numbering {
    own: Vec<u32>,
    numbers: Vec<u64>,
    /// The first number of each part, and the number of all unknowns.
    first: Vec<u64>,
    /// By part the own unknowns whose values it needs, and the unknowns whose values it has.
    sent: Vec<Vec<u32>>,
    received: Vec<Vec<u32>>,
}

impl Numbering {
    /// Numbers the unknowns of a discretisation on a part; all parts call it.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts if cells have other owners in one part than in another, or if a part
    /// has too few [layers](crate::scheme::Scheme#method.layers) to know who numbers an unknown; those of the
    /// exchange.
    pub fn new<const D: usize>(
        part: &Part<D>,
        discretisation: &Discretisation<'_, D>,
        exchange: &dyn Exchange,
    ) -> Result<Self, ExchangeError> {
        let per_cell = discretisation.unknowns_of(0).count();
        let mut unknowns = Vec::with_capacity(per_cell * part.owners.len());
        for cell in 0..part.owners.len() {
            unknowns.extend(discretisation.unknowns_of(cell).map(|unknown| unknown as u32));
        }
        let owners = discretisation.owners(&part.owners);
        Cells {
            number: part.number,
            owners: &part.owners,
            numbers: &part.cells,
            unknowns,
            per_cell,
        }
        .number(&owners, exchange)
    }
    /// The own unknowns, in the order of their numbers.
    pub fn own(&self) -> &[u32] {
        &self.own
    }
    /// The number of each unknown of the part among those of all parts.
    pub fn numbers(&self) -> &[u64] {
        &self.numbers
    }
    /// The first number of each part, and the number of all unknowns.
    pub fn first(&self) -> &[u64] {
        &self.first
    }
    /// The unknowns that other parts own.
    pub(super) fn ghosts(&self) -> impl Iterator<Item = usize> + '_ {
        self.received.iter().flatten().map(|&unknown| unknown as usize)
    }
    /// Gives the unknowns that other parts own the values that they have there; all parts call it.
    ///
    /// # Errors
    /// [`ExchangeError::Length`] if the parts do not have the numbers of one discretisation; those of the exchange.
    ///
    /// # Panics
    /// If there are fewer values than unknowns.
    pub fn update(&self, values: &mut [f64], exchange: &dyn Exchange) -> Result<(), ExchangeError> {
        let mut received = Vec::new();
        let receive = &mut |unknown, value| received.push((unknown, value));
        self.exchange_values(&|unknown| values[unknown], receive, exchange)?;
        received.into_iter().for_each(|(unknown, value)| values[unknown] = value);
        Ok(())
    }
    /// Calls `receive` with every unknown that another part owns and the `value` that it has there; all parts
    /// call it.
    ///
    /// # Errors
    /// Those of [`Numbering::update`].
    pub fn exchange_values(
        &self,
        value: &dyn Fn(usize) -> f64,
        receive: &mut dyn FnMut(usize, f64),
        exchange: &dyn Exchange,
    ) -> Result<(), ExchangeError> {
        let bits = |&unknown: &u32| value(unknown as usize).to_bits();
        let lists = self.sent.iter().map(|unknowns| unknowns.iter().map(bits).collect()).collect();
        let lists = exchange.exchange(lists)?;
        check_lengths(&lists, |part| self.received[part].len())?;
        for (unknowns, bits) in self.received.iter().zip(lists) {
            for (&unknown, bits) in unknowns.iter().zip(bits) {
                receive(unknown as usize, f64::from_bits(bits));
            }
        }
        Ok(())
    }
}

/// The cells of a part and their unknowns.
struct Cells<'p> {
    /// The number of the part.
    number: u32,
    owners: &'p [u32],
    /// The numbers of the cells in the whole mesh.
    numbers: &'p [u64],
    unknowns: Vec<u32>,
    per_cell: usize,
}

impl Cells<'_> {
    fn number(&self, owners: &[u32], exchange: &dyn Exchange) -> Result<Numbering, ExchangeError> {
        let n_parts = exchange.parts();
        let mut is_inside = vec![false; owners.len()];
        for (cell, unknowns) in self.unknowns.chunks_exact(self.per_cell).enumerate() {
            if self.owners[cell] == self.number {
                unknowns.iter().for_each(|&unknown| is_inside[unknown as usize] = true);
            }
        }
        let is_own = |&i: &u32| owners[i as usize] == self.number;
        let own: Vec<u32> = (0..owners.len() as u32).filter(is_own).collect();
        let counts = exchange.exchange(vec![vec![own.len() as u64]; n_parts])?;
        check_lengths(&counts, |_| 1)?;
        let mut first = vec![0];
        for count in counts.iter().flatten() {
            first.push(first[first.len() - 1] + count);
        }
        let mut numbers = vec![UNKNOWN; owners.len()];
        for (number, &unknown) in (first[self.number as usize]..).zip(&own) {
            numbers[unknown as usize] = number;
        }
        let of_lower_parts = |unknown: usize, of: u32| is_inside[unknown] && owners[unknown] == of;
        self.ask(&mut numbers, n_parts, exchange, &of_lower_parts)?;
        self.ask(&mut numbers, n_parts, exchange, &|_, _| true)?;
        agree(self.check(&numbers), exchange)?;
        let (mut received, mut asked) = (vec![Vec::new(); n_parts], vec![Vec::new(); n_parts]);
        for (unknown, &number) in (0..).zip(&numbers) {
            let of = first.partition_point(|&first| first <= number) - 1;
            if of != self.number as usize {
                received[of].push(unknown);
                asked[of].push(number - first[of]);
            }
        }
        let at = |positions: Vec<u64>| positions.iter().map(|&k| own[k as usize]).collect();
        let sent = exchange.exchange(asked)?.into_iter().map(at).collect();
        Ok(Numbering { own, numbers, first, sent, received })
    }

    /// Asks the owners of other cells for the numbers of those of their unknowns that are not known, and
    /// answers the same questions.
    fn ask(
        &self,
        numbers: &mut [u64],
        n_parts: usize,
        exchange: &dyn Exchange,
        asks: &dyn Fn(usize, u32) -> bool,
    ) -> Result<(), ExchangeError> {
        let mut names = vec![Vec::new(); n_parts];
        let mut asked: Vec<Vec<u32>> = vec![Vec::new(); n_parts];
        let mut is_asked = vec![false; numbers.len()];
        for (k, &unknown) in self.unknowns.iter().enumerate() {
            let (cell, place, i) = (k / self.per_cell, k % self.per_cell, unknown as usize);
            let of = self.owners[cell];
            if of == self.number || numbers[i] != UNKNOWN || is_asked[i] || !asks(i, of) {
                continue;
            }
            is_asked[i] = true;
            names[of as usize].push(self.numbers[cell] * self.per_cell as u64 + place as u64);
            asked[of as usize].push(unknown);
        }
        let answer = |name: &u64| {
            let [cell, place] = [name / self.per_cell as u64, name % self.per_cell as u64];
            match self.numbers.binary_search(&cell) {
                Ok(cell) if self.owners[cell] == self.number => {
                    numbers[self.unknowns[cell * self.per_cell + place as usize] as usize]
                }
                _ => NOT_OWNED,
            }
        };
        let answers = |names: &Vec<u64>| names.iter().map(answer).collect();
        let answers = exchange.exchange(names)?.iter().map(answers).collect();
        let answers = exchange.exchange(answers)?;
        check_lengths(&answers, |part| asked[part].len())?;
        for (unknowns, answers) in asked.iter().zip(answers) {
            for (&unknown, number) in unknowns.iter().zip(answers) {
                numbers[unknown as usize] = number;
            }
        }
        Ok(())
    }

    /// Whether every unknown has a number.
    fn check(&self, numbers: &[u64]) -> Result<(), ExchangeError> {
        for (k, &unknown) in self.unknowns.iter().enumerate() {
            let cell = k / self.per_cell;
            let (part, owner, cell) = (self.number, self.owners[cell], self.numbers[cell]);
            match numbers[unknown as usize] {
                NOT_OWNED if owner != part => {
                    return Err(ExchangeError::NotOwned(format!(
                        "part {owner} has no cell {cell} of the whole mesh, which it owns for part {part}: take all parts of one mesh with the same owners of its cells, and refine all as often"
                    )));
                }
                UNKNOWN => {
                    return Err(ExchangeError::NotNumbered(format!(
                        "part {owner} has no number for an unknown of its cell {cell} of the whole mesh: take parts with as many layers as the scheme asks for"
                    )));
                }
                _ => {}
            }
        }
        Ok(())
    }
}
