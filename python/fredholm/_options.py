"""Arguments that many studies share: checked here, handed on as the compiled part reads them."""

from __future__ import annotations

import difflib
import json
import os
from typing import Any, Dict, Iterable, List, Optional, Sequence, Union

from . import _core
from ._errors import wrong
from ._progress import Listener, listener

Path = Union[str, "os.PathLike[str]"]
Progress = Union[bool, Listener, None]
Memory = Union[int, str, None]


def how(threads: Optional[int], progress: Progress) -> Dict[str, Any]:
    """How a study is carried out."""
    return {"threads": threads, "progress": listener(progress)}


def problem(
    threads: Optional[int] = None,
    discretisation: Optional[str] = None,
    solver: Optional[str] = None,
    form_factor_tolerance: Optional[float] = None,
    storage: Optional[str] = None,
    memory: Memory = None,
) -> Dict[str, Any]:
    """What decides the size and the effort of a problem."""
    if threads is not None and not 1 <= threads <= 1024:
        raise wrong(f"threads is {threads}", "ask for 1 to 1024 threads, or none for one a core")
    if solver is not None:
        known(solver, [entry[0] for entry in _core.solvers()], "solver")
    share("form_factor_tolerance", form_factor_tolerance)
    return {
        "threads": threads,
        "discretisation": discretisation,
        "solver": solver,
        "form_factor_tolerance": form_factor_tolerance,
        "storage": storage,
        "memory": memory,
    }


def stop(tolerance: Optional[float], max_iterations: Optional[int]) -> Dict[str, Any]:
    """When a solution ends."""
    share("tolerance", tolerance)
    if max_iterations is not None and max_iterations < 1:
        raise wrong(f"max_iterations is {max_iterations}", "allow 1 iteration or more")
    return {"tolerance": tolerance, "max_iterations": max_iterations}


def share(name: str, value: Optional[float]) -> None:
    """Refuses what is not above 0 and below 1."""
    if value is not None and not 0.0 < value < 1.0:
        raise wrong(f"{name} is {value}", f"give a value above 0 and below 1, such as 0.01")


def known(name: str, names: Iterable[str], what: str) -> None:
    """Refuses a name that there is not, and says which are like it."""
    names = list(names)
    if name not in names:
        like = difflib.get_close_matches(name, names, 3)
        said = "write " + " or ".join(like) if like else "known are " + ", ".join(names)
        raise wrong(f"there is no {what} {name!r}", said)


def texts(names: Union[str, Sequence[str]]) -> List[str]:
    """A list of one name or of several."""
    return [names] if isinstance(names, str) else list(names)


def record(text: str) -> Dict[str, Any]:
    """The record of a run; a number that is not finite is None."""
    read: Dict[str, Any] = json.loads(text)
    return read
