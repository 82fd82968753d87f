"""The light of a solved scene."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, Mapping, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _core, _html, _options
from ._errors import FredholmWarning, Interrupted, wrong
from ._options import Path

if TYPE_CHECKING:
    from ._scene import Material

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class SurfaceLight:
    """The light of a surface.

    Attributes
    ----------
    name : str
        Name of the surface.
    irradiance : ndarray, shape (bands,)
        Mean irradiance over the surface, W/m².
    error : ndarray, shape (bands,)
        Its stated error, W/m²: an estimate. NaN where the solution states none.
    """

    name: str
    irradiance: Floats
    error: Floats


@dataclass(frozen=True)
class Faces:
    """The light of the faces of a scene, which results are reported for.

    Attributes
    ----------
    surface : ndarray of int, shape (faces,)
        Number of the surface of each.
    area : ndarray, shape (faces,)
        Areas, m².
    centroid : ndarray, shape (faces, 3)
        Centroids, m.
    irradiance, radiosity : ndarray, shape (faces, bands)
        Means over the faces, W/m²: the numbers of faces.csv.
    error : ndarray, shape (faces, bands), or None
        Stated error of the irradiance, W/m²: an estimate. None where the solution states none.
    """

    surface: Ints
    area: Floats
    centroid: Floats
    irradiance: Floats
    radiosity: Floats
    error: Optional[Floats]


def solved(run: Callable[[], _core.Solved], materials: Mapping[str, Material]) -> Solution:
    """The solution of a run; what Ctrl-C leaves of it is a solution, too."""
    try:
        found = Solution(run(), materials)
    except Interrupted as stop:
        if stop.partial is not None:
            stop.partial = Solution(stop.partial, materials)
        raise
    for remark in found._core.remarks:
        warnings.warn(remark, FredholmWarning, stacklevel=3)
    return found


class Solution:
    """The light of a scene, with its stated errors. Made by :meth:`fredholm.Scene.solve`.

    The arrays of elements are the memory in which the solver left its answer: they are not copied,
    and cannot be written to.
    """

    def __init__(self, core: _core.Solved, materials: Mapping[str, Material]) -> None:
        self._core, self._materials = core, list(materials)
        self.record: Dict[str, Any] = _options.record(core.record)
        """What made the result, as run.json has it."""

    @property
    def irradiance(self) -> Floats:
        """Mean irradiance of the elements, W/m²: ndarray, shape (elements, bands), read-only."""
        return self._core.irradiance

    @property
    def radiosity(self) -> Floats:
        """Mean radiosity of the elements, W/m²: ndarray, shape (elements, bands), read-only."""
        return self._core.radiosity

    @property
    def area(self) -> Floats:
        """Areas of the elements, m²: ndarray, shape (elements,)."""
        return self._core.area[:, 0]

    @property
    def centroid(self) -> Floats:
        """Centroids of the elements, m: ndarray, shape (elements, 3)."""
        return self._core.centroid

    @property
    def normal(self) -> Floats:
        """Unit normals of the lit sides: ndarray, shape (elements, 3)."""
        return self._core.normal

    @property
    def face(self) -> Ints:
        """Face of every element: ndarray of int, shape (elements,)."""
        return self._core.indices[:, 1]

    @property
    def surface_of_element(self) -> Ints:
        """Number of the surface of every element: ndarray of int, shape (elements,)."""
        return self._core.indices[:, 2]

    @property
    def polygons(self) -> Tuple[Floats, Ints]:
        """Corners of the elements.

        Returns
        -------
        corners : ndarray, shape (sum of corners, 3)
            The corners of one element after the other, m.
        starts : ndarray of int, shape (elements + 1,)
            Element i has the corners ``starts[i]:starts[i + 1]``.
        """
        starts = np.concatenate([[0], np.cumsum(self._core.indices[:, 0])]).astype(np.int64)
        return self._core.corners, starts

    @property
    def faces(self) -> Faces:
        """The light of the faces."""
        faces, (irradiance, radiosity) = self._core.faces, self._core.face_means
        surface = self._core.face_surface[:, 0]
        area, centroid, error = faces[:, 0], faces[:, 1:], self._core.face_errors
        return Faces(surface, area, centroid, irradiance, radiosity, error)

    @property
    def bands(self) -> List[str]:
        """Names of the bands, in the order of the last axis."""
        return list(self.record["bands"])

    @property
    def surfaces(self) -> List[str]:
        """Names of the surfaces, by their numbers."""
        return [name for name, _ in self._core.surfaces]

    def __getitem__(self, surface: str) -> SurfaceLight:
        """The light of a surface by its name."""
        _options.known(surface, self.surfaces, "surface")
        found = self._core.surface(surface)
        assert found is not None
        irradiance, error = found
        nothing = [np.nan] * len(irradiance)
        return SurfaceLight(surface, np.array(irradiance), np.array(error or nothing))

    def __iter__(self) -> Iterator[SurfaceLight]:
        """The light of one surface after the other."""
        return (self[name] for name in self.surfaces)

    def __len__(self) -> int:
        """Number of surfaces."""
        return len(self.surfaces)

    @property
    def relative_error(self) -> Optional[float]:
        """Stated relative error of the irradiance of the faces (L², an estimate), or of the goal,
        in the worst band; None where it is not known."""
        return self._core.relative_error

    @property
    def residual(self) -> Floats:
        """Last relative residual ‖b − A x‖₂/‖b‖₂: ndarray, shape (bands,); NaN where there is
        none."""
        last = [band[-1] if band else None for band in self.record["history"]["residual"]]
        return np.array([np.nan if value is None else value for value in last])

    @property
    def iterations(self) -> int:
        """Iterations of the solver."""
        done = self.record["history"]["iterations"]
        return int(done[-1]) if done else 0

    @property
    def ended(self) -> str:
        """ "done", "not converged" (the tolerance or the accuracy was missed), or "interrupted"."""
        return self._core.ended

    @property
    def converged(self) -> bool:
        """Whether what was asked for was met."""
        return self.ended == "done"

    @property
    def warnings(self) -> List[str]:
        """What the user should know of the scene and the result."""
        return list(self.record["warnings"])

    @property
    def counts(self) -> Dict[str, int]:
        """Surfaces, faces, elements, unknowns, occluders, bands and entries of the matrix."""
        return dict(self.record["counts"])

    def picture(self, width: int = 400) -> bytes:
        """A picture of the light as the camera of the scene sees it: a PNG file.

        Parameters
        ----------
        width : int
            Pixels in width, 1 to 16384.
        """
        if not 1 <= width <= 16384:
            raise wrong(f"the picture is {width} pixels wide", "ask for 1 to 16384")
        return self._core.picture(width)

    def write(self, folder: Path) -> None:
        """Writes what the command line writes into a folder, which is made where it does not exist.

        Parameters
        ----------
        folder : str or path
            The folder. run.json is written last: where it stands, the folder is complete.
        """
        self._core.write(os.fspath(folder))

    def page(self, height: int = 600) -> _html.Page:
        """The page report.html, which notebooks show in a frame.

        Parameters
        ----------
        height : int
            Height of the frame in pixels.
        """
        return _html.written(self.write, height)

    def to_pandas(self) -> Any:
        """The faces as a ``pandas.DataFrame``: surface, centroid (m), area (m²), and for every band
        irradiance, radiosity and error of the irradiance (W/m²)."""
        import pandas

        faces, names = self.faces, np.array(self.surfaces, dtype=object)
        columns: Dict[str, Any] = {"surface": names[faces.surface]}
        columns.update({f"c{axis}": faces.centroid[:, at] for at, axis in enumerate("xyz")})
        columns["area"] = faces.area
        for at, band in enumerate(self.bands):
            columns[f"irradiance_{band}"] = faces.irradiance[:, at]
            columns[f"radiosity_{band}"] = faces.radiosity[:, at]
            if faces.error is not None:
                columns[f"error_{band}"] = faces.error[:, at]
        return pandas.DataFrame(columns).rename_axis("face")

    def to_xarray(self) -> Any:
        """The elements as an ``xarray.Dataset`` over ``element`` and ``band``; no values are
        copied."""
        import xarray

        over, one = ("element", "band"), ("element",)
        per_area = {"units": "W/m²"}
        data = {
            "irradiance": (over, self.irradiance, {**per_area, "long_name": "mean irradiance"}),
            "radiosity": (over, self.radiosity, {**per_area, "long_name": "mean radiosity"}),
            "area": (one, self.area, {"units": "m²"}),
            "centroid": (("element", "axis"), self.centroid, {"units": "m"}),
            "face": (one, self.face),
            "surface": (one, np.array(self.surfaces, dtype=object)[self.surface_of_element]),
        }
        coords = {"band": self.bands, "axis": ["x", "y", "z"]}
        facts = {"scene": self.record["scene"], "scene_sha256": self.record["scene_sha256"]}
        return xarray.Dataset(data, coords=coords, attrs=facts)

    def to_pyvista(self) -> Any:
        """The elements as a ``pyvista.PolyData`` with irradiance and radiosity of every band
        (W/m²), and the face and the surface of every cell."""
        import pyvista

        corners, starts = self.polygons
        sizes = np.diff(starts)
        cells = np.insert(np.arange(starts[-1]), starts[:-1], sizes)
        mesh = pyvista.PolyData(corners, faces=cells)
        for at, band in enumerate(self.bands):
            mesh.cell_data[f"irradiance_{band}"] = self.irradiance[:, at]
            mesh.cell_data[f"radiosity_{band}"] = self.radiosity[:, at]
        mesh.cell_data["face"], mesh.cell_data["surface"] = self.face, self.surface_of_element
        return mesh

    def _facts(self) -> List[Tuple[str, str]]:
        """Sizes and errors in words."""
        counts, error = self.counts, self.relative_error
        residual = np.nanmax(self.residual) if np.isfinite(self.residual).any() else np.nan
        stated = (
            "not known"
            if error is None
            else f"{100 * error:.2g} % (L² over the faces, an estimate)"
        )
        facts = [
            ("ended", self.ended),
            (
                "size",
                ", ".join(
                    f"{counts[of]} {of}" for of in ("elements", "faces", "surfaces", "bands")
                ),
            ),
            ("stated error", stated),
            (
                "residual",
                f"{residual:.1e} after {self.iterations} iterations of {self.record['solver']}",
            ),
        ]
        closure = self.record["closure"]["max"]
        if closure is not None:
            facts.append(("closure", f"row sums differ from 1 by {closure:.1e} at most"))
        if self.record.get("choice"):
            facts.append(("way", str(self.record["choice"])))
        return facts + [("warning", warning) for warning in self.warnings]

    def __repr__(self) -> str:
        lines = [f"  {label:<14}{text}" for label, text in self._facts()]
        return "\n".join([f"<Solution of {self.record['scene']}>", *lines])

    def _repr_html_(self) -> str:
        rows = [
            (
                light.name,
                *(f"{value:.4g}" for value in (light.irradiance.mean(), light.error.mean())),
            )
            for light in self
        ]
        table = _html.table(("surface", "irradiance, W/m²", "stated error, W/m²"), rows)
        return _html.panel(str(self.record["scene"]), self._facts(), table, self._picture())

    def _picture(self) -> Optional[bytes]:
        try:
            return self.picture(320)
        except ValueError:
            return None
