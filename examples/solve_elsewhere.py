"""Solves an inequality of `compare --dump DIR` with SciPy, or with a solver of quadratic programs.

    cargo run --release -- compare --scene radial-2d --scheme sipg --levels 32 --dump target/dump
    python3 examples/solve_elsewhere.py target/dump/radial-2d-sipg-32
    cargo run --release -- judge target/dump/radial-2d-sipg-32 target/dump/radial-2d-sipg-32/u.npy
"""
import sys
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import spsolve

folder = sys.argv[1]
A = sparse.load_npz(f"{folder}/inequality.npz").tocsr()
data = np.load(f"{folder}/inequality.npz")
b, lower, upper = data["load"], data["lower"], data["upper"]
fixed = lower == upper
# friction: rows of unknown, place, slope below and slope above the place of a convex function in the energy
kinks = data["kinks"] if "kinks" in data else np.zeros((0, 4))
at, place, below, above = kinks[:, 0].astype(int), kinks[:, 1], kinks[:, 2], kinks[:, 3]

if "clarabel" in sys.argv:  # minimise u.Au/2 - b.u + sum t within the bounds, t above both lines of a kink; A symmetric
    import clarabel
    n, m = len(b), len(at)
    I, low, up = sparse.eye(n, format="csr"), np.isfinite(lower) & ~fixed, np.isfinite(upper) & ~fixed
    lines = [sparse.hstack([sparse.diags(slope) @ I[at], -sparse.eye(m)]) for slope in (below, above)]
    bounds = sparse.vstack([I[fixed], -I[low], I[up]])
    bounds = sparse.hstack([bounds, sparse.csr_matrix((bounds.shape[0], m))])
    G, h = sparse.vstack([bounds, *lines]), np.r_[lower[fixed], -lower[low], upper[up], below * place, above * place]
    A, b = sparse.block_diag([A, sparse.csr_matrix((m, m))]), np.r_[b, -np.ones(m)]
    cones = [clarabel.ZeroConeT(int(fixed.sum())), clarabel.NonnegativeConeT(int(low.sum() + up.sum()) + 2 * m)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    u = np.array(clarabel.DefaultSolver(sparse.triu(A).tocsc(), -b, G.tocsc(), h, cones, settings).solve().x)[:n]
else:  # the primal-dual active set method
    c, u = A.diagonal(), np.clip(0.0, lower, upper)
    for step in range(100):
        multiplier = A @ u - b
        at_lower = fixed | (multiplier + c * (lower - u) > 0)
        at_upper = ~fixed & (multiplier + c * (upper - u) < 0)
        force = c[at] * (u[at] - place) - multiplier[at]  # beyond a slope it slips, between them it sticks
        sticks = (force >= below) & (force <= above)
        before = u
        u = np.where(at_lower, lower, np.where(at_upper, upper, 0.0))
        free = ~(at_lower | at_upper)
        u[at[sticks]], free[at[sticks]] = place[sticks], False
        load = b.copy()
        load[at] -= np.clip(force, below, above)
        u[free] = spsolve(A[free][:, free], (load - A @ u)[free])
        if np.abs(u - before).max() <= 1e-14 * np.abs(u).max():
            break

np.save(f"{folder}/u.npy", u)
