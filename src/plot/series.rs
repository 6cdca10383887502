//! Curves of points, taken from rows.

use crate::study::Series;
use crate::study::row::{Row, distinct};

/// A number of a row that an axis shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// Largest cell diameter.
    MeshSize,
    /// Seconds altogether.
    Seconds,
    /// Seconds altogether, with those of the bound.
    SecondsWithBound,
    /// Number of unknowns.
    Unknowns,
    /// L2 error.
    L2,
    /// Error in the broken H1 seminorm.
    H1,
    /// Error in the broken energy norm, the same for all schemes.
    Energy,
    /// Bound on the error in the broken energy norm.
    Bound,
}

impl Quantity {
    /// The label of the axis.
    pub fn label(self) -> &'static str {
        match self {
            Quantity::MeshSize => "mesh size h",
            Quantity::Seconds => "time in s",
            Quantity::SecondsWithBound => "time in s, bound included",
            Quantity::Unknowns => "number of unknowns",
            Quantity::L2 => "L2 error",
            Quantity::H1 => "broken H1 error",
            Quantity::Energy => "error in the broken energy norm",
            Quantity::Bound => "error bound",
        }
    }

    /// The value of a row, if a logarithmic axis can show it.
    fn of(self, row: &Row) -> Option<f64> {
        let begun = row.unknowns.is_some();
        let value = match self {
            Quantity::MeshSize => Some(row.mesh_size),
            // no clock is finer: a smaller number is a time that was not measured
            Quantity::Seconds => begun.then(|| row.seconds.total.max(1e-6)),
            Quantity::SecondsWithBound => begun.then(|| row.seconds_with_bound().max(1e-6)),
            Quantity::Unknowns => row.unknowns.map(|n| n as f64),
            Quantity::L2 => row.error.l2,
            Quantity::H1 => row.error.h1,
            Quantity::Energy => row.error.broken_energy,
            Quantity::Bound => row.bound.discrete,
        };
        value.filter(|x| x.is_finite() && *x > 0.0)
    }

    /// The bound on this error: that on the error in the broken energy norm, which may be the H1 seminorm.
    fn bound(self, row: &Row) -> Option<f64> {
        let is_bounded = match self {
            Quantity::Energy => true,
            Quantity::H1 => row.error.is_energy_h1(),
            _ => false,
        };
        row.bound.discrete.filter(|x| is_bounded && *x > 0.0)
    }

    /// The order that theory promises for this quantity. The broken energy norm and the broken H1
    /// seminorm of a problem are equivalent.
    fn expected(self, row: &Row) -> Option<f64> {
        match self {
            Quantity::L2 => row.expected_order.l2,
            Quantity::H1 | Quantity::Energy => row.expected_order.h1,
            _ => None,
        }
    }

    /// The orders that theory promises, ascending; one and two if it promises none.
    pub fn orders<'a>(self, rows: impl Iterator<Item = &'a Row>) -> Orders {
        let mut promised = distinct(rows.filter_map(|r| self.expected(r)).filter(|p| *p > 0.0));
        promised.sort_by(f64::total_cmp);
        let are_promised = !promised.is_empty();
        let orders = if are_promised { promised } else { vec![1.0, 2.0] };
        Orders { orders, are_promised, falls_over: None }
    }
}

/// Orders to compare with, drawn as slopes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Orders {
    pub orders: Vec<f64>,
    /// Whether theory promises them.
    pub are_promised: bool,
    /// Whether the slopes fall, each over this dimension.
    pub falls_over: Option<u32>,
}

/// One run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub x: f64,
    /// None: the run failed.
    pub y: Option<f64>,
    /// The bound on the error, the upper end of the band.
    pub bound: Option<f64>,
}

impl Point {
    /// The point of a row; none for a converged run without an error.
    fn of(row: &Row, x: Quantity, y: Quantity) -> Option<Self> {
        let x = x.of(row)?;
        match row.converged() {
            true => Some(Point { x, y: Some(y.of(row)?), bound: y.bound(row) }),
            false => Some(Point { x, y: None, bound: None }),
        }
    }
}

/// The runs of one scheme.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    /// The place of its name in the legend, which gives colour and mark.
    pub key: usize,
    /// From coarse to fine.
    pub points: Vec<Point>,
}

/// One panel: two numbers against each other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Panel {
    pub title: String,
    /// Labels of the axes.
    pub x: String,
    pub y: String,
    pub curves: Vec<Curve>,
    /// Orders to compare with.
    pub orders: Orders,
    /// A limit of the second number.
    pub limit: Option<f64>,
}

impl Panel {
    /// The panel of a scene: a curve for each of its series.
    pub fn new(
        (scene, series): (&str, &[&Series<'_>]),
        names: &[String],
        x: Quantity,
        y: Quantity,
    ) -> Self {
        let curves = series.iter().filter_map(|of| {
            let key = names.iter().position(|name| *name == of.name)?;
            Some(Curve { key, points: of.rows.iter().filter_map(|r| Point::of(r, x, y)).collect() })
        });
        let of_scene = || series.iter().flat_map(|of| of.rows.iter().copied());
        let orders = match x {
            Quantity::MeshSize => y.orders(of_scene()),
            // the best rate of linears, on any meshes
            Quantity::Unknowns => Orders {
                orders: vec![1.0],
                are_promised: false,
                falls_over: of_scene().map(|row| row.dimension as u32).next(),
            },
            _ => Orders::default(),
        };
        Self::of(&title(scene, of_scene()), (x.label(), y.label()), curves, orders)
    }

    /// A panel of curves, of which those without points are left out.
    pub fn of(
        title: &str,
        (x, y): (&str, &str),
        curves: impl Iterator<Item = Curve>,
        orders: Orders,
    ) -> Self {
        let curves = curves.filter(|c| !c.points.is_empty()).collect();
        let (title, x, y) = (title.to_owned(), x.to_owned(), y.to_owned());
        Panel { title, x, y, curves, orders, limit: None }
    }

    /// Whether some run has an error.
    pub fn has_errors(&self) -> bool {
        self.points().any(|p| p.y.is_some())
    }

    /// Whether there is more to see than single points.
    pub fn has_curves(&self) -> bool {
        self.has_errors() && self.curves.iter().any(|c| c.points.len() > 1)
    }

    /// Whether a curve has a band up to the bound on its errors.
    pub fn has_bands(&self) -> bool {
        let of_curve = |c: &Curve| c.points.iter().filter(|p| p.bound.is_some()).count() > 1;
        self.has_curves() && self.curves.iter().any(of_curve)
    }

    /// All runs.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        self.curves.iter().flat_map(|c| c.points.iter().copied())
    }

    /// The numbers that the second axis shows.
    pub fn errors(&self) -> Vec<f64> {
        self.points().flat_map(|p| [p.y, p.bound]).flatten().chain(self.limit).collect()
    }
}

/// The scene, and what its errors are measured against unless that is the exact solution.
fn title<'r>(scene: &str, rows: impl IntoIterator<Item = &'r Row>) -> String {
    let reference = rows.into_iter().find_map(Row::reference);
    reference.map_or_else(|| scene.to_owned(), |r| format!("{scene}, against {r}"))
}

/// The panels with curves; of several without any the first, which says why there is none.
pub(crate) fn with_curves(panels: Vec<Panel>) -> Vec<Panel> {
    let any = panels.iter().any(Panel::has_curves);
    let shown = panels.into_iter().filter(|p| !any || p.has_curves());
    shown.take(if any { usize::MAX } else { 1 }).collect()
}
