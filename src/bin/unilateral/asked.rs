//! The options that the commands which compare schemes share.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use clap::Args;
use unilateral::input::excerpt;
use unilateral::mesh::gmsh::GmshFile;
use unilateral::nested::Adaptivity;
use unilateral::scenes::{self, AcceptedParameters, AnyScene, Parameters};
use unilateral::scheme::NamedScheme;
use unilateral::study::Program;

use crate::adaptive::{adaptivity, words};
use crate::constants::Constants;
use crate::mesh_file::MeshFile;
use crate::shared::{MOST_THREADS, Request, each_once, reference};

/// The groups of options in pages of help.
pub const PROBLEM: &str = "Problem";
pub const SCHEMES: &str = "Schemes";
pub const MESHES: &str = "Meshes";
pub const SOLVER: &str = "Solver";
pub const OUTPUT: &str = "Output";

/// Problem, schemes and meshes, and how the runs are made.
#[derive(Args, Clone, Debug)]
pub struct Asked {
    /// A problem of your own: mesh or box, data, boundary conditions
    #[arg(help_heading = PROBLEM, value_name = "PROBLEM.toml", conflicts_with_all = ["scenes", "mesh", "boundary"])]
    pub problem: Option<PathBuf>,
    /// Scenes by name, or `all`
    #[arg(help_heading = PROBLEM, long = "scene", value_delimiter = ',', value_name = "A[,B...]")]
    pub scenes: Vec<String>,
    #[command(flatten)]
    pub constants: Constants,
    /// Length scale of scenes that have one
    #[arg(help_heading = PROBLEM, long, value_name = "L", allow_negative_numbers = true, value_parser = number)]
    pub scale: Option<f64>,
    /// Ratio of coefficients of scenes that have one
    #[arg(help_heading = PROBLEM, long, value_name = "X", allow_negative_numbers = true, value_parser = number)]
    pub contrast: Option<f64>,
    /// Load of scenes that have one
    #[arg(help_heading = PROBLEM, long, value_name = "X", allow_negative_numbers = true, value_parser = number)]
    pub load: Option<f64>,
    /// Errors against a fine solution, by p2 where no scheme S is named
    #[arg(help_heading = PROBLEM, long, value_name = "[S@level=]N", value_parser = reference)]
    pub reference: Option<(NamedScheme, usize)>,
    /// NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]], or `all`
    #[arg(help_heading = SCHEMES, long = "scheme", value_delimiter = ',', value_name = "A[,B...]")]
    pub schemes: Vec<String>,
    /// On a box: subdivisions of its shortest side; else refinements
    #[arg(help_heading = MESHES, long, alias = "level", value_delimiter = ',',
        value_name = "N[,N...]", allow_negative_numbers = true, value_parser = whole)]
    pub levels: Vec<usize>,
    /// Meshes by the bound, to GOAL or theta=X,steps=N,unknowns=N,goal=X
    #[arg(help_heading = MESHES, long, value_name = "GOAL|KEY=X", allow_negative_numbers = true,
        value_parser = adaptivity)]
    pub adaptive: Option<Adaptivity>,
    #[command(flatten)]
    pub mesh: MeshFile,
    /// Number of threads; all cores by default
    #[arg(help_heading = SOLVER, long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    pub threads: Option<usize>,
    /// No progress, no tables
    #[arg(help_heading = OUTPUT, long)]
    pub quiet: bool,
}

/// Scenes, each on its mesh, and the files that were read for them.
pub struct FoundScenes {
    pub scenes: Vec<AnyScene>,
    /// What each file is, with its fingerprint.
    pub fingerprints: Vec<(&'static str, String)>,
    pub paths: Vec<PathBuf>,
}

impl Asked {
    /// Refuses numbers of threads that are none.
    pub fn check(&self) -> Request<()> {
        check_count("--threads", self.threads, MOST_THREADS)
    }

    /// Whether the user named scenes, not all or whichever are the default.
    pub fn scenes_are_named(&self) -> bool {
        let all = self.scenes.is_empty() || self.scenes.iter().any(|name| name == "all");
        self.problem.is_some() || !all
    }

