"""Scenes of waves: conductors and other bodies in a time-harmonic field, exp(+jωt)."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _core, _html, _options, _studies
from ._errors import FileError, Interrupted
from ._options import Memory, Path, Progress
from ._scene import Surface, with_surfaces

Floats = NDArray[np.float64]
Phasors = NDArray[np.complex128]
Names = NDArray[Any]


@dataclass(frozen=True)
class NearField:
    """The fields at points: peak phasors.

    Attributes
    ----------
    receiver : ndarray of str, shape (n,)
        Receiver of each point.
    position : ndarray, shape (n, 3)
        Points, m.
    frequency : ndarray, shape (n,)
        Frequencies, Hz.
    incident, scattered : ndarray of complex, shape (n, 6)
        Ex, Ey, Ez (V/m) and Hx, Hy, Hz (A/m).
    """

    receiver: Names
    position: Floats
    frequency: Floats
    incident: Phasors
    scattered: Phasors

    @property
    def total(self) -> Phasors:
        """Incident and scattered field together: ndarray of complex, shape (n, 6)."""
        return self.incident + self.scattered


@dataclass(frozen=True)
class FarField:
    """The far fields in directions.

    Attributes
    ----------
    receiver : ndarray of str, shape (n,)
        Receiver of each direction.
    theta, phi : ndarray, shape (n,)
        Angles from +z, and from +x about z, degrees.
    frequency : ndarray, shape (n,)
        Frequencies, Hz.
    amplitude : ndarray of complex, shape (n, 2)
        F of E → F exp(−jkr)/r along θ and φ, V.
    cross_section : ndarray, shape (n, 2)
        Radar cross-sections for reception along θ and φ, m²; NaN where no plane wave is incident.
    """

    receiver: Names
    theta: Floats
    phi: Floats
    frequency: Floats
    amplitude: Phasors
    cross_section: Floats


@dataclass(frozen=True)
class Monostatic:
    """What plane waves from directions send back to them.

    Attributes
    ----------
    receiver : ndarray of str, shape (n,)
        Receiver of each direction.
    theta, phi : ndarray, shape (n,)
        Angles from +z, and from +x about z, degrees.
    frequency : ndarray, shape (n,)
        Frequencies, Hz.
    scattering : ndarray of complex, shape (n, 4)
        S_θθ, S_φθ, S_θφ and S_φφ, m: received, then incident.
    """

    receiver: Names
    theta: Floats
    phi: Floats
    frequency: Floats
    scattering: Phasors

    @property
    def cross_section(self) -> Floats:
        """Radar cross-sections 4π|S|², m²: ndarray, shape (n, 4)."""
        section: Floats = 4.0 * np.pi * np.abs(self.scattering) ** 2
        return section


class WaveScene:
    """A scene of waves: that of a file, or by :meth:`build` one with surfaces from arrays.

    Parameters
    ----------
    path : str or path
        The file, which is read when it is solved.
    """

    #: Where a scene is that was built; removed together with it.
    _folder: Optional[tempfile.TemporaryDirectory[str]] = None

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        if not os.path.isfile(self.path):
            error = FileError(
                f"{self.path}: there is no such file\n  help: correct the name of the file"
            )
            error.file, error.help = self.path, "correct the name of the file"
            raise error

    @classmethod
    def load(cls, path: Path) -> WaveScene:
        """The scene of a file, which is read when it is solved."""
        return cls(path)

    @classmethod
    def build(cls, text: str, surfaces: Sequence[Surface] = ()) -> WaveScene:
        """A scene from the text of a scene file, and surfaces from arrays.

        Parameters
        ----------
        text : str
            Frequencies, method, sources, receivers, materials, and any surfaces that the text has
            itself, as scene files have them (docs/waves.md).
        surfaces : sequence of Surface
            Surfaces that are added to it; vertices in m.

        Examples
        --------
        >>> plate = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
        >>> scene = WaveScene.build(text, [Surface("plate", plate)])
        """
        folder = tempfile.TemporaryDirectory(prefix="fredholm-")
        whole, files = with_surfaces(text, surfaces, "edge")
        for name, data in [("scene.toml", whole.encode()), *files.items()]:
            with open(os.path.join(folder.name, name), "wb") as file:
                file.write(data)
        scene = cls(os.path.join(folder.name, "scene.toml"))
        scene._folder = folder
        return scene

    def solve(
        self,
        *,
        report: bool = True,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Waves:
        """Computes the fields by the method that the scene names.

        Parameters
        ----------
        report : bool
            Whether :meth:`Waves.write` writes report.html.
        threads, memory, progress
            As for :meth:`fredholm.Scene.solve`.
        """
        problem, how = _options.problem(threads, memory=memory), _options.how(threads, progress)
        try:
            return Waves(_core.waves(self.path, report, problem, how))
        except Interrupted as stop:
            if stop.partial is not None:
                stop.partial = Waves(stop.partial)
            raise

    def compare(
        self,
        solvers: Union[str, Sequence[str]] = "all",
        *,
        tolerance: float = 1e-6,
        max_iterations: int = 1000,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> _studies.Comparison:
        """Runs solvers of complex systems on the coupling of the scene."""
        _options.stop(tolerance, max_iterations)
        asked = (_options.texts(solvers), tolerance, max_iterations)
        problem, how = _options.problem(threads, memory=memory), _options.how(threads, progress)
        compared = _studies.Comparison
        return _studies.answered(
            compared, lambda: _core.compare_waves(self.path, asked, problem, how)
        )

    def methods(
        self,
        methods: Union[str, Sequence[str]] = "all",
        *,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> _studies.Methods:
        """Computes the fields by several methods, and compares each with the one that states the
        least error.

        Parameters
        ----------
        methods : str or sequence of str
            Such as ``["physical-optics:edges", "iterated", "efie"]``; ``"all"`` stands for all of
            them. Those that the scene does not admit are left out, with the reason.
        threads, memory, progress
            As for :meth:`fredholm.Scene.solve`.
        """
        problem, how = _options.problem(threads, memory=memory), _options.how(threads, progress)
        asked = _options.texts(methods)
        compared = _studies.Methods
        return _studies.answered(
            compared, lambda: _core.compare_wave_methods(self.path, asked, problem, how)
        )

    def trace(
        self,
        method: str = "surface-sampling",
        *,
        samples: Optional[int] = None,
        seconds: Optional[float] = None,
        to: Optional[float] = None,
        seed: int = 1,
        points: str = "sobol",
        batch: Optional[int] = None,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> _studies.Trace:
        """Estimates the fields by random paths; see :class:`fredholm.Trace`.

        Parameters
        ----------
        method, samples, seconds, to, seed, points, batch, threads, memory, progress
            As for :meth:`fredholm.Scene.trace`.
        """
        asked = _studies.sampling(
            method,
            paths=(seed, points, batch),
            tracing=(samples, seconds, to),
            problem=_options.problem(threads, memory=memory),
        )
        how = _options.how(threads, progress)
        return _studies.answered(_studies.Trace, lambda: _core.trace(self.path, asked, how))

    def crosscheck(
        self,
        method: str = "surface-sampling",
        *,
        significance: float = 0.01,
        correction: str = "holm",
        samples: Optional[int] = None,
        seconds: Optional[float] = None,
        to: Optional[float] = None,
        seed: int = 1,
        points: str = "sobol",
        batch: Optional[int] = None,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> _studies.Crosscheck:
        """Solves and samples, and decides whether the two agree; see
        :class:`fredholm.Crosscheck`.

        Parameters
        ----------
        method, significance, correction, samples, seconds, to, seed, points, batch, threads, \
