"""Studies whose answer is a record and files: what a class is made of is said with the class."""

from __future__ import annotations

import csv
import io
import os
import tempfile
from typing import (
    Any,
    Callable,
    Dict,
    List,
    Optional,
    Sequence,
    Tuple,
    Type,
    TypeVar,
    Union,
)

import numpy as np
from numpy.typing import NDArray

from . import _core, _html, _options
from ._errors import Interrupted, wrong
from ._options import Memory, Progress

Floats = NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]
S = TypeVar("S", bound="Study")
#: Seed, points and batch; samples, seconds and standard error.
Paths = Tuple[int, str, Optional[int]]
Tracing = Tuple[Optional[int], Optional[float], Optional[float]]


class Study:
    """The answer of a study.

    Attributes
    ----------
    record : dict
        Everything that was found, as the record among the files has it; a number that is not finite
        is None.
    ended : str
        "done", "not converged" or "interrupted"; of a cross-check its verdict.
    """

    def __init__(self, core: _core.Study) -> None:
        self._core = core
        self.record: Dict[str, Any] = _options.record(core.record)
        self.ended: str = core.ended

    @property
    def files(self) -> List[str]:
        """Names of the files that :meth:`write` writes."""
        return self._core.files

    @property
    def warnings(self) -> List[str]:
        """What the user should know."""
        return list(self.record.get("warnings", []))

    def write(self, folder: _options.Path) -> None:
        """Writes what the command line writes into a folder, which is made where it does not exist.

        Parameters
        ----------
        folder : str or path
            The folder. The record is written last: where it stands, the folder is complete.
        """
        self._core.write(os.fspath(folder))

    def page(self, height: int = 600) -> _html.Page:
        """The page report.html, which notebooks show in a frame.

        Parameters
        ----------
        height : int
            Height of the frame in pixels.
        """
        if "report.html" not in self.files:
            raise wrong("this study has no page", "ask for it with report=True, or see .record")
        return _html.Page(bytes(self._core.read("report.html")).decode(), height)

    def table(self, file: str) -> Dict[str, NDArray[Any]]:
        """The columns of one of the files that end in .csv, by their names.

        Parameters
        ----------
        file : str
            One of :attr:`files`.
        """
        _options.known(file, [name for name in self.files if name.endswith(".csv")], "table")
        rows = list(csv.reader(io.StringIO(bytes(self._core.read(file)).decode())))
        return {name: _column(values) for name, *values in zip(*rows)}

    def to_pandas(self, file: Optional[str] = None) -> Any:
        """A table as a ``pandas.DataFrame``: the first one where none is named."""
        import pandas

        tables = [name for name in self.files if name.endswith(".csv")]
        if file is None and not tables:
            raise wrong("this study writes no table", "see .record")
        return pandas.DataFrame(self.table(file or tables[0]))

    def _facts(self) -> List[Tuple[str, str]]:
        shown = [
            (key.replace("_", " "), f"{value:.6g}" if isinstance(value, float) else str(value))
            for key, value in self.record.items()
            if isinstance(value, (str, int, float))
            and key not in ("format", "version", "scene_sha256")
        ]
        return [("ended", self.ended), *shown, *(("warning", text) for text in self.warnings)]

    def __repr__(self) -> str:
        lines = [f"  {label:<22}{text}" for label, text in self._facts()]
        return "\n".join([f"<{type(self).__name__}>", *lines])

    def _repr_html_(self) -> str:
        tables = [name for name in self.files if name.endswith(".csv")]
        more = ""
        if tables:
            columns = self.table(tables[0])
            more = _html.table(
                list(columns), list(zip(*(map(str, column) for column in columns.values())))
            )
        return _html.panel(type(self).__name__, self._facts(), more)


def _column(values: List[str]) -> NDArray[Any]:
    """Whole numbers, numbers, or texts. What is left empty is NaN among numbers."""
    for kind in (np.int64, np.float64):
        try:
            return np.array([value or "nan" for value in values], dtype=str).astype(kind)
        except (ValueError, OverflowError):
            pass
    return np.array(values, dtype=object)


class Check(Study):
    """What the mesh of a scene is, and what its solution will take.

    ``record`` has pieces, components, closed, diagonal (m) and findings of the mesh; elements,
    faces, surfaces, occluders, unknowns, memory_bytes, seconds (of one thread, from samples)
    and warnings of a solution, or refused, why it does not fit the memory. check.png shows the
    sides.
    """


class Comparison(Study):
    """Solvers on one system: iterations, work, time and error against the best answer there is."""

    @property
    def runs(self) -> List[Dict[str, Any]]:
        """What became of each solver in each case, with ``solver``, ``outcome``, ``iterations``,
        ``seconds``, ``residual``, ``error`` and ``history``."""
        cases = self.record["cases"]
        return [
            {"reflectance": case.get("reflectance"), **run}
            for case in cases
            for run in case["runs"]
        ]


