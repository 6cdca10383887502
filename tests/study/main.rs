//! Studies and what they write: scenes, reports, tables, pictures, files of fields.

mod active_bounds;
mod adaptive;
mod axes;
mod boundary_data;
mod colours;
mod errors;
mod expressions;
mod extrapolation;
mod forces;
mod hierarchies;
mod journal;
mod links;
mod memory;
mod named_schemes;
mod noise;
mod one_problem;
mod orders_page;
mod pictures;
mod problem_file_constants;
mod problem_file_data;
mod problem_file_mistakes;
mod problem_files;
mod program;
mod references;
mod report;
mod rows;
mod scenes;
mod series;
mod stability;
mod svg;
mod table_formats;
mod tables;
mod totals;
mod values;
mod vectors;
mod verdicts;
mod vtu;
mod vtu_grid;
mod vtu_readers;
mod vtu_vectors;
mod work_precision;

#[path = "../support"]
mod support {
    pub mod keys;
    pub mod scratch;
}
