//! What a problem says of its data.

use unilateral::prelude::*;

#[test]
fn debug_lists_the_data_that_are_present() {
    let problem = Problem::<2>::new()
        .constant_source(-1.0)
        .reaction(|x: &Point<2>| x[0])
        .obstacle_below(|_| 0.0);
    let expected =
        "Problem { source: Constant(-1.0), reaction: Function(..), lower obstacle: Function(..) }";
    assert_eq!(format!("{problem:?}"), expected);
    assert_eq!(problem.reaction.everywhere.map(|c| c.at(&Point::from([3.0, 4.0]))), Some(3.0));
}
