"""Irradiance of all faces of a scene by Fredholm and by Mitsuba 3: true error against CPU seconds of one thread.

    pip install numpy scipy mitsuba
    fredholm trace SCENE --method light --to 0.3% --seed 77 -o truth
    python3 benches/beside_mitsuba.py SCENE truth/faces.csv -o DIR [--links] [--program target/release/fredholm]

Mitsuba has two ways (variant llvm_ad_rgb, whose rays are Embree's, compiled before the clock
starts):

- particles: light from the lamps, added up face by face where it arrives, as in its integrator
  `ptracer`, which only makes pictures. Written with its sampler and its rays; all faces are one
  mesh and reflectances one table, which is quicker than one BSDF a surface.
- meters: its integrator `path` along rays that leave the faces with the density of the cosine, as
  its sensor `irradiancemeter` sends them.

Errors are L2 over the faces, worst band, |E - E_truth| / |E_truth|, without what the truth is not
known to. Those of Mitsuba are standard errors, from its rounds: where faces lie on each other it
may find either, so that it tends to something else on some small ones. Writes errors.csv into DIR. Needs the package `fredholm` for the corners of faces.
"""

import argparse
import csv
import json
import subprocess
import tempfile
import time
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np
from scipy.spatial import ConvexHull

import fredholm

mi.set_variant("llvm_ad_rgb")
LANES = 1 << 17
LEAST_ROUNDS = 6
# Rays of a path end by chance from here on, as in Mitsuba's integrators.
ALWAYS_REFLECTED = 4


