//! Levels of nested meshes.

use unilateral::prelude::*;

#[test]
fn levels_that_no_mesh_has_are_refused_before_one_is_made() {
    let scene = scenes::radial::<2>(1.0);
    let refused = |level| {
        let error = Hierarchy::<2>::of_domain(&scene.domain, level).unwrap_err();
        assert!(matches!(&error, Error::Parameter(why) if why.starts_with("level = ")), "{error}");
        error.to_string()
    };
    assert!(refused(0).contains("at least one subdivision"), "{}", refused(0));
    let error = refused(30_000);
    assert!(error.contains("would make 1.8e9 cells, at most 1.1e9 are possible"), "{error}");
}
