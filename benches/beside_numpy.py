"""Direct solvers of Fredholm beside NumPy and SciPy on the same matrices, in turns, so that other load hits both alike.

    pip install numpy scipy
    python3 benches/beside_numpy.py [rounds]

The matrices are those of crates/direct/benches/faer.rs: I - D G with a real symmetric G, its symmetric form for
Cholesky, and a complex symmetric one like those of boundary elements.
"""

import re
import subprocess
import sys

import numpy as np
import scipy.linalg
from timing import best

REAL_DIM = 2500
COMPLEX_DIM = 4900
COMPLEX_TRIALS = 2


def real_matrices():
    """I - D G, and I - sqrt(D) G sqrt(D)."""
    at = np.arange(REAL_DIM * (REAL_DIM + 1) // 2, dtype=np.int64)
    g = np.zeros((REAL_DIM, REAL_DIM))
    g[np.tril_indices(REAL_DIM)] = (at * 7919 % 1021 / 1021.0) ** 3
    g = g + np.tril(g, -1).T
    d = 0.7 / g.sum(axis=1)
    root = np.sqrt(d)
    return np.eye(REAL_DIM) - d[:, None] * g, np.eye(REAL_DIM) - root[:, None] * g * root[None, :]


def complex_matrix():
    """I - K with K = -exp(-0.3j d)/sqrt(1 + d)/2, d = |i - j|."""
    d = np.abs(np.subtract.outer(np.arange(COMPLEX_DIM), np.arange(COMPLEX_DIM)))
    return np.eye(COMPLEX_DIM) + 0.5 * np.exp(-0.3j * d) / np.sqrt(1.0 + d)


def solve_by_lu(matrix, right):
    return scipy.linalg.lu_solve(scipy.linalg.lu_factor(matrix), right)


def real_times(general, symmetric, right):
    return {
        "numpy solve": best(lambda: np.linalg.solve(general, right)),
        "scipy lu": best(lambda: solve_by_lu(general, right)),
        "scipy cholesky": best(lambda: scipy.linalg.cho_solve(scipy.linalg.cho_factor(symmetric, lower=True), right)),
    }


def complex_times(matrix, right):
    return {
        "numpy solve": best(lambda: np.linalg.solve(matrix, right), COMPLEX_TRIALS),
        "scipy lu": best(lambda: solve_by_lu(matrix, right), COMPLEX_TRIALS),
        "scipy sysv": best(lambda: scipy.linalg.solve(matrix, right, assume_a="sym"), COMPLEX_TRIALS),
    }


def fredholm_times():
    """The times of the real and of the complex system."""
    command = ["cargo", "bench", "--quiet", "-p", "fredholm-direct", "--bench", "faer"]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    systems = []
    for part in out.split("n = ")[1:]:
        found = {}
        for name, own, faer in re.findall(r"^([a-z-]+) +([\d.]+) s(?:, faer ([\d.]+) s)?", part, re.M):
            found[f"fredholm {name}"] = float(own)
            if faer:
                found[f"faer {name}"] = float(faer)
        systems.append(found)
    return systems


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    general, symmetric = real_matrices()
    matrix = complex_matrix()
    right, complex_right = (np.arange(dim) % 7 + 1.0 for dim in (REAL_DIM, COMPLEX_DIM))
    times = [{}, {}]
    for _ in range(rounds):
        real, waves = fredholm_times()
        real |= real_times(general, symmetric, right)
        waves |= complex_times(matrix, complex_right)
        for best_times, found in zip(times, (real, waves), strict=True):
            for name, seconds in found.items():
                best_times[name] = min(seconds, best_times.get(name, seconds))
    print(f"numpy {np.__version__}, scipy {scipy.__version__}; best of {rounds} rounds")
    for kind, dim, found in zip(("real", "complex symmetric"), (REAL_DIM, COMPLEX_DIM), times, strict=True):
        print(f"{kind}, n = {dim}")
        for name, seconds in found.items():
            print(f"{name:20} {seconds:.3f} s")


main()
