//! Over-penalty and rounding: Poisson on meshes fine enough for it to show, and the limit of large factors, which is
//! the Crouzeix-Raviart scheme.

use crate::real::Precision;
use crate::stability::table::*;

/// The largest factor between errors of a mesh and of the coarser one.
const HALVING: ExpectedRange = ExpectedRange::at_most(0.3);

const ABOVE_BARRIER: Criterion = Criterion::new(
    "halving-above-barrier",
    &[HALVING],
    "Poisson, over-penalty 1/h^3 in values at vertices: each halving of h multiplies the error by 0.3 at most as long as h is at least 4 (epsilon eta)^(1/6), epsilon half the distance from one to the next number.",
);
const TO_FLOOR: Criterion = Criterion::new(
    "halving-to-floor",
    &[HALVING],
    "Poisson: errors fall like h^2, by 0.3 or better at each halving, down to h = epsilon^(1/4). Conforming elements do so; an over-penalty does not where it is added to the stiffness, and does where the two are kept apart, as they are here.",
);
const LIMIT: Criterion = Criterion::new(
    "limit-of-large-factors",
    &[ExpectedRange::at_most(1.0)],
    "With bounds on facet means or with none, the relative distance in L2 to the Crouzeix-Raviart solution, times eta^(1/2), is at most 1 for eta to 1e6: the limit is reached before rounding matters. For larger factors rounding is known to prevail.",
);
pub(crate) const CASE: Case =
    Case { name: "round-off", criteria: &[ABOVE_BARRIER, TO_FLOOR, LIMIT], sweeps };

/// The largest factor for which the limit is met; rounding dominates for larger factors.
const JUDGED: f64 = 1e6;

fn sweeps(study: &Plan<'_>) -> Result<Vec<Sweep>, Error> {
    let [strings, squares] = study.effort.pick([10, 5], [15, 7]);
    let mut sweeps = vec![
        halvings("sines-1d", strings, Precision::Double),
        halvings("sines-1d", strings.min(12), Precision::Single),
        halvings("sines-2d", squares, Precision::Single),
        halvings("sines-2d", squares, Precision::Double),
    ];
    let level = study.effort.pick(16, 32);
    let exponents = study.effort.pick(&[2, 6][..], &[0, 2, 4, 6, 8, 10]);
    for (scheme, scene) in [
        ("wopsip", "sines-2d"),
        ("wopsip:facet-means", "sines-2d"),
        ("wopsip:facet-means", "radial-2d"),
    ] {
        sweeps.push(Sweep {
            schemes: with_eta(scheme, exponents),
            beside: schemes("cr"),
            parameter: "eta",
            places: Place::levels(scene, &[level]),
            columns: vec![
                Column::new(&LIMIT, "relative L2 distance to cr, times eta^(1/2)", |at| {
                    Some(relative_distance(at)? * at.value()?.sqrt())
                })
                .asked(|at| Asked::limit_unless(at.value() > Some(JUDGED))),
            ],
            ..Sweep::default()
        });
    }
    Ok(sweeps)
}

/// Halves the mesh size from four subdivisions on.
fn halvings(scene: &str, finest: u32, precision: Precision) -> Sweep {
    let levels: Vec<usize> = (2..=finest).map(|k| 2_usize.pow(k)).collect();
    let places = Place::levels(scene, &levels).into_iter();
    let rounding = 0.5 * precision.epsilon();
    let barrier = 4.0 * rounding.powf(1.0 / 6.0);
    let floor = rounding.powf(0.25);
    let above_barrier = move |at: &At<'_>| {
        let scheme = at.scheme();
        let has_barrier =
            scheme.label_without_choices() == "wopsip" && scheme.options().eta.is_some();
        match has_barrier && at.place > 0 && 2.0 * at.size() >= barrier {
            true => Asked::Limit(0),
            false => Asked::NoRow,
        }
    };
    let to_floor = move |at: &At<'_>| match at.place {
        0 => Asked::NoRow,
        // quadratics reach the floor of rounding with their higher order long before
        _ if at.size() >= floor && at.scheme().name() != "p2" => Asked::Limit(0),
        _ => Asked::Report,
    };
    let quantity = "L2 error over that on twice h";
    let ratio = |at: &At<'_>| Some(at.of(L2.1)? / at.before()?.of(L2.1)?);
    Sweep {
        compares: true,
        schemes: schemes("wopsip@eta=1 wopsip:facet-means@eta=1"),
        parameter: "h",
        places: places.map(|place| place.at_size().precision(precision)).collect(),
        columns: vec![
            Column::new(&ABOVE_BARRIER, quantity, ratio).asked(above_barrier),
            Column::new(&TO_FLOOR, quantity, ratio).asked(to_floor),
        ],
        ..Sweep::default()
    }
}

/// The distance of a broken linear solution from that of Crouzeix-Raviart elements in L2 over the norm of the latter,
/// both by values at the vertices of cells: `int_K v^2 = |K| / ((D+1)(D+2)) (sum v_i^2 + (sum v_i)^2)`.
fn relative_distance(at: &At<'_>) -> Option<f64> {
    let (mesh, a, b) = (at.mesh()?, at.values()?, at.beside("cr").values()?);
    let square = |c: usize, value: &dyn Fn(usize) -> f64| {
        let (mut squares, mut sum) = (0.0, 0.0);
        for v in (3 * c..3 * c + 3).map(value) {
            squares += v * v;
            sum += v;
        }
        mesh.geometry(c).volume * (squares + sum * sum)
    };
    let (mut above, mut below) = (0.0, 0.0);
    for c in 0..mesh.n_cells() {
        above += square(c, &|k| a[k] - b[k]);
        below += square(c, &|k| b[k]);
    }
    Some((above / below).sqrt())
}
