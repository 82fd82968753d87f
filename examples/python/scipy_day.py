"""Fredholm beside SciPy: `python examples/python/scipy_day.py`. Needs SciPy.

View factors of a mesh file as a sparse matrix, eigenvalues of Fredholm's operator by SciPy, and the
light by GMRES of both on the same operator.
"""

from time import perf_counter

import numpy as np
from scipy.sparse.linalg import LinearOperator, aslinearoperator, eigsh, gmres

import fredholm
from fredholm import solvers


def main() -> None:
    factors = fredholm.view_factors("scenes/studio/vase.obj", threshold=1e-4)
    print(f"{factors.sparse.nnz} of {len(factors.names) ** 2} view factors are at least 1e-4")

    found = fredholm.Scene.load("scenes/leblond_room.toml").couplings()
    symmetric: LinearOperator = aslinearoperator(found.symmetric)
    values = np.sort(eigsh(symmetric, k=4, return_eigenvectors=False))[::-1]
    print("largest eigenvalues of the view factors:", values)

    system, emitted = aslinearoperator(found.system()), found.exitance[:, 0]
    started = perf_counter()
    ours = solvers.gmres(system, emitted, tolerance=1e-10)
    between = perf_counter()
    theirs, _ = gmres(system, emitted, rtol=1e-10, atol=0.0)
    ended = perf_counter()
    difference = np.abs(ours.x - theirs).max()
    print(f"Fredholm: {ours.iterations} iterations, {1e3 * (between - started):.1f} ms")
    print(f"SciPy: {1e3 * (ended - between):.1f} ms, largest difference {difference:.1e} W/m²")


if __name__ == "__main__":
    main()
