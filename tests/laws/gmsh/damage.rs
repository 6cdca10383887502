//! Damaged files: whatever the bytes, an error or a mesh, never a panic.

use super::files::{INTERVAL, SQUARE, SQUARE_V2, TETRAHEDRON};
use super::writer::{FORMS, Form, interval, square, tetrahedron};
use unilateral::mesh::gmsh::{GmshError, GmshFile};

/// A deterministic stream of numbers (xorshift).
struct Stream(u64);

impl Stream {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound.max(1) as u64) as usize
    }
}

fn read_all(bytes: &[u8]) -> Vec<Result<usize, GmshError>> {
    match GmshFile::parse(bytes) {
        Err(error) => vec![Err(error)],
        Ok(file) => vec![
            file.mesh::<1>().map(|r| r.mesh.n_cells()),
            file.mesh::<2>().map(|r| r.mesh.n_cells()),
            file.mesh::<3>().map(|r| r.mesh.n_cells()),
        ],
    }
}

/// Reads in every dimension; a mesh must have cells, an error a message.
fn survives(bytes: &[u8]) {
    for result in read_all(bytes) {
        match result {
            Ok(cells) => assert!(cells > 0),
            Err(error) => {
                let message = error.to_string();
                assert!((1..1000).contains(&message.len()), "{} bytes: {message}", message.len());
                assert!(!message.chars().any(char::is_control), "{message:?}");
            }
        }
    }
}

fn samples() -> Vec<(Form, Vec<u8>)> {
    let mut files = Vec::new();
    for sample in [interval(), square(), tetrahedron()] {
        for form in FORMS {
            files.push((form, sample.four(form)));
            files.push((form, sample.two(form)));
        }
    }
    for text in [SQUARE, SQUARE_V2, INTERVAL, TETRAHEDRON] {
        files.push((Form::Text, text.as_bytes().to_vec()));
    }
    files
}

#[test]
fn every_truncation_is_an_error() {
    for (_, bytes) in samples() {
        let end = bytes.windows(12).rposition(|w| w == b"$EndElements").unwrap() + 12;
        for length in 0..bytes.len() {
            for result in read_all(&bytes[..length]) {
                assert!(result.is_err() || length >= end, "cut at {length} of {end}");
            }
        }
    }
}

/// Every word of a text in turn by one that is long and has control characters.
#[test]
fn long_words() {
    let long = "\u{1b}[31mé\u{7}".repeat(2000);
    for text in [SQUARE, SQUARE_V2, INTERVAL, TETRAHEDRON] {
        let starts =
            text.split_whitespace().map(|word| word.as_ptr() as usize - text.as_ptr() as usize);
        for start in starts {
            let length = text[start..].find(char::is_whitespace).unwrap_or(text.len() - start);
            for new in [long.clone(), format!("${long}"), format!("\"{long}\"")] {
                let mut damaged = text.to_owned();
                damaged.replace_range(start..start + length, &new);
                survives(damaged.as_bytes());
            }
        }
    }
}

#[test]
fn flipped_bytes() {
    let mut stream = Stream(0x9e37_79b9_7f4a_7c15);
    for (_, bytes) in samples() {
        for _ in 0..2000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + stream.below(3) {
                let at = stream.below(damaged.len());
                damaged[at] = match stream.below(4) {
                    0 => damaged[at] ^ (1 << stream.below(8)),
                    1 => b"0123456789-+.eE \n$\""[stream.below(19)],
                    2 => 0xff,
                    _ => stream.below(256) as u8,
                };
            }
            survives(&damaged);
        }
    }
}

#[test]
fn deleted_and_repeated_stretches() {
    let mut stream = Stream(0x2545_f491_4f6c_dd1d);
    for (_, bytes) in samples() {
        for _ in 0..500 {
            let start = stream.below(bytes.len());
            let end = (start + stream.below(40)).min(bytes.len());
            let mut damaged = bytes[..start].to_vec();
            if stream.below(2) == 0 {
                damaged.extend_from_slice(&bytes[start..end]);
                damaged.extend_from_slice(&bytes[start..end]);
            }
            damaged.extend_from_slice(&bytes[end..]);
            survives(&damaged);
        }
    }
}

#[test]
fn every_deleted_line_is_noticed() {
    for (form, bytes) in samples() {
        if form != Form::Text {
            continue;
        }
        let text = String::from_utf8(bytes).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        for skipped in 0..lines.len() {
            let kept = lines.iter().enumerate().filter(|(k, _)| *k != skipped);
            let damaged: String = kept.map(|(_, line)| format!("{line}\n")).collect();
            survives(damaged.as_bytes());
            let within = |section: &str| {
                let at = |line: String| lines.iter().position(|l| *l == line).unwrap();
                (at(format!("${section}"))..=at(format!("$End{section}"))).contains(&skipped)
            };
            if ["MeshFormat", "Nodes", "Elements"].into_iter().any(within) {
                let read = read_all(damaged.as_bytes());
                assert!(read.iter().all(Result::is_err), "line {} deleted", skipped + 1);
            }
        }
    }
}

#[test]
fn extreme_words() {
    let words = [
        "1000000000000000000",
        "18446744073709551615",
        "99999999999999999999999",
        "-1",
        "0",
        "nan",
        "inf",
        "1e400",
        "$",
        "$End",
        "\"",
        "",
        "\u{e9}",
        "2147483648",
        "-9223372036854775808",
        "4294967295",
    ];
    for (form, bytes) in samples() {
        if form != Form::Text {
            continue;
        }
        let text = String::from_utf8(bytes).unwrap();
        let count = text.split(' ').count();
        for at in 0..count {
            for word in words {
                let changed =
                    text.split(' ').enumerate().map(|(k, w)| if k == at { word } else { w });
                survives(changed.collect::<Vec<_>>().join(" ").as_bytes());
            }
        }
    }
}

#[test]
fn extreme_binary_numbers() {
    for (form, bytes) in samples() {
        if form == Form::Text {
            continue;
        }
        for at in 0..bytes.len() - 8 {
            for value in [u64::MAX, 1 << 62, 1_000_000_000_000_000_000, 0x7fff_ffff_7fff_ffff, 0] {
                let mut damaged = bytes.clone();
                damaged[at..at + 8].copy_from_slice(&value.to_le_bytes());
                survives(&damaged);
            }
        }
    }
}

#[test]
fn arbitrary_bytes() {
    let mut stream = Stream(1);
    for length in 0..300 {
        let mut bytes: Vec<u8> = (0..length).map(|_| stream.below(256) as u8).collect();
        survives(&bytes);
        for header in [
            "$MeshFormat\n4.1 1 8\n\u{1}\0\0\0\n$EndMeshFormat\n$Nodes\n",
            "$MeshFormat\n2.2 1 8\n\u{1}\0\0\0\n$EndMeshFormat\n$Elements\n7\n",
        ] {
            let mut file = header.as_bytes().to_vec();
            file.append(&mut bytes.clone());
            survives(&file);
        }
        bytes.clear();
    }
}
