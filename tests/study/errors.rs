//! What errors print: their message, and the causes that it leaves out.

use std::error::Error as _;
use std::{fs, io};

use crate::rows::{report, rows};
use crate::support::scratch::Scratch;
use unilateral::error::Error;
use unilateral::mesh::Mesh;

#[test]
fn debug_prints_the_message() {
    let of_mesh = Mesh::<2>::new(Vec::new(), Vec::new(), &[]).unwrap_err();
    assert_eq!(format!("{of_mesh:?}"), "the mesh has no cells of dimension 2");
    let error = Error::from(of_mesh);
    assert_eq!(format!("{error:?}"), "the mesh has no cells of dimension 2");
    assert_eq!(format!("{error:?}"), error.to_string());
}

#[test]
fn debug_prints_causes_that_the_message_leaves_out() {
    #[derive(Debug)]
    struct Outer(io::Error);
    impl std::fmt::Display for Outer {
        fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("outer")
        }
    }
    impl std::error::Error for Outer {
        fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
            Some(&self.0)
        }
    }
    let error = Error::Processes(Box::new(Outer(io::Error::other("inner"))));
    assert_eq!(error.to_string(), "outer");
    assert_eq!(format!("{error:?}"), "outer: inner");
    let file = Error::Write { path: "out.csv".into(), why: Box::new(Outer(io::Error::other("x"))) };
    assert_eq!(format!("{file:?}"), "cannot write out.csv: outer: x");
}

#[test]
fn a_file_that_cannot_be_written_keeps_the_error_of_the_system() {
    let scratch = Scratch::new("unwritable");
    // a file in place of the directory
    let path = scratch.file("taken", "");
    let error = report(rows()).write(&path).unwrap_err();
    let why = fs::create_dir_all(&path).unwrap_err();
    assert_eq!(format!("{error:?}"), format!("cannot write {path}: {why}"));
    let source = error.source().and_then(|why| why.downcast_ref::<io::Error>());
    assert_eq!(source.map(io::Error::kind), Some(why.kind()));
    let error = Error::Write { path: "out.svg".into(), why: "no such colour".into() };
    assert_eq!(error.to_string(), "cannot write out.svg: no such colour");
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let scratch = Scratch::new("blocked");
    fs::create_dir_all(scratch.0.join("report.csv")).unwrap();
    let error = report(rows()).write(&scratch.0).unwrap_err().to_string();
    assert!(error.starts_with("cannot write ") && error.contains("report.csv"), "{error}");
}
