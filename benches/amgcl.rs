//! Linear systems of conforming P1 by this library and by AMGCL, in turns on one thread, where the finest
//! matrix alone is known.
//!
//! AMGCL consists of headers (repository `ddemidov/amgcl` on GitHub); the program is built once:
//!
//! ```sh
//! git clone https://github.com/ddemidov/amgcl target/amgcl
//! g++ -std=c++17 -O3 -march=native -DNDEBUG -DAMGCL_NO_BOOST -I target/amgcl \
//!     benches/amgcl/solve.cpp -o target/amgcl_solve
//! cargo bench --bench amgcl -- --peer target/amgcl_solve --rounds 3 --mesh target/gmsh/cube.msh
//! ```
//!
//! The problem is `-Δu = 1` with zero Dirichlet data on the unit square at 1024, the unit cube at 64, and on each Gmsh
//! mesh of dimension three that `--mesh` names. Both sides get the same matrix; seconds are the least of all rounds for
//! set-up and solve. AMGCL ends at a residual of 1e-8 of the right side, this library at an energy norm of the error of
//! 1e-8 of that of the solution; residuals of both are printed.

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Instant;

use unilateral::algebra::Inequality;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::inequality::{ActiveSet, InequalitySolver, InitialGuess, Solution};
use unilateral::linear::LinearMethod;
use unilateral::mesh::gmsh;
use unilateral::prelude::*;

const TOLERANCE: f64 = 1e-8;

/// The unknowns that have no Dirichlet data.
fn free_unknowns(inequality: &Inequality<f64>) -> Vec<usize> {
    let bounds = inequality.bounds.iter().enumerate();
    bounds.filter(|(_, bound)| bound.fixed_value().is_none()).map(|(i, _)| i).collect()
}

/// Writes the matrix and the load of the free unknowns, for zero Dirichlet data; the format is that of
/// `benches/amgcl/solve.cpp`.
fn write_system(path: &Path, inequality: &Inequality<f64>) -> std::io::Result<()> {
    let free = free_unknowns(inequality);
    let mut number = vec![None; inequality.size()];
    free.iter().enumerate().for_each(|(k, &i)| number[i] = Some(k as u64));
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for &i in &free {
        let (row, entries) = inequality.matrix.row(i);
        for (&j, &value) in row.iter().zip(entries) {
            if let Some(k) = number[j as usize] {
                columns.push(k);
                values.push(value);
            }
        }
        starts.push(columns.len() as u64);
    }
    let mut file = BufWriter::new(File::create(path)?);
    let sizes = [free.len() as u64, columns.len() as u64];
    for n in sizes.iter().chain(&starts).chain(&columns) {
        file.write_all(&n.to_ne_bytes())?;
    }
    let load = inequality.assembled_load();
    for x in values.iter().chain(free.iter().map(|&i| &load[i])) {
        file.write_all(&x.to_ne_bytes())?;
    }
    file.flush()
}

/// The Euclidean norm of the residual of the free unknowns over that of the load.
fn relative_residual(inequality: &Inequality<f64>, solution: &Solution<f64>) -> f64 {
    let mut residual = vec![0.0; inequality.size()];
    inequality.residual_f64(&solution.values, &mut residual);
    let free = free_unknowns(inequality);
    let norm = |v: &[f64]| free.iter().map(|&i| v[i] * v[i]).sum::<f64>().sqrt();
    norm(&residual) / norm(&inequality.assembled_load())
}

/// A system on a mesh, and what its rounds have taken.
struct Case {
    name: String,
    inequality: Inequality<f64>,
    assembly: f64,
    solve: f64,
    solution: Option<Solution<f64>>,
    /// Name, seconds, iterations and residual of each choice of AMGCL.
    peers: Vec<(String, f64, String, String)>,
}

