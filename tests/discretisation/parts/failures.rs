//! What one part cannot do is an error of all parts, and no part waits for another one for ever.

use super::compare::Assembled;
use super::gathered::process;
use super::meshes::{box_mesh, moved};
use unilateral::inequality::Outcome;
use unilateral::mesh::Layers;
use unilateral::prelude::*;
use unilateral::processes::{
    Exchange, ExchangeError, InProcess, Numbering, agree, check_bounds, in_process,
};

/// The message that all parts have.
#[track_caller]
fn message_of_all<T>(results: Vec<Result<T, ExchangeError>>) -> String {
    let messages: Vec<String> =
        results.into_iter().map(|result| result.err().unwrap().to_string()).collect();
    assert!(messages.iter().all(|message| *message == messages[0]), "{messages:?}");
    messages[0].clone()
}

#[test]
fn an_error_of_one_part_is_one_of_all() {
    let results = in_process(4, |part, exchange| {
        let own = if part % 2 == 1 { Err(format!("ψ of {part}")) } else { Ok(part) };
        agree(own, exchange)
    });
    assert!(matches!(results[3], Err(ExchangeError::Failed { part: 1, .. })));
    assert_eq!(message_of_all(results), "part 1: ψ of 1");
    // after it the parts are at one place
    let results = in_process(3, |part, exchange| {
        let empty = agree(if part == 0 { Err("") } else { Ok(()) }, exchange);
        assert_eq!(
            empty,
            Err(ExchangeError::Failed { part: 0, message: String::new(), outcome: None })
        );
        agree(Ok::<_, String>(part), exchange)
    });
    assert_eq!(results, [Ok(0), Ok(1), Ok(2)]);
}

/// Messages of any length arrive, and words that no part sends do no harm.
#[test]
fn messages_of_any_length_arrive() {
    let failed = |part, message: &str, outcome| {
        Err::<(), _>(ExchangeError::Failed { part, message: message.to_owned(), outcome })
    };
    let long = "λ₁ ≥ 0 in cell 18446744073709551615".repeat(9);
    for text in ["", "a", "of eight", "of nine b", &long] {
        let results = in_process(2, |part, exchange| {
            agree(if part == 1 { Err(text) } else { Ok(()) }, exchange)
        });
        assert!(results.iter().all(|result| *result == failed(1, text, None)), "{results:?}");
    }
    /// An exchange with one part, which sends these words.
    #[derive(Debug)]
    struct Sends(Vec<u64>);
    impl Exchange for Sends {
        fn parts(&self) -> usize {
            1
        }
        fn exchange(&self, _: Vec<Vec<u64>>) -> Result<Vec<Vec<u64>>, ExchangeError> {
            Ok(vec![self.0.clone()])
        }
    }
    let received = |words: &[u64]| agree(Ok::<(), String>(()), &Sends(words.to_vec()));
    assert_eq!(received(&[]), Ok(()));
    assert_eq!(received(&[1]), failed(0, "", None));
    assert_eq!(received(&[9, u64::MAX, 0x61]), failed(0, "a\0\0\0\0\0\0\0", None));
    // the number of an outcome, the length of the message and its bytes
    let outcomes = [None, Some(Outcome::NotCoercive), Some(Outcome::NotFinite)]
        .into_iter()
        .chain([Some(Outcome::Infeasible), Some(Outcome::OutOfRange), None]);
    for (number, outcome) in (0..).zip(outcomes) {
        assert_eq!(received(&[number, 1, 0x61]), failed(0, "a", outcome));
    }
}

/// Where numbers of cells end a level is refused, on parts where those of a part end.
#[test]
fn levels_are_refused_where_numbers_of_cells_end() {
    let message = |level: usize, parts: usize| {
        let results = in_process(parts, |number, exchange| {
            let study = Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).levels([level]);
            study.check_on_parts(&process(number, exchange)).unwrap_err().to_string()
        });
        assert!(results.iter().all(|message| *message == results[0]), "{results:?}");
        results[0].clone()
    };
    for (level, parts, expected) in [
        (30_000, 1, "would make 1.8e9 cells, at most 1.1e9 are possible"),
        (60_000, 4, "1.8e9 cells in each process, at most 1.1e9"),
    ] {
        let found = message(level, parts);
        assert!(found.contains(expected), "{level}, {parts}: {found}");
    }
}

#[test]
fn values_by_name_are_refused_over_parts() {
    let results = in_process(2, |number, exchange| {
        let mut scene = scenes::radial::<2>(1.0);
        scene.problem = scene.problem.value("mean", ValueOf::Mean("default".to_owned()));
        let study = Study::new(scene).scheme(ConformingP1).levels([4]);
        study.check_on_parts(&process(number, exchange)).unwrap_err().to_string()
    });
    assert!(results.iter().all(|message| message.contains("values by name")), "{results:?}");
}

