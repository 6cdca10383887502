//! The tensor of a coefficient: rows of numbers and expressions.

use std::sync::Arc;

use nalgebra::DMatrix;

use crate::problem::{BoundaryFlux, Tensor};
use crate::problem_file::error::ProblemFileError;
use crate::problem_file::expression::VARIABLES;
use crate::problem_file::formula::Formula;
use crate::problem_file::table::{Source, Value};
use crate::real::{Matrix, Point};

/// The least eigenvalue of a symmetric matrix; not a number if an entry is none.
fn least_eigenvalue<const D: usize>(of: Matrix<D>) -> f64 {
    match of.iter().all(|entry| entry.is_finite()) {
        true => DMatrix::from_fn(D, D, |i, j| of[(i, j)]).symmetric_eigenvalues().min(),
        false => f64::NAN,
    }
}

/// Reads the tensor of a region, `[[2, 0], [0, 1]]`, with its least eigenvalue, which must be positive.
pub(super) fn read<'t, const D: usize>(
    source: &Source<'t>,
    group: &str,
    value: &Value<'t>,
) -> Result<(Tensor<D>, BoundaryFlux<D>), ProblemFileError> {
    let expected = "a symmetric list of rows, each with an entry for each coordinate";
    let wrong = || source.wrong_type(group, value, expected);
    let list = |value: &Value<'t>| {
        let list = value.get_ref().as_array().filter(|list| list.len() == D);
        list.cloned().ok_or_else(wrong)
    };
    let (mut formulas, mut texts) = (Vec::new(), Vec::new());
    for row in list(value)?.iter() {
        for entry in list(row)?.iter() {
            formulas.push(source.formula(group, entry, &VARIABLES[0][..D])?);
            texts.push(source.text[entry.span()].replace(' ', ""));
        }
    }
    let is_same = |a: usize, b: usize| match (&formulas[a], &formulas[b]) {
        (Formula::Number(a), Formula::Number(b)) => a == b,
        _ => texts[a] == texts[b],
    };
    if !(0..D).all(|i| (0..i).all(|j| is_same(i * D + j, j * D + i))) {
        return Err(wrong());
    }
    let is_constant = formulas.iter().all(|formula| matches!(formula, Formula::Number(_)));
    let data: Vec<_> = formulas.iter().map(Formula::datum::<D>).collect();
    let at = move |x: &Point<D>| Matrix::from_fn(|i, j| data[i * D + j].at(x));
    let tensor = match is_constant {
        true => Tensor::Constant(at(&Point::zeros())),
        false => Tensor::function(at),
    };
    let of = tensor.clone();
    Ok((tensor, BoundaryFlux::Function(Arc::new(move |x, _| least_eigenvalue(of.at(x))))))
}