    /// The subject of a message: the file of a problem, or a scene, perhaps on the mesh of a file.
    pub fn place(&self, name: &str) -> String {
        match (&self.problem, &self.mesh.path) {
            (Some(path), _) if self.constants.set.is_empty() => path.display().to_string(),
            (Some(path), _) => format!("{}, problem {name}", path.display()),
            (None, Some(mesh)) => format!("{}, scene {name}", mesh.display()),
            (None, None) => format!("scene {name}"),
        }
    }

    /// The problem of the file, or the scenes on the mesh of the command line, if there is one. Each warning goes to
    /// `warn` once.
    pub fn scenes(&self, default: &[&str], warn: &dyn Fn(String)) -> Request<FoundScenes> {
        let said = RefCell::new(Vec::new());
        let warn = |warning: String| {
            if !said.borrow().contains(&warning) {
                said.borrow_mut().push(warning.clone());
                warn(warning);
            }
        };
        if let Some(path) = &self.problem {
            self.check_problem(path)?;
            let problems = self.constants.problems(path, &warn)?;
            let first = problems.first().expect("every constant has a value");
            let (fingerprints, paths) = (first.fingerprints.clone(), first.paths.clone());
            let scenes = problems.into_iter().map(|read| read.scene).collect();
            return Ok(FoundScenes { scenes, fingerprints, paths });
        }
        self.constants.check_absent()?;
        let mesh = self.mesh.read()?;
        let scenes = self.scenes_of_catalogue(default, mesh.as_ref().map(GmshFile::dimension))?;
        let on_mesh = |scene| self.mesh.under(scene, mesh.as_ref(), &warn);
        let scenes = scenes.into_iter().map(on_mesh).collect::<Request<_>>()?;
        let fingerprints = mesh.iter().map(|file| ("mesh", file.fingerprint())).collect();
        Ok(FoundScenes { scenes, fingerprints, paths: self.mesh.path.iter().cloned().collect() })
    }

