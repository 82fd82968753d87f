"""The package as a whole: imports, stubs, examples. `tests/book.py` runs the code of the pages."""

import json
import pathlib
import re
import runpy
import subprocess
import sys
from typing import Any

import pytest
from conftest import ROOT

import fredholm

EXAMPLES = sorted((ROOT / "examples" / "python").glob("*.py"))


def test_nothing_but_numpy_is_imported() -> None:
    code = "import fredholm, sys; print(' '.join({name.split('.')[0] for name in sys.modules}))"
    loaded = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    ).stdout.split()
    assert "numpy" in loaded
    assert not {
        "scipy",
        "pandas",
        "xarray",
        "pyvista",
        "tqdm",
        "matplotlib",
        "trimesh",
        "meshio",
    } & set(loaded)


def test_every_public_name_is_documented() -> None:
    for name in fredholm.__all__:
        assert name.startswith("__") or getattr(fredholm, name).__doc__, name


def test_stubs_are_those_of_the_module() -> None:
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy.stubtest", "fredholm._core"]
    found = subprocess.run(command, capture_output=True, text=True, cwd=ROOT / "python" / "tests")
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.filterwarnings("ignore::fredholm.FredholmWarning")
def test_the_notebook_runs(tmp_path: pathlib.Path, monkeypatch: Any) -> None:
    notebook = json.loads((ROOT / "examples" / "python" / "five_minutes.ipynb").read_text())
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert len(cells) >= 4 and not any(
        cell["outputs"] for cell in notebook["cells"] if "outputs" in cell
    )
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    exec(compile("\n".join(cells), "notebook", "exec"), {"__name__": "__main__"})


@pytest.mark.filterwarnings("ignore::fredholm.FredholmWarning")
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_examples_run(path: pathlib.Path, tmp_path: pathlib.Path, monkeypatch: Any) -> None:
    for name in set(re.findall(r"^(?:import|from) (\w+)", path.read_text(), re.MULTILINE)):
        pytest.importorskip(name)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")
