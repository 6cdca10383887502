//! The catalogue: named variational inequalities, most of them with an exact solution.
//!
//! A scene is a function of some thirty lines that returns a [`Scene`]: see [`ridge`] for one in every dimension,
//! [`pyramid_full_2d`] for one whose contact set and multiplier are known. Scenes with a common formula share a file.
//! The doc comment of the function derives the solution, and [`check_scene`] tests the derivation numerically.
//!
//! To add one: write the function, name it in this file, and register it by one line in [`catalogue`]; the tests of
//! the catalogue then check it. Studies also run scenes that are not registered.

mod ball;
mod biactive;
mod bilateral;
mod catalogue;
pub mod check;
mod cone;
mod contrast;
mod dual_number;
mod free_boundary;
mod friction;
mod halfplane;
mod hertz;
mod hertz_in_space;
mod lshape;
mod oscillating;
mod polynomial;
mod radial;
mod ridge;
mod scene;
mod signorini;
mod signorini_harmonic;
mod signorini_layers;
mod signorini_smooth;
mod signorini_string;
mod sines;
mod strings;
mod without_solution;

pub use ball::{ball_2d, ball_3d, disc_2d};
pub use biactive::{biactive_half_2d, biactive_ring_2d};
pub use bilateral::bilateral_1d;
pub use catalogue::{AcceptedParameters, AnyScene, Entry, Parameters, by_name, catalogue};
pub(crate) use check::check_exact_on;
pub use check::check_scene;
pub use cone::cone;
pub use contrast::{contrast, contrast_disc_2d};
pub use friction::{friction, friction_1d, friction_both_1d};
pub use hertz::hertz_2d;
pub use hertz_in_space::hertz_3d;
pub use lshape::lshape_2d;
pub use oscillating::oscillating_1d;
pub use polynomial::{degenerate, hill, polynomial};
pub use radial::{radial, radial_quarter_2d};
pub use ridge::{pyramid_full_2d, ridge};
pub use scene::Scene;
pub use signorini::{
    signorini_2d, signorini_irrational_2d, signorini_line_3d, signorini_shifted_2d,
    signorini_two_2d,
};
pub use signorini_harmonic::signorini_harmonic;
pub use signorini_layers::signorini_layers_2d;
pub use signorini_smooth::{
    signorini_biactive_2d, signorini_disc, signorini_halves_2d, signorini_smooth,
};
pub use signorini_string::{
    signorini_closed_1d, signorini_grazing_1d, signorini_open_1d, signorini_reaction_1d,
};
pub use sines::sines;
pub use strings::{icelike_1d, parabola_1d};
pub use without_solution::{pyramid_2d, signorini_sine_2d, spiral_2d, torsion_2d};
