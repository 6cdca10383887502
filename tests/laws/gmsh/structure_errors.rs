//! One test for each error about the structure of a file.

use super::errors::{FOUR, TWO, change, fail, says};
use super::writer::{Form, square};
use std::path::Path;
use unilateral::mesh::gmsh;
use unilateral::mesh::gmsh::{FilePosition, GmshError};

#[test]
fn unreadable() {
    let error = gmsh::read::<2>(Path::new("no/such/file.msh")).unwrap_err();
    assert!(matches!(error, GmshError::Unreadable { .. }));
    says(&error, &["no/such/file.msh", "No such file"]);
}

#[test]
fn not_gmsh() {
    for bytes in [&b"solid ascii\nfacet"[..], b"\x7fELF\x02\x01", b"", b"<?xml version=\"1.0\"?>"] {
        let error = fail::<2>(bytes);
        assert!(matches!(error, GmshError::NotGmsh { .. }));
        says(&error, &["not a Gmsh mesh", "$MeshFormat", "save"]);
    }
}

#[test]
fn unsupported_version() {
    for version in ["4.0", "4", "2.1", "3", "5.0"] {
        let text = format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n");
        let error = fail::<2>(text.as_bytes());
        assert!(
            matches!(&error, GmshError::UnsupportedVersion { position: FilePosition::Line(2), version: v } if v == version)
        );
        says(&error, &["line 2", version, "4.1 and 2.2", "msh41"]);
    }
    assert!(matches!(
        fail::<2>(b"$NOD\n3\n"),
        GmshError::UnsupportedVersion { position: FilePosition::Line(1), .. }
    ));
}

#[test]
fn unsupported_data_size() {
    let (text, _) = change(TWO, "2.2 0 8", "2.2 0 4");
    let error = fail::<2>(text.as_bytes());
    assert!(matches!(
        error,
        GmshError::UnsupportedDataSize { position: FilePosition::Line(2), data_size: 4 }
    ));
    says(&error, &["line 2", "4 bytes", "only of 8", "save again"]);
}

#[test]
fn byte_order() {
    let mut bytes = square().four(Form::Little);
    bytes[20] = 13;
    let error = fail::<2>(&bytes);
    assert!(
        matches!(
            error,
            GmshError::ByteOrder { position: FilePosition::Byte(20), found: [13, 0, 0, 0] }
        ),
        "{error}"
    );
    says(&error, &["byte 20", "[13, 0, 0, 0]", "copy it again"]);
}

#[test]
fn truncated() {
    let cut = FOUR.find("2 1 1 1").unwrap();
    let error = fail::<2>(&FOUR.as_bytes()[..cut]);
    assert!(
        matches!(&error, GmshError::Truncated { position: FilePosition::Line(40), section } if section == "$Nodes"),
        "{error}"
    );
    says(&error, &["line 40", "$Nodes", "incomplete"]);
    for bytes in [square().four(Form::Little), square().two(Form::Big)] {
        let cut = bytes.len() - 40;
        let error = fail::<2>(&bytes[..cut]);
        assert!(
            matches!(&error, GmshError::Truncated { position: FilePosition::Byte(b), section } if *b == cut && section == "$Elements"),
            "{error}"
        );
    }
    let error = fail::<2>(b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\nno end");
    says(&error, &["line 5", "$Comments"]);
}

#[test]
fn missing_section() {
    let cut = TWO.find("$Elements").unwrap();
    let error = fail::<2>(&TWO.as_bytes()[..cut]);
    assert!(matches!(error, GmshError::MissingSection { section: "$Elements" }));
    says(&error, &["$Elements", "save"]);
    let text = TWO.replace("$Nodes", "$Dots").replace("$EndNodes", "$EndDots");
    assert!(matches!(fail::<2>(text.as_bytes()), GmshError::MissingSection { section: "$Nodes" }));
}

#[test]
fn partitioned() {
    let text = FOUR.replace("$Nodes", "$PartitionedEntities\n2\n$EndPartitionedEntities\n$Nodes");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::Partitioned { position: FilePosition::Line(28) }),
        "{error}"
    );
    says(&error, &["line 28", "unpartitioned"]);
}

