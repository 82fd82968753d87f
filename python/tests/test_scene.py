"""Scenes from files and from arrays, and what is wrong with them."""

import pathlib
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import FURNACE

import fredholm
from fredholm import Material, Scene, Surface

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
# The sides of the cube, lit within.
SIDES = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
GREY = {"grey": Material(0.5, 1.0)}


def triangles(quads: np.ndarray) -> np.ndarray:
    """Two triangles for each quad."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def built(mesh: Any, **how: Any) -> Scene:
    return Scene.build([Surface("cube", mesh, "grey", **how)], GREY)


def test_arrays_make_a_scene() -> None:
    scene = built((CUBE, SIDES))
    solution = scene.solve()
    assert scene.faces == 6 and np.allclose(solution.radiosity, 2.0, atol=1e-6)


def test_meshes_of_other_libraries_are_taken_by_their_attributes() -> None:
    three = triangles(SIDES)
    counted = np.hstack([np.full((12, 1), 3), three]).ravel()
    block = SimpleNamespace(type="triangle", data=three)
    meshes = [
        SimpleNamespace(vertices=CUBE, faces=three),
        SimpleNamespace(points=CUBE, cells=[SimpleNamespace(type="vertex", data=[[0]]), block]),
        SimpleNamespace(points=CUBE, faces=counted, regular_faces=three),
    ]
    light = [built(mesh).solve().irradiance.tobytes() for mesh in meshes]
    assert len(set(light)) == 1
    assert np.allclose(np.frombuffer(light[0]), 2.0, atol=1e-5)


def test_a_mesh_of_trimesh() -> None:
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box()
    box.invert()
    assert np.allclose(built(box).solve().radiosity, 2.0, atol=1e-5)


def test_a_mesh_of_meshio() -> None:
    meshio = pytest.importorskip("meshio")
    box = meshio.Mesh(CUBE, [("line", [[0, 1]]), ("quad", SIDES)])
    assert np.allclose(built(box).solve().radiosity, 2.0, atol=1e-5)
    solid = meshio.Mesh(CUBE, [("tetra", [[0, 1, 2, 4]])])
    with pytest.raises(fredholm.InputError, match="cells of the type 'tetra'"):
        built(solid)


def test_a_mesh_of_pyvista() -> None:
    pyvista = pytest.importorskip("pyvista")
    for faces in (SIDES, triangles(SIDES)):
        counted = np.hstack([np.full((len(faces), 1), faces.shape[1]), faces]).ravel()
        box = pyvista.PolyData(CUBE, faces=counted)
        assert np.allclose(built(box).solve().radiosity, 2.0, atol=1e-5)


def test_polygons_bands_and_two_sides() -> None:
    plate = ([[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 2, 0], [0, 1, 0]], [[0, 1, 2, 3, 4]])
    scene = Scene.build(
        [
            Surface("plate", plate, "red", two_sided=True, largest_edge=0.5),
            Surface("cube", (4 * CUBE - 1, SIDES), "lamp"),
        ],
        {"red": Material([0.5, 0.1]), "lamp": Material(0.0, {"r": 1.0, "g": 2.0})},
        bands=["r", "g"],
        title="A plate",
        camera={"eye": [1, 1, 2.5], "target": [1, 1.1, 0], "width": 64, "height": 48},
    )
    solution = scene.solve()
    assert scene.title == "A plate" and solution.surfaces == ["plate", "plate/back", "cube"]
    # Light from all sides: E = M of the cube, whatever else there is.
    assert np.allclose(solution["plate"].irradiance, [1.0, 2.0], rtol=0.05)
    assert scene.materials["lamp"].exitance == [1.0, 2.0]


def test_a_built_scene_is_saved_for_the_command_line(tmp_path: pathlib.Path) -> None:
    rng = np.random.default_rng(1)
    scene = built((CUBE + 1e-3 * rng.random(CUBE.shape), triangles(SIDES)))
    again = Scene.load(scene.save(tmp_path / "scene"))
    assert again.sha256 == scene.sha256
    assert again.solve().irradiance.tobytes() == scene.solve().irradiance.tobytes()


WRONG = [
    # What is called, the exception, its text, and the help.
    (
        lambda: Scene.load("nowhere.toml"),
        fredholm.FileError,
        "cannot read the scene",
        "correct the name",
    ),
    (lambda: built((CUBE, [[0, 1, 8]])), fredholm.InputError, "face 0 of `cube` is", "from 0 to 7"),
    (lambda: built((CUBE[:, :2], SIDES)), fredholm.InputError, "the shape (8, 2)", "(n, 3)"),
    (lambda: built(3), fredholm.InputError, "is a int", "(vertices, faces)"),
    (
        lambda: Scene.from_toml(FURNACE).solve(accuracy=1.5),
        fredholm.InputError,
        "accuracy is 1.5",
        "below 1",
    ),
    (
        lambda: Scene.from_toml(FURNACE).solve(solver="gmrse"),
        fredholm.InputError,
        "'gmrse'",
        "gmres",
    ),
    (
        lambda: Scene.from_toml(FURNACE).solve(threads=0),
        fredholm.InputError,
        "threads is 0",
        "1 to 1024",
    ),
    (
        lambda: Scene.from_toml(FURNACE).solve(memory="2 bytes"),
        fredholm.InputError,
        "2 bytes",
        None,
    ),
    (
        lambda: Scene.from_toml(FURNACE).solve(memory=1000),
        fredholm.ResourceError,
        "memory",
        "fewer elements",
    ),
    (
        lambda: Scene.from_toml(FURNACE).solve()["rom"],
        fredholm.InputError,
        "no surface 'rom'",
        "room",
    ),
    (
        lambda: fredholm.WaveScene("nowhere.toml"),
        fredholm.FileError,
        "no such file",
        "correct the name",
    ),
]


@pytest.mark.parametrize("call, kind, text, help", WRONG)
def test_wrong_calls_say_what_is_wrong_and_what_helps(
    call: Any, kind: Any, text: str, help: Any
) -> None:
    with pytest.raises(kind) as raised:
        call()
    assert text in str(raised.value)
    assert isinstance(raised.value, fredholm.FredholmError)
    if help is not None:
        assert help in (raised.value.help or "")


def test_errors_know_file_and_line(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(FURNACE.replace("reflectance", "reflectence"))
    with pytest.raises(ValueError) as raised:
        Scene.load(path)
    error = raised.value
    assert isinstance(error, fredholm.InputError)
    assert (error.file, error.line, error.column) == (str(path), 3, 1)
    assert error.help is not None and "reflectance" in error.help


def test_warnings_are_warnings(scenes: pathlib.Path) -> None:
    with pytest.warns(fredholm.FredholmWarning, match="a black box around the mesh"):
        Scene.load(scenes / "studio" / "vase.obj").check()