def faces_of(path):
    """Columns of a faces.csv: areas, irradiances, standard errors (zeros where none are stated)."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    bands = [name.removeprefix("irradiance_") for name in rows[0] if name.startswith("irradiance_")]
    column = lambda name: np.array([float(row.get(name) or 0.0) for row in rows])
    per_band = lambda what: np.stack([column(f"{what}_{band}") for band in bands], axis=1)
    return column("area"), per_band("irradiance"), per_band("standard_error")


def outline(points, normal):
    """Corners of the convex outline of points of a plane, counter-clockwise; middles of sides may be among them."""
    u = points[1] - points[0]
    u /= np.linalg.norm(u)
    flat = (points - points.mean(axis=0)) @ np.stack([u, np.cross(normal, u)], axis=1)
    return points[ConvexHull(flat).vertices]


def area_of(polygon):
    sides = polygon[1:] - polygon[0]
    return 0.5 * np.linalg.norm(np.cross(sides[:-1], sides[1:]).sum(axis=0))


def fan(polygon):
    return [[polygon[0], polygon[k], polygon[k + 1]] for k in range(1, len(polygon) - 1)]


def geometry(scene_file):
    """Faces as lists of polygons, exposed shares, and what each reflects and emits."""
    scene = fredholm.Scene.load(scene_file)
    solution = scene.solve(accuracy=0.1, way="rays")
    corners, starts = solution.polygons
    face = np.asarray(solution.face)
    radiosity, irradiance = np.asarray(solution.radiosity), np.asarray(solution.irradiance)
    kinds = [(np.asarray(m.reflectance), np.asarray(m.exitance)) for m in scene.materials.values()]
    offs = np.stack([np.abs(radiosity - (m + r * irradiance)).max(axis=1) for r, m in kinds], axis=1)
    kind = offs.argmin(axis=1)
    with tempfile.TemporaryDirectory() as folder:
        solution.write(folder)
        field = np.load(Path(folder) / "field.npz")
    exposed = np.bincount(face, field["exposed"] * field["area"]) / np.bincount(face, field["area"])
    polygons, reflectance, exitance = [], [], []
    order = np.argsort(face, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(face[order])) + 1)
    for elements in groups:
        points = np.concatenate([corners[starts[e] : starts[e + 1]] for e in elements])
        polygons.append(outline(points, solution.normal[elements[0]]))
        if not np.isclose(area_of(polygons[-1]), solution.area[elements].sum(), rtol=1e-6):
            # It has holes, or is bent.
            polygons[-1] = [corners[starts[e] : starts[e + 1]] for e in elements]
        else:
            polygons[-1] = [polygons[-1]]
        best = elements[np.argmax(irradiance[elements].sum(axis=1))]
        reflectance.append(kinds[kind[best]][0])
        exitance.append(kinds[kind[best]][1])
    return polygons, exposed, np.array(reflectance), np.array(exitance)


class Soup:
    """All faces as one mesh; sides of two-sided faces share their triangles."""

    def __init__(self, polygons, reflectance, exitance):
        triangles, of_face = [], []
        for i, parts in enumerate(polygons):
            own = [triangle for polygon in parts for triangle in fan(polygon)]
            triangles += own
            of_face += [i] * len(own)
        triangles, of_face = np.array(triangles), np.array(of_face)
        # Two triangles of the same corners are the two sides of one.
        key = np.round(np.sort(np.round(triangles, 7).view("f8,f8,f8").reshape(-1, 3), axis=1).view("f8").reshape(-1, 9), 7)
        _, first, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
        which = which.reshape(-1)
        front = of_face[first]
        back = np.full(len(first), -1)
        second = np.flatnonzero(first[which] != np.arange(len(of_face)))
        back[which[second]] = of_face[second]
        self.triangles = triangles[first]
        self.faces = len(polygons)
        count = len(first)
        mesh = mi.Mesh("soup", 3 * count, count)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = mi.Float(self.triangles.reshape(-1).astype(np.float32))
        parameters["faces"] = mi.UInt(np.arange(3 * count, dtype=np.uint32))
        parameters.update()
        self.scene = mi.load_dict({"type": "scene", "mesh": mesh})
        self.front, self.back = mi.Int(front.astype(np.int32)), mi.Int(back.astype(np.int32))
        self.reflectance = [mi.Float(column.astype(np.float32)) for column in reflectance.T]
        edges = self.triangles[:, 1:] - self.triangles[:, :1]
        area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
        # A lamp's triangle as often as it has power, summed over the bands.
        sides = np.concatenate([front, back])
        emitted = np.where(sides[:, None] >= 0, exitance[sides], 0.0) * np.tile(area, 2)[:, None]
        lamps = np.flatnonzero(emitted.sum(axis=1) > 0)
        chance = emitted[lamps].sum(axis=1) / emitted.sum()
        self.lamp_triangle = mi.UInt((lamps % count).astype(np.uint32))
        self.lamp_turn = mi.Float(np.where(lamps < count, 1.0, -1.0).astype(np.float32))
        self.lamp = mi.DiscreteDistribution(mi.Float(chance.astype(np.float32)))
        self.lamp_power = [mi.Float((emitted[lamps, b] / chance).astype(np.float32)) for b in range(emitted.shape[1])]
        self.corner = [mi.Float(self.triangles[:, i, k].astype(np.float32)) for i in range(3) for k in range(3)]

    def point(self, triangle, a, b):
        at = [dr.gather(mi.Float, column, triangle) for column in self.corner]
        p, q, r = (mi.Point3f(*at[3 * i : 3 * i + 3]) for i in range(3))
        root = dr.sqrt(a)
        place = p * (1 - root) + q * (root * (1 - b)) + r * (root * b)
        return place, dr.normalize(dr.cross(q - p, r - p))


@dr.syntax
def particles(soup, seed, lanes):
    """Power that arrives at each face, W, from `lanes` particles."""
    random = mi.PCG32(lanes, seed)
    bands = len(soup.lamp_power)
    index = soup.lamp.sample(random.next_float32())
    power = [dr.gather(mi.Float, column, index) for column in soup.lamp_power]
    triangle = dr.gather(mi.UInt, soup.lamp_triangle, index)
    place, normal = soup.point(triangle, random.next_float32(), random.next_float32())
    normal *= dr.gather(mi.Float, soup.lamp_turn, index)
    sums = [dr.zeros(mi.Float, soup.faces) for _ in range(bands)]
    active, depth = mi.Bool(True), mi.UInt(0)
    while active:
        frame = mi.Frame3f(normal)
        way = frame.to_world(
            mi.warp.square_to_cosine_hemisphere(mi.Point2f(random.next_float32(), random.next_float32()))
        )
        ray = mi.Ray3f(place + normal * 1e-5, way)
        hit = soup.scene.ray_intersect_preliminary(ray, coherent=False, active=active)
        active &= hit.is_valid()
        at = [dr.gather(mi.Float, column, hit.prim_index, active) for column in soup.corner]
        p, q, r = (mi.Point3f(*at[3 * i : 3 * i + 3]) for i in range(3))
        outward = dr.normalize(dr.cross(q - p, r - p))
        is_front = dr.dot(outward, way) < 0
        face = dr.select(
            is_front,
            dr.gather(mi.Int, soup.front, hit.prim_index, active),
            dr.gather(mi.Int, soup.back, hit.prim_index, active),
        )
        active &= face >= 0
        slot = mi.UInt(face)
        best = mi.Float(0)
        reflects = []
        for b in range(bands):
            dr.scatter_add(sums[b], power[b], slot, active)
            reflects.append(dr.gather(mi.Float, soup.reflectance[b], slot, active))
            best = dr.maximum(best, reflects[b])
        depth += 1
        stays = dr.select(depth < ALWAYS_REFLECTED, 1.0, best)
        active &= (random.next_float32() < stays) & (best > 0)
        for b in range(bands):
            power[b] *= reflects[b] / stays
        normal = dr.select(is_front, outward, -outward)
        place = ray(hit.t)
    return sums


def repeated(one_round, seconds):
    """Rounds with seeds from 1 on; yields CPU seconds, means and their standard errors at times."""
    total, squares, rounds, spent = 0.0, 0.0, 0, 0.0
    seconds = list(seconds)
    while seconds:
        start = time.process_time()
        columns = one_round(rounds + 1)
        dr.eval(columns)
        dr.sync_thread()
        found = np.stack([np.array(column, dtype=np.float64) for column in columns], axis=1)
        total, squares = total + found, squares + found**2
        spent += time.process_time() - start
        rounds += 1
        if spent >= seconds[0] and rounds >= LEAST_ROUNDS:
            seconds.pop(0)
            mean = total / rounds
            yield spent, mean, np.sqrt(np.maximum(squares / rounds - mean**2, 0.0) / (rounds - 1))


def by_particles(soup, area, seconds):
    """Runs for some CPU seconds, at least; yields seconds and irradiances at their doubles."""
    dr.eval(particles(soup, 0, LANES))
    dr.sync_thread()
    rounds = lambda seed: particles(soup, seed, LANES)
    for spent, mean, error in repeated(rounds, seconds):
        yield spent, mean / LANES / area[:, None], error / LANES / area[:, None]


def by_meters(scene_file, polygons, seconds):
    """The path integrator along rays from the faces, as many from each."""
    with tempfile.TemporaryDirectory() as folder:
        program = [ASKED.program, "export", "--to", "mitsuba", scene_file, "-o", folder]
        subprocess.run(program, check=True, capture_output=True)
        scene = mi.load_file(str(next(Path(folder).glob("*.xml"))))
    integrator = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": ALWAYS_REFLECTED})
    own = [[triangle for polygon in parts for triangle in fan(polygon)] for parts in polygons]
    table = np.array([triangle for triangles in own for triangle in triangles])
    corner = [mi.Float(table[:, i, k].astype(np.float32)) for i in range(3) for k in range(3)]
    # A face is chosen, and a triangle of it by its area.
    sizes = np.linalg.norm(np.cross(table[:, 1] - table[:, 0], table[:, 2] - table[:, 0]), axis=1)
    ends = np.cumsum([len(triangles) for triangles in own])
    sums = np.cumsum(sizes)
    below = np.concatenate([[0.0], sums[ends[:-1] - 1]])
    cumulative, below, above = mi.Float64(sums), mi.Float64(below), mi.Float64(sums[ends - 1])
    last = len(table) - 1
    count = len(polygons)
    each = max(1, LANES // count)

    def round_of(seed):
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed, count * each)
        face = dr.arange(mi.UInt, count * each) // each
        low, high = dr.gather(mi.Float64, below, face), dr.gather(mi.Float64, above, face)
        target = low + (high - low) * mi.Float64(sampler.next_1d())
        triangle = mi.UInt(
            dr.binary_search(0, last, lambda index: dr.gather(mi.Float64, cumulative, mi.UInt(index)) < target)
        )
        at = [dr.gather(mi.Float, column, triangle) for column in corner]
        p, q, r = (mi.Point3f(*at[3 * i : 3 * i + 3]) for i in range(3))
        root, b = dr.sqrt(sampler.next_1d()), sampler.next_1d()
        place = p * (1 - root) + q * (root * (1 - b)) + r * (root * b)
        normal = dr.normalize(dr.cross(q - p, r - p))
        way = mi.Frame3f(normal).to_world(mi.warp.square_to_cosine_hemisphere(sampler.next_2d()))
        ray = mi.RayDifferential3f(place + normal * 1e-5, way)
        light, _, _ = integrator.sample(scene, sampler, ray)
        means = []
        for band in range(3):
            sums = dr.zeros(mi.Float, count)
            dr.scatter_add(sums, light[band], face)
            means.append(sums * (dr.pi / each))
        return means

    dr.eval(round_of(0))
    dr.sync_thread()
    yield from repeated(round_of, seconds)


def by_fredholm(line):
    """CPU seconds of the solution or of tracing, and irradiances."""
    with tempfile.TemporaryDirectory() as folder:
        common = ["--threads", "1", "--no-report", "-o", folder, "-q"]
        done = subprocess.run([ASKED.program, *line, *common], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{' '.join(line)}: {done.stderr}")
        record = json.loads((Path(folder) / "run.json").read_text())
        stages = {timing["stage"]: timing["seconds"] for timing in record["timings"]}
        spent = sum(seconds for name, seconds in stages.items() if name not in {"scene", "mesh", "results"})
        return spent, faces_of(Path(folder) / "faces.csv")[1]


def main():
    area, truth, sigma = faces_of(ASKED.truth)
    weight = area[:, None]
    size = (weight * truth**2).sum(axis=0)
    unknown = (weight * sigma**2).sum(axis=0) / size
    rows = []

    def add(way, what, spent, found, error=None):
        squares = (weight * (found - truth) ** 2).sum(axis=0) / size - unknown
        if error is not None:
            squares = (weight * error**2).sum(axis=0) / size
        error = float(np.sqrt(np.maximum(squares, 0.0)).max())
        large = area > area.sum() / 1000
        worst = float((np.abs(found - truth) / np.where(truth > 0, truth, np.inf))[large].max())
        rows.append((way, what, spent, error, worst))
        print(f"{way:12} {what:8} {spent:8.2f} s {100 * error:7.2f} % {100 * worst:7.1f} %", flush=True)

    quiet = ["--no-pictures"]
    for accuracy in ASKED.accuracies.split(","):
        add("rays", accuracy, *by_fredholm(["solve", ASKED.scene, "--accuracy", accuracy, "--way", "rays", *quiet]))
    for method in ASKED.methods.split(","):
        for accuracy in ASKED.traced.split(","):
            add(f"trace {method}", accuracy, *by_fredholm(["trace", ASKED.scene, "--method", method, "--to", accuracy]))
    if ASKED.links:
        for accuracy in ASKED.links.split(","):
            line = ["solve", ASKED.scene, "--accuracy", accuracy, "--way", "links", *quiet]
            add("links", accuracy, *by_fredholm(line))
    if ASKED.matrix:
        add("matrix", "", *by_fredholm(["solve", ASKED.scene, *quiet]))
    dr.set_thread_count(1)
    polygons, exposed, reflectance, exitance = geometry(ASKED.scene)
    soup = Soup(polygons, reflectance, exitance)
    seconds = [float(s) for s in ASKED.seconds.split(",")]
    lit = np.where(exposed > 0, exposed, 1.0) * area
    for spent, found, error in by_particles(soup, lit, seconds):
        add("particles", "", spent, found, error)
    share = np.where(exposed > 0, exposed, 1.0)[:, None]
    for spent, found, error in by_meters(ASKED.scene, polygons, seconds):
        add("meters", "", spent, found / share, error / share)
    folder = Path(ASKED.output)
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "errors.csv", "w", newline="") as file:
        csv.writer(file).writerows([("way", "asked", "cpu_seconds", "true_error", "worst_face"), *rows])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("truth", help="faces.csv with standard errors")
    parser.add_argument("-o", "--output", required=True, help="folder for errors.csv")
    parser.add_argument("--program", default="target/release/fredholm")
    parser.add_argument("--accuracies", default="10%,5%,2%,1%")
    parser.add_argument("--traced", default="5%,2%,1%")
    parser.add_argument("--methods", default="light")
    parser.add_argument("--links", default="", help="accuracies of links, none by default")
    parser.add_argument("--matrix", action="store_true", help="the matrix of the scene's elements, too")
    parser.add_argument("--seconds", default="0.5,1,2,4,8,16", help="CPU seconds of Mitsuba")
    ASKED = parser.parse_args()
    main()
