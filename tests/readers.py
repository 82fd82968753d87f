#!/usr/bin/env python3
"""What Fredholm writes is read by programs of others, and the other way round, to equal values.

    pip install trimesh meshio pyvista mitsuba OpenEXR
    FREDHOLM_PROGRAM=target/release/fredholm python3 tests/readers.py

Of every format a line says who read it, how many triangles or values there are, and the largest
difference. The exit code is 1 where one is above the last digit that the format holds. This is not
part of the tests that run by themselves: the packages take 500 MB.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import meshio
import mitsuba
import numpy as np
import OpenEXR
import pyvista
import trimesh

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = str(Path(os.environ.get("FREDHOLM_PROGRAM", ROOT / "target/release/fredholm")).resolve())
#: Triangles, as the corners are compared, of rooms of a metre: what f32 and f64 leave.
SINGLE, DOUBLE = 1e-6, 1e-15
SCENE = ROOT / "scenes" / "cornell_planar.toml"
FAULTS = []


def fredholm(*arguments):
    subprocess.run([PROGRAM, *map(str, arguments)], check=True, stdout=subprocess.PIPE,
                   stderr=subprocess.PIPE, text=True)


def ordered(triangles):
    """Triangles in an order of their own, each beginning with its least corner, still turning the
    same way."""
    triangles = np.asarray(triangles, dtype=float).reshape(-1, 3, 3) + 0.0
    keys = np.round(triangles, 5)
    first = [min(range(3), key=lambda k, t=t: tuple(t[k])) for t in keys]
    turned = np.array([np.roll(t, -k, axis=0) for t, k in zip(triangles, first)])
    flat = np.round(turned, 5).reshape(len(turned), 9)
    return turned[np.lexsort(flat.T[::-1])]


def fan(points, faces):
    """The triangles of polygons."""
    points = np.asarray(points, dtype=float)
    return [points[[f[0], f[k], f[k + 1]]] for f in faces for k in range(1, len(f) - 1)]


def obj(path):
    """Triangles of an OBJ file: this script's own reader, which knows v and f alone."""
    points, faces = [], []
    for line in Path(path).read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append([float(x) for x in rest[:3]])
        elif word == "f":
            faces.append([int(corner.split("/")[0]) - 1 for corner in rest])
    return fan(points, faces)


def told(what, found, expected, allowed):
    found, expected = np.asarray(found, dtype=float), np.asarray(expected, dtype=float)
    if found.shape != expected.shape:
        worst = f"shapes {found.shape} and {expected.shape}"
        wrong = True
    else:
        difference = float(np.abs(found - expected).max(initial=0.0))
        worst, wrong = f"largest difference {difference:.1e}", not difference <= allowed
    print(f"{what:<44} {len(found):>6} {worst}{'   FAULT' if wrong else ''}", flush=True)
    if wrong:
        FAULTS.append(what)


def of_trimesh(path):
    return trimesh.load(path, process=False, force="mesh").triangles


def of_meshio(path):
    mesh = meshio.read(path)
    return [t for block in mesh.cells if block.type in ("triangle", "quad", "polygon")
            for t in fan(mesh.points, block.data)]


def of_pyvista(path):
    # Not triangulated by PyVista, which may cut a quad along its other diagonal.
    mesh = pyvista.read(path)
    if isinstance(mesh, pyvista.PolyData):
        return fan(mesh.points, mesh.irregular_faces)
    return fan(mesh.points, [mesh.get_cell(k).point_ids for k in range(mesh.n_cells)])


def of_mitsuba(path):
    mitsuba.set_variant("scalar_rgb")
    triangles = []
    for shape in mitsuba.load_file(str(path)).shapes():
        points = np.array(mitsuba.traverse(shape)["vertex_positions"]).reshape(-1, 3)
        triangles += fan(points, np.array(mitsuba.traverse(shape)["faces"]).reshape(-1, 3))
    return triangles


def written(folder, expected):
    """What Fredholm writes, read by others. The binary PLY reader of meshio takes no property beside
    the corners of a face, such as the number of its surface, and is left out."""
    for name, ending, read, allowed in [
        ("trimesh", "obj", of_trimesh, DOUBLE), ("trimesh", "stl", of_trimesh, SINGLE),
        ("trimesh", "ply", of_trimesh, DOUBLE), ("trimesh", "glb", of_trimesh, SINGLE),
        ("meshio", "obj", of_meshio, DOUBLE), ("meshio", "stl", of_meshio, SINGLE),
        ("meshio", "msh", of_meshio, DOUBLE),
        ("PyVista", "obj", of_pyvista, SINGLE), ("PyVista", "stl", of_pyvista, SINGLE),
        ("PyVista", "ply", of_pyvista, SINGLE), ("PyVista", "msh", of_pyvista, DOUBLE),
        ("Mitsuba", "xml", of_mitsuba, SINGLE),
    ]:
        path = folder / f"out.{ending}"
        if not path.exists():
            fredholm("convert", SCENE, path)
        try:
            told(f"written {ending}, read by {name}", ordered(read(path)), expected, allowed)
        except Exception as error:
            print(f"written {ending}, read by {name}: {type(error).__name__}: {error}   FAULT")
            FAULTS.append(f"{ending} {name}")


