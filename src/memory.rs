//! Large pages of virtual memory for newly allocated vectors.

/// Bytes of a large page; smaller allocations keep ordinary pages.
#[cfg(target_os = "linux")]
const LARGE_PAGE: usize = 2 << 20;

/// Advises the operating system to back the allocation of a vector with large pages, which it does
/// when the memory is first written. The advice has no effect where large pages are not available.
///
/// The arrays of an assembly are written once from front to back. Page faults for pages of 4 KB take
/// two thirds of the time of a first assembly of SIPG in the plane.
#[cfg(target_os = "linux")]
#[allow(
    unsafe_code,
    reason = "advice to the system about our own memory; halves the time of a first SIPG assembly"
)]
pub(crate) fn in_large_pages<T>(mut vector: Vec<T>) -> Vec<T> {
    let start = vector.as_mut_ptr() as usize;
    let end = start + vector.capacity() * size_of::<T>();
    let (first, last) = (start.next_multiple_of(LARGE_PAGE), end / LARGE_PAGE * LARGE_PAGE);
    if size_of::<T>() > 0 && first < last {
        // SAFETY: the range lies inside the vector's own allocation, and the advice changes neither
        // the contents of memory nor its mapping. A refusal is harmless.
        unsafe {
            libc::madvise(first as *mut libc::c_void, last - first, libc::MADV_HUGEPAGE);
        }
    }
    vector
}

/// The vector itself: there is no advice for other systems than Linux.
#[cfg(not(target_os = "linux"))]
pub(crate) fn in_large_pages<T>(vector: Vec<T>) -> Vec<T> {
    vector
}
