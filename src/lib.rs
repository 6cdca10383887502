// labels of links and pictures: see `guide`
#![cfg_attr(doc, doc = include_str!("guide/links.md"), doc = include_str!("guide/pictures.md"))]
#![doc = include_str!("../README.md")]
#![deny(unsafe_code)]
#![deny(missing_docs)]

pub mod algebra;
pub mod assemble;
pub mod element;
pub mod error;
pub mod facet;
pub mod guide;
pub mod inequality;
pub mod kit;
pub mod linear;
pub mod measure;
mod memory;
pub mod mesh;
pub mod nested;
pub mod output;
mod parallel;
pub mod paraview;
pub mod plot;
pub mod prelude;
pub mod problem;
pub mod quadrature;
pub mod real;
pub mod scenes;
pub mod scheme;
pub mod stability;
pub mod study;
pub mod work_precision;
