"""LU and Cholesky of Fredholm beside NumPy and SciPy on the same matrix, in turns, so that other load hits both alike.

    pip install numpy scipy
    python3 benches/beside_numpy.py [rounds]

The matrix is that of crates/direct/benches/faer.rs: I - D G with a symmetric G, and its symmetric form for Cholesky.
"""

import re
import subprocess
import sys

import numpy as np
import scipy.linalg
from timing import best

DIM = 2500


def matrices():
    """I - D G, and I - sqrt(D) G sqrt(D)."""
    at = np.arange(DIM * (DIM + 1) // 2, dtype=np.int64)
    g = np.zeros((DIM, DIM))
    g[np.tril_indices(DIM)] = (at * 7919 % 1021 / 1021.0) ** 3
    g = g + np.tril(g, -1).T
    d = 0.7 / g.sum(axis=1)
    root = np.sqrt(d)
    return np.eye(DIM) - d[:, None] * g, np.eye(DIM) - root[:, None] * g * root[None, :]


def numpy_times(general, symmetric, right):
    return {
        "numpy solve": best(lambda: np.linalg.solve(general, right)),
        "scipy lu": best(lambda: scipy.linalg.lu_solve(scipy.linalg.lu_factor(general), right)),
        "scipy cholesky": best(lambda: scipy.linalg.cho_solve(scipy.linalg.cho_factor(symmetric, lower=True), right)),
    }


def fredholm_times():
    command = ["cargo", "bench", "--quiet", "-p", "fredholm-direct", "--bench", "faer"]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    found = {}
    for name, own, faer in re.findall(r"^(lu|cholesky) +([\d.]+) s, faer ([\d.]+) s", out, re.M):
        found[f"fredholm {name}"], found[f"faer {name}"] = float(own), float(faer)
    return found


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    general, symmetric = matrices()
    right = np.arange(DIM) % 7 + 1.0
    times = {}
    for _ in range(rounds):
        for name, seconds in (fredholm_times() | numpy_times(general, symmetric, right)).items():
            times[name] = min(seconds, times.get(name, seconds))
    print(f"n = {DIM}, numpy {np.__version__}, scipy {scipy.__version__}; best of {rounds} rounds")
    for name, seconds in times.items():
        print(f"{name:16} {seconds:.3f} s")


main()
