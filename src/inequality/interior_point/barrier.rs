//! Bounds on the way of an interior point method, and how far it is to them.

/// Most powers of the length that a way has.
pub(crate) const MOST_POWERS: usize = 8;

/// Share of the way to the nearest bound that a step goes.
const SHARE: f64 = 0.995;

/// What a step is shortened to as long as it leads beyond a bound all the same.
const SHORTER: f64 = 0.9;

/// Parts of a way that are looked at, and halvings of the one in which it ends.
const PARTS: usize = 32;
const HALVINGS: usize = 40;

/// A polynomial without its constant, powers ascending.
type Powers = [f64; MOST_POWERS];

/// One bound of one unknown: `side` times the unknown is above `side` times the bound by `gap`. Both
/// gap and force are about to move along polynomials of the length of a step.
pub(crate) struct Wall {
    pub unknown: usize,
    pub side: f64,
    pub gap: f64,
    pub force: f64,
    gap_powers: Powers,
    force_powers: Powers,
    /// What share of themselves the last step left of gap and force; one before the first.
    pub left: [f64; 2],
}

/// What is left of a wall between two steps.
pub(crate) struct Rest {
    unknown: usize,
    side: f64,
    gap: f64,
    force: f64,
    left: [f64; 2],
}

impl From<Wall> for Rest {
    fn from(Wall { unknown, side, gap, force, left, .. }: Wall) -> Self {
        Self { unknown, side, gap, force, left }
    }
}

impl From<Rest> for Wall {
    fn from(Rest { unknown, side, gap, force, left }: Rest) -> Self {
        Self { left, ..Self::new(unknown, side, gap, force) }
    }
}

impl Wall {
    pub fn new(unknown: usize, side: f64, gap: f64, force: f64) -> Self {
        let none = [0.0; MOST_POWERS];
        Self { unknown, side, gap, force, gap_powers: none, force_powers: none, left: [1.0; 2] }
    }

    pub fn product(&self) -> f64 {
        self.gap * self.force
    }

    /// The part of the product's power `k + 1` that lower powers of gap and force make.
    pub fn mixed(&self, k: usize) -> f64 {
        (0..k).map(|i| self.gap_powers[i] * self.force_powers[k - 1 - i]).sum()
    }

    /// Sets the power `k + 1` of the gap, and that of the force for which the product's has what
    /// lower powers make of it and `rate` besides.
    pub fn set_power(&mut self, k: usize, of_gap: f64, rate: f64) {
        self.gap_powers[k] = of_gap;
        self.force_powers[k] = (rate - self.force * of_gap) / self.gap;
    }

    /// Gap and force after a step of this length with so many powers.
    fn at(&self, length: f64, powers: usize) -> [f64; 2] {
        let gap = self.gap + along(&self.gap_powers[..powers], length);
        [gap, self.force + along(&self.force_powers[..powers], length)]
    }

    /// Goes there.
    pub fn go(&mut self, length: f64, powers: usize) {
        let [gap, force] = self.at(length, powers);
        self.left = [gap / self.gap, force / self.force];
        (self.gap, self.force) = (gap, force);
    }
}

/// The longest step, at most one, that leaves all gaps and forces positive.
pub(crate) fn longest_step(walls: &[Wall], powers: usize) -> f64 {
    let longest = walls.iter().fold(1.0, |most, wall| {
        let most = first_zero(wall.gap, &wall.gap_powers[..powers], most);
        first_zero(wall.force, &wall.force_powers[..powers], most)
    });
    let mut length = if longest < 1.0 { SHARE * longest } else { 1.0 };
    // a dip between the points looked at
    while walls.iter().any(|wall| wall.at(length, powers).iter().any(|&left| left <= 0.0)) {
        length *= SHORTER;
    }
    length
}

/// The mean product that a step leaves.
pub(crate) fn mean_product(walls: &[Wall], length: f64, powers: usize) -> f64 {
    let product = |wall: &Wall| {
        let [gap, force] = wall.at(length, powers);
        gap * force
    };
    walls.iter().map(product).sum::<f64>() / walls.len().max(1) as f64
}

fn along(powers: &[f64], length: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, power| length * (sum + power))
}

/// The least zero of a polynomial below `most`, up to what may hide between two points looked at;
/// `most` if there is none. The value at zero is positive.
fn first_zero(value: f64, powers: &[f64], most: f64) -> f64 {
    let largest_change = powers.iter().rev().fold(0.0, |sum, power| most * (sum + power.abs()));
    if largest_change < value {
        return most;
    }
    let is_beyond = |length: f64| value + along(powers, length) <= 0.0;
    let part = most / PARTS as f64;
    let Some(end) = (1..=PARTS).find(|&k| is_beyond(k as f64 * part)) else {
        return most;
    };
    let (mut low, mut high) = ((end - 1) as f64 * part, end as f64 * part);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        *(if is_beyond(middle) { &mut high } else { &mut low }) = middle;
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(gap_powers: Powers, force_powers: Powers) -> Wall {
        Wall { gap_powers, force_powers, ..Wall::new(0, 1.0, 2.0, 3.0) }
    }

    #[test]
    fn steps_end_short_of_the_first_bound() {
        let mut gap = [0.0; MOST_POWERS];
        // 2 (1 - 4 t^3): zero at the cube root of a quarter
        gap[2] = -8.0;
        let walls = [wall([0.0; MOST_POWERS], gap), wall(gap, [0.0; MOST_POWERS])];
        let zero = 0.25_f64.cbrt();
        assert!((longest_step(&walls, 3) - SHARE * zero).abs() < 1e-12);
        assert_eq!(longest_step(&walls, 2), 1.0);
        let half = mean_product(&walls, 0.5, 3);
        assert!((half - 0.5 * (2.0 * (3.0 - 1.0) + (2.0 - 1.0) * 3.0)).abs() < 1e-14);
    }

    /// The product moves as it is told to, power by power.
    #[test]
    fn products_follow_their_rates() {
        let mut wall = Wall::new(0, 1.0, 2.0, 3.0);
        let rates = [-12.0, 6.0, 0.0, 0.0];
        for (k, (rate, of_gap)) in rates.into_iter().zip([0.5, -0.25, 0.75, 1.0]).enumerate() {
            let rate = rate - wall.mixed(k);
            wall.set_power(k, of_gap, rate);
        }
        // 6 (1 - t)^2 up to the fifth power
        let off = |t: f64| {
            (mean_product(std::slice::from_ref(&wall), t, 4) - 6.0 * (1.0 - t).powi(2)).abs()
        };
        assert!(off(1e-2) < 1e-8, "{}", off(1e-2));
        assert!(off(1e-2) > 16.0 * off(5e-3));
    }

    /// A polynomial that dips below zero between two points looked at.
    #[test]
    fn no_step_ends_beyond_a_bound() {
        let at = SHARE * 0.5;
        let mut gap = [0.0; MOST_POWERS];
        // 2 (t / at - 1)^2 - tiny, and a force that ends at one half
        (gap[0], gap[1]) = (-4.0 / at, 2.0 / at.powi(2));
        let mut force = [0.0; MOST_POWERS];
        force[0] = -6.0;
        let mut touched = wall(gap, force);
        touched.gap -= 1e-9;
        let length = longest_step(std::slice::from_ref(&touched), 2);
        assert!(touched.at(length, 2).iter().all(|&left| left > 0.0), "{length}");
    }
}
