//! The numbers of nodes that elements of each type have.

use unilateral::mesh::gmsh::{GmshError, GmshErrorKind, GmshFile};

/// Reads a file with a line and an element of a type with so many nodes.
fn read(element_type: i64, nodes: usize) -> Result<GmshFile, GmshError> {
    let element = format!("2 {element_type} 2 1 1{}", " 1".repeat(nodes));
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n2\n1 1 2 1 1 1 1\n{element}\n$EndElements\n"
    );
    GmshFile::parse(text)
}

#[test]
fn nodes_of_the_types_in_the_manual() {
    let table = [(1, 2), (2, 3), (4, 4), (8, 3), (9, 6), (11, 10), (15, 1)];
    for (element_type, nodes) in table {
        // of one node more or less the line is too long or too short
        let is_read = [nodes - 1, nodes, nodes + 1].map(|n| read(element_type, n).is_ok());
        assert_eq!(is_read, [false, true, false], "type {element_type}");
    }
    for element_type in [-1, 0, 3, 21, 29, 140, 1 << 40] {
        let error = read(element_type, 4).unwrap_err();
        assert_eq!(error.kind, GmshErrorKind::Unsupported, "type {element_type}");
    }
}