def read_back(folder, expected):
    """What others write, read by Fredholm and written as OBJ."""
    mesh = trimesh.Trimesh(*_indexed(expected), process=False)
    for ending, allowed in [("obj", 1e-8), ("stl", SINGLE), ("ply", SINGLE), ("glb", SINGLE)]:
        path = folder / f"trimesh.{ending}"
        mesh.export(path)
        back(f"written by trimesh: {ending}", path, expected, allowed)
    points, faces = _indexed(expected)
    mesh = meshio.Mesh(points, [("triangle", faces)])
    for name, ending, options, allowed in [
        ("text", "msh", {"file_format": "gmsh", "binary": False}, DOUBLE),
        ("binary", "msh", {"file_format": "gmsh", "binary": True}, DOUBLE),
        ("text", "ply", {"binary": False}, 1e-8), ("binary", "ply", {"binary": True}, DOUBLE),
        ("text", "stl", {"binary": False}, SINGLE), ("binary", "stl", {"binary": True}, SINGLE),
        ("text", "obj", {}, DOUBLE),
    ]:
        path = folder / f"meshio_{name}.{ending}"
        meshio.write(path, mesh, **options)
        back(f"written by meshio: {ending}, {name}", path, expected, allowed)
    mesh = pyvista.make_tri_mesh(points, faces)
    for ending, binary in [("ply", True), ("ply", False), ("stl", True), ("stl", False)]:
        path = folder / f"pyvista_{binary}.{ending}"
        mesh.save(path, binary=binary)
        kind = "binary" if binary else "text"
        back(f"written by PyVista: {ending}, {kind}", path, expected, SINGLE)


def back(what, path, expected, allowed):
    out = path.with_name(f"{path.stem}_{path.suffix[1:]}_back.obj")
    try:
        fredholm("convert", path, out)
    except subprocess.CalledProcessError as error:
        print(f"{what}: {error.stderr.strip()}   FAULT")
        FAULTS.append(what)
        return
    told(what, ordered(obj(out)), expected, allowed)


def _indexed(triangles):
    points, faces = np.unique(np.asarray(triangles).reshape(-1, 3), axis=0, return_inverse=True)
    return points, faces.reshape(-1, 3)


def results(folder):
    """Fields of a solution: VTU, PLY and glTF."""
    out = folder / "solved"
    fredholm("solve", SCENE, "-o", out, "--also", "ply,glb", "--no-report")
    field = np.load(out / "field.npz")
    values = field["radiosity"].reshape(-1, field["radiosity"].shape[-1])
    bands = [str(band) for band in field["bands"]]
    for name, data in [
        ("PyVista", pyvista.read(out / "field.vtu").cell_data),
        ("meshio", {key: np.concatenate([np.ravel(part) for part in parts])
                    for key, parts in meshio.read(out / "field.vtu").cell_data.items()}),
    ]:
        found = np.stack([np.ravel(data[f"radiosity_{band}"]) for band in bands], axis=1)
        told(f"field.vtu, read by {name}", found, values, 0.0)
    ply = trimesh.load(out / "field.ply", process=False)
    raw = ply.metadata["_ply_raw"]["face"]["data"]
    found = np.stack([np.ravel(raw[f"radiosity_{band}"]) for band in bands], axis=1)
    told("field.ply, read by trimesh", found, values, 1e-15 * np.abs(values).max())
    scene = trimesh.load(out / "field.glb", process=False)
    baked = np.concatenate([m.vertex_attributes["_RADIOSITY"] for m in scene.geometry.values()])
    span = [baked.min(axis=0), baked.max(axis=0)]
    print(f"field.glb, read by trimesh: {len(baked)} corners, radiosity from {span[0]} to {span[1]},"
          f" elements from {values.min(axis=0)} to {values.max(axis=0)}")


def pictures(folder):
    """An EXR of OpenEXR itself and an array are judged alike."""
    bundle = folder / "bundle"
    fredholm("reference", SCENE, "-o", bundle, "--to", "5%", "--size", "16x16", "--spp", "64")
    pixels = np.load(bundle / "pixels.npz")
    radiance = (pixels["radiosity"] / np.pi).astype(np.float32)
    kinds = [("ZIP_COMPRESSION", OpenEXR.ZIP_COMPRESSION), ("PIZ_COMPRESSION", OpenEXR.PIZ_COMPRESSION),
             ("NO_COMPRESSION", OpenEXR.NO_COMPRESSION)]
    np.save(folder / "picture.npy", radiance)
    expected = scores(bundle, folder / "picture.npy", folder / "npy")
    for name, kind in kinds:
        path = folder / f"{name}.exr"
        header = {"compression": kind, "type": OpenEXR.scanlineimage}
        OpenEXR.File(header, {"RGB": radiance}).write(str(path))
        told(f"OpenEXR {name}, scores of judge", scores(bundle, path, folder / name), expected, 0.0)


def scores(bundle, picture, out):
    subprocess.run([PROGRAM, "judge", str(bundle), str(picture), "--exact", "-o", str(out)],
                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    table = (out / "judge.csv").read_text().splitlines()
    at = table[0].split(",").index("z")
    return [float(row.split(",")[at]) for row in table[1:]]


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        fredholm("convert", SCENE, folder / "own.obj")
        expected = ordered(obj(folder / "own.obj"))
        written(folder, expected)
        read_back(folder, expected)
        results(folder)
        pictures(folder)
    print(f"{len(FAULTS)} faults")
    return 1 if FAULTS else 0


if __name__ == "__main__":
    sys.exit(main())