memory, progress
            As for :meth:`fredholm.Scene.crosscheck`.
        """
        asked = _studies.sampling(
            method,
            significance=significance,
            correction=correction,
            paths=(seed, points, batch),
            tracing=(samples, seconds, to),
            problem=_options.problem(threads, memory=memory),
        )
        how = _options.how(threads, progress)
        check = _studies.Crosscheck
        return _studies.answered(check, lambda: _core.crosscheck(self.path, asked, how))

    def __repr__(self) -> str:
        return f"<WaveScene from {self.path}>"


class Waves:
    """The fields of a scene of waves. Made by :meth:`WaveScene.solve`.

    Attributes
    ----------
    receivers : list of str
        Names of the receivers.
    record : dict
        What made the fields: the method, what blocks waves, facets and residuals of every
        frequency, and estimated errors where the scene asks for them.
    """

    def __init__(self, core: _core.Waves) -> None:
        self._core, self.receivers = core, core.receivers
        self.record: Dict[str, Any] = _options.record(core.record)

    @property
    def near(self) -> NearField:
        """The fields at the points of the receivers."""
        places, incident, scattered = self._core.near
        return NearField(self._names(places), places[:, 2:5], places[:, 5], incident, scattered)

    @property
    def far(self) -> FarField:
        """The far fields in the directions of the receivers."""
        places, amplitude = self._core.far
        theta, phi, frequency = places[:, 2], places[:, 3], places[:, 4]
        return FarField(self._names(places), theta, phi, frequency, amplitude, places[:, 5:])

    @property
    def monostatic(self) -> Monostatic:
        """What the waves of monostatic receivers send back."""
        places, scattering = self._core.monostatic
        theta, phi, frequency = places[:, 2], places[:, 3], places[:, 4]
        return Monostatic(self._names(places), theta, phi, frequency, scattering)

    def _names(self, places: Floats) -> Names:
        """Names of the receivers of some rows."""
        names: Names = np.array(self.receivers, dtype=object)[places[:, 0].astype(int)]
        return names

    @property
    def ended(self) -> str:
        """ "done", or "not converged" where a residual asked for was missed."""
        return self._core.ended

    @property
    def converged(self) -> bool:
        """Whether the residuals asked for were met."""
        return self.ended == "done"

    @property
    def method(self) -> str:
        """The method."""
        return str(self.record["method"])

    def write(self, folder: Path) -> None:
        """Writes what the command line writes into a folder, which is made where it does not
        exist."""
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
        """The fields at points as a ``pandas.DataFrame``, or the far fields where there are no
        points."""
        import pandas

        near, far = self.near, self.far
        if near.frequency.size:
            columns: Dict[str, Any] = {"receiver": near.receiver, "frequency": near.frequency}
            columns.update({axis: near.position[:, at] for at, axis in enumerate("xyz")})
            for kind, field in (("incident", near.incident), ("scattered", near.scattered)):
                for at, name in enumerate(("ex", "ey", "ez", "hx", "hy", "hz")):
                    columns[f"{name}_{kind}"] = field[:, at]
            return pandas.DataFrame(columns)
        columns = {
            "receiver": far.receiver,
            "frequency": far.frequency,
            "theta": far.theta,
            "phi": far.phi,
        }
        for at, name in enumerate(("theta", "phi")):
            columns[f"amplitude_{name}"] = far.amplitude[:, at]
            columns[f"cross_section_{name}"] = far.cross_section[:, at]
        return pandas.DataFrame(columns)

    def _facts(self) -> List[Tuple[str, str]]:
        facts = [
            ("ended", self.ended),
            ("method", self.method),
            ("solution", str(self.record["solution"])),
        ]
        for name, key in (
            ("order", "order"),
            ("shadows", "shadows"),
            ("chosen", "chosen_because"),
        ):
            # Records of the first version know no order.
            if self.record.get(key) is not None:
                facts.insert(-1, (name, str(self.record[key])))
        for found in self.record["frequencies"]:
            last = found["residuals"][-1] if found["residuals"] else None
            residual = "" if last is None else f", residual {last:.1e}"
            facts.append(
                (f"{found['frequency_hz'] / 1e6:g} MHz", f"{found['facets']} facets{residual}")
            )
        return facts

    def __repr__(self) -> str:
        lines = [f"  {label:<14}{text}" for label, text in self._facts()]
        return "\n".join([f"<Waves of {self.record['scene']}>", *lines])

    def _repr_html_(self) -> str:
        return _html.panel(str(self.record["scene"]), self._facts())
