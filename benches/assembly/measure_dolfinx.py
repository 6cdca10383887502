"""Time per cell of the same matrices assembled by DOLFINx 0.5, for comparison.

    OMP_NUM_THREADS=1 python3 benches/assembly/measure_dolfinx.py

Debian has it as python3-dolfinx. Times are processor seconds, the least of five (from nothing: two)
runs; compiling the forms is not counted. From nothing means pattern and values.
"""

import time

import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

OPTIONS = {"cffi_extra_compile_args": ["-O3", "-march=native"]}


def bilinear_form(domain, dimension, degree, broken):
    space = fem.FunctionSpace(domain, ("DG" if broken else "Lagrange", degree))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    form = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
    if broken:
        n = ufl.FacetNormal(domain)
        size = ufl.FacetArea(domain)
        weight = 10.0 * degree**2 / (size if dimension == 2 else ufl.sqrt(size))
        form -= ufl.inner(ufl.avg(ufl.grad(u)), ufl.jump(v, n)) * ufl.dS
        form -= ufl.inner(ufl.jump(u, n), ufl.avg(ufl.grad(v))) * ufl.dS
        form += weight("+") * ufl.inner(ufl.jump(u), ufl.jump(v)) * ufl.dS
        form -= (ufl.dot(ufl.grad(u), n) * v + u * ufl.dot(ufl.grad(v), n)) * ufl.ds
        form += weight * u * v * ufl.ds
    return fem.form(form, jit_params=OPTIONS)


def least(runs, work):
    times = []
    for _ in range(runs):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def measure(name, dimension, n, degree, broken):
    box = mesh.create_unit_square if dimension == 2 else mesh.create_unit_cube
    domain = box(MPI.COMM_SELF, *[n] * dimension)
    cells = domain.topology.index_map(dimension).size_local
    form = bilinear_form(domain, dimension, degree, broken)

    def fill(matrix):
        matrix.zeroEntries()
        fem.petsc.assemble_matrix(matrix, form)
        matrix.assemble()

    def from_nothing():
        matrix = fem.petsc.create_matrix(form)
        fill(matrix)
        matrix.destroy()

    kept = fem.petsc.create_matrix(form)
    fill(kept)
    refill = 1e9 * least(5, lambda: fill(kept)) / cells
    kept.destroy()
    both = 1e9 * least(2, from_nothing) / cells
    print(f"{name}, n = {n}: refill {refill:.0f} ns per cell, from nothing {both:.0f}", flush=True)


for case in [
    ("2d/p1", 2, 1024, 1, False),
    ("3d/p1", 3, 64, 1, False),
    ("2d/p2", 2, 512, 2, False),
    ("3d/p2", 3, 32, 2, False),
    ("2d/sipg", 2, 512, 1, True),
    ("3d/sipg", 3, 32, 1, True),
    ("2d/sipg-p2", 2, 256, 2, True),
    ("3d/sipg-p2", 3, 16, 2, True),
]:
    measure(*case)
