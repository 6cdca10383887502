//! The pages of the folder `docs` of the repository, each as a module.
//!
//! [`choosing`] says which scheme to take, [`own_problems`] how to pose your own problem, [`conventions`] what signs,
//! norms and keys of a report mean, [`bound`] what is guaranteed.
//!
//! # Generated results
//!
//! The folder `docs/results` has tables that the program wrote: orders, hard cases, comparisons, times. Each has its
//! command, date, machine and commit in its head. They are not part of this documentation.

// A page links to other pages by labels, which it defines at its end as files. The first definition of a label counts:
// `labels.md` stands before each page and defines the labels as modules.
macro_rules! pages {
    ($($page:ident)*) => {$(
        #[doc = include_str!("labels.md")]
        #[doc = include_str!(concat!("../../docs/", stringify!($page), ".md"))]
        pub mod $page {}
    )*};
}

pages! { adaptive bound choosing conventions distributed house own_problems reproduce solvers }