class Methods(Study):
    """Methods on one scene of waves: what each makes of the fields, against the most exact one.

    ``table("methods.csv")`` has the stated error of every method at every receiver and frequency,
    and its difference from ``record["reference"]``.
    """

    @property
    def runs(self) -> List[Dict[str, Any]]:
        """What became of each method, with ``method``, ``outcome``, ``reason``, ``seconds`` and
        ``receivers``."""
        return list(self.record["methods"])


class Convergence(Study):
    """A scene on finer and finer meshes: the order of the error, and how much of it is left.

    ``record["levels"]`` has the elements, unknowns, size h (m) and seconds of each mesh;
    ``record["bands"]`` the differences to the finest, the orders and the verdict of each band.
    """


class Spectrum(Study):
    """Eigenvalues, radii and conditions of the matrix of a scene, in ``record["bands"]``."""


class Trace(Study):
    """Estimates by random paths, with standard errors.

    ``table("faces.csv")`` has the irradiance of every face and its standard error, W/m².
    """


class Crosscheck(Study):
    """A solution and random paths, place by place: ``ended`` is "agree", "disagree" or
    "undecided"."""

    @property
    def agrees(self) -> bool:
        """Whether the two agree, and a deviation worth the name would have been found."""
        return self.ended == "agree"


class Reference(Study):
    """Reference values with stated errors for other programs: reference.csv (faces) and pixels.npz
    among the files. ``write(folder)`` makes the bundle that :func:`judge` reads."""


class Judgement(Study):
    """Another tracer and reference values, place by place: ``ended`` is "agree", "disagree" or
    "undecided".

    ``record`` has the power and the worst places; ``table("judge.csv")`` the z of every place.
    """

    @property
    def agrees(self) -> bool:
        """Whether the two agree, and a deviation worth the name would have been found."""
        return self.ended == "agree"


def answered(make: Type[S], run: Callable[[], _core.Study]) -> S:
    """The answer of a run; what Ctrl-C leaves of it is one, too."""
    try:
        return make(run())
    except Interrupted as stop:
        if stop.partial is not None:
            stop.partial = make(stop.partial)
        raise


def sampling(
    method: Optional[str],
    *,
    paths: Paths,
    tracing: Tracing,
    problem: Dict[str, Any],
    control: bool = False,
    spp: Optional[int] = None,
    pictures: bool = True,
    report: bool = True,
    accuracy: Optional[float] = None,
    significance: float = 0.01,
    correction: str = "holm",
) -> Dict[str, Any]:
    """What is asked of random paths: how they are made (seed, points, batch), and when they end
    (samples, seconds, standard error)."""
    _options.share("accuracy", accuracy)
    _options.share("significance", significance)
    _options.share("to", tracing[2])
    return {
        "method": method,
        "control": control,
        "spp": spp,
        "pictures": pictures,
        "report": report,
        "accuracy": accuracy,
        "significance": significance,
        "correction": correction,
        "paths": dict(zip(("seed", "points", "batch"), paths)),
        "tracing": dict(zip(("samples", "seconds", "error"), tracing)),
        "problem": problem,
    }


