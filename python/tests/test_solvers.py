"""Every registered solver on matrices and operators of one's own."""

from typing import Any

import numpy as np
import pytest

import fredholm
from fredholm import solvers

RNG = np.random.default_rng(7)
#: Symmetric, positive definite, with a diagonal that dominates: every solver suits it.
SMALL = np.eye(12) - 0.05 * (lambda r: (r + r.T) / 2)(RNG.random((12, 12)))
RIGHT = RNG.random(12)


class Counted:
    """A matrix that only multiplies, and counts how often."""

    def __init__(self, matrix: np.ndarray) -> None:
        self.matrix, self.shape, self.dtype, self.count = matrix, matrix.shape, matrix.dtype, 0

    def matvec(self, x: np.ndarray) -> np.ndarray:
        self.count += 1
        return self.matrix @ x


@pytest.mark.parametrize("name", solvers.names())
def test_every_solver_agrees_with_numpy(name: str) -> None:
    solve = getattr(solvers, name.replace("-", "_"))
    expected = np.linalg.solve(SMALL, RIGHT)
    for system in (SMALL, Counted(SMALL)):
        answer = solve(system, RIGHT, tolerance=1e-11, max_iterations=5000, symmetric=True)
        assert answer.converged and answer.x.shape == (12,), (name, answer.reason)
        assert np.allclose(answer.x, expected, rtol=1e-8), name
    assert solve.__doc__ and "Requires" in solve.__doc__


def test_entries_of_an_operator_cost_one_product_each() -> None:
    counted = Counted(SMALL)
    assert solvers.gauss_seidel(counted, RIGHT, tolerance=1e-10).converged
    assert counted.count < 12 + 30


@pytest.mark.parametrize("scale", [1e-30, 1e-9, 1.0, 3e8, 1e40])
def test_the_size_of_a_system_does_not_matter(scale: float) -> None:
    matrix = scale * (SMALL + np.triu(0.01 * RNG.random((12, 12)), 1))
    for system in (matrix, Counted(matrix)):
        answer = solvers.gmres(system, RIGHT, tolerance=1e-12)
        assert answer.converged and np.allclose(
            scale * answer.x, np.linalg.solve(matrix / scale, RIGHT), rtol=1e-9
        )
        residual = np.linalg.norm(RIGHT - matrix @ answer.x) / np.linalg.norm(RIGHT)
        assert residual < 1e-11


def test_complex_systems_and_several_sides() -> None:
    matrix = SMALL + 0.1j * np.diag(RNG.random(12))
    sides = RNG.random((12, 3)) + 1j * RNG.random((12, 3))
    answer = solvers.gmres(matrix, sides, tolerance=1e-12, restart=12)
    assert answer.x.shape == (12, 3) and answer.residuals.shape[1] == 3
    assert np.allclose(matrix @ answer.x, sides)
    assert np.allclose(solvers.lu(matrix, RIGHT).x, np.linalg.solve(matrix, RIGHT))


def test_options_start_and_history() -> None:
    answer = solvers.sor(SMALL, RIGHT, omega=1.05, x0=np.ones(12), tolerance=1e-9)
    assert answer.converged and answer.residuals[-1, 0] <= 1e-9 and answer.iterations > 1
    started = solvers.gmres(SMALL, RIGHT, x0=np.linalg.solve(SMALL, RIGHT), tolerance=1e-9)
    assert started.iterations == 0


WRONG: Any = [
    (lambda: solvers.gmres(SMALL, RIGHT[:5]), "b has the shape (5,)"),
    (lambda: solvers.gmres(SMALL[:3], RIGHT), "A has the shape (3, 12)"),
    (lambda: solvers.gmres(SMALL, RIGHT, omega=2), "no option"),
    (lambda: solvers.cholesky(np.triu(SMALL), RIGHT), "symmetric"),
    (lambda: solvers.gmres(np.full((2, 2), np.nan), [1, 2]), "not finite"),
    (lambda: solvers.gmres(SMALL, RIGHT, tolerance=2), "tolerance is 2"),
    (lambda: solvers.solve("magic", SMALL, RIGHT), "no solver 'magic'"),
    (lambda: solvers.lu([[1.0, 1.0], [1.0, 1.0]], [1.0, 2.0]), "singular"),
]


@pytest.mark.parametrize("call, text", WRONG)
def test_wrong_calls(call: Any, text: str) -> None:
    with pytest.raises(fredholm.FredholmError) as raised:
        call()
    assert text in str(raised.value)


def test_what_an_operator_raises_is_raised() -> None:
    class Broken:
        shape, calls = (2, 2), 0

        def matvec(self, x: Any) -> Any:
            self.calls += 1
            if self.calls > 2:
                raise ZeroDivisionError("the third product")
            return x * np.array([1.0, 2.0])

    class Short:
        shape, calls = (2, 2), 0

        def matvec(self, x: Any) -> Any:
            self.calls += 1
            return x if self.calls == 1 else x[:1]

    with pytest.raises(ZeroDivisionError, match="the third product"):
        solvers.gmres(Broken(), [1.0, 2.0])
    with pytest.raises(ValueError, match="matvec returned 1 numbers"):
        solvers.gmres(Short(), [1.0, 2.0])
    with pytest.raises(AttributeError, match="there is no solver 'magic'"):
        solvers.magic  # noqa: B018