/// A thread that ends, by an error or by a panic, ends the exchanges of the others.
#[test]
fn a_part_that_ends_leaves_no_other_waiting() {
    let results = in_process(3, |part, exchange| match part {
        1 => Ok(Vec::new()),
        _ => exchange.exchange(vec![vec![7]; 3]),
    });
    for part in [0, 2] {
        assert!(matches!(results[part], Err(ExchangeError::Ended(_))), "{:?}", results[part]);
    }
    let all = std::panic::catch_unwind(|| {
        in_process(3, |part, exchange| {
            assert!(part != 2, "what a bug does");
            let result = agree(Ok::<_, String>(()), exchange);
            assert!(matches!(result, Err(ExchangeError::Ended(_))), "{result:?}");
        })
    });
    assert_eq!(all.unwrap_err().downcast_ref::<&str>(), Some(&"what a bug does"));
}

/// The error of a part that sent so many numbers in place of so many.
fn wrong_length((part, found, expected): (u32, usize, usize)) -> ExchangeError {
    ExchangeError::Length(format!(
        "part {part} sent {found} numbers in place of {expected}: all parts call the same functions in the same order"
    ))
}

#[test]
fn lists_that_do_not_fit_are_errors() {
    let results = in_process(2, |part, exchange| match part {
        0 => exchange.exchange(vec![Vec::new()]).map(|_| ()),
        _ => exchange.sum(&[1.0]).map(|_| ()),
    });
    let lists = "1 lists are sent to 2 parts: there must be one for each";
    assert_eq!(results[0], Err(ExchangeError::Lists(lists.to_owned())));
    let ended = "part 0 has ended without this exchange: look for its error";
    assert_eq!(results[1], Err(ExchangeError::Ended(ended.to_owned())));
    let results = in_process(2, |part, exchange| exchange.largest(&vec![1.0; 1 + part as usize]));
    assert_eq!(results, [(1, 2, 1), (0, 1, 2)].map(|of| Err(wrong_length(of))));
}

/// Sums have the same bits in all parts, those of the order of the parts; what is not a number stays.
#[test]
fn sums_and_maxima_over_parts() {
    let values: Vec<[f64; 2]> = vec![[0.1, -3.0], [0.2, -7.0], [0.3, -0.5], [1e16, -1.0]];
    let found = in_process(4, |part, exchange| {
        let own = &values[part as usize];
        (exchange.sum(own).unwrap(), exchange.largest(own).unwrap())
    });
    for (sum, largest) in found {
        assert_eq!(sum, [((0.1 + 0.2) + 0.3) + 1e16, -11.5]);
        assert_eq!(largest, [1e16, -0.5]);
    }
    for at in 0..3 {
        let largest = in_process(3, |part, exchange| {
            exchange.largest(&[if part == at { f64::NAN } else { f64::from(part) }]).unwrap()
        });
        assert!(largest.iter().all(|x| x[0].is_nan()));
    }
}

/// An exchange may have sums and maxima of its own.
#[test]
fn an_exchange_may_have_sums_of_its_own() {
    #[derive(Debug)]
    struct Counting<'e>(&'e InProcess);
    impl Exchange for Counting<'_> {
        fn parts(&self) -> usize {
            self.0.parts()
        }
        fn exchange(&self, _: Vec<Vec<u64>>) -> Result<Vec<Vec<u64>>, ExchangeError> {
            Err(ExchangeError::Transport("no network".to_owned()))
        }
        fn sum(&self, values: &[f64]) -> Result<Vec<f64>, ExchangeError> {
            Ok(vec![42.0; values.len()])
        }
    }
    in_process(1, |_, exchange| {
        let exchange: &dyn Exchange = &Counting(exchange);
        assert_eq!(exchange.sum(&[1.0]), Ok(vec![42.0]));
        let error = exchange.largest(&[1.0]).unwrap_err();
        assert_eq!(error.to_string(), "the exchange between parts failed: no network");
    });
}