class LightStudies:
    """The studies of a scene of light whose answers are records and files."""

    _core: _core.Scene

    def check(
        self,
        *,
        threads: Optional[int] = None,
        discretisation: Optional[str] = None,
        solver: Optional[str] = None,
        form_factor_tolerance: Optional[float] = None,
        storage: Optional[str] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Check:
        """Tells what the mesh is and what a solution will take; see :class:`Check`.

        Parameters
        ----------
        threads, discretisation, solver, form_factor_tolerance, storage, memory, progress
            As for :meth:`Scene.solve`.
        """
        problem = _options.problem(
            threads, discretisation, solver, form_factor_tolerance, storage, memory
        )
        how = _options.how(threads, progress)
        return answered(Check, lambda: _core.check(self._core, problem, how))

    def compare(
        self,
        solvers: Union[str, Sequence[str]] = "all",
        *,
        tolerance: float = 1e-10,
        max_iterations: int = 1000,
        sweep: Optional[Sequence[float]] = None,
        report: bool = True,
        form_factor_tolerance: Optional[float] = None,
        storage: Optional[str] = None,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Comparison:
        """Runs solvers on the system of the scene; see :class:`Comparison`.

        Parameters
        ----------
        solvers : str or sequence of str
            Their names, such as "gmres:restart=20", or "all".
        tolerance : float
            Relative residual to reach.
        max_iterations : int
            Iterations allowed.
        sweep : sequence of float, optional
            Largest reflectances to which all are scaled in turn.
        report : bool
            Whether report.html is written.
        form_factor_tolerance, storage, threads, memory, progress
            As for :meth:`Scene.solve`.
        """
        _options.stop(tolerance, max_iterations)
        asked = {
            "solvers": _options.texts(solvers),
            "tolerance": tolerance,
            "max_iterations": max_iterations,
            "sweep": None if sweep is None else [float(value) for value in sweep],
            "report": report,
            "problem": _options.problem(
                threads, None, None, form_factor_tolerance, storage, memory
            ),
        }
        known = [entry[0] for entry in _core.solvers()] + ["all"]
        for text in _options.texts(solvers):
            _options.known(text.split(":")[0], known, "solver")
        how = _options.how(threads, progress)
        return answered(Comparison, lambda: _core.compare(self._core, asked, how))

    def converge(
        self,
        levels: int = 3,
        *,
        discretisation: Optional[str] = None,
        solver: Optional[str] = None,
        tolerance: Optional[float] = None,
        max_iterations: Optional[int] = None,
        form_factor_tolerance: Optional[float] = None,
        report: bool = True,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Convergence:
        """Solves on finer and finer meshes; see :class:`Convergence`.

        Parameters
        ----------
        levels : int
            Meshes: that of the scene, and each with 2 × 2 elements for one of the last.
        report : bool
            Whether report.html is written.
        discretisation, solver, tolerance, max_iterations, form_factor_tolerance, threads, memory, \
progress
            As for :meth:`Scene.solve`.
        """
        if not 1 <= levels <= 20:
            raise wrong(
                f"levels is {levels}", "ask for 3 levels or more, the fewest that show an order"
            )
        problem = _options.problem(
            threads, discretisation, solver, form_factor_tolerance, None, memory
        )
        stop, how = _options.stop(tolerance, max_iterations), _options.how(threads, progress)
        return answered(
            Convergence, lambda: _core.converge(self._core, (levels, report), problem, stop, how)
        )

    def spectrum(
        self,
        *,
        dense: int = 2000,
        steps: int = 60,
        form_factor_tolerance: Optional[float] = None,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Spectrum:
        """Analyses the matrix of the scene; see :class:`Spectrum`.

        Parameters
        ----------
        dense : int
            Unknowns up to which dense methods are taken.
        steps : int
            Steps of the Lanczos process beyond.
        form_factor_tolerance, threads, memory, progress
            As for :meth:`Scene.solve`.
        """
        problem = _options.problem(threads, None, None, form_factor_tolerance, None, memory)
        how = _options.how(threads, progress)
        return answered(Spectrum, lambda: _core.spectrum(self._core, (dense, steps), problem, how))

    def trace(
        self,
        method: str = "path",
        *,
        samples: Optional[int] = None,
        seconds: Optional[float] = None,
        to: Optional[float] = None,
        control: bool = False,
        spp: Optional[int] = None,
        seed: int = 1,
        points: str = "sobol",
        batch: Optional[int] = None,
        pictures: bool = True,
        report: bool = True,
        discretisation: Optional[str] = None,
        solver: Optional[str] = None,
        form_factor_tolerance: Optional[float] = None,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Trace:
        """Estimates the irradiance of the faces by random paths; see :class:`Trace`.

        Parameters
        ----------
        method : str
            path, light, bidirectional, walk-gathering or another one that ``fredholm trace --help``
            lists.
        samples, seconds, to : int, float, float, optional
            Tracing ends at the first of so many samples, so many seconds, and this standard error,
            relative to the mean; 0.01 where none is given.
        control : bool
            Whether the scene is solved first and only the rest is sampled.
        spp : int, optional
            Samples of every pixel, where a picture is to be traced.
        seed, points, batch : int, str, int
            How paths are made: ``points`` is independent, jittered, n-rooks, multi-jittered or
            sobol.
        pictures, report : bool
            Whether pictures and report.html are written.
        discretisation, solver, form_factor_tolerance, threads, memory, progress
            As for :meth:`Scene.solve`.
        """
        asked = sampling(
            method,
            control=control,
            spp=spp,
            pictures=pictures,
            report=report,
            paths=(seed, points, batch),
            tracing=(samples, seconds, to),
            problem=_options.problem(
                threads, discretisation, solver, form_factor_tolerance, None, memory
            ),
        )
        how = _options.how(threads, progress)
        return answered(Trace, lambda: _core.trace(self._core, asked, how))

    def crosscheck(
        self,
        method: Optional[str] = None,
        *,
        accuracy: Optional[float] = None,
        significance: float = 0.01,
        correction: str = "holm",
        samples: Optional[int] = None,
        seconds: Optional[float] = None,
        to: Optional[float] = None,
        seed: int = 1,
        points: str = "sobol",
        batch: Optional[int] = None,
        report: bool = True,
        discretisation: Optional[str] = None,
        solver: Optional[str] = None,
        form_factor_tolerance: Optional[float] = None,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Crosscheck:
        """Solves and traces, and decides by statistics whether the two agree; see
        :class:`Crosscheck`.

        Parameters
        ----------
        accuracy : float, optional
            What is asked of the solution.
        significance : float
            Probability of a false alarm that is allowed.
        correction : {"holm", "benjamini-hochberg"}
            How the number of tests is taken into account.
        method, samples, seconds, to, seed, points, batch
            As for :meth:`trace`.
        report : bool
            Whether report.html is written.
        discretisation, solver, form_factor_tolerance, threads, memory, progress
            As for :meth:`Scene.solve`.
        """
        asked = sampling(
            method,
            accuracy=accuracy,
            significance=significance,
            correction=correction,
            report=report,
            paths=(seed, points, batch),
            tracing=(samples, seconds, to),
            problem=_options.problem(
                threads, discretisation, solver, form_factor_tolerance, None, memory
            ),
        )
        how = _options.how(threads, progress)
        return answered(Crosscheck, lambda: _core.crosscheck(self._core, asked, how))

    def reference(
        self,
        *,
        size: Optional[Tuple[int, int]] = None,
        spp: Optional[int] = None,
        samples: Optional[int] = None,
        seconds: Optional[float] = None,
        to: Optional[float] = None,
        seed: int = 1,
        points: str = "sobol",
        batch: Optional[int] = None,
        discretisation: Optional[str] = None,
        solver: Optional[str] = None,
        form_factor_tolerance: Optional[float] = None,
        threads: Optional[int] = None,
        memory: Memory = None,
        progress: Progress = None,
    ) -> Reference:
        """Solves, and traces with the solution as control variate: values with stated errors for
        other tracers; see :class:`Reference`.

        Parameters
        ----------
        size : (int, int), optional
            Width and height of the picture; that of the scene, at most 64 along the longer side.
        spp : int, optional
            Samples of every pixel; 1024.
        samples, seconds, to : int, float, float, optional
            Tracing of the faces ends at the first of these; a standard error of 0.002 where none
            is given.
        seed, points, batch
            As for :meth:`trace`.
        discretisation, solver, form_factor_tolerance, threads, memory, progress
            As for :meth:`Scene.solve`.
        """
        asked = sampling(
            None,
            spp=spp,
            paths=(seed, points, batch),
            tracing=(samples, seconds, to),
            problem=_options.problem(
                threads, discretisation, solver, form_factor_tolerance, None, memory
            ),
        )
        how = _options.how(threads, progress)
        return answered(Reference, lambda: _core.reference(self._core, size, asked, how))


def judge(
    bundle: Path,
    found: Union[Path, Sequence[Path], Any],
    *,
    significance: float = 0.01,
    correction: str = "holm",
    exact: bool = False,
    rounding: Optional[float] = None,
    progress: Progress = None,
) -> Judgement:
    """Judges what another tracer has found by a bundle of :meth:`Scene.reference`.

    Parameters
    ----------
    bundle : path
        Folder of the bundle.
    found : path, sequence of paths or array
        Tables of faces (.csv: irradiance, W/m²) or pictures (.npy, .exr: radiance, W/(m² sr)), or
        an array of radiances: height × width × bands, or seeds × height × width × bands, rows from
        the top. Several files or pictures are independent runs.
    significance : float
        Probability of a false alarm that is allowed.
    correction : {"holm", "benjamini-hochberg"}
        How the number of tests is taken into account.
    exact : bool
        Whether the values have no random error, as those of a deterministic program.
    rounding : float, optional
        Standard deviation of rounding, relative to the value; 1e-5 where nothing is said.

    Raises
    ------
    InputError
        For values that cannot be used, or whose error is not known.
    FileError
        For files that cannot be read.
    """
    _options.share("significance", significance)
    _options.share("rounding", rounding)
    with tempfile.TemporaryDirectory() as folder:
        if hasattr(found, "__array__"):
            files = [os.path.join(folder, "found.npy")]
            np.save(files[0], np.asarray(found, dtype=np.float64))
        elif isinstance(found, (str, os.PathLike)):
            files = [os.fspath(found)]
        else:
            files = [os.fspath(file) for file in found]
        asked = {
            "bundle": os.fspath(bundle),
            "files": files,
            "significance": significance,
            "correction": correction,
            "exact": exact,
            "rounding": rounding,
        }
        how = _options.how(None, progress)
        return answered(Judgement, lambda: _core.judge(asked, how))
