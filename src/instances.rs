//! Generic functions compiled once, in this library.
//!
//! The compiler instantiates a generic function anew in every crate that calls it, so that each
//! example, test and program would compile the assembler and the solvers again. There are two scalars
//! and three dimensions only: [`compiled!`] lists the instances of a function in a static table of
//! function pointers, whose code is in the library's object file, and picks one by its type. The
//! generic function that callers see does no more than this look-up and a call.
//!
//! ```text
//! pub fn certify<T: Real>(inequality: &Inequality<T>, u: &[T]) -> Certificate {
//!     compiled!(T: fn(&Inequality<T>, &[T]) -> Certificate = certify_compiled)(inequality, u)
//! }
//! ```
//!
//! The function after the equals sign is written with the same name of scalar or dimension as the
//! signature. A method of a type with a lifetime parameter is written as a closure.
//!
//! `benches/instances.py` counts the functions that an example compiles all the same, and names the largest: a call
//! outside of the tables is seen there.

use std::any::{Any, TypeId};

/// The instance of a function for the scalar `T` or the dimension `D`.
macro_rules! compiled {
    ($T:ident: $signature:ty = $function:expr) => {{
        static INSTANCES: [&(dyn ::std::any::Any + Sync); 2] = [
        &$crate::instances::compiled!(@ type $T = f64; $signature = $function),
        &$crate::instances::compiled!(@ type $T = f32; $signature = $function),
        ];
        $crate::instances::find::<$signature>(&INSTANCES)
    }};
    (const $D:ident: $signature:ty = $function:expr) => {{
        static INSTANCES: [&(dyn ::std::any::Any + Sync); 3] = [
        &$crate::instances::compiled!(@ const $D: usize = 1; $signature = $function),
        &$crate::instances::compiled!(@ const $D: usize = 2; $signature = $function),
        &$crate::instances::compiled!(@ const $D: usize = 3; $signature = $function),
        ];
        $crate::instances::find::<$signature>(&INSTANCES)
    }};
    (@ type $T:ident = $scalar:ty; $signature:ty = $function:expr) => {{
        type $T = $scalar;
        $function as $signature
    }};
    (@ const $D:ident: usize = $d:literal; $signature:ty = $function:expr) => {{
        const $D: usize = $d;
        $function as $signature
    }};
}
pub(crate) use compiled;

/// The entry of a table of scalars or dimensions that has this type.
///
/// # Panics
/// If there is none: for a dimension other than one, two and three.
pub(crate) fn find<F: Copy + 'static>(table: &[&(dyn Any + Sync)]) -> F {
    match required_entry(table, TypeId::of::<F>()).downcast_ref() {
        Some(found) => *found,
        None => unreachable!(),
    }
}

/// The entry of a type, found by a function that does not depend on the type.
fn required_entry<'t>(table: &[&'t (dyn Any + Sync)], id: TypeId) -> &'t dyn Any {
    match table.iter().copied().find(|entry| (**entry).type_id() == id) {
        Some(entry) => entry,
        None => panic!("functions are compiled for f64 and f32 in one, two and three dimensions"),
    }
}
