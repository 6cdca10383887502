//! The guide: which scheme to take, what signs and norms mean, and how every figure was measured.
//!
//! The chapters are the pages of the folder `docs` of the repository.
//!
//! | chapter | contents |
//! |---|---|
//! | [`gallery`] | six programs with pictures |
//! | [`choosing`] | what each scheme costs and gives, and where it fails |
//! | [`own_problems`] | a mesh of one's own, materials, boundary names, errors without an exact solution |
//! | [`bound`] | bounds on the error without an exact solution: theorems, what is guaranteed, figures |
//! | [`adaptive`] | meshes that follow the error bound, for every scheme: steps, rates, times |
//! | [`conventions`] | signs, scalings, norms, the certificate |
//! | [`reproduce`] | published tables beside ours |
//! | [`solvers`] | which solver runs when, what to do on each status, rounding, time and memory |
//! | [`assembly`] | what assembly costs |
//! | [`distributed`] | a mesh in parts over the processes of MPI, with PETSc |
//! | [`pictures`] | solutions drawn |
//! | [`house`] | the rooms of the source and their order |
//!
//! # Generated tables
//!
//! The program writes two reports that are too long for a page. The folder `docs` has their summaries:
//!
//! | page | contents | command, after `cargo run --release --` |
//! |---|---|---|
//! | `docs/orders.md` | observed and promised orders: what is kept, missed, undecided, and why | `orders FILE --summary FILE` |
//! | `docs/stability.md` | hard cases: safe ranges of factors, verdicts, what is missed | `stability --markdown FILE` |

// A page of the repository links to other pages, to source files and to pictures by labels, which it
// defines at its end. The first definition of a label counts: `links.md` and `pictures.md` stand
// before each page and define the labels as items of this crate and as pictures inside the page.
// Only rustdoc reads them.

/// Six programs with pictures.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"), doc = include_str!("pictures.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/gallery.md"))]
pub mod gallery {}

/// Which scheme to take: costs, errors, orders and difficulties of each.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"), doc = include_str!("pictures.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/choosing.md"))]
pub mod choosing {}

/// A problem of one's own: from a file or a program, with names, measured against a fine solution.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/own_problems.md"))]
pub mod own_problems {}

/// Guaranteed bounds on the error, from the solution and the data alone.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/bound.md"))]
pub mod bound {}

/// Meshes that follow the error bound: steps, rates, times.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/adaptive.md"))]
pub mod adaptive {}

/// Signs, scalings, norms and the certificate, each with the test that asserts it.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/conventions.md"))]
pub mod conventions {}

/// Published tables beside ours, each with the command that prints ours.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/reproduce.md"))]
pub mod reproduce {}

/// Which solver runs when, and what to do on each status; rounding, time and memory.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/solvers.md"))]
pub mod solvers {}

/// Time per cell of assembly, beside the bandwidth of the memory.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/assembly.md"))]
pub mod assembly {}

/// A mesh in parts over the processes of MPI, with PETSc: commands, figures, limits.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/distributed.md"))]
pub mod distributed {}

/// Solutions, contact sets, jumps and multipliers drawn.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"), doc = include_str!("pictures.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/pictures.md"))]
pub mod pictures {}

/// The rooms of the source and their order.
#[cfg_attr(doc, doc = "", doc = include_str!("links.md"))]
#[cfg_attr(doc, doc = include_str!("../../docs/house.md"))]
pub mod house {}