impl Case {
    fn new<const D: usize>(name: String, mesh: &Mesh<D>) -> Result<Self, Box<dyn Error>> {
        let problem = Problem::new().source(|_| 1.0);
        let (mut assembly, mut inequality) = (f64::INFINITY, None);
        for _ in 0..3 {
            let start = Instant::now();
            let quadrature = DataQuadrature::default();
            let space = Discretisation::new(&ConformingP1, &problem, mesh, quadrature)?;
            inequality = Some(space.inequality()?);
            assembly = start.elapsed().as_secs_f64().min(assembly);
        }
        let inequality = inequality.ok_or("nothing was assembled")?;
        let (solve, solution, peers) = (f64::INFINITY, None, Vec::new());
        Ok(Self { name, inequality, assembly, solve, solution, peers })
    }

    fn run_ours(&mut self) {
        let solver = ActiveSet::default().linear(LinearMethod::Iterative);
        let guess = InitialGuess::default().energy_tolerance(TOLERANCE);
        let start = Instant::now();
        let solution = solver.solve_from(&self.inequality, &guess);
        self.solve = start.elapsed().as_secs_f64().min(self.solve);
        self.solution = Some(solution);
    }

    /// One round of the program in C++.
    fn run_peer(&mut self, program: &str, file: &Path) -> Result<(), Box<dyn Error>> {
        let output = Command::new(program).arg(file).arg("1").output()?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into());
        }
        for line in String::from_utf8(output.stdout)?.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let [name, seconds, _, iterations, residual] = words[..] else {
                return Err(format!("{program} wrote: {line}").into());
            };
            let seconds = seconds.parse::<f64>()?;
            match self.peers.iter_mut().find(|peer| peer.0 == name) {
                Some(peer) => peer.1 = peer.1.min(seconds),
                None => self.peers.push((
                    name.to_owned(),
                    seconds,
                    iterations.to_owned(),
                    residual.to_owned(),
                )),
            }
        }
        Ok(())
    }

    fn print(&self) {
        let Some(solution) = &self.solution else { return };
        let residual = relative_residual(&self.inequality, solution);
        let largest = solution.values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        println!(
            "{}: {} unknowns, assembly {:.3} s, largest value {largest:.8}",
            self.name,
            self.inequality.size(),
            self.assembly,
        );
        println!(
            "  {:<26}{:>8.3} s{:>5} iterations, residual {residual:.1e}, {}",
            "this library", self.solve, solution.linear, solution.outcome
        );
        for (name, seconds, iterations, residual) in &self.peers {
            println!(
                "  {name:<26}{seconds:>8.3} s{iterations:>5} iterations, residual {residual}; {:.2} times ours, {:.2} with \
                 our assembly on both sides",
                seconds / self.solve,
                (seconds + self.assembly) / (self.solve + self.assembly),
            );
        }
    }
}

fn all() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if !words.iter().any(|w| w == "--bench") {
        println!("nothing is measured without `--bench`, which `cargo bench` adds");
        return Ok(());
    }
    let values = |name: &'static str| {
        words.windows(2).filter(move |pair| pair[0] == name).map(|pair| pair[1].as_str())
    };
    let rounds: usize = values("--rounds").next().unwrap_or("3").parse()?;
    let square = BoxDomain::dirichlet(Point::from([0.0; 2]), Point::from([1.0; 2]));
    let cube = BoxDomain::dirichlet(Point::from([0.0; 3]), Point::from([1.0; 3]));
    let mut cases = vec![
        Case::new("square 1024".into(), &Mesh::<2>::kuhn_box(&square, [1024; 2])?)?,
        Case::new("cube 64".into(), &Mesh::<3>::kuhn_box(&cube, [64; 3])?)?,
    ];
    for path in values("--mesh") {
        cases.push(Case::new(path.to_owned(), &gmsh::read::<3>(Path::new(path))?.mesh)?);
    }
    let file = std::env::temp_dir().join(format!("unilateral-{}.bin", std::process::id()));
    for case in &mut cases {
        write_system(&file, &case.inequality)?;
        for _ in 0..rounds {
            for program in values("--peer") {
                case.run_peer(program, &file)?;
            }
            case.run_ours();
        }
        case.print();
    }
    Ok(std::fs::remove_file(&file)?)
}

fn main() -> ExitCode {
    let run = || all().map_err(|error| error.to_string());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    match pool.map_err(|error| error.to_string()).and_then(|pool| pool.install(run)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
