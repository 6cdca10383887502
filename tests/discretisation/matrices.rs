//! Matrices by themselves: jumps of a penalised matrix, symmetric parts.

use unilateral::algebra::{JumpTerm, Jumps, SparseMatrix};

const NONE: u32 = JumpTerm::<f64>::NO_UNKNOWN;

/// The jump between unknowns 0, 1 of the first block and 3, 5 of the second, and unknown 2 by itself.
fn terms() -> Vec<JumpTerm<f64>> {
    [(0, 3), (1, NONE), (NONE, 5), (2, NONE)]
        .map(|(here, there)| JumpTerm { here, there, weight: 0.5 })
        .to_vec()
}

#[test]
fn blocks_have_their_sides() {
    let jumps = Jumps::new((2, 3), vec![0, 3, 4], terms()).unwrap();
    let sides = |block| {
        let sides = jumps.sides_of(block).iter();
        sides.map(|s| (s.jump(), s.is_here(), s.sign())).collect::<Vec<_>>()
    };
    assert_eq!(sides(0), [(0, true, 1.0), (1, true, 1.0)]);
    assert_eq!(sides(1), [(0, false, -1.0)]);
    assert_eq!(jumps.blocks_of(1), [Some(0), None]);
}

#[test]
fn wrong_starts_and_jumps_within_a_block_are_refused() {
    for starts in [vec![], vec![0, 4, 3], vec![1, 4], vec![0, 3], vec![0, 5, 4]] {
        assert!(Jumps::new((2, 3), starts.clone(), terms()).is_none(), "{starts:?}");
    }
    assert!(Jumps::new((2, 0), vec![0, 3, 4], terms()).is_none());
    // a side of two blocks, both sides of one block, an unknown of no block
    for (here, there) in [(4, NONE), (1, 2), (6, NONE)] {
        let mut wrong = terms();
        wrong[1] = JumpTerm { here, there, weight: 0.5 };
        assert!(Jumps::new((2, 3), vec![0, 3, 4], wrong).is_none(), "{here} {there}");
    }
    let within = JumpTerm { here: 1, there: 2, weight: 0.5 };
    assert!(Jumps::new((2, 3), vec![0, 1], vec![within]).is_none());
}

#[test]
fn the_symmetric_part_has_the_entries_of_both_sides() {
    // [[1, 2, 0], [0, 3, 4], [6, 2, 0]], the last diagonal entry not stored
    let matrix = SparseMatrix::<f64> {
        row_starts: vec![0, 2, 4, 6],
        columns: vec![0, 1, 1, 2, 0, 1],
        values: vec![1.0, 2.0, 3.0, 4.0, 6.0, 2.0],
    };
    let part = matrix.symmetric_part();
    assert!(part.is_well_formed() && part.transpose(part.size()) == part);
    assert_eq!(part.columns, [0, 1, 2, 0, 1, 2, 0, 1]);
    assert_eq!(part.values, [1.0, 1.0, 3.0, 1.0, 3.0, 3.0, 3.0, 3.0]);
    assert_eq!(matrix.transpose(matrix.size()).transpose(matrix.size()), matrix);
}
