/* All that the library asks of MPI and PETSc. Numbers of rows and columns have 64 bits here, whatever PetscInt
 * has. A function returns 0, or an error of PETSc, whose text ul_error_text gives; MPI ends the job itself. */
#include <petscksp.h>
#include <petscsnes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#if !defined(PETSC_USE_REAL_DOUBLE) || defined(PETSC_USE_COMPLEX)
#error "the library needs a PETSc with real numbers of double precision"
#endif

/* Besides the errors of PETSc: factors have found that a matrix is not positive definite. */
#define NOT_POSITIVE 10001
/* Besides the errors of PETSc: PetscInt has 32 bits, and a number does not fit. */
#define TOO_LARGE 10002
/* Seconds that a process whose step failed waits for the others. */
#define PATIENCE 10.0

#define TRY(call)                                                                                                  \
  do {                                                                                                             \
    PetscErrorCode code_ = (call);                                                                                 \
    if (code_) return (int)code_;                                                                                  \
  } while (0)

/* ---- processes ---- */

/* For agreements on failures: processes may be inside functions of PETSc that use the communicator of PETSc. */
static MPI_Comm agreement;

/* A library that PETSc loads (SuperLU_DIST) tells the allocator never to give memory back, so that freed vectors stay
 * with a process: a seventh of its peak for SIPG on radial-2d at 512. Large vectors get mappings of their own again. */
static void give_memory_back(void) {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 65536);
  mallopt(M_MMAP_THRESHOLD, 8 << 20);
  mallopt(M_TRIM_THRESHOLD, 64 << 20);
#endif
}

int ul_start(void) {
  int provided, flag;
  give_memory_back();
  if (MPI_Initialized(&flag) || flag) return 1; /* somebody else ends it */
  /* threads of the library never call MPI */
  if (MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided) || provided < MPI_THREAD_FUNNELED) return 1;
  if (MPI_Comm_dup(MPI_COMM_WORLD, &agreement)) return 1;
  /* files of options in a home directory would change results unseen; the variable PETSC_OPTIONS is looked at */
  TRY(PetscOptionsSetValue(NULL, "-skip_petscrc", "1"));
  TRY(PetscInitialize(NULL, NULL, NULL, NULL));
  TRY(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  return 0;
}

int ul_end(void) {
  MPI_Comm_free(&agreement);
  TRY(PetscPopErrorHandler());
  TRY(PetscFinalize());
  return MPI_Finalize();
}

void ul_abort(int code) { MPI_Abort(MPI_COMM_WORLD, code); }

/* Ends the job with a sentence: the last thing that it says. */
void ul_abort_with(const char *why) {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  fprintf(stderr, "error: process %d: %s; the job ends here, finished rows are in the journal\n", rank, why);
  fflush(stderr);
  MPI_Abort(MPI_COMM_WORLD, 1);
}

/* Whether a step failed in any process; all call it after the step. The others may wait for a process inside the step
 * in which it failed alone: after a while without an answer it ends the job. */
int ul_any(int failed, const char *why) {
  int any = 0, done = 0;
  MPI_Request request;
  MPI_Iallreduce(&failed, &any, 1, MPI_INT, MPI_MAX, agreement, &request);
  double start = MPI_Wtime();
  while (!done) {
    if (failed && MPI_Wtime() - start > PATIENCE) ul_abort_with(why);
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
  }
  return any;
}

