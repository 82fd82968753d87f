"""A day of a user of SciPy: sparse view factors, eigenvalues of a coupling, a solver on an
operator."""

import pathlib

import numpy as np
import pytest
from conftest import FURNACE

import fredholm
from fredholm import solvers

sparse = pytest.importorskip("scipy.sparse")
linalg = pytest.importorskip("scipy.sparse.linalg")


@pytest.fixture(scope="module")
def couplings() -> fredholm.Couplings:
    return fredholm.Scene.from_toml(FURNACE).couplings(form_factor_tolerance=1e-6)


def test_view_factors_as_a_sparse_matrix(scenes: pathlib.Path) -> None:
    scene = fredholm.Scene.load(scenes / "leblond_room.toml")
    kept = scene.view_factors(rows="element", threshold=1e-3)
    whole = scene.view_factors(rows="element")
    matrix = kept.sparse
    assert sparse.issparse(matrix) and 0 < matrix.nnz < whole.dense.size
    assert matrix.data.ctypes.data == kept._core.address()
    assert np.array_equal(matrix.toarray(), np.where(whole.dense >= 1e-3, whole.dense, 0.0))
    assert np.array_equal(matrix.toarray(), kept.dense)
    assert np.allclose(kept.row_sum - kept.row_dropped, matrix.sum(axis=1))
    assert kept.errors.shape == (matrix.nnz,)


def test_eigenvalues_of_a_coupling(couplings: fredholm.Couplings) -> None:
    operator = linalg.aslinearoperator(couplings.symmetric)
    found = linalg.eigsh(operator, k=4, return_eigenvectors=False)
    expected = np.linalg.eigvalsh(couplings.symmetric.toarray())[-4:]
    assert np.allclose(np.sort(found), expected, atol=1e-9)
    # The rows of F sum to 1 in a closed room, so that its largest eigenvalue is 1.
    assert abs(found.max() - 1.0) < 1e-5


def test_operators_are_what_they_say(couplings: fredholm.Couplings) -> None:
    exchange, area = couplings.exchange.toarray(), couplings.area
    assert np.array_equal(exchange, exchange.T)
    assert np.allclose(couplings.view_factors.toarray(), exchange / area[:, None])
    symmetric = exchange / np.sqrt(np.outer(area, area))
    assert np.allclose(couplings.symmetric.toarray(), symmetric, rtol=1e-12)
    expected = np.eye(len(area)) - couplings.reflectance[:, :1] * exchange / area[:, None]
    assert np.allclose(couplings.system(0).toarray(), expected, rtol=1e-12)
    x = np.arange(float(len(area)))
    for coupling in (couplings.view_factors, couplings.system()):
        assert np.allclose(coupling.rmatvec(x), coupling.toarray().T @ x)
        assert np.allclose(linalg.aslinearoperator(coupling).rmatvec(x), coupling.toarray().T @ x)
    with pytest.raises(fredholm.InputError, match="no band 1"):
        couplings.system(1)


def test_solvers_of_both_on_operators_of_both(couplings: fredholm.Couplings) -> None:
    system, emitted = couplings.system(), couplings.exitance[:, 0]
    ours = solvers.gmres(linalg.aslinearoperator(system), emitted, tolerance=1e-12)
    theirs, failed = linalg.gmres(linalg.aslinearoperator(system), emitted, rtol=1e-12, atol=0.0)
    assert ours.converged and failed == 0
    assert np.allclose(ours.x, theirs, rtol=1e-9) and np.allclose(ours.x, 4.0, rtol=1e-4)
    assert np.allclose(solvers.bicgstab(system, emitted, tolerance=1e-12).x, theirs, rtol=1e-9)


def test_a_sparse_matrix_is_taken() -> None:
    matrix = sparse.diags([4.0, -1.0, -1.0], [0, 1, -1], shape=(50, 50)).tocsr()
    answer = solvers.gmres(matrix, np.ones(50), tolerance=1e-12)
    assert answer.converged and np.allclose(matrix @ answer.x, 1.0)
