"""Segments and rays of Fredholm beside Embree on the same kind of scenes, in turns, so that other load hits both alike.

    pip install numpy embreex
    python3 benches/beside_embree.py [rounds]

The scenes are those of crates/visibility/benches/segments.rs: a room of 46 triangles, and one with
four spheres of 20,480 triangles each. Ends of segments are random points of the surfaces. Embree
decides in f32 and is told where a segment begins and ends, a ten-thousandth of it away from both surfaces.
"""

import re
import subprocess
import sys

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
from timing import best

SEGMENTS = 1 << 16
MARGIN = 1e-4


def cuboid(centre, half, turn, inward):
    """Twelve triangles of a box turned about z."""
    sin, cos = np.sin(turn), np.cos(turn)
    axes = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]) * np.asarray(half)[:, None]
    triangles = []
    for n, u, v in ([0, 1, 2], [1, 2, 0], [2, 0, 1]):
        for s in (-1.0, 1.0):
            w = axes[v] * s * (-1.0 if inward else 1.0)
            a, b, c, d = (
                np.asarray(centre) + axes[n] * s + axes[u] * i + w * j
                for i, j in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
            )
            triangles += [[a, b, c], [a, c, d]]
    return np.array(triangles)


def room():
    """A room with a lamp, two boxes and four panels: 46 triangles."""
    parts = [
        cuboid([0.5, 0.5, 0.5], [0.5, 0.5, 0.5], 0.0, True),
        cuboid([0.33, 0.35, 0.15], [0.15, 0.15, 0.15], 0.3, False),
        cuboid([0.65, 0.65, 0.3], [0.14, 0.14, 0.3], -0.4, False),
    ]
    for x, y, z, size in [(0.4, 0.4, 0.99, 0.2)] + [(x, 0.1, 0.8, 0.1) for x in (0.0, 0.25, 0.5, 0.75)]:
        a, b, c, d = (np.array([x + size * u, y + size * v, z]) for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)))
        parts.append(np.array([[a, b, c], [a, c, d]]))
    return np.concatenate(parts)


def spheres():
    """Four spheres in a room: 81,932 triangles."""
    g = 0.5 * (1.0 + 5.0**0.5)
    corners = np.array(
        [p for a, b in ((1, g), (-1, g), (1, -g), (-1, -g)) for p in ((0, a, b), (a, b, 0), (b, 0, a))], float
    )
    near = np.abs(np.linalg.norm(corners[:, None] - corners[None], axis=2) - 2.0) < 1e-9
    faces = [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[k, i]]
    unit = corners[np.array(faces)] / np.linalg.norm(corners[0])
    for _ in range(5):
        a, b, c = unit[:, 0], unit[:, 1], unit[:, 2]
        d, e, f = (m / np.linalg.norm(m, axis=1)[:, None] for m in (a + b, b + c, c + a))
        unit = np.concatenate([np.stack(t, axis=1) for t in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
    places = [((0.3, 0.3, 0.2), 0.2), ((0.7, 0.65, 0.3), 0.25), ((0.25, 0.75, 0.6), 0.15), ((0.7, 0.25, 0.75), 0.2)]
    box = cuboid([0.5, 0.5, 0.5], [0.5, 0.5, 0.5], 0.0, True)
    return np.concatenate([box] + [np.asarray(centre) + radius * unit for centre, radius in places])


def points(triangles, random):
    """Random points of the surfaces."""
    areas = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    picked = triangles[random.choice(len(triangles), SEGMENTS, p=areas / areas.sum())]
    u, v = random.random((2, SEGMENTS, 1))
    u, v = np.where(u + v > 1.0, (1.0 - u, 1.0 - v), (u, v))
    return picked[:, 0] + u * (picked[:, 1] - picked[:, 0]) + v * (picked[:, 2] - picked[:, 0])


def embree():
    """Millions a second of segments and of closest hits, and the share of segments that is blocked."""
    for name, triangles in (("46 triangles", room()), ("81932 triangles", spheres())):
        random = np.random.default_rng(1)
        p, q = points(triangles, random), points(triangles, random)
        scene = rtcore_scene.EmbreeScene()
        TriangleMesh(scene, triangles.astype(np.float32))
        start = (p + MARGIN * (q - p)).astype(np.float32)
        along = ((1.0 - 2.0 * MARGIN) * (q - p)).astype(np.float32)
        ends = np.ones(SEGMENTS, np.float32)
        blocked = np.mean(scene.run(start, along, ends, query="OCCLUDED") != -1)
        segment = best(lambda: scene.run(start, along, ends, query="OCCLUDED"))
        ray = best(lambda: scene.run(start, along))
        rates = [SEGMENTS / seconds / 1e6 for seconds in (segment, ray)]
        print(f"Embree    {name:16} segments {rates[0]:6.2f}   rays {rates[1]:6.2f}   blocked {blocked:.3f}")


def own():
    """The same by the benchmark."""
    command = ["cargo", "bench", "--workspace", "--bench", "segments", "--", "segments|rays"]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    for kind, name, rate, unit in re.findall(
        r"^(segments|rays)/([^\n]*)\s+time:.*?\n\s*thrpt:\s+\[\S+ \S+ (\S+) ([MK])elem/s", said, re.M
    ):
        print(f"Fredholm  {name.strip():16} {kind} {float(rate) / (1.0 if unit == 'M' else 1e3):6.2f}")


def main():
    for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 2):
        embree()
        own()


if __name__ == "__main__":
    main()