int ul_rank(void) {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

int ul_size(void) {
  int size = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  return size;
}

void ul_version(int *numbers) {
  numbers[0] = PETSC_VERSION_MAJOR;
  numbers[1] = PETSC_VERSION_MINOR;
  numbers[2] = PETSC_VERSION_SUBMINOR;
}

const char *ul_error_text(int code) {
  const char *text = NULL;
  if (code == NOT_POSITIVE) return "the matrix is not positive definite";
  if (code == TOO_LARGE) return "a number exceeds 32 bits: this needs a PETSc with 64-bit integers";
  if (PetscErrorMessage((PetscErrorCode)code, &text, NULL) || !text) return "unknown error";
  return text;
}

/* ---- messages ---- */

int ul_sum(double *numbers, int count) {
  return MPI_Allreduce(MPI_IN_PLACE, numbers, count, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
}

int ul_largest(double *numbers, int count) {
  return MPI_Allreduce(MPI_IN_PLACE, numbers, count, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
}

int ul_counts(const int *sent, int *received) {
  return MPI_Alltoall(sent, 1, MPI_INT, received, 1, MPI_INT, PETSC_COMM_WORLD);
}

/* Words from and to every process, one after the other in the order of processes; only those that have words
 * for one another send messages. */
int ul_exchange(const int64_t *sent, const int *to, int64_t *received, const int *from) {
  int size = ul_size(), requests = 0, error = 0, tag = 7;
  MPI_Request *request = malloc(2 * (size_t)size * sizeof *request);
  if (!request) return PETSC_ERR_MEM;
  for (int k = 0; k < size && !error; received += from[k++])
    if (from[k]) error = MPI_Irecv(received, from[k], MPI_INT64_T, k, tag, PETSC_COMM_WORLD, &request[requests++]);
  for (int k = 0; k < size && !error; sent += to[k++])
    if (to[k]) error = MPI_Isend(sent, to[k], MPI_INT64_T, k, tag, PETSC_COMM_WORLD, &request[requests++]);
  if (!error) error = MPI_Waitall(requests, request, MPI_STATUSES_IGNORE);
  free(request);
  return error;
}

/* ---- matrices: own rows, columns by their numbers over all processes ---- */

static int fits(int64_t number) { return number <= PETSC_MAX_INT; }

static int new_matrix(PetscInt n, const PetscInt *own, const PetscInt *other, Mat *out) {
  TRY(MatCreate(PETSC_COMM_WORLD, out));
  TRY(MatSetSizes(*out, n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  TRY(MatSetType(*out, MATAIJ));
  TRY(MatSeqAIJSetPreallocation(*out, 0, own));
  TRY(MatMPIAIJSetPreallocation(*out, 0, own, 0, other));
  TRY(MatSetOption(*out, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  TRY(MatSetOption(*out, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  return 0;
}

/* `first` is the number of the first of so many own rows. */
int ul_matrix_new(int64_t first, int64_t rows, const int *in_own_columns, const int *in_other_columns, Mat *out) {
  PetscInt n = (PetscInt)rows, *own, *other;
  if (!fits(first + rows)) return TOO_LARGE;
  TRY(PetscMalloc2(n + 1, &own, n + 1, &other));
  for (PetscInt i = 0; i < n; i++) own[i] = in_own_columns[i], other[i] = in_other_columns[i];
  int code = new_matrix(n, own, other, out);
  TRY(PetscFree2(own, other));
  return code;
}

int ul_matrix_row(Mat matrix, int64_t row, int count, const int64_t *columns, const double *values) {
  PetscInt i = (PetscInt)row, buffer[256];
  for (int done = 0; done < count;) {
    int n = count - done < 256 ? count - done : 256;
    for (int k = 0; k < n; k++) {
      if (!fits(columns[done + k])) return TOO_LARGE;
      buffer[k] = (PetscInt)columns[done + k];
    }
    TRY(MatSetValues(matrix, 1, &i, n, buffer, values + done, INSERT_VALUES));
    done += n;
  }
  return 0;
}

int ul_matrix_assemble(Mat matrix) {
  TRY(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  TRY(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  return 0;
}

int ul_matrix_destroy(Mat *matrix) {
  TRY(MatDestroy(matrix));
  return 0;
}

/* ---- preconditioners ---- */

typedef struct {
  Mat matrix; /* as given; owned by the solver */
  PC pc;
  Vec r, z; /* without memory of their own */
  double mean; /* of the diagonal */
  int method; /* 0: a cycle of algebraic multigrid, 1: factors */
} Solver;

int ul_solver_new(Mat matrix, int method, Solver **out) {
  Solver *solver = calloc(1, sizeof *solver);
  if (!solver) return PETSC_ERR_MEM;
  solver->matrix = matrix;
  solver->method = method;
  *out = solver;
  PetscInt n, all;
  Vec diagonal;
  PetscScalar sum;
  TRY(MatCreateVecs(matrix, &diagonal, NULL));
  TRY(MatGetDiagonal(matrix, diagonal));
  TRY(VecSum(diagonal, &sum));
  TRY(VecGetSize(diagonal, &all));
  TRY(VecDestroy(&diagonal));
  solver->mean = all > 0 && sum > 0 ? sum / all : 1;
  TRY(MatGetLocalSize(matrix, &n, NULL));
  TRY(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, n, PETSC_DETERMINE, NULL, &solver->r));
  TRY(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, n, PETSC_DETERMINE, NULL, &solver->z));
  return 0;
}

static int new_preconditioner(Solver *solver) {
  TRY(PCCreate(PETSC_COMM_WORLD, &solver->pc));
  if (solver->method == 0) {
    TRY(PCSetOptionsPrefix(solver->pc, "ul_multigrid_"));
    TRY(PCSetType(solver->pc, PCHYPRE));
    TRY(PCHYPRESetType(solver->pc, "boomeramg"));
  } else {
    TRY(PCSetOptionsPrefix(solver->pc, "ul_factors_"));
    TRY(PCSetType(solver->pc, PCCHOLESKY));
    TRY(PCFactorSetMatSolverType(solver->pc, MATSOLVERMUMPS));
  }
  TRY(PCSetFromOptions(solver->pc));
  return 0;
}

/* Rows and columns of the own rows listed become those of the identity times the mean of the diagonal. */
int ul_solver_fix(Solver *solver, const int64_t *rows, int64_t count) {
  PetscInt n = (PetscInt)count, *list;
  if (n > 0 && !fits(rows[n - 1])) return TOO_LARGE;
  TRY(PetscMalloc1(n + 1, &list));
  for (PetscInt k = 0; k < n; k++) list[k] = (PetscInt)rows[k];
  Mat fixed;
  TRY(PCDestroy(&solver->pc));
  TRY(MatDuplicate(solver->matrix, MAT_COPY_VALUES, &fixed));
  TRY(MatSetOption(fixed, MAT_KEEP_NONZERO_PATTERN, PETSC_TRUE));
  TRY(MatZeroRowsColumns(fixed, n, list, solver->mean, NULL, NULL));
  TRY(PetscFree(list));
  if (solver->method == 0) {
    /* multigrid has a copy of its own: this one is gone before the coarse matrices come */
    Mat copy;
    TRY(MatConvert(fixed, MATHYPRE, MAT_INITIAL_MATRIX, &copy));
    TRY(MatDestroy(&fixed));
    fixed = copy;
  } else
    TRY(MatSetOption(fixed, MAT_SPD, PETSC_TRUE));
  TRY(new_preconditioner(solver));
  TRY(PCSetOperators(solver->pc, fixed, fixed));
  TRY(MatDestroy(&fixed));
  if (solver->method == 1) {
    Mat factors;
    TRY(PCFactorSetUpMatSolverType(solver->pc));
    TRY(PCFactorGetMatrix(solver->pc, &factors));
    /* work space in per cent beyond the estimate, which is too small for some blocks over several processes */
    TRY(MatMumpsSetIcntl(factors, 14, 200));
  }
  TRY(PCSetUp(solver->pc));
  PCFailedReason reason;
  TRY(PCGetFailedReason(solver->pc, &reason));
  if (solver->method == 0) return !reason ? 0 : NOT_POSITIVE;
  Mat factors;
  PetscInt error, n_negative;
  TRY(PCFactorGetMatrix(solver->pc, &factors));
  TRY(MatMumpsGetInfog(factors, 1, &error));
  TRY(MatMumpsGetInfog(factors, 12, &n_negative));
  /* -10: singular; -40: a pivot of the last block is not positive; others are lack of memory */
  if (error == -10 || error == -40 || (error >= 0 && (reason || n_negative > 0))) return NOT_POSITIVE;
  return error < 0 ? PETSC_ERR_MEM : 0;
}

int ul_solver_apply(Solver *solver, const double *residual, double *correction) {
  TRY(VecPlaceArray(solver->r, residual));
  TRY(VecPlaceArray(solver->z, correction));
  TRY(PCApply(solver->pc, solver->r, solver->z));
  TRY(VecResetArray(solver->r));
  TRY(VecResetArray(solver->z));
  return 0;
}

int ul_solver_destroy(Solver *solver) {
  TRY(PCDestroy(&solver->pc));
  TRY(VecDestroy(&solver->r));
  TRY(VecDestroy(&solver->z));
  TRY(MatDestroy(&solver->matrix));
  free(solver);
  return 0;
}
