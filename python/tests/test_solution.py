"""The light of a scene: numbers with a known answer, arrays that are not copied, what is shown."""

import gc
import pathlib

import numpy as np
import pytest
from conftest import FURNACE

import fredholm


@pytest.fixture(scope="module")
def furnace() -> fredholm.Solution:
    return fredholm.Scene.from_toml(FURNACE, "furnace.toml").solve()


def test_a_furnace_glows_evenly(furnace: fredholm.Solution) -> None:
    assert furnace.converged and furnace.ended == "done"
    assert furnace.radiosity.shape == (96, 1) and furnace.faces.irradiance.shape == (96, 1)
    assert np.allclose(furnace.radiosity, 4.0, rtol=1e-5)
    room = furnace["room"]
    assert abs(room.irradiance[0] - 4.0) <= room.error[0] + 1e-6
    assert np.isclose(furnace.area.sum(), 22.0) and np.isclose(furnace.faces.area.sum(), 22.0)
    assert furnace.residual.max() <= 1e-10 and furnace.iterations > 1
    assert furnace.counts["elements"] == 96 and furnace.bands == ["grey"]


def test_the_geometry_of_elements(furnace: fredholm.Solution) -> None:
    corners, starts = furnace.polygons
    assert starts[-1] == len(corners) == 4 * 96
    middles = corners.reshape(96, 4, 3).mean(axis=1)
    assert np.allclose(middles, furnace.centroid)
    assert np.allclose(np.linalg.norm(furnace.normal, axis=1), 1.0)
    inward = np.einsum("ij,ij->i", furnace.normal, np.array([0.5, 1.0, 1.5]) - furnace.centroid)
    assert (inward > 0).all()
    assert (furnace.surface_of_element == 0).all() and list(furnace.face) == list(range(96))


def test_arrays_are_the_memory_of_the_solver(furnace: fredholm.Solution) -> None:
    addresses = [furnace.irradiance.ctypes.data, furnace.radiosity.ctypes.data]
    assert addresses == furnace._core.addresses()
    assert addresses == [furnace.irradiance.ctypes.data, furnace.radiosity.ctypes.data]
    with pytest.raises(ValueError, match="read-only"):
        furnace.irradiance[0, 0] = 1.0


def test_arrays_outlive_their_solution() -> None:
    irradiance = fredholm.Scene.from_toml(FURNACE).solve().irradiance
    gc.collect()
    assert np.allclose(irradiance, 4.0, rtol=1e-5)


def test_writing_moves_nothing(tmp_path: pathlib.Path) -> None:
    solution = fredholm.Scene.from_toml(FURNACE).solve(pictures=False, report=False)
    before, irradiance = solution._core.addresses(), solution.irradiance
    solution.write(tmp_path / "a")
    solution.write(tmp_path / "b")
    assert solution._core.addresses() == before and irradiance.ctypes.data == before[0]
    assert (tmp_path / "a" / "run.json").exists() and not (tmp_path / "a" / "image.png").exists()


def test_an_accuracy_is_stated(scenes: pathlib.Path) -> None:
    solution = fredholm.Scene.load(scenes / "occluder.toml").solve(accuracy=0.01)
    assert solution.relative_error is not None and solution.relative_error <= 0.01
    names = [light.name for light in solution]
    assert names == solution.surfaces and len(solution) == len(names)


def test_notebooks_show_escaped_tables() -> None:
    text = FURNACE.replace('"room"', '"<script>alert(1)</script>"')
    solution = fredholm.Scene.from_toml(text).solve()
    html = solution._repr_html_()
    assert "<script>" not in html and "&lt;script&gt;" in html
    assert "data:image/png;base64," in html and "<details>" in html
    assert solution.picture(64).startswith(b"\x89PNG")
    assert "stated error" in repr(solution)
    page = solution.page(height=300)._repr_html_()
    assert page.startswith("<iframe") and "<script" not in page and "300px" in page
    with pytest.raises(fredholm.InputError, match="without its page"):
        fredholm.Scene.from_toml(FURNACE).solve(report=False).page()


def test_to_pandas(furnace: fredholm.Solution) -> None:
    pytest.importorskip("pandas")
    frame = furnace.to_pandas()
    assert list(frame["surface"].unique()) == ["room"] and len(frame) == 96
    assert np.array_equal(frame["irradiance_grey"], furnace.faces.irradiance[:, 0])


def test_to_xarray(furnace: fredholm.Solution) -> None:
    pytest.importorskip("xarray")
    data = furnace.to_xarray()
    assert data.irradiance.dims == ("element", "band")
    assert data.irradiance.values.ctypes.data == furnace.irradiance.ctypes.data


def test_to_pyvista(furnace: fredholm.Solution) -> None:
    pytest.importorskip("pyvista")
    mesh = furnace.to_pyvista()
    assert mesh.n_cells == 96 and np.isclose(mesh.area, 22.0)
    assert np.array_equal(mesh.cell_data["irradiance_grey"], furnace.irradiance[:, 0])