#[test]
fn not_a_number() {
    let (text, line) = change(TWO, "4 0 1 0", "4 0 one 0");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(&error, GmshError::NotANumber { position: FilePosition::Line(l), word, .. } if *l == line && word == "one")
    );
    says(&error, &[&format!("line {line}"), "$Nodes", "coordinate y", "`one`"]);
    let (text, line) = change(FOUR, "103 30 40 90000000000", "103 30 -40 90000000000");
    let error = fail::<2>(text.as_bytes());
    says(&error, &[&format!("line {line}"), "$Elements", "tag of a node", "`-40`"]);
}

#[test]
fn unexpected() {
    // A number is missing: told on its own line.
    let (text, line) = change(TWO, "4 0 1 0", "4 0 1");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(&error, GmshError::Unexpected { position: FilePosition::Line(l), .. } if *l == line),
        "{error}"
    );
    says(&error, &[&format!("line {line}"), "coordinate z", "the end of the line"]);
    // One too many.
    let (text, line) = change(TWO, "6 2 2 7 1 2 3 5", "6 2 2 7 1 2 3 5 4");
    says(&fail::<2>(text.as_bytes()), &[&format!("line {line}"), "the end of the line", "`4`"]);
    // The wrong end.
    let (text, line) = change(TWO, "$EndNodes", "$EndNode");
    says(&fail::<2>(text.as_bytes()), &[&format!("line {line}"), "`$EndNodes`", "`$EndNode`"]);
    // A name without quotes.
    let (text, line) = change(TWO, "1 3 \"contact\"", "1 3 contact");
    says(&fail::<2>(text.as_bytes()), &[&format!("line {line}"), "double quotes", "`contact`"]);
    // Triangles on a curve.
    let (text, line) = change(FOUR, "2 1 2 4", "1 1 2 4");
    says(&fail::<2>(text.as_bytes()), &[&format!("line {}", line + 1), "dimension 1", "triangle"]);
    // Words between sections.
    let text = TWO.replace("$Elements", "hello\n$Elements");
    says(&fail::<2>(text.as_bytes()), &["line 19", "beginning of a section", "`hello`"]);
}

#[test]
fn counts() {
    let (text, _) = change(TWO, "5", "6");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(&error, GmshError::Count { position: FilePosition::Line(18), announced: 6, found, .. } if found == "5"),
        "{error}"
    );
    says(&error, &["line 18", "$Nodes", "6 nodes", "5 found", "damaged"]);
    let (text, _) = change(TWO, "5", "4");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(&error, GmshError::Count { position: FilePosition::Line(17), announced: 4, .. }),
        "{error}"
    );
    // The blocks do not add up.
    let (text, _) = change(FOUR, "3 5 10 90000000000", "3 7 10 90000000000");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(&error, GmshError::Count { announced: 7, found, .. } if found == "5"),
        "{error}"
    );
    let (text, _) = change(FOUR, "6 9 1 104", "6 8 1 104");
    assert!(matches!(fail::<2>(text.as_bytes()), GmshError::Count { announced: 8, .. }));
}

#[test]
fn absurd_counts_take_no_memory() {
    let (text, _) = change(TWO, "5", "1000000000000000000");
    let error = fail::<2>(text.as_bytes());
    assert!(
        matches!(error, GmshError::Count { announced: 1_000_000_000_000_000_000, .. }),
        "{error}"
    );
    let mut bytes = square().four(Form::Little);
    let at = bytes.windows(7).position(|w| w == b"$Nodes\n").unwrap() + 7 + 8;
    bytes[at..at + 8].copy_from_slice(&1_000_000_000_000_000_000u64.to_le_bytes());
    let error = fail::<2>(&bytes);
    let place = FilePosition::Byte(at + 24);
    assert!(
        matches!(error, GmshError::Count { position: p, announced: 1_000_000_000_000_000_000, .. } if p <= place),
        "{error}"
    );
    says(&error, &["byte ", "$Nodes", "at most"]);
}
