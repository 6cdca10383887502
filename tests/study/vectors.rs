//! Vectors from files of other programs.

use std::fs;

use crate::support::scratch::Scratch;
use unilateral::error::Error;
use unilateral::exchange::read_vector;

/// A file of NumPy with an array of this type and shape.
fn npy(kind: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let header = format!("{header:<117}\n");
    let length = header.len() as u16;
    [b"\x93NUMPY\x01\x00", &length.to_le_bytes()[..], header.as_bytes(), data].concat()
}

fn bytes<const N: usize>(numbers: impl IntoIterator<Item = [u8; N]>) -> Vec<u8> {
    numbers.into_iter().flatten().collect()
}

/// What is read of a file with these contents.
fn read(folder: &Scratch, contents: &[u8]) -> Result<Vec<f64>, Error> {
    let path = folder.0.join("vector");
    fs::write(&path, contents).unwrap();
    read_vector(&path)
}

#[test]
fn vectors_come_back_from_their_files() {
    let folder = Scratch::new("vectors");
    let values = [1.5, -0.0, f64::INFINITY, 1e-300];
    let double = npy("<f8", "(4,)", &bytes(values.map(f64::to_le_bytes)));
    let found = read(&folder, &double).unwrap();
    assert_eq!(found, values);
    assert!(found[1].is_sign_negative());
    let column = npy("<f8", "(4, 1)", &bytes(values.map(f64::to_le_bytes)));
    assert_eq!(read(&folder, &column).unwrap(), values);
    let single = npy("<f4", "(2,)", &bytes([1.5_f32, -2.0].map(f32::to_le_bytes)));
    assert_eq!(read(&folder, &single).unwrap(), [1.5, -2.0]);
    let text = read(&folder, b"1, 2e-3\n inf\r\n").unwrap();
    assert_eq!(text, [1.0, 2e-3, f64::INFINITY]);
    // later versions of the format state the length of their header in four bytes
    let mut later = single;
    later.splice(6..8, [2, 0]);
    later.splice(10..10, [0, 0]);
    assert_eq!(read(&folder, &later).unwrap(), [1.5, -2.0]);
}

#[test]
fn damaged_vectors_are_refused() {
    let folder = Scratch::new("vectors-damaged");
    let whole = npy("<f8", "(2,)", &bytes([1.0_f64, 2.0].map(f64::to_le_bytes)));
    for n in 1..whole.len() {
        let outcome = read(&folder, &whole[..n]);
        assert!(matches!(outcome, Err(Error::Read { .. })), "{n} bytes: {outcome:?}");
    }
    let refused = |contents: &[u8]| read(&folder, contents).unwrap_err().to_string();
    let integers = refused(&npy("<i8", "(1,)", &7_i64.to_le_bytes()));
    assert!(integers.contains("numbers of type <i8"), "{integers}");
    let square = refused(&npy("<f8", "(2, 2)", &[0; 32]));
    assert!(square.contains("2 axes"), "{square}");
    assert!(refused(b"1 two").contains("\"two\" is no number"));
}
