"""Every registered solver of Fredholm, for matrices and operators of one's own.

Each is a function of this module by its name, with hyphens as underscores:

>>> import numpy as np
>>> from fredholm import solvers
>>> answer = solvers.gmres(np.array([[2.0, 1.0], [0.0, 3.0]]), np.array([4.0, 6.0]))
>>> answer.x
array([1., 2.])

Solvers that ask for rows or entries of an operator which only multiplies get them from one product
for each unknown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Protocol, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _options
from ._errors import Interrupted, wrong
from ._options import Progress


class Operator(Protocol):
    """Anything that multiplies: a LinearOperator of SciPy, a Coupling, or an object of one's
    own."""

    @property
    def shape(self) -> Tuple[int, int]:
        """(n, n)."""

    def matvec(self, x: Any) -> Any:
        """A x for a vector (n,)."""


@dataclass(frozen=True)
class Answer:
    """The answer of a solver.

    Attributes
    ----------
    x : ndarray
        The answer, in the shape of b.
    converged : bool
        Whether the tolerance was met.
    reason : str
        "converged", "not converged" (the iterations ran out), "diverged" or "interrupted".
    iterations : int
        Iterations done.
    residuals : ndarray, shape (iterations + 1, right-hand sides)
        ‖b − A x‖₂/‖b‖₂ on the way.
    products : int
        Products with A.
    seconds : float
        Time of the solver.
    """

    x: NDArray[Any]
    converged: bool
    reason: str
    iterations: int
    residuals: NDArray[np.float64]
    products: int
    seconds: float


_ENTRIES = {entry[0]: entry for entry in _core.solvers()}


def names() -> List[str]:
    """Names of all solvers, as the command line has them."""
    return list(_ENTRIES)


def solve(
    name: str,
    A: Union[ArrayLike, Operator],
    b: ArrayLike,
    *,
    tolerance: float = 1e-10,
    max_iterations: int = 1000,
    x0: Optional[ArrayLike] = None,
    symmetric: Optional[bool] = None,
    threads: Optional[int] = None,
    progress: Progress = False,
    **options: Any,
) -> Answer:
    """Solves A x = b with the solver of a name.

    Parameters
    ----------
    name : str
        One of :func:`names`.
    A : array_like, shape (n, n), or an object with ``shape`` and ``matvec``
        The matrix, or what multiplies with it.
    b : array_like, shape (n,) or (n, k)
        One right-hand side, or several. Complex numbers in A or b make a complex system.
    tolerance : float
        Relative residual ‖b − A x‖₂/‖b‖₂ to reach for every right-hand side.
    max_iterations : int
        Iterations allowed.
    x0 : array_like, in the shape of b, optional
        Where the iteration starts; 0.
    symmetric : bool, optional
        Whether A is symmetric, and Hermitian where it is complex, as some solvers ask for. It is
        looked up in an array; of an operator it is to be said.
    threads : int, optional
        Threads; one a core.
    progress : bool or callable
        As for :meth:`fredholm.Scene.solve`.
    **options
        Options of the solver, such as ``restart`` of gmres.

    Returns
    -------
    Answer
        The answer and how it was found. One that misses the tolerance is an answer, too: see
        ``converged``.

    Raises
    ------
    InputError
        The solver does not suit the system, with the reason.
    """
    _options.known(name, _ENTRIES, "solver")
    _options.share("tolerance", tolerance)
    b = np.asarray(b)
    system = _system(A, b)
    start = np.zeros(b.shape) if x0 is None else np.asarray(x0)
    if start.shape != b.shape:
        raise wrong(f"x0 has the shape {start.shape} and b {b.shape}", "give x0 in the shape of b")
    sides, start = _columns(b, system.dtype), _columns(start, system.dtype)
    scale = _scale(system, sides)
    asked = {
        "solver": ":".join(
            [name, *(f"{key.replace('_', '-')}={_text(value)}" for key, value in options.items())]
        ),
        "tolerance": float(tolerance),
        "max_iterations": int(max_iterations),
        "symmetric": None if symmetric is None else bool(symmetric),
        "scale": scale,
    }
    how = _options.how(threads, progress)

    def answer(found: Any) -> Answer:
        x, reason, iterations, residuals, products, seconds = found
        x = x.reshape(b.shape)
        return Answer(x, reason == "converged", reason, iterations, residuals, products, seconds)

    try:
        return answer(_core.solve_system(system.handed, sides, start, asked, how))
    except Interrupted as stop:
        if stop.partial is not None:
            stop.partial = answer(stop.partial)
        raise


@dataclass(frozen=True)
class _System:
    """A matrix, or a function that multiplies."""

    handed: Any
    dtype: Any
    #: The largest entry of a matrix; of a function it is not known.
    size: Optional[float]


def _system(A: Any, b: NDArray[Any]) -> _System:
    """What the compiled part is handed."""
    shape = tuple(getattr(A, "shape", None) or np.shape(A))
    if len(shape) != 2 or shape[0] != shape[1]:
        raise wrong(f"A has the shape {shape}", "give a square matrix or operator")
    if b.ndim not in (1, 2) or b.shape[0] != shape[0]:
        raise wrong(f"b has the shape {b.shape}, but A {shape}", f"give b of {shape[0]} entries")
    matvec = getattr(A, "matvec", None)
    sparse = matvec is None and hasattr(A, "tocsr")
    if sparse:
        matvec = A.__matmul__
    kind = getattr(A, "dtype", None)
    if matvec is None:
        A = np.asarray(A)
        kind = A.dtype
    complex_ = np.iscomplexobj(b) or (kind is not None and np.issubdtype(kind, np.complexfloating))
    dtype = np.dtype(np.complex128 if complex_ else np.float64)
    if matvec is None:
        matrix = np.ascontiguousarray(A, dtype=dtype)
        # Of complex numbers the larger part will do, and what is not finite stays so.
        parts = matrix.view(np.float64)
        size = max(float(parts.max(initial=0.0)), -float(parts.min(initial=0.0)))
        if not math.isfinite(size):
            raise wrong("A has entries that are not finite", "correct them")
        return _System(matrix, dtype, size)

    def multiply(x: NDArray[Any]) -> NDArray[Any]:
        product = np.asarray(matvec(x)).reshape(-1)
        if np.iscomplexobj(product) and not complex_:
            raise TypeError("matvec returned complex numbers; give b as complex numbers, too")
        return np.ascontiguousarray(product, dtype=dtype)

    return _System(multiply, dtype, None)


def _columns(values: NDArray[Any], dtype: Any) -> NDArray[Any]:
    """Vectors as columns."""
    if np.iscomplexobj(values) and dtype != np.complex128:
        raise wrong("x0 is complex, but A and b are real", "give b as complex numbers, too")
    columns = np.ascontiguousarray(values.reshape(len(values), -1), dtype=dtype)
    if not np.isfinite(columns).all():
        raise wrong("b or x0 has entries that are not finite", "correct them")
    return columns


def _scale(system: _System, b: NDArray[Any]) -> float:
    """A power of two, which the system is divided by: 1 where the size of A is near 1.

    The solvers see A as I − K. Entries of A that are tiny would be lost in that, and huge ones
    would leave nothing of the 1. Where nothing can be lost the system stays as it is, since schemes
    such as neumann converge by the K that it has.
    """
    size = system.size
    if size is None:
        vector = b[:, 0] if b.shape[1] and np.any(b[:, 0]) else np.ones(len(b), dtype=b.dtype)
        size = float(np.linalg.norm(system.handed(vector)) / np.linalg.norm(vector))
    if not (math.isfinite(size) and size > 0.0) or 1 / 16 <= size <= 16:
        return 1.0
    return math.ldexp(1.0, max(-1000, min(1000, math.frexp(size)[1])))


def _text(value: Any) -> str:
    """The value of an option as the command line writes it."""
    return ("yes" if value else "no") if isinstance(value, bool) else str(value)


def _function(name: str) -> Callable[..., Answer]:
    """The function of a solver."""
    _, description, requirements, options = _ENTRIES[name]

    def function(A: Any, b: ArrayLike, **how: Any) -> Answer:
        return solve(name, A, b, **how)

    lines = [f"    {option} : {meaning}" for option, meaning in options]
    listed = "\n".join(["", "    Options", "    -------", *lines, ""]) if lines else ""
    function.__name__ = function.__qualname__ = name.replace("-", "_")
    function.__doc__ = (
        f"{description}.\n\n    Requires: {requirements}.\n{listed}\n"
        "    Parameters and what is returned: see :func:`solve`.\n    "
    )
    return function


_FUNCTIONS: Dict[str, Callable[..., Answer]] = {
    name.replace("-", "_"): _function(name) for name in _ENTRIES
}
globals().update(_FUNCTIONS)


def __getattr__(name: str) -> Callable[..., Answer]:
    """Says which solvers there are where there is none of a name."""
    raise AttributeError(f"there is no solver {name!r}; there are {', '.join(_FUNCTIONS)}")


def __dir__() -> List[str]:
    return sorted([*_FUNCTIONS, "Answer", "Operator", "names", "solve"])
