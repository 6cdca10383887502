//! The numbers of the solution for which a file asks.

use crate::mesh::Mesh;
use crate::problem::{Problem, ValueOf};
use crate::problem_file::error::{ProblemFileError, ProblemFileErrorKind};
use crate::problem_file::table::{Source, Value};
use crate::real::Point;

type Done<V = ()> = Result<V, ProblemFileError>;

/// What a value may be.
const KINDS: [&str; 7] = ["at", "mean", "largest", "smallest", "integral", "reaction", "force"];

/// A value by name, and where the file has it.
pub(super) type Wanted<const D: usize> = (String, ValueOf<D>, usize);

/// Reads the table of values.
pub(super) fn values<'t, const D: usize>(
    source: &Source<'t>,
    value: &Value<'t>,
) -> Done<Vec<Wanted<D>>> {
    let mut wanted = Vec::new();
    for (key, value) in source.table("values", value)?.iter() {
        let name = key.get_ref().to_string();
        let table = source.table(&name, value)?;
        source.allow(table, &KINDS)?;
        let mut kinds = table.iter();
        let (Some((kind, of)), None) = (kinds.next(), kinds.next()) else {
            let expected = format!("a table with one key of {}", KINDS.join(", "));
            return Err(source.wrong_type(&name, value, &expected));
        };
        let kind = &**kind.get_ref();
        let group = || source.string(kind, of).map(str::to_owned);
        let value = match kind {
            "at" => ValueOf::At(point(source, of)?),
            "mean" => ValueOf::Mean(group()?),
            "largest" => ValueOf::Largest(group()?),
            "smallest" => ValueOf::Smallest(group()?),
            "integral" => ValueOf::Integral(group()?),
            "reaction" => ValueOf::Reaction(group()?),
            _ => ValueOf::Force(group()?),
        };
        wanted.push((name, value, of.span().start));
    }
    Ok(wanted)
}

/// A point by its coordinates.
fn point<'t, const D: usize>(source: &Source<'t>, value: &Value<'t>) -> Done<Point<D>> {
    let expected = ["a number", "two numbers", "three numbers"][D - 1];
    let wrong = || source.wrong_type("at", value, &format!("a list of {expected}"));
    let list = value.get_ref().as_array().filter(|list| list.len() == D).ok_or_else(wrong)?;
    let number = |x| source.number("at", x)?.filter(|x| x.is_finite()).ok_or_else(wrong);
    let coordinates = list.iter().map(number).collect::<Done<Vec<f64>>>()?;
    Ok(Point::from_fn(|k, _| coordinates[k]))
}

/// Refuses values that the mesh of the problem does not have.
pub(super) fn check<const D: usize>(
    source: &Source<'_>,
    (wanted, problem): (&[Wanted<D>], &Problem<D>),
    mesh: &Mesh<D>,
) -> Done {
    for (name, value, offset) in wanted {
        if let Some(fault) = value.fault(problem, mesh) {
            let kind = ProblemFileErrorKind::Group;
            return Err(source.error(*offset, kind, format!("values.{name}: {fault}")));
        }
    }
    Ok(())
}
