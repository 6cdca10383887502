/* Poisson's equation on the unit square or cube by hypre's structured multigrid PFMG, as preconditioner of conjugate
 * gradients, on one thread: the peer of `cargo bench --bench scaling` on problems without bounds.
 *
 *     git clone https://github.com/hypre-space/hypre target/hypre
 *     (cd target/hypre/src && ./configure --without-MPI --disable-fortran CFLAGS="-O3 -march=native" && make -j2)
 *     cc -O3 -march=native -I target/hypre/src/hypre/include benches/hypre/poisson.c \
 *         -L target/hypre/src/hypre/lib -lHYPRE -lm -lstdc++ -o target/hypre_poisson
 *     target/hypre_poisson 2 1024 5
 *     target/hypre_poisson 3 64 5
 *     cargo bench --bench scaling -- --rounds 5 2d-p1-linear-1024 3d-p1-linear-64
 *
 * Arguments are dimension, subdivisions and rounds. The matrix is that of conforming P1 on the built-in meshes, which
 * is the stencil of 5 or 7 points, on the unknowns without Dirichlet data; the load is 1. Seconds are those of the
 * fastest round; the run ends where the residual is 1e-8 of its initial norm. The largest value is 0.07367 on the square
 * and 0.0562 on the cube.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "HYPRE_krylov.h"
#include "HYPRE_struct_ls.h"
#include "HYPRE_utilities.h"

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: %s DIMENSION SUBDIVISIONS ROUNDS\n", argv[0]);
        return 2;
    }
    int dim = atoi(argv[1]), n = atoi(argv[2]), rounds = atoi(argv[3]);
    HYPRE_Initialize();
    int lower[3] = {1, 1, 1}, upper[3] = {n - 1, n - 1, n - 1};
    long size = 1;
    for (int d = 0; d < dim; d++)
        size *= n - 1;

    HYPRE_StructGrid grid;
    HYPRE_StructGridCreate(0, dim, &grid);
    HYPRE_StructGridSetExtents(grid, lower, upper);
    HYPRE_StructGridAssemble(grid);

    /* half of the symmetric stencil: the diagonal and one neighbour in each direction */
    HYPRE_StructStencil stencil;
    HYPRE_StructStencilCreate(dim, dim + 1, &stencil);
    int offset[3] = {0, 0, 0}, entries[4] = {0, 1, 2, 3};
    HYPRE_StructStencilSetElement(stencil, 0, offset);
    for (int d = 0; d < dim; d++) {
        offset[d] = 1;
        HYPRE_StructStencilSetElement(stencil, d + 1, offset);
        offset[d] = 0;
    }

    double h = 1.0 / n, scale = dim == 3 ? h : 1.0, volume = dim == 3 ? h * h * h : h * h;
    double *values = malloc(sizeof(double) * size * (dim + 1));
    for (long i = 0; i < size; i++) {
        values[i * (dim + 1)] = 2.0 * dim * scale;
        long place = i;
        for (int d = 0; d < dim; d++) {
            /* no entry reaches outside the grid */
            values[i * (dim + 1) + d + 1] = place % (n - 1) == n - 2 ? 0.0 : -scale;
            place /= n - 1;
        }
    }
    HYPRE_StructMatrix matrix;
    HYPRE_StructMatrixCreate(0, grid, stencil, &matrix);
    HYPRE_StructMatrixSetSymmetric(matrix, 1);
    HYPRE_StructMatrixInitialize(matrix);
    HYPRE_StructMatrixSetBoxValues(matrix, lower, upper, dim + 1, entries, values);
    HYPRE_StructMatrixAssemble(matrix);

    HYPRE_StructVector load, solution;
    HYPRE_StructVectorCreate(0, grid, &load);
    HYPRE_StructVectorInitialize(load);
    HYPRE_StructVectorCreate(0, grid, &solution);
    HYPRE_StructVectorInitialize(solution);
    for (long i = 0; i < size; i++)
        values[i] = volume;
    HYPRE_StructVectorSetBoxValues(load, lower, upper, values);
    HYPRE_StructVectorAssemble(load);
    HYPRE_StructVectorAssemble(solution);

    double least_setup = 1e30, least_solve = 1e30, norm = 0.0;
    int iterations = 0;
    for (int round = 0; round < rounds; round++) {
        HYPRE_StructVectorSetConstantValues(solution, 0.0);
        HYPRE_StructSolver krylov, multigrid;
        double start = seconds();
        HYPRE_StructPFMGCreate(0, &multigrid);
        HYPRE_StructPFMGSetMaxIter(multigrid, 1);
        HYPRE_StructPFMGSetTol(multigrid, 0.0);
        HYPRE_StructPFMGSetZeroGuess(multigrid);
        HYPRE_StructPFMGSetRelaxType(multigrid, 2);
        HYPRE_StructPFMGSetNumPreRelax(multigrid, 1);
        HYPRE_StructPFMGSetNumPostRelax(multigrid, 1);
        HYPRE_StructPCGCreate(0, &krylov);
        HYPRE_StructPCGSetMaxIter(krylov, 100);
        HYPRE_StructPCGSetTol(krylov, 1e-8);
        HYPRE_StructPCGSetTwoNorm(krylov, 1);
        HYPRE_StructPCGSetPrecond(krylov, HYPRE_StructPFMGSolve, HYPRE_StructPFMGSetup, multigrid);
        HYPRE_StructPCGSetup(krylov, matrix, load, solution);
        double middle = seconds();
        HYPRE_StructPCGSolve(krylov, matrix, load, solution);
        double end = seconds();
        HYPRE_StructPCGGetNumIterations(krylov, &iterations);
        HYPRE_StructPCGGetFinalRelativeResidualNorm(krylov, &norm);
        HYPRE_StructPCGDestroy(krylov);
        HYPRE_StructPFMGDestroy(multigrid);
        if (end - start < least_setup + least_solve) {
            least_setup = middle - start;
            least_solve = end - middle;
        }
    }
    HYPRE_StructVectorGetBoxValues(solution, lower, upper, values);
    double largest = 0.0;
    for (long i = 0; i < size; i++)
        largest = values[i] > largest ? values[i] : largest;
    printf("hypre %dD n = %d: %ld unknowns, set-up %.4f s, solve %.4f s, %d iterations, residual %.1e, maximum %.6f\n",
           dim, n, size, least_setup, least_solve, iterations, norm, largest);
    free(values);
    HYPRE_Finalize();
    return 0;
}
