"""Every other study: what it returns, and that it writes what the command line writes."""

import pathlib

import numpy as np
import pytest
from conftest import FURNACE

import fredholm

#: A room of two materials and a lamp.
ROOM = """
[materials.wall]
reflectance = 0.5
[materials.lamp]
reflectance = 0.1
exitance = 10
[[surface]]
name = "room"
material = "wall"
box = { min = [0, 0, 0], max = [1, 1, 1], inward = true }
divide = [2, 2]
[[surface]]
name = "lamp"
material = "lamp"
quad = [[0.3, 0.3, 0.9], [0.3, 0.7, 0.9], [0.7, 0.7, 0.9], [0.7, 0.3, 0.9]]
"""


@pytest.fixture(scope="module")
def room() -> fredholm.Scene:
    return fredholm.Scene.from_toml(ROOM, "room.toml")


def written(study: fredholm.Study, folder: pathlib.Path) -> None:
    """All files arrive, the record last."""
    study.write(folder)
    found = [path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()]
    # The folder's own list of its files is hidden.
    assert sorted(name for name in found if not name.startswith(".")) == sorted(study.files)
    assert study.files[-1].endswith(".json")
    assert study._repr_html_() and repr(study)


def test_check(room: fredholm.Scene, tmp_path: pathlib.Path) -> None:
    found = room.check()
    assert found.record["elements"] == room.elements == 25 and found.record["refused"] is None
    found.write(tmp_path)
    assert (tmp_path / "check.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(fredholm.ResourceError, match="--memory"):
        room.check(memory=1000)


def test_compare(room: fredholm.Scene, tmp_path: pathlib.Path) -> None:
    found = room.compare(["gauss-seidel", "gmres:restart=5", "lu"], tolerance=1e-9)
    assert [run["solver"] for run in found.runs] == ["gauss-seidel", "gmres:restart=5", "lu"]
    assert all(run["error"] < 1e-7 for run in found.runs) and found.ended == "done"
    written(found, tmp_path)
    assert len(found.table("compare.csv")["solver"]) == 3
    assert len(room.compare("neumann", sweep=[0.2, 0.4]).runs) == 2
    with pytest.raises(fredholm.InputError, match="no solver 'magic'"):
        room.compare("magic")


def test_converge(room: fredholm.Scene, tmp_path: pathlib.Path) -> None:
    found = room.converge(3)
    elements = [level["elements"] for level in found.record["levels"]]
    assert elements == [25, 100, 400] and found.record["bands"][0]["verdict"]
    written(found, tmp_path)


def test_spectrum(tmp_path: pathlib.Path) -> None:
    found = fredholm.Scene.from_toml(FURNACE).spectrum()
    assert found.record["method"] == "dense" and found.record["unknowns"] == 96
    written(found, tmp_path)


def test_trace(room: fredholm.Scene, tmp_path: pathlib.Path) -> None:
    found = room.trace("path", samples=4096, seed=3)
    again = room.trace("path", samples=4096, seed=3, threads=1)
    faces = found.table("faces.csv")
    column = next(name for name in faces if name.startswith("irradiance"))
    assert np.array_equal(faces[column], again.table("faces.csv")[column])
    assert len(faces[column]) == 25
    written(found, tmp_path)


def test_crosscheck(room: fredholm.Scene, tmp_path: pathlib.Path) -> None:
    found = room.crosscheck(accuracy=0.01, to=0.02)
    assert found.ended in ("agree", "undecided") and found.agrees == (found.ended == "agree")
    written(found, tmp_path)
    with pytest.raises(fredholm.InputError, match="no correction"):
        room.crosscheck(correction="none")


def test_reference(room: fredholm.Scene, tmp_path: pathlib.Path) -> None:
    found = room.reference(to=0.02, size=(16, 12), spp=256)
    assert found.record["relative_error"] > 0.0
    written(found, tmp_path)
    assert (found.record["pixels"]["width"], found.record["pixels"]["height"]) == (16, 12)
    assert "reference.csv" in found.files and len(found.table("reference.csv")["face"]) == 25


def test_judge(room: fredholm.Scene, tmp_path: pathlib.Path) -> None:
    room.reference(to=0.02, size=(16, 12), spp=1024).write(tmp_path / "bundle")
    stored = np.load(tmp_path / "bundle" / "pixels.npz")
    known, error = stored["radiosity"] / np.pi, stored["standard_error"] / np.pi
    noise = np.random.default_rng(1).normal(size=(16, *known.shape))
    right = fredholm.judge(tmp_path / "bundle", known + 4.0 * error * noise)
    assert right.agrees and right.record["seeds"] == 16, right.record
    assert np.allclose(right.table("judge.csv")["reference"][: known.size], known.ravel())
    wrong = fredholm.judge(tmp_path / "bundle", 1.05 * known + 4.0 * error * noise)
    assert wrong.ended == "disagree" and not wrong.agrees, wrong.record
    with pytest.raises(fredholm.InputError, match="random error of the tracer is not known"):
        fredholm.judge(tmp_path / "bundle", known)
    with pytest.raises(fredholm.FileError):
        fredholm.judge(tmp_path, known)


def test_waves(scenes: pathlib.Path) -> None:
    solved = fredholm.WaveScene.load(scenes / "waves" / "plate.toml").solve()
    far = solved.far
    assert solved.converged and len(far.theta) == len(far.receiver) == len(far.amplitude)
    # Seen squarely: 4πA²/λ² (Knott, Shaeffer and Tuley, Radar Cross Section, section 5.3).
    wavelength = 299_792_458.0 / far.frequency[0]
    expected = 4 * np.pi * 1.498_962_29**4 / wavelength**2
    assert np.isclose(np.nanmax(far.cross_section), expected, rtol=0.02)
    assert "MHz" in repr(solved) and solved._repr_html_()


def test_monostatic_cross_sections_are_those_of_the_amplitudes() -> None:
    scattering = np.array([[1.0 + 1j, 0, 0, 2.0]])
    none = np.zeros(1)
    found = fredholm.Monostatic(np.array(["a"], dtype=object), none, none, none, scattering)
    assert np.allclose(found.cross_section, 4 * np.pi * np.array([[2.0, 0, 0, 4.0]]))


def test_view_factors(scenes: pathlib.Path, tmp_path: pathlib.Path) -> None:
    found = fredholm.Scene.from_toml(FURNACE).view_factors(
        rows="surface", points=[[0.5, 1, 1.5, 0, 0, 1]]
    )
    assert found.dense.shape == (1, 1) and np.isclose(found.dense[0, 0], 1.0, atol=1e-4)
    assert found.dense.ctypes.data == found._core.address()
    assert found.points is not None and np.isclose(found.points.sum(), 1.0)
    assert np.asarray(found).shape == (1, 1) and found.names == ["room"]
    found.write(tmp_path / "F.csv")
    assert (tmp_path / "F.csv").exists() and (tmp_path / "F.json").exists()
    with pytest.raises(fredholm.InputError, match="no method 'magic'"):
        fredholm.view_factors(scenes / "occluder.toml", method="magic")
    assert "auto" in fredholm.view_factor_methods()


def test_a_scene_of_waves_takes_surfaces_from_arrays() -> None:
    text = """
[wave]
frequencies_hz = [1e8]
method = "physical-optics"
[[source]]
kind = "plane-wave"
travel = [0, 0, -1]
polarisation = [1, 0, 0]
[[receiver]]
name = "back"
far = { theta_degrees = 0, phi_degrees = 0 }
"""
    sides = ([[0, 0, 0], [6, 0, 0], [6, 6, 0], [0, 6, 0]], [[0, 1, 2, 3]])
    solved = fredholm.WaveScene.build(text, [fredholm.Surface("plate", sides)]).solve()
    # The radar cross-section of a plate that is met head on: 4π A²/λ².
    wavelength = 299_792_458.0 / 1e8
    expected = 4 * np.pi * 36.0**2 / wavelength**2
    assert abs(solved.far.cross_section[0, 0] / expected - 1) < 1e-6
    assert "<iframe" in solved.page()._repr_html_()


def test_a_study_has_a_page() -> None:
    page = fredholm.Scene.from_toml(ROOM).compare("gmres").page(height=300)
    assert "height:300px" in page._repr_html_()


def test_methods_of_waves(scenes: pathlib.Path) -> None:
    found = fredholm.WaveScene.load(scenes / "waves" / "dihedral.toml").methods(
        ["physical-optics", "iterated", "cfie"]
    )
    assert [run["outcome"] for run in found.runs] == ["done", "done", "refused"]
    assert found.record["reference"] == "iterated"
    differences = [run["receivers"][0]["difference"] for run in found.runs[:2]]
    assert differences[0] > 0.5 and differences[1] is None
    assert list(found.table("methods.csv")["method"]) == ["physical-optics", "iterated", "cfie"]
    with pytest.raises(fredholm.InputError, match="no method `magic`"):
        fredholm.WaveScene.load(scenes / "waves" / "dihedral.toml").methods("magic")
