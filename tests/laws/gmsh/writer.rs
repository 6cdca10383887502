//! A small writer of MSH 4.1 and 2.2, text and binary, for tests.

use std::fmt::Write;

/// How a file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Text,
    Binary,
}

pub const FORMS: [Form; 2] = [Form::Text, Form::Binary];

/// The elements of an entity.
#[derive(Clone, Debug)]
pub struct Block {
    pub dimension: usize,
    pub entity: i32,
    pub groups: Vec<i32>,
    pub element_type: i32,
    pub elements: Vec<(u64, Vec<u64>)>,
}

/// What a file says.
#[derive(Clone, Debug, Default)]
pub struct Sample {
    pub names: Vec<(usize, i32, &'static str)>,
    pub nodes: Vec<(u64, [f64; 3])>,
    pub blocks: Vec<Block>,
    /// Whether nodes carry parametric coordinates (on an entity of dimension two).
    pub parametric: bool,
}

/// Words on lines, or bytes.
struct Out {
    form: Form,
    bytes: Vec<u8>,
}

impl Out {
    fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }
    fn number(&mut self, text: impl ToString, little: &[u8]) {
        match self.form {
            Form::Text => self.text(&format!("{} ", text.to_string())),
            Form::Binary => self.bytes.extend_from_slice(little),
        }
    }
    fn int(&mut self, value: i32) {
        self.number(value, &value.to_le_bytes());
    }
    fn size(&mut self, value: u64) {
        self.number(value, &value.to_le_bytes());
    }
    fn real(&mut self, value: f64) {
        self.number(value, &value.to_le_bytes());
    }
    fn end_line(&mut self) {
        if self.form == Form::Text {
            self.text("\n");
        }
    }
    fn close(&mut self, section: &str) {
        if self.form != Form::Text {
            self.text("\n");
        }
        self.text(&format!("$End{section}\n"));
    }
    fn header(&mut self, version: &str, names: &[(usize, i32, &str)]) {
        let binary = i32::from(self.form != Form::Text);
        self.text(&format!("$MeshFormat\n{version} {binary} 8\n"));
        if binary == 1 {
            self.int(1);
            self.text("\n");
        }
        self.text("$EndMeshFormat\n");
        let mut text = format!("$PhysicalNames\n{}\n", names.len());
        for (dimension, tag, name) in names {
            writeln!(text, "{dimension} {tag} \"{name}\"").unwrap();
        }
        self.text(&text);
        self.text("$EndPhysicalNames\n");
    }
}

impl Sample {
    /// The file in MSH 4.1.
    pub fn four(&self, form: Form) -> Vec<u8> {
        let mut out = Out { form, bytes: Vec::new() };
        out.header("4.1", &self.names);
        out.text("$Entities\n");
        for dimension in 0..4 {
            out.size(self.blocks.iter().filter(|b| b.dimension == dimension).count() as u64);
        }
        out.end_line();
        for dimension in 0..4 {
            for block in self.blocks.iter().filter(|b| b.dimension == dimension) {
                out.int(block.entity);
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    out.real(0.0);
                }
                out.size(block.groups.len() as u64);
                block.groups.iter().for_each(|&group| out.int(group));
                if dimension > 0 {
                    out.size(2);
                    out.int(1);
                    out.int(-2);
                }
                out.end_line();
            }
        }
        out.close("Entities");

        out.text("$Nodes\n");
        // Two blocks, so that blocks are told apart.
        let (first, second) = self.nodes.split_at(self.nodes.len() / 2);
        out.size(2);
        out.size(self.nodes.len() as u64);
        out.size(self.nodes.iter().map(|n| n.0).min().unwrap_or(0));
        out.size(self.nodes.iter().map(|n| n.0).max().unwrap_or(0));
        out.end_line();
        for nodes in [first, second] {
            out.int(2);
            out.int(1);
            out.int(i32::from(self.parametric));
            out.size(nodes.len() as u64);
            out.end_line();
            for node in nodes {
                out.size(node.0);
                out.end_line();
            }
            for node in nodes {
                node.1.iter().for_each(|&x| out.real(x));
                if self.parametric {
                    out.real(0.125);
                    out.real(0.25);
                }
                out.end_line();
            }
        }
        out.close("Nodes");

