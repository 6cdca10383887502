//! Fresh memory in large pages.

/// Bytes of a large page; smaller pieces of memory are left as they are.
#[cfg(target_os = "linux")]
const PAGE: usize = 2 << 20;

/// Asks the system to hand out the memory of a vector that has just been reserved in large pages
/// when it is first touched. Where there are none, nothing happens.
///
/// Arrays of an assembly are written once, front to back, in memory that the program has never had.
/// Taking it in pages of 4 KB costs more than writing it: from nothing, two thirds of the time of
/// SIPG in the plane went into that.
#[cfg(target_os = "linux")]
#[allow(
    unsafe_code,
    reason = "advice to the system about our own memory; halves SIPG from nothing"
)]
pub(crate) fn in_large_pages<T>(mut vector: Vec<T>) -> Vec<T> {
    let start = vector.as_mut_ptr() as usize;
    let end = start + vector.capacity() * size_of::<T>();
    let (first, last) = (start.next_multiple_of(PAGE), end / PAGE * PAGE);
    if size_of::<T>() > 0 && first < last {
        // SAFETY: the range lies inside the vector's own allocation, and this advice changes neither
        // what memory holds nor whether it is mapped. A refusal costs nothing but time.
        unsafe {
            libc::madvise(first as *mut libc::c_void, last - first, libc::MADV_HUGEPAGE);
        }
    }
    vector
}

/// Elsewhere memory is taken as it comes.
#[cfg(not(target_os = "linux"))]
pub(crate) fn in_large_pages<T>(vector: Vec<T>) -> Vec<T> {
    vector
}
