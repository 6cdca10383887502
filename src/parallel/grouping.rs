//! Values in groups, by a counting sort.

use super::vectors::{collect, is_sequential};
use super::{for_each_item, map_groups, split};

/// Most tasks of a sort: each task has a list for every range of keys.
const MAX_TASKS: usize = 64;

/// Items and keys that one task has at least.
const LEAST: usize = 1 << 12;

/// The values that `each` passes on for the items below `n_items`, grouped by their keys below `n_keys`: where the group
/// of each key starts, with the number of values at the end, and the values, in each group in the order of items.
///
/// `each` is called twice for an item.
pub(crate) fn group_by_key<V: Copy + Default + Send + Sync>(
    n_items: usize,
    n_keys: usize,
    each: impl Fn(usize, &mut dyn FnMut(u32, V)) + Sync,
) -> (Vec<u32>, Vec<V>) {
    if is_sequential(n_items) {
        let mut starts = vec![0; n_keys];
        (0..n_items).for_each(|item| each(item, &mut |key, _| starts[key as usize] += 1));
        let n_values = starts.iter().sum::<u32>();
        let mut values = collect(n_values as usize, |_| V::default());
        let add = |put: &mut dyn FnMut(u32, V)| (0..n_items).for_each(|item| each(item, put));
        fill(&mut starts, &mut values, (0, 0), &add);
        starts.push(n_values);
        return (starts, values);
    }
    // one list for each range of items and each range of keys
    let length = |n: usize| LEAST.max(n.div_ceil(MAX_TASKS));
    let n_ranges = n_keys.div_ceil(length(n_keys));
    let lists = map_groups(n_items, length(n_items), &|items| {
        let mut lists = vec![Vec::new(); n_ranges];
        let mut put = |key: u32, value| lists[key as usize / length(n_keys)].push((key, value));
        items.for_each(|item| each(item, &mut put));
        lists
    });
    let n_values_of = |range: usize| lists.iter().map(|lists| lists[range].len()).sum::<usize>();
    let lengths: Vec<usize> = (0..n_ranges).map(n_values_of).collect();
    let n_values = lengths.iter().sum();
    let mut starts = vec![0; n_keys];
    let mut values = collect(n_values, |_| V::default());
    let mut first = 0;
    let firsts = lengths.iter().map(|length| {
        first += length;
        first - length
    });
    let ranges = starts.chunks_mut(length(n_keys)).zip(firsts);
    let tasks = ranges.zip(split(&mut values, lengths.iter().copied())).collect();
    for_each_item(tasks, &|range, ((starts, first), values): ((&mut [u32], usize), &mut [V])| {
        let entries = || lists.iter().flat_map(|lists| &lists[range]);
        let first_key = range * length(n_keys);
        entries().for_each(|(key, _)| starts[*key as usize - first_key] += 1);
        let add = |put: &mut dyn FnMut(u32, V)| entries().for_each(|&(key, value)| put(key, value));
        fill(starts, values, (first_key, first), &add);
    });
    starts.push(n_values as u32);
    (starts, values)
}

/// Passes on the keys and values of a range of keys.
type Add<'a, V> = &'a dyn Fn(&mut dyn FnMut(u32, V));

/// Replaces the numbers of values of consecutive keys by where their groups start, and puts the values that `add` passes
/// on into their groups. The first key and the start of its group are given.
fn fill<V: Copy>(
    starts: &mut [u32],
    values: &mut [V],
    (first_key, first): (usize, usize),
    add: Add<'_, V>,
) {
    let mut next = 0;
    for start in starts.iter_mut() {
        next += std::mem::replace(start, next);
    }
    add(&mut |key, value| {
        let at = &mut starts[key as usize - first_key];
        values[*at as usize] = value;
        *at += 1;
    });
    // the start of each group has moved to its end
    let mut start = 0;
    for end in starts.iter_mut() {
        start = std::mem::replace(end, first as u32 + start);
    }
}
