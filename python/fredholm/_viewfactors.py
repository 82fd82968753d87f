"""The matrix of view factors."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _html, _options
from ._errors import FredholmWarning, wrong
from ._options import Memory, Path, Progress

if TYPE_CHECKING:
    from ._scene import Scene

Floats = NDArray[np.float64]


def view_factor_methods() -> List[str]:
    """Names of the methods: "row-budget", the usual one, to a tolerance of rows, "auto", the same to
    one of pairs, and those that are there for study."""
    return _core.methods()


def view_factors(
    source: Union[Scene, _core.Scene, Path],
    *,
    rows: str = "face",
    tolerance: Optional[float] = None,
    method: str = "row-budget",
    setting: Optional[str] = None,
    threshold: Optional[float] = None,
    close: bool = False,
    sky: bool = False,
    points: Optional[ArrayLike] = None,
    threads: Optional[int] = None,
    memory: Memory = None,
    progress: Progress = None,
) -> ViewFactors:
    """Computes the matrix of view factors of a scene or of a mesh file, whose faces are the
    patches.

    Parameters
    ----------
    source : Scene, str or path
        A scene, or the file of one or of a mesh.
    rows : {"face", "element", "surface"}
        What a row stands for.
    tolerance : float, optional
        Error asked for in a row, of "auto" in a pair; 1e-3.
    method : str
        One of :func:`view_factor_methods`.
    setting : str, optional
        Setting of a method for study: its order, tolerance, samples or pixels.
    threshold : float, optional
        Least factor that is kept; what a row drops is stated. All are kept where it is left out.
    close : bool
        Whether the factors are changed so that every row sums to 1; the change is stated.
    sky : bool
        Whether the sky is the last row and column.
    points : array_like, shape (n, 6), optional
        Points (m) and their normals, which see the surfaces.
    threads, memory, progress
        As for :meth:`Scene.solve`.

    Returns
    -------
    ViewFactors
        The matrix with its stated errors.
    """
    _options.share("tolerance", tolerance)
    _options.known(method, view_factor_methods(), "method")
    if threshold is not None and not 0.0 < threshold < 1.0:
        raise wrong(f"threshold is {threshold}", "give a threshold above 0 and below 1")
    places = np.zeros((0, 6)) if points is None else np.asarray(points, dtype=np.float64)
    if places.ndim != 2 or places.shape[1] != 6:
        raise wrong(f"points have the shape {places.shape}", "give (n, 6): x, y, z and the normal")
    asked = {
        "tolerance": tolerance,
        "method": method,
        "setting": setting,
        "rows": rows,
        "threshold": threshold,
        "close": close,
        "sky": sky,
        "points": places.tolist(),
        "problem": _options.problem(threads, memory=memory),
    }
    given = source if isinstance(source, _core.Scene) else getattr(source, "_core", None)
    given = given or os.fspath(source)  # type: ignore[arg-type]
    return ViewFactors(_core.view_factors(given, asked, _options.how(threads, progress)))


class ViewFactors:
    """View factors between surfaces. Made by :func:`view_factors`.

    Attributes
    ----------
    names : list of str
        Names of the rows.
    area : ndarray, shape (rows,)
        Areas, m².
    row_error : ndarray, shape (rows,)
        Stated error of the sum of each row: an estimate.
    row_sum : ndarray, shape (rows,)
        Sum of each row, with what was dropped; 1 in a closed scene.
    row_dropped : ndarray, shape (rows,)
        Sum of what each row dropped because of the threshold.
    points : ndarray, shape (points, rows), or None
        What the points see.
    record : dict
        What made the matrix.
    """

    def __init__(self, core: _core.ViewFactors) -> None:
        self._core, self.names = core, core.names
        self.area, self.row_error, self.row_sum, self.row_dropped = core.rows.T
        self.points: Optional[Floats] = core.points
        self.record: Dict[str, Any] = _options.record(core.record)
        for warning in self.warnings:
            warnings.warn(warning, FredholmWarning, stacklevel=4)

    @property
    def shape(self) -> Tuple[int, int]:
        """(rows, rows)."""
        return (len(self.names), len(self.names))

    @property
    def warnings(self) -> List[str]:
        """What the user should know of the matrix."""
        return list(self.record["warnings"])

    @property
    def dense(self) -> Floats:
        """F: ndarray, shape (rows, rows), dimensionless. Where all factors are kept it is the
        memory in which they were computed, and cannot be written to; else a new array."""
        whole = self._core.dense
        if whole is not None:
            return whole
        starts, columns, values = self._kept()
        found = np.zeros(self.shape)
        found[np.repeat(np.arange(len(self.names)), np.diff(starts)), columns] = values
        return found

    @property
    def errors(self) -> NDArray[np.float32]:
        """Stated error of every stored factor, in their order: ndarray, shape (stored,)."""
        return self._core.errors[:, 0]

    @property
    def sparse(self) -> Any:
        """F as a ``scipy.sparse.csr_array`` (``csr_matrix`` of old SciPy) of the factors that are
        kept."""
        from scipy import sparse

        make = getattr(sparse, "csr_array", sparse.csr_matrix)
        kept = self._core.sparse
        if kept is None:
            return make(self.dense)
        starts, columns, values = self._kept()
        return make((values, columns, starts), shape=self.shape)

    def _kept(self) -> Tuple[NDArray[np.int64], NDArray[np.int32], Floats]:
        kept = self._core.sparse
        assert kept is not None
        starts, columns, values = kept
        return starts, columns, values[:, 0]

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> Any:
        """F as NumPy asks for it."""
        return (
            np.array(self.dense, dtype=dtype, copy=True) if copy else np.asarray(self.dense, dtype)
        )

    def write(self, file: Path) -> None:
        """Writes the matrix in the form of the ending of the name (.npz, .csv, .txt, .out or .vf),
        and a picture, a plot and the record beside it.

        Parameters
        ----------
        file : str or path
            The file of the matrix.
        """
        self._core.write(os.fspath(file))

    def to_pandas(self) -> Any:
        """F as a ``pandas.DataFrame`` whose rows and columns have the names."""
        import pandas

        return pandas.DataFrame(self.dense, index=self.names, columns=self.names)

    def to_xarray(self) -> Any:
        """F as an ``xarray.DataArray`` over ``source`` and ``receiver``."""
        import xarray

        coords = {"source": self.names, "receiver": self.names, "area": ("source", self.area)}
        return xarray.DataArray(self.dense, coords, ("source", "receiver"), "view factor")

    def _facts(self) -> List[Tuple[str, str]]:
        closure = self.record["closure"]["max"]
        facts = [
            ("rows", str(len(self.names))),
            ("stored", str(self.record["counts"]["stored"])),
            (
                "stated error",
                f"{float(np.max(self.row_error, initial=0.0)):.1e} of a row at most, an estimate",
            ),
        ]
        if closure is not None:
            facts.append(("closure", f"row sums differ from 1 by {closure:.1e} at most"))
        return facts + [("warning", warning) for warning in self.warnings]

    def __repr__(self) -> str:
        lines = [f"  {label:<14}{text}" for label, text in self._facts()]
        return "\n".join([f"<ViewFactors of {self.record['input']}>", *lines])

    def _repr_html_(self) -> str:
        rows = [
            (name, f"{area:.4g}", f"{total:.6f}", f"{error:.1e}")
            for name, area, total, error in zip(self.names, self.area, self.row_sum, self.row_error)
        ]
        table = _html.table(("row", "area, m²", "sum", "stated error"), rows)
        return _html.panel(str(self.record["input"]), self._facts(), table)
