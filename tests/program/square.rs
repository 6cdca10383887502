//! A mesh to be spoiled.

/// A unit square of four triangles around its centre, in MSH 2.2, to be spoiled.
pub struct Square {
    pub names: Vec<&'static str>,
    pub nodes: Vec<&'static str>,
    pub elements: Vec<&'static str>,
}

impl Square {
    pub fn new() -> Self {
        Self {
            names: vec!["1 1 \"dirichlet\"", "1 2 \"contact\"", "1 3 \"neumann\""],
            nodes: vec!["1 0 0 0", "2 1 0 0", "3 1 1 0", "4 0 1 0", "5 0.5 0.5 0"],
            elements: vec![
                "1 1 2 1 1 1 2",
                "2 1 2 1 1 2 3",
                "3 1 2 1 1 3 4",
                "4 1 2 1 1 4 1",
                "5 2 2 9 1 1 2 5",
                "6 2 2 9 1 2 3 5",
                "7 2 2 9 1 3 4 5",
                "8 2 2 9 1 4 1 5",
            ],
        }
    }
    pub fn with(spoil: impl FnOnce(&mut Self)) -> String {
        let mut square = Self::new();
        spoil(&mut square);
        let section = |name: &str, lines: &[&str]| {
            format!("${name}\n{}\n{}\n$End{name}\n", lines.len(), lines.join("\n"))
        };
        ["$MeshFormat\n2.2 0 8\n$EndMeshFormat\n".to_owned()]
            .into_iter()
            .chain((!square.names.is_empty()).then(|| section("PhysicalNames", &square.names)))
            .chain([section("Nodes", &square.nodes), section("Elements", &square.elements)])
            .collect()
    }
    pub fn sound() -> String {
        Self::with(|_| {})
    }
    /// The same with its lower side in contact.
    pub fn in_contact() -> String {
        Self::with(|s| s.elements[0] = "1 1 2 2 1 1 2")
    }
}