    /// The parameters of scenes, by name.
    pub fn parameters(&self) -> [(&'static str, Option<f64>); 3] {
        [("scale", self.scale), ("contrast", self.contrast), ("load", self.load)]
    }

    /// Refuses a problem file that is not there, and parameters of scenes beside one.
    fn check_problem(&self, path: &Path) -> Request<()> {
        if !path.exists() {
            let path = excerpt(path.as_os_str().as_encoded_bytes());
            return Err(format!("there is no file {path}; scenes are named by --scene"));
        }
        match self.parameters().iter().find_map(|(n, x)| Some((n, (*x)?))) {
            None => Ok(()),
            Some((name, x)) => {
                let path = path.display();
                Err(format!("--{name} {x:?}: a parameter of scenes; {path} has none"))
            }
        }
    }

    fn scenes_of_catalogue(&self, default: &[&str], mesh: Option<usize>) -> Request<Vec<AnyScene>> {
        let mut catalogue = scenes::catalogue();
        let names: Vec<&str> = catalogue.iter().map(|s| &s.name[..]).collect();
        let default = if mesh.is_some() { &names[..] } else { default };
        let wanted = choose("scene", &self.scenes, default, &names)?;
        // with a mesh, all scenes are all that live in its dimension
        let any_fitting = !self.scenes_are_named();
        catalogue.retain(|s| !any_fitting || mesh.is_none_or(|d| d == s.dimension));
        let accepts: [fn(&AcceptedParameters) -> bool; 3] =
            [|of| of.scale, |of| of.contrast, |of| of.load];
        for ((parameter, value), accepts) in self.parameters().into_iter().zip(accepts) {
            let takers: Vec<&str> =
                catalogue.iter().filter(|s| accepts(&s.accepts)).map(|s| &s.name[..]).collect();
            if let Some(x) = value
                && !takers.iter().any(|s| wanted.iter().any(|w| w == s))
            {
                return Err(format!(
                    "--{parameter} {x:?}: none of the scenes chosen takes it; there are: {}",
                    if takers.is_empty() { "none".to_owned() } else { takers.join(", ") }
                ));
            }
        }
        let mut scenes = Vec::new();
        for entry in wanted.iter().filter_map(|name| catalogue.iter().find(|s| s.name == *name)) {
            if let (Some(d), Some(path)) = (mesh.filter(|&d| d != entry.dimension), &self.mesh.path)
            {
                let saved = match d < entry.dimension {
                    true => {
                        ", or put the domain in a physical group: Gmsh saves only elements of groups"
                    }
                    false => "",
                };
                return Err(format!(
                    "{} has dimension {d}, scene {} has {}: choose a scene of dimension {d} (`unilateral list` names them){saved}",
                    path.display(),
                    entry.name,
                    entry.dimension
                ));
            }
            // a parameter goes to the scenes that take it
            let parameters = Parameters::new()
                .with_scale(self.scale.filter(|_| entry.accepts.scale))
                .with_contrast(self.contrast.filter(|_| entry.accepts.contrast))
                .with_load(self.load.filter(|_| entry.accepts.load));
            scenes.push(entry.make(&parameters));
        }
        scenes.into_iter().collect::<Result<_, _>>().map_err(|e| e.to_string())
    }

    /// States in the program of a report what its rows depend on and do not say.
    pub fn stated_in(&self, mut program: Program, files: &[(&str, String)]) -> Program {
        for (name, value) in self.parameters() {
            if let Some(x) = value {
                program = program.with_request(name, format!("{x:?}"));
            }
        }
        for (name, value) in self.constants.unnamed() {
            program = program.with_request(&format!("constant {name}"), value);
        }
        if let Some((scheme, level)) = &self.reference {
            program = program.with_request("reference", format!("{scheme} at level {level}"));
        }
        if let Some(of) = &self.adaptive {
            program = program.with_request("adaptive", words(of));
            if let [level] = self.levels[..] {
                program = program.with_request("first level", level);
            }
        }
        for (name, condition) in &self.mesh.boundary {
            program = program.with_request(&format!("boundary {name}"), condition.name());
        }
        for (name, fingerprint) in files {
            program = program.with_request(name, fingerprint);
        }
        program.command = command();
        program
    }
}

/// The command line as a shell reads it.
pub fn command() -> Option<String> {
    let words = std::iter::once("unilateral".to_owned()).chain(std::env::args().skip(1));
    Some(Program::quoted(words))
}

/// Refuses a number of things that is zero or beyond a limit.
pub fn check_count(option: &str, count: Option<usize>, most: usize) -> Request<()> {
    match count {
        Some(0) => Err(format!("{option} 0: must be at least 1")),
        Some(n) if n > most => Err(format!("{option} {n}: must be at most {most}")),
        _ => Ok(()),
    }
}

pub fn whole(text: &str) -> Request<usize> {
    text.parse().map_err(|_| "expected a whole number, such as 16".to_owned())
}

pub fn number(text: &str) -> Request<f64> {
    text.parse().map_err(|_| "expected a number, such as 2.5 or 1e-3".to_owned())
}

/// A name of a list, or a message with the list.
pub fn known(kind: &str, name: &str, names: &[&str]) -> Request<()> {
    if names.contains(&name) {
        return Ok(());
    }
    Err(format!("unknown {kind} \"{}\"; there are: {}", excerpt(name), names.join(", ")))
}

/// The names asked for, each once; all of them if one is `all`.
pub fn choose(
    kind: &str,
    asked: &[String],
    default: &[&str],
    names: &[&str],
) -> Request<Vec<String>> {
    let allowed = [names, &["all"]].concat();
    asked.iter().try_for_each(|name| known(kind, name, &allowed))?;
    Ok(if asked.is_empty() {
        default.iter().map(|&name| name.to_owned()).collect()
    } else if asked.iter().any(|name| name == "all") {
        names.iter().map(|&name| name.to_owned()).collect()
    } else {
        each_once(asked)
    })
}
