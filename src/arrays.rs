//! Arrays filled by a loop.
//!
//! [`std::array::from_fn`] and the method `map` of arrays account for panics and for entries that need to be
//! dropped, and compile to five times as much code. Most functions here exist for three dimensions,
//! so that this is a noticeable part of the library's compilation.

/// The array of the values of a function at `0`, `1`, ..., in this order. It has at least one entry.
pub(crate) fn array_of<X: Copy, const N: usize>(mut entry: impl FnMut(usize) -> X) -> [X; N] {
    let mut entries = [entry(0); N];
    for k in 1..N {
        entries[k] = entry(k);
    }
    entries
}

/// The array of the values of a function of the entries of an array, which has at least one.
pub(crate) fn map_entries<A: Copy, X: Copy, const N: usize>(
    from: [A; N],
    mut entry: impl FnMut(A) -> X,
) -> [X; N] {
    array_of(|k| entry(from[k]))
}