        out.text("$Elements\n");
        out.size(self.blocks.len() as u64);
        out.size(self.blocks.iter().map(|b| b.elements.len() as u64).sum());
        out.size(1);
        out.size(1000);
        out.end_line();
        for block in &self.blocks {
            out.int(block.dimension as i32);
            out.int(block.entity);
            out.int(block.element_type);
            out.size(block.elements.len() as u64);
            out.end_line();
            for (tag, nodes) in &block.elements {
                out.size(*tag);
                nodes.iter().for_each(|&node| out.size(node));
                out.end_line();
            }
        }
        out.close("Elements");
        out.bytes
    }

    /// The file in MSH 2.2; an element in several groups is repeated, as Gmsh does.
    pub fn two(&self, form: Form) -> Vec<u8> {
        let mut out = Out { form, bytes: Vec::new() };
        out.header("2.2", &self.names);
        let section = if self.parametric { "ParametricNodes" } else { "Nodes" };
        out.text(&format!("${section}\n{}\n", self.nodes.len()));
        for (k, (tag, x)) in self.nodes.iter().enumerate() {
            out.int(*tag as i32);
            x.iter().for_each(|&x| out.real(x));
            if self.parametric {
                // on entities of all dimensions, of which curves and surfaces have coordinates
                out.int((k % 4) as i32);
                out.int(1);
                (0..[0, 1, 2, 0][k % 4]).for_each(|_| out.real(0.125));
            }
            out.end_line();
        }
        out.close(section);
        let count: usize =
            self.blocks.iter().map(|b| b.elements.len() * b.groups.len().max(1)).sum();
        out.text(&format!("$Elements\n{count}\n"));
        for block in &self.blocks {
            let none = vec![0];
            let groups = if block.groups.is_empty() { &none } else { &block.groups };
            if form != Form::Text {
                out.int(block.element_type);
                out.int((block.elements.len() * groups.len()) as i32);
                out.int(2);
            }
            for (tag, nodes) in &block.elements {
                for &group in groups {
                    out.int(*tag as i32);
                    if form == Form::Text {
                        out.int(block.element_type);
                        out.int(2);
                    }
                    out.int(group);
                    out.int(block.entity);
                    nodes.iter().for_each(|&node| out.int(node as i32));
                    out.end_line();
                }
            }
        }
        out.close("Elements");
        out.bytes
    }
}

fn block(dimension: usize, entity: i32, groups: &[i32], first: u64, elements: &[&[u64]]) -> Block {
    let element_type = [15, 1, 2, 4][dimension];
    let elements = elements.iter().zip(first..).map(|(nodes, tag)| (tag, nodes.to_vec())).collect();
    Block { dimension, entity, groups: groups.to_vec(), element_type, elements }
}

/// The interval from 0 to 2, one end fixed and one free.
pub fn interval() -> Sample {
    let x = [0.0, 2.0, 0.5, 1.25];
    Sample {
        names: vec![(0, 1, "dirichlet"), (0, 2, "neumann"), (1, 3, "string")],
        nodes: x.iter().zip(1..).map(|(&x, tag)| (tag, [x, 0.0, 0.0])).collect(),
        blocks: vec![
            block(0, 1, &[1], 1, &[&[1]]),
            block(0, 2, &[2], 2, &[&[2]]),
            block(1, 1, &[3], 3, &[&[1, 3], &[3, 4], &[4, 2]]),
        ],
        parametric: false,
    }
}

/// The unit square of four triangles, with sparse tags of nodes, in two groups of cells.
pub fn square() -> Sample {
    Sample {
        names: vec![(1, 1, "dirichlet"), (1, 2, "neumann"), (1, 3, "contact"), (2, 7, "domain")],
        nodes: vec![
            (10, [0.0, 0.0, 0.0]),
            (20, [1.0, 0.0, 0.0]),
            (30, [1.0, 1.0, 0.0]),
            (40, [0.0, 1.0, 0.0]),
            (900_000, [0.5, 0.5, 0.0]),
        ],
        blocks: vec![
            block(1, 1, &[1], 1, &[&[10, 20]]),
            block(1, 2, &[2], 2, &[&[20, 30], &[40, 30]]),
            block(1, 4, &[-3], 4, &[&[40, 10]]),
            block(2, 1, &[7, 8], 5, &[&[10, 20, 900_000], &[20, 30, 900_000]]),
            block(2, 2, &[7], 7, &[&[30, 40, 900_000], &[40, 10, 900_000]]),
        ],
        parametric: false,
    }
}

/// One tetrahedron, resting on its lowest face.
pub fn tetrahedron() -> Sample {
    Sample {
        names: vec![(2, 1, "dirichlet"), (2, 2, "contact"), (3, 3, "body")],
        nodes: vec![
            (1, [0.0, 0.0, 0.0]),
            (2, [1.0, 0.0, 0.0]),
            (3, [0.0, 1.0, 0.0]),
            (4, [0.0, 0.0, 1.0]),
        ],
        blocks: vec![
            block(2, 1, &[1], 1, &[&[1, 2, 4], &[2, 3, 4], &[3, 1, 4]]),
            block(2, 2, &[2], 4, &[&[3, 2, 1]]),
            block(3, 1, &[3], 5, &[&[1, 2, 3, 4]]),
        ],
        parametric: false,
    }
}