/// Parts with other owners, and parts without enough layers, are refused in all parts, with part and cell.
#[test]
fn parts_that_do_not_belong_together_have_no_numbers() {
    let mesh = box_mesh::<2>(4);
    let problem = Problem::new();
    let number = |part: u32, owners: &[u32], layers, exchange: &InProcess| {
        let part = mesh.part(owners, part, layers).unwrap();
        let on_part = Assembled::new(&Sipg::default(), &problem, &part.mesh).discretisation;
        Numbering::new(&part, &on_part, exchange).map(|numbering| numbering.own().len())
    };
    let owners = mesh.partition(3).unwrap();
    let layers = Layers::across_facets(1);
    let found = in_process(3, |part, exchange| number(part, &owners, layers, exchange).unwrap());
    assert_eq!(found.iter().sum::<usize>(), 32 * 3);
    // part 1 has the cells of part 2
    let others: Vec<u32> = owners.iter().map(|&owner| [0, 2, 1][owner as usize]).collect();
    let message = message_of_all(in_process(3, |part, exchange| {
        number(part, if part == 1 { &others } else { &owners }, layers, exchange)
    }));
    assert!(message.starts_with("part 0: part 1 has no cell "), "{message}");
    let cell = message.split("no cell ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert_eq!(owners[cell.parse::<usize>().unwrap()], 1, "{message}");
}

/// Of six parts around a vertex the fourth sees none that knows who numbers the vertex.
#[test]
fn parts_with_too_few_layers_have_no_numbers() {
    let mesh = Mesh::<2>::disc(1.0, 1).unwrap();
    let (owners, problem) = ([0, 1, 2, 3, 4, 5], Problem::new());
    let number = |layers| {
        in_process(6, |part, exchange| {
            let part = mesh.part(&owners, part, layers).unwrap();
            let on_part = Assembled::new(&ConformingP1, &problem, &part.mesh).discretisation;
            Numbering::new(&part, &on_part, exchange).map(|numbering| numbering.own().len())
        })
    };
    let own: usize = number(Layers::across_vertices(1)).into_iter().map(Result::unwrap).sum();
    assert_eq!(own, 7);
    let message = message_of_all(number(Layers::across_facets(1)));
    assert!(message.contains("has no number for an unknown of its cell"), "{message}");
}

/// Bounds that contradict each other in one part, by more than rounding of the largest datum of all parts, are an
/// error of all parts, which names the cell by its number in the whole mesh.
#[test]
fn contradicting_bounds_of_one_part_are_an_error_of_all() {
    let mesh = moved::<2>(6);
    let owners = mesh.partition(4).unwrap();
    let check = |problem: &Problem<2>, scheme: &dyn Scheme<2>| {
        in_process(4, |number, exchange| {
            let part = mesh.part(&owners, number, scheme.layers(&mesh)).unwrap();
            let on_part = Assembled::new(scheme, problem, &part.mesh).discretisation;
            check_bounds(&part, &on_part, exchange)
        })
    };
    // in cells of the last part to be found
    let barycentre = |cell: usize| mesh.barycentre(cell);
    let last = (0..mesh.n_cells()).rfind(|&cell| owners[cell] == 3).unwrap();
    let at = barycentre(last);
    let schemes = NamedScheme::list(["p1", "cr", "sipg", "wopsip", "p2"]).unwrap();
    for scheme in schemes {
        let scheme = scheme.make::<2>();
        let problem = |height: f64| {
            Problem::new().obstacle_above(|_| 1.0).obstacle_below(move |x: &Point<2>| {
                if (x - at).norm() < 0.25 { 1.0 + height } else { -1e3 }
            })
        };
        let serial = scheme.inequality(&problem(0.5), &mesh, Default::default()).unwrap_err();
        let Error::EmptyConstraint { cell, .. } = serial else { panic!("{serial}") };
        let message = message_of_all(check(&problem(0.5), &*scheme));
        let part = owners[cell as usize];
        // the lowest part that fails need not be that of the first cell
        if message.starts_with(&format!("part {part}:")) {
            assert_eq!(message, format!("part {part}: {serial}"));
        }
        let named: usize = message
            .split("in cell ")
            .nth(1)
            .and_then(|rest| rest.split(' ').next())
            .and_then(|cell| cell.parse().ok())
            .unwrap();
        assert!(message.starts_with(&format!("part {}:", owners[named])), "{message}");
        assert!((barycentre(named) - at).norm() < 0.8, "{message}");
        // rounding of the data of other parts
        assert!(scheme.inequality(&problem(5e-7), &mesh, Default::default()).is_ok());
        assert!(check(&problem(5e-7), &*scheme).iter().all(Result::is_ok));
        assert!(check(&problem(2e-6), &*scheme).iter().all(Result::is_err));
    }
}

/// A datum that is not finite in one cell: the error of all parts has the cell of the whole mesh.
#[test]
fn data_that_are_not_finite_in_one_part_are_an_error_of_all() {
    let mesh = moved::<2>(6);
    let owners = mesh.partition(3).unwrap();
    let bad = (0..mesh.n_cells()).rfind(|&cell| owners[cell] == 2).unwrap();
    let (geometry, corners) = (mesh.geometry(bad), mesh.cell(bad).to_vec());
    let vertices = mesh.vertices().to_vec();
    let problem = Problem::new().source(move |x: &Point<2>| {
        let inside =
            |k: usize| geometry.gradient(k).dot(&(x - vertices[corners[k] as usize])) > -1.0;
        if (0..3).all(inside) { f64::NAN } else { 1.0 }
    });
    let (scheme, quadrature): (&dyn Scheme<2>, _) = (&ConformingP1, Default::default());
    let serial = scheme.inequality(&problem, &mesh, quadrature).unwrap_err();
    assert!(serial.to_string().contains(&format!("in cell {bad}:")), "{serial}");
    let part = |number| mesh.part(&owners, number, Layers::across_vertices(1)).unwrap();
    let results = in_process(3, |number, exchange| {
        let part = part(number);
        let result = scheme.inequality(&problem, &part.mesh, quadrature);
        agree(result.map_err(|error| error.in_whole_mesh(&part.cells)), exchange)
    });
    let first = (0..3).find(|&number| part(number).cells.contains(&(bad as u64))).unwrap();
    assert_eq!(message_of_all(results), format!("part {first}: {serial}"));
}
