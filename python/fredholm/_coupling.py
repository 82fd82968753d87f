"""The couplings of a scene, as operators that SciPy takes."""

from __future__ import annotations

from typing import List, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core

Floats = NDArray[np.float64]


class Coupling:
    """A linear operator on the values of the elements of a scene.

    It has what ``scipy.sparse.linalg.aslinearoperator`` asks for, and is taken by
    :mod:`fredholm.solvers`. Its entries are stored once, as the lower triangle of a symmetric
    matrix; all operators of a scene share them.

    Attributes
    ----------
    shape : tuple of int
        (elements, elements).
    dtype : numpy.dtype
        float64.
    """

    def __init__(self, core: _core.Coupling) -> None:
        self._core = core
        self.shape: Tuple[int, int] = core.shape
        self.dtype: np.dtype[np.float64] = np.dtype(np.float64)

    def matmat(self, x: ArrayLike) -> Floats:
        """The product with each column of an array (elements, k)."""
        return self._core.matmat(np.ascontiguousarray(x, dtype=np.float64))

    def rmatmat(self, x: ArrayLike) -> Floats:
        """The product of the transposed operator with each column of an array (elements, k)."""
        return self._core.rmatmat(np.ascontiguousarray(x, dtype=np.float64))

    def matvec(self, x: ArrayLike) -> Floats:
        """The product with a vector (elements,) or (elements, 1), in the shape of it."""
        vector = np.asarray(x, dtype=np.float64)
        return self.matmat(vector.reshape(-1, 1)).reshape(vector.shape)

    def rmatvec(self, x: ArrayLike) -> Floats:
        """The product of the transposed operator with a vector (elements,) or (elements, 1)."""
        vector = np.asarray(x, dtype=np.float64)
        return self.rmatmat(vector.reshape(-1, 1)).reshape(vector.shape)

    def __matmul__(self, x: ArrayLike) -> Floats:
        """The product with a vector or with each column of a matrix."""
        return self.matvec(x) if np.ndim(x) == 1 else self.matmat(x)

    def toarray(self) -> Floats:
        """All entries: ndarray, shape (elements, elements)."""
        return self.matmat(np.eye(self.shape[0]))

    def __repr__(self) -> str:
        return f"<Coupling of {self.shape[0]} elements>"


class Couplings:
    """What the elements of a scene exchange. Made by :meth:`fredholm.Scene.couplings`.

    Attributes
    ----------
    exchange : Coupling
        G with G_ij = A_i F_ij, m²: symmetric.
    view_factors : Coupling
        F, dimensionless: the share of what leaves element i that reaches element j.
    symmetric : Coupling
        A^(−1/2) G A^(−1/2), dimensionless: symmetric, with the eigenvalues of F.
    area : ndarray, shape (elements,)
        Areas A, m².
    reflectance : ndarray, shape (elements, bands)
        Reflectances ρ.
    exitance : ndarray, shape (elements, bands)
        What the elements emit, M, W/m²: the right-hand side of (I − R F) B = M.
    row_error : ndarray, shape (elements,)
        Stated error of each row of F: an estimate of Σ_j |ΔF_ij|.
    bands : list of str
        Names of the bands.
    """

    def __init__(self, core: _core.Couplings, bands: List[str]) -> None:
        self._core, self.bands = core, bands
        self.exchange = Coupling(core.exchange())
        self.view_factors = Coupling(core.view_factors())
        self.symmetric = Coupling(core.symmetric())
        self.area, self.row_error = core.area, core.row_error
        self.reflectance, self.exitance = core.reflectance, core.exitance

    def system(self, band: int = 0) -> Coupling:
        """I − R F of a band, the matrix of the radiosity: (I − R F) B = M.

        Parameters
        ----------
        band : int
            Number of the band, from 0.
        """
        return Coupling(self._core.system(band))

    def __repr__(self) -> str:
        return f"<Couplings of {self.area.size} elements, {len(self.bands)} bands>"
