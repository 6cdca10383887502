//! One test for each error about the structure of a file.

use super::errors::{FOUR, TWO, change, fail, is, says};
use super::writer::{Form, square};
use std::path::Path;
use unilateral::mesh::gmsh;
use unilateral::mesh::gmsh::GmshErrorKind::*;

#[test]
fn unreadable() {
    let error = gmsh::read::<2>(Path::new("no/such/file.msh")).unwrap_err();
    assert_eq!(error.kind, Unreadable);
    says(&error, &["no/such/file.msh", "No such file"]);
}

#[test]
fn not_gmsh() {
    for bytes in [&b"solid ascii\nfacet"[..], b"\x7fELF\x02\x01", b"", b"<?xml version=\"1.0\"?>"] {
        let error = fail::<2>(bytes);
        assert_eq!(error.kind, NotGmsh);
        says(&error, &["not a Gmsh mesh", "$MeshFormat", "save"]);
    }
}

#[test]
fn unsupported_version() {
    for version in ["4.0", "4", "2.1", "3", "5.0"] {
        let text = format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n");
        let error = fail::<2>(text.as_bytes());
        is(&error, Unsupported, "line 2");
        let version = format!("version `{version}` ");
        says(&error, &["line 2", &version, "4.1 and 2.2", "msh41"]);
    }
    says(&fail::<2>(b"$NOD\n3\n"), &["not a Gmsh mesh", "`$NOD`"]);
}

#[test]
fn unsupported_data_size() {
    let (text, _) = change(TWO, "2.2 0 8", "2.2 0 4");
    let error = fail::<2>(text.as_bytes());
    is(&error, Unsupported, "line 2");
    says(&error, &["line 2", "4 bytes", "only of 8", "save again"]);
}

#[test]
fn byte_order() {
    let mut bytes = square().four(Form::Binary);
    bytes[20] = 13;
    let error = fail::<2>(&bytes);
    is(&error, Damaged, "byte 20");
    says(&error, &["byte order mark", "bytes [13, 0, 0, 0]", "copied as text"]);
}

#[test]
fn truncated() {
    let cut = FOUR.find("2 1 1 1").unwrap();
    let error = fail::<2>(&FOUR.as_bytes()[..cut]);
    is(&error, Damaged, "line 40");
    says(&error, &["section $Nodes: ", "found the end of the file"]);
    for bytes in [square().four(Form::Binary), square().two(Form::Binary)] {
        let cut = bytes.len() - 40;
        let error = fail::<2>(&bytes[..cut]);
        is(&error, Damaged, &format!("byte {cut}"));
        says(&error, &["section $Elements: ", "found the end of the file"]);
    }
    let error = fail::<2>(b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\nno end");
    says(&error, &["line 5", "$Comments"]);
}

#[test]
fn missing_section() {
    let cut = TWO.find("$Elements").unwrap();
    let error = fail::<2>(&TWO.as_bytes()[..cut]);
    assert_eq!(error.kind, Damaged);
    says(&error, &["$Elements", "save"]);
    let text = TWO.replace("$Nodes", "$Dots").replace("$EndNodes", "$EndDots");
    let error = fail::<2>(text.as_bytes());
    assert_eq!(error.kind, Damaged);
    says(&error, &["$Nodes"]);
}

#[test]
fn partitioned() {
    let text = FOUR.replace("$Nodes", "$PartitionedEntities\n2\n$EndPartitionedEntities\n$Nodes");
    let error = fail::<2>(text.as_bytes());
    is(&error, Unsupported, "line 28");
    says(&error, &["line 28", "unpartitioned"]);
}

#[test]
fn not_a_number() {
    let (text, line) = change(TWO, "4 0 1 0", "4 0 one 0");
    let error = fail::<2>(text.as_bytes());
    is(&error, Damaged, &format!("line {line}"));
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
    is(&error, Damaged, &format!("line {line}"));
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
    // Words between sections.
    let text = TWO.replace("$Elements", "hello\n$Elements");
    says(&fail::<2>(text.as_bytes()), &["line 19", "beginning of a section", "`hello`"]);
}

#[test]
fn counts() {
    let (text, _) = change(TWO, "5", "6");
    let error = fail::<2>(text.as_bytes());
    is(&error, Damaged, "line 18");
    says(&error, &["section $Nodes: expected a node, found `$EndNodes`"]);
    let (text, _) = change(TWO, "5", "4");
    let error = fail::<2>(text.as_bytes());
    is(&error, Damaged, "line 17");
    says(&error, &["expected `$EndNodes`", "found `5`"]);
    let (text, _) = change(FOUR, "6 9 1 104", "7 9 1 104");
    says(&fail::<2>(text.as_bytes()), &["expected a block of elements", "found `$EndElements`"]);
}

#[test]
fn absurd_counts_take_no_memory() {
    let (text, _) = change(TWO, "5", "1000000000000000000");
    let error = fail::<2>(text.as_bytes());
    is(&error, Damaged, "line 18");
    let mut bytes = square().four(Form::Binary);
    let at = bytes.windows(7).position(|w| w == b"$Nodes\n").unwrap() + 7;
    // of blocks, and of the nodes of the first one
    for at in [at, at + 44] {
        let mut bytes = bytes.clone();
        bytes[at..at + 8].copy_from_slice(&1_000_000_000_000_000_000u64.to_le_bytes());
        let error = fail::<2>(&bytes);
        assert_eq!(error.kind, Damaged, "{error}");
        says(&error, &["byte ", "$Nodes"]);
    }
    bytes.truncate(at);
    says(&fail::<2>(&bytes), &["$Nodes", "the end of the file"]);
}
