"""Scenes: from files, or built from arrays."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, _options
from ._coupling import Couplings
from ._errors import wrong
from ._options import Memory, Path, Progress
from ._solution import Solution, solved
from ._studies import LightStudies
from ._viewfactors import ViewFactors, view_factors

#: One number for all bands, one for each, or a number by the name of the band.
PerBand = Union[float, Sequence[float], Mapping[str, float]]


@dataclass(frozen=True)
class Material:
    """A diffuse (Lambertian) material.

    Parameters
    ----------
    reflectance : float, sequence of float, or mapping
        Share of the arriving light that is reflected, from 0 to below 1: one number for all bands,
        a list in the order of the bands, or numbers by the names of the bands.
    exitance : float, sequence of float, or mapping
        Power that the surface emits by itself, W/m²; its radiance is exitance/π.
    """

    reflectance: PerBand
    exitance: PerBand = 0.0


@dataclass(frozen=True)
class Surface:
    """A named surface of a scene that is built.

    Parameters
    ----------
    name : str
        Its name; no two surfaces have the same.
    mesh : object
        A pair (vertices, faces), or what trimesh, meshio or PyVista make: an object with
        ``vertices`` and ``faces``, with ``points`` and ``cells``, or with ``points`` and ``faces``.
        Vertices are an array (n, 3), m. Faces are an array (m, 3) or (m, 4) of indices of vertices,
        or a list of such lists of any length; they run counter-clockwise seen from the lit side.
    material : str, optional
        Name of its material; of waves, a perfect conductor where it is left out.
    two_sided : bool
        Whether it is lit on both sides; the back is then a surface called NAME/back.
    largest_edge : float, optional
        Faces are cut so that no edge is longer, m. Where it is left out they are not, and those of
        waves as the frequency asks for.
    elements_per_face : int, optional
        Elements that every face is computed on, a square number. That of the scene where it is left
        out.
    """

    name: str
    mesh: Any
    material: Optional[str] = None
    two_sided: bool = False
    largest_edge: Optional[float] = None
    elements_per_face: Optional[int] = None


class Scene(LightStudies):
    """Surfaces, what they are made of, and how to look at them.

    Made by :meth:`load`, :meth:`from_toml` or :meth:`build`.
    """

    def __init__(self, core: _core.Scene, text: Optional[str], files: Mapping[str, bytes]) -> None:
        self._core, self._text, self._files = core, text, dict(files)

    @classmethod
    def load(cls, path: Path) -> Scene:
        """Reads a scene file (.toml), or a mesh file that stands for a scene.

        Parameters
        ----------
        path : str or path
            The file.

        Raises
        ------
        InputError
            What is wrong with it, with ``file``, ``line``, ``column`` and ``help``.
        FileError
            It cannot be read.
        """
        return cls(_core.Scene.load(os.fspath(path)), None, {})

    @classmethod
    def from_toml(
        cls, text: str, path: Path = "scene.toml", files: Optional[Mapping[str, bytes]] = None
    ) -> Scene:
        """Reads a scene from the text of a scene file.

        Parameters
        ----------
        text : str
            The text.
        path : str or path
            What errors call it; files that it names are looked for in the folder of this path.
        files : mapping of str to bytes, optional
            Files that are there already, by the names that the text has for them.
        """
        given = dict(files or {})
        return cls(_core.Scene.from_memory(text, os.fspath(path), given), text, given)

    @classmethod
    def build(
        cls,
        surfaces: Sequence[Surface],
        materials: Mapping[str, Material],
        *,
        bands: Optional[Sequence[str]] = None,
        title: Optional[str] = None,
        elements_per_face: int = 1,
        camera: Optional[Mapping[str, Any]] = None,
    ) -> Scene:
        """Makes a scene from arrays.

        Parameters
        ----------
        surfaces : sequence of Surface
            The surfaces.
        materials : mapping of str to Material
            The materials by name.
        bands : sequence of str, optional
            Names of the bands of light; one band, "grey", where it is left out.
        title : str, optional
            What the scene is called.
        elements_per_face : int
            Elements that every face is computed on, a square number.
        camera : mapping, optional
            ``eye``, ``target`` and, where wanted, ``up``, ``vertical_fov_degrees``, ``width``,
            ``height`` and ``exposure``, as scene files have them.

        Examples
        --------
        >>> floor = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
        >>> lamp = ([[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], [[0, 1, 2, 3]])
        >>> scene = Scene.build(
        ...     [Surface("floor", floor, "grey"), Surface("lamp", lamp, "lamp")],
        ...     {"grey": Material(0.5), "lamp": Material(0.0, exitance=1.0)},
        ... )
        """
        head: Dict[str, Any] = {"elements_per_face": elements_per_face}
        if title is not None:
            head["title"] = title
        if bands is not None:
            head["bands"] = list(bands)
        lines = [f"{key} = {_toml(value)}" for key, value in head.items()]
        if camera is not None:
            lines += ["[camera]"] + [f"{key} = {_toml(value)}" for key, value in camera.items()]
        for name, material in materials.items():
            lines += [f"[materials.{_toml(name)}]", f"reflectance = {_toml(material.reflectance)}"]
            lines += [f"exitance = {_toml(material.exitance)}"]
        text, files = with_surfaces("\n".join(lines) + "\n", surfaces, "largest_edge")
        return cls.from_toml(text, "built.toml", files)

    @property
    def path(self) -> str:
        """The file, as it was named."""
        return str(self._core.path)

    @property
    def title(self) -> Optional[str]:
        """What the scene is called."""
        return self._core.title

    @property
    def bands(self) -> List[str]:
        """Names of the bands, in the order of the last axis of all arrays."""
        return self._core.bands

    @property
    def materials(self) -> Dict[str, Material]:
        """The materials by name, with a number for each band."""
        return {name: Material(rho, exitance) for name, rho, exitance in self._core.materials}

    @property
    def sha256(self) -> str:
        """SHA-256 of the scene file and of the files it names, in hexadecimal."""
        return self._core.sha256

    @property
    def notes(self) -> List[str]:
        """What was taken from material libraries, and what was mended in mesh files."""
        return self._core.notes

    @property
    def elements(self) -> int:
        """Number of elements that the mesh will have."""
        return self._core.predicted[0]

    @property
    def faces(self) -> int:
        """Number of faces that the mesh will have."""
        return self._core.predicted[1]

    def save(self, folder: Path) -> str:
        """Writes a scene that was built, and its meshes, for the command line; returns the scene
        file.

        Parameters
        ----------
        folder : str or path
            The folder, made where it does not exist.
        """
        if self._text is None:
            raise wrong(
                f"the scene is a file already: {self.path}", "copy that file and those it names"
            )
        os.makedirs(folder, exist_ok=True)
        for name, data in self._files.items():
            _write(os.path.join(folder, name), data)
        path = os.path.join(folder, os.path.basename(self.path))
        _write(path, self._text.encode())
        return path

    def solve(
        self,
        *,
        accuracy: Optional[float] = None,
        way: Optional[str] = None,
        goal: Union[str, Sequence[str]] = (),
        solver: Optional[str] = None,
        discretisation: Optional[str] = None,
        tolerance: Optional[float] = None,
        max_iterations: Optional[int] = None,
        form_factor_tolerance: Optional[float] = None,
        storage: Optional[str] = None,
        final_gather: bool = False,
        false_colour: Union[bool, str] = False,
        discontinuity: bool = False,
        pictures: bool = True,
        report: bool = True,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Solution:
        """Computes the light. What is left out is as the scene says, else as usual.

        Parameters
        ----------
        accuracy : float, optional
            Relative error of the irradiance of the faces to reach, above 0 and below 1; the
            elements are then chosen where they are needed. Left out: the elements of the scene.
        way : {"links", "rays"}, optional
            How the accuracy is reached: by hierarchical radiosity, or by rays from the elements
            of the scene; left out, as is predicted to cost about the least.
        goal : str or sequence of str
            Surfaces whose mean irradiance is to have the accuracy; all else is only as exact as
            that needs.
        solver, discretisation : str, optional
            Their names.
        tolerance : float, optional
            Relative residual ‖b − A x‖₂/‖b‖₂ to reach in every band; 1e-10.
        max_iterations : int, optional
            Iterations allowed; 1000.
        form_factor_tolerance : float, optional
            Error asked for in a row of form factors; 1e-3.
        storage : {"f64", "f32"}, optional
            Number format of the stored matrix.
        final_gather, discontinuity, pictures, report : bool
            What :meth:`Solution.write` makes: a picture whose pixels gather their light, elements
            cut along the borders of shadows, pictures at all, and the page report.html.
        false_colour : bool or str
            Whether :meth:`Solution.write` also draws the irradiance in false colour, of all bands
            together, or of the band named.
        threads : int, optional
            Threads; one a core. Any number gives the same results.
        memory : int or str, optional
            Memory allowed, bytes or such as "4GiB"; most of what the machine has left.
        progress : bool or callable, optional
            Whether progress is shown; where it is left out, on terminals and in notebooks. A
            callable is told of it: (event, stage, share, text).

        Returns
        -------
        Solution
            The light of elements, faces and surfaces with its stated errors.

        Raises
        ------
        ResourceError
            What is asked for does not fit the memory; none of it was taken.
        Interrupted
            Ctrl-C, within a second; ``partial`` is a :class:`Solution` where there is an iterate.
        """
        _options.share("accuracy", accuracy)
        asked = {
            "accuracy": accuracy,
            "way": way,
            "goal": _options.texts(goal),
            "final_gather": final_gather,
            "false_colour": "" if false_colour is True else false_colour or None,
            "discontinuity": discontinuity,
            "pictures": pictures,
            "report": report,
            "problem": _options.problem(
                threads, discretisation, solver, form_factor_tolerance, storage, memory
            ),
            "stop": _options.stop(tolerance, max_iterations),
        }
        how = _options.how(threads, progress)
        return solved(lambda: _core.solve(self._core, asked, how), self.materials)

    def couplings(
        self,
        *,
        form_factor_tolerance: Optional[float] = None,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Couplings:
        """Computes what the elements of the scene exchange, as operators for SciPy.

        Parameters
        ----------
        form_factor_tolerance, threads, memory, progress
            As for :meth:`solve`.

        Examples
        --------
        >>> from scipy.sparse.linalg import aslinearoperator, eigsh
        >>> found = scene.couplings()
        >>> eigsh(aslinearoperator(found.symmetric), k=3, return_eigenvectors=False)
        """
        problem = _options.problem(threads, None, None, form_factor_tolerance, None, memory)
        how = _options.how(threads, progress)
        return Couplings(_core.couplings(self._core, problem, how), self.bands)

    def view_factors(
        self,
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
        """Computes the matrix of view factors; the arguments are those of
        :func:`fredholm.view_factors`."""
        return view_factors(
            self._core,
            rows=rows,
            tolerance=tolerance,
            method=method,
            setting=setting,
            threshold=threshold,
            close=close,
            sky=sky,
            points=points,
            threads=threads,
            memory=memory,
            progress=progress,
        )

    def __repr__(self) -> str:
        title = f" {self.title!r}" if self.title else ""
        bands = ", ".join(self.bands[:3]) + (", …" if len(self.bands) > 3 else "")
        return (
            f"<Scene{title} from {self.path}: {self.faces} faces, {self.elements} elements, "
            f"{len(self.bands)} band{'s' if len(self.bands) > 1 else ''} ({bands})>"
        )


def _write(path: str, data: bytes) -> None:
    """Writes a file that appears whole or not at all."""
    beside = path + ".part"
    with open(beside, "wb") as file:
        file.write(data)
    os.replace(beside, path)


def _toml(value: Any) -> str:
    """A value as scene files write it."""
    if isinstance(value, Mapping):
        return (
            "{ " + ", ".join(f"{_toml(key)} = {_toml(item)}" for key, item in value.items()) + " }"
        )
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007F")
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return "[" + ", ".join(_toml(item) for item in value) + "]"


def with_surfaces(
    text: str, surfaces: Sequence[Surface], edge: str
) -> Tuple[str, Dict[str, bytes]]:
    """A scene file with tables for some surfaces at its end, in which ``edge`` is the key of the
    longest edge, and their mesh files by name."""
    files = {f"surface{number}.obj": _obj(surface) for number, surface in enumerate(surfaces)}
    lines = [text]
    for surface, file in zip(surfaces, files):
        lines += _surface(surface, file, edge)
    return "\n".join(lines) + "\n", files


def _surface(surface: Surface, file: str, edge: str) -> List[str]:
    """The lines of a surface."""
    lines = ["[[surface]]", f"name = {_toml(surface.name)}"]
    if surface.material is not None:
        lines += [f"material = {_toml(surface.material)}"]
    lines += [f"mesh = {{ file = {_toml(file)} }}"]
    if surface.two_sided:
        lines += ["two_sided = true"]
    if surface.largest_edge is not None:
        lines += [f"{edge} = {_toml(surface.largest_edge)}"]
    if surface.elements_per_face is not None:
        lines += [f"elements_per_face = {_toml(surface.elements_per_face)}"]
    return lines


def _obj(surface: Surface) -> bytes:
    """A surface as an OBJ file, in which every number is written in full."""
    vertices, faces = _mesh(surface)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    return ("\n".join(lines) + "\n").encode()


Corners = List[List[int]]


def _mesh(surface: Surface) -> Tuple[NDArray[np.float64], Corners]:
    """Vertices and faces of a surface, checked."""
    name, mesh = surface.name, surface.mesh
    points, faces = _parts(name, mesh)
    vertices = np.asarray(points, dtype=np.float64)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise wrong(
            f"the vertices of `{name}` have the shape {vertices.shape}", "give an array (n, 3), m"
        )
    if not np.isfinite(vertices).all():
        at = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise wrong(f"vertex {at} of `{name}` is not a finite number", "remove or correct it")
    if not faces:
        raise wrong(f"`{name}` has no faces", "give a list of triangles, quads or polygons")
    for number, face in enumerate(faces):
        if len(face) < 3 or min(face) < 0 or max(face) >= len(vertices):
            text = f"face {number} of `{name}` is {face}, where there are {len(vertices)} vertices"
            raise wrong(text, f"give three or more indices from 0 to {len(vertices) - 1}")
    return vertices, faces


def _parts(name: str, mesh: Any) -> Tuple[ArrayLike, Corners]:
    """Points and faces of what libraries call a mesh."""
    if hasattr(mesh, "cells") and hasattr(mesh, "points") and not hasattr(mesh, "regular_faces"):
        return mesh.points, _cells(name, mesh.cells)
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):
        return mesh.points, _counted(mesh.faces)
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, _listed(name, mesh.faces)
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return mesh[0], _listed(name, mesh[1])
    help = "give (vertices, faces), or a mesh of trimesh, meshio or PyVista"
    raise wrong(f"the mesh of `{name}` is a {type(mesh).__name__}", help)


def _listed(name: str, faces: Any) -> Corners:
    try:
        return [[_index(corner) for corner in face] for face in np.asarray(faces).tolist()]
    except (TypeError, ValueError):
        pass
    try:
        return [[_index(corner) for corner in face] for face in faces]
    except (TypeError, ValueError):
        raise wrong(
            f"the faces of `{name}` are no lists of indices", "give (m, 3), or lists"
        ) from None


def _index(corner: Any) -> int:
    """An index, which is a whole number."""
    if int(corner) != corner:
        raise ValueError(corner)
    return int(corner)


def _cells(name: str, cells: Any) -> Corners:
    """Cells of meshio: blocks of triangles, quads and polygons; others bound no surface."""
    faces: Corners = []
    for block in cells:
        kind = getattr(block, "type", None)
        if kind in ("triangle", "quad", "polygon"):
            faces += _listed(name, block.data)
        elif kind not in ("line", "vertex"):
            help = "extract the surface first; lines and vertices are passed over"
            raise wrong(f"`{name}` has cells of the type {kind!r}", help)
    return faces


def _counted(faces: Any) -> Corners:
    """Faces of PyVista: the number of corners before the corners of each face."""
    flat, at, found = np.asarray(faces).ravel().tolist(), 0, []
    while at < len(flat):
        count = flat[at]
        found.append([int(corner) for corner in flat[at + 1 : at + 1 + count]])
        at += 1 + count
    return found
