//! Compiles the C file that calls MPI and PETSc, for the feature `petsc` alone.

fn main() {
    println!("cargo:rerun-if-changed=src/distributed/petsc/build.rs");
    #[cfg(feature = "petsc")]
    petsc::compile();
}

#[cfg(feature = "petsc")]
mod petsc {
    use std::process::exit;

    const SHIM: &str = "src/distributed/petsc/shim.c";

    pub fn compile() {
        println!("cargo:rerun-if-changed={SHIM}");
        println!("cargo:rerun-if-env-changed=MPICC");
        let found = pkg_config::Config::new().atleast_version("3.18").probe("PETSc");
        let Ok(petsc) = found else {
            eprintln!(
                "feature `petsc` needs PETSc 3.18 or later with its headers, where pkg-config finds it; on Debian: apt-get install libpetsc-real-dev"
            );
            exit(1)
        };
        let compiler = std::env::var("MPICC").unwrap_or_else(|_| "mpicc".to_owned());
        let compiled = cc::Build::new()
            .compiler(&compiler)
            .includes(&petsc.include_paths)
            .file(SHIM)
            .try_compile("unilateral_petsc");
        if let Err(error) = compiled {
            eprintln!(
                "feature `petsc` needs an MPI compiler, `{compiler}` or the one that MPICC names, that compiles {SHIM}: {error}"
            );
            exit(1)
        }
        // MPI itself is called from C alone
        println!("cargo:rustc-link-lib=mpi");
    }
}
