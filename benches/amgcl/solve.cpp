// Solves a linear system by conjugate gradients with multigrid of AMGCL, set up in single precision.
//
//     solve FILE ROUNDS
//
// FILE is what `cargo bench --bench amgcl` writes: the numbers n, m (64 bits), n + 1 starts of rows (64 bits), m columns
// (64 bits), m values, n entries of the right side (double). Prints one line for each choice of coarsening and smoother:
// name, least seconds of set-up and solve together, seconds of the solve in that round, iterations, and the residual
// over the right side in the Euclidean norm.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include <amgcl/adapter/crs_tuple.hpp>
#include <amgcl/amg.hpp>
#include <amgcl/backend/builtin.hpp>
#include <amgcl/coarsening/ruge_stuben.hpp>
#include <amgcl/coarsening/smoothed_aggregation.hpp>
#include <amgcl/make_solver.hpp>
#include <amgcl/relaxation/gauss_seidel.hpp>
#include <amgcl/relaxation/spai0.hpp>
#include <amgcl/solver/cg.hpp>

typedef amgcl::backend::builtin<double> Double;
typedef amgcl::backend::builtin<float> Single;

struct System {
    std::vector<int64_t> starts, columns;
    std::vector<double> values, right;
};

template <class X>
void read(std::FILE* file, std::vector<X>& out, size_t count) {
    out.resize(count);
    if (std::fread(out.data(), sizeof(X), count, file) != count) {
        std::fprintf(stderr, "the file is too short\n");
        std::exit(1);
    }
}

System read_system(const char* path) {
    std::FILE* file = std::fopen(path, "rb");
    if (!file) {
        std::fprintf(stderr, "cannot read %s\n", path);
        std::exit(1);
    }
    std::vector<int64_t> sizes;
    read(file, sizes, 2);
    System system;
    read(file, system.starts, sizes[0] + 1);
    read(file, system.columns, sizes[1]);
    read(file, system.values, sizes[1]);
    read(file, system.right, sizes[0]);
    std::fclose(file);
    return system;
}

double seconds() {
    auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(now).count();
}

template <template <class> class Coarsening, template <class> class Relaxation>
void measure(const char* name, const System& system, int rounds) {
    typedef amgcl::make_solver<amgcl::amg<Single, Coarsening, Relaxation>, amgcl::solver::cg<Double>> Solver;
    const ptrdiff_t n = system.right.size();
    auto matrix = std::tie(n, system.starts, system.columns, system.values);
    double best = 1e300, best_solve = 0, residual = 0;
    size_t iterations = 0;
    for (int round = 0; round < rounds; ++round) {
        typename Solver::params parameters;
        parameters.solver.tol = 1e-8;
        std::vector<double> u(n, 0.0);
        const double start = seconds();
        Solver solve(matrix, parameters);
        const double is_set_up = seconds();
        std::tie(iterations, residual) = solve(system.right, u);
        const double end = seconds();
        if (end - start < best) {
            best = end - start;
            best_solve = end - is_set_up;
        }
    }
    std::printf("%s %.6f %.6f %zu %.3e\n", name, best, best_solve, iterations, residual);
    std::fflush(stdout);
}

int main(int count, char** words) {
    if (count != 3) {
        std::fprintf(stderr, "usage: solve FILE ROUNDS\n");
        return 2;
    }
    const System system = read_system(words[1]);
    const int rounds = std::atoi(words[2]);
    measure<amgcl::coarsening::smoothed_aggregation, amgcl::relaxation::spai0>("aggregation+spai0", system, rounds);
    measure<amgcl::coarsening::smoothed_aggregation, amgcl::relaxation::gauss_seidel>("aggregation+gauss-seidel", system, rounds);
    measure<amgcl::coarsening::ruge_stuben, amgcl::relaxation::spai0>("ruge-stuben+spai0", system, rounds);
    measure<amgcl::coarsening::ruge_stuben, amgcl::relaxation::gauss_seidel>("ruge-stuben+gauss-seidel", system, rounds);
    return 0;
}
