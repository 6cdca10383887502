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

if "clarabel" in sys.argv:  # minimise u.Au/2 - b.u within the bounds, for a symmetric A
    import clarabel
    I, low, up = sparse.eye(len(b), format="csr"), np.isfinite(lower) & ~fixed, np.isfinite(upper) & ~fixed
    G, h = sparse.vstack([I[fixed], -I[low], I[up]]), np.r_[lower[fixed], -lower[low], upper[up]]
    cones = [clarabel.ZeroConeT(int(fixed.sum())), clarabel.NonnegativeConeT(int(low.sum() + up.sum()))]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    u = np.array(clarabel.DefaultSolver(sparse.triu(A).tocsc(), -b, G.tocsc(), h, cones, settings).solve().x)
else:  # the primal-dual active set method
    c, u = A.diagonal(), np.clip(0.0, lower, upper)
    for step in range(100):
        multiplier = A @ u - b
        at_lower = fixed | (multiplier + c * (lower - u) > 0)
        at_upper = ~fixed & (multiplier + c * (upper - u) < 0)
        before = u
        u = np.where(at_lower, lower, np.where(at_upper, upper, 0.0))
        free = ~(at_lower | at_upper)
        u[free] = spsolve(A[free][:, free], (b - A @ u)[free])
        if np.abs(u - before).max() <= 1e-14 * np.abs(u).max():
            break

np.save(f"{folder}/u.npy", u)
