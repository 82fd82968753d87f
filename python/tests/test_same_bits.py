"""The command line and Python find the same numbers, bit for bit."""

import csv
import pathlib
import subprocess

import numpy as np
import pytest

import fredholm

# Scene, and the accuracy asked for where there is one.
CASES = [
    ("furnace.toml", None),
    ("occluder.toml", 0.05),
    ("leblond_room.toml", None),
    ("cornell_planar.toml", 0.1),
    ("studio/table.obj", None),
    ("studio/vase.obj", 0.2),
]


@pytest.mark.filterwarnings("ignore::fredholm.FredholmWarning")
@pytest.mark.parametrize("name, accuracy", CASES)
def test_solve(
    scenes: pathlib.Path, program: str, tmp_path: pathlib.Path, name: str, accuracy: float
) -> None:
    wish = [] if accuracy is None else ["--accuracy", str(accuracy)]
    command = [program, "solve", str(scenes / name), "-o", str(tmp_path / "line"), "--no-pictures"]
    subprocess.run([*command, "--no-report", "--quiet", *wish], check=True)
    solution = fredholm.Scene.load(scenes / name).solve(
        accuracy=accuracy, pictures=False, report=False
    )
    solution.write(tmp_path / "python")
    for file in ("field.npz", "faces.csv", "field.csv", "surfaces.csv", "field.vtu"):
        assert (tmp_path / "line" / file).read_bytes() == (
            tmp_path / "python" / file
        ).read_bytes(), file
    field = np.load(tmp_path / "line" / "field.npz")
    for of in ("irradiance", "radiosity"):
        assert field[of].reshape(-1).tobytes() == getattr(solution, of).tobytes()
    with open(tmp_path / "line" / "faces.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    written = [float(row[f"irradiance_{solution.bands[0]}"]) for row in rows]
    assert written == solution.faces.irradiance[:, 0].tolist()


@pytest.mark.filterwarnings("ignore::fredholm.FredholmWarning")
def test_view_factors(scenes: pathlib.Path, program: str, tmp_path: pathlib.Path) -> None:
    for name in ("leblond_room.toml", "studio/table.obj"):
        line = tmp_path / "line.npz"
        subprocess.run(
            [program, "viewfactors", str(scenes / name), "-o", str(line), "--quiet"], check=True
        )
        found = fredholm.view_factors(scenes / name)
        found.write(tmp_path / "python.npz")
        assert line.read_bytes() == (tmp_path / "python.npz").read_bytes()


def test_waves(scenes: pathlib.Path, program: str, tmp_path: pathlib.Path) -> None:
    scene = scenes / "waves" / "plate.toml"
    subprocess.run(
        [program, "waves", str(scene), "-o", str(tmp_path / "line"), "--quiet"], check=True
    )
    solved = fredholm.WaveScene(scene).solve()
    solved.write(tmp_path / "python")
    written = sorted(path.name for path in (tmp_path / "line").iterdir())
    assert written == sorted(path.name for path in (tmp_path / "python").iterdir())
    tables = [name for name in written if name.endswith((".csv", ".npz"))]
    assert tables
    for name in tables:
        assert (tmp_path / "line" / name).read_bytes() == (
            tmp_path / "python" / name
        ).read_bytes(), name
