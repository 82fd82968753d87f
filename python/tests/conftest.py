"""What the tests share: where the scenes are, and the command line to compare with."""

from __future__ import annotations

import os
import pathlib
import signal

import pytest

ROOT = pathlib.Path(__file__).parents[2]
SCENES = ROOT / "scenes"

# What runs in the background may have been told to ignore Ctrl-C: Python then has no KeyboardInterrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)

#: A closed room of which every wall emits: the radiosity is M/(1 − ρ) everywhere.
FURNACE = """
[materials.wall]
reflectance = 0.75
exitance = 1
[[surface]]
name = "room"
material = "wall"
box = { min = [0, 0, 0], max = [1, 2, 3], inward = true }
divide = [4, 4]
"""


@pytest.fixture
def scenes() -> pathlib.Path:
    """The folder of the scenes."""
    return SCENES


@pytest.fixture(scope="session")
def program() -> str:
    """The command line, as cargo has built it."""
    names = [ROOT / "target" / profile / "fredholm" for profile in ("release", "debug")]
    built = [str(name) for name in names if name.exists()]
    found = os.environ.get("FREDHOLM_PROGRAM") or max(built, key=os.path.getmtime, default="")
    if not found:
        pytest.skip("the command line is not built: cargo build, or set FREDHOLM_PROGRAM")
    return found

    """Nobody is told of progress."""
    return ()
