"""A room made of arrays, with a lamp at several heights: `python examples/python/room.py`."""

import numpy as np

import fredholm
from fredholm import Material, Scene, Surface

#: Corners of a room of 4 m × 3 m × 2.5 m, and its sides, lit within.
CORNERS = np.array([[x, y, z] for x in (0.0, 4.0) for y in (0.0, 3.0) for z in (0.0, 2.5)])
SIDES = {
    "walls": [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3]],
    "floor": [[0, 4, 6, 2]],
    "ceiling": [[1, 3, 7, 5]],
}


def room(height: float) -> Scene:
    """The room with a square lamp of 1 m² at some height, m, that shines downwards."""
    lamp = np.array([[1.5, 1, height], [1.5, 2, height], [2.5, 2, height], [2.5, 1, height]])
    surfaces = [
        Surface("walls", (CORNERS, SIDES["walls"]), "paint", largest_edge=1.0),
        Surface("floor", (CORNERS, SIDES["floor"]), "paint", largest_edge=1.0),
        Surface("ceiling", (CORNERS, SIDES["ceiling"]), "paint", largest_edge=1.0),
        Surface("lamp", (lamp, [[0, 1, 2, 3]]), "lamp"),
    ]
    return Scene.build(surfaces, {"paint": Material(0.6), "lamp": Material(0.1, exitance=100.0)})


def main() -> None:
    for height in (1.6, 2.0, 2.4):
        solution: fredholm.Solution = room(height).solve(accuracy=0.02)
        floor = solution["floor"]
        light, error = floor.irradiance[0], floor.error[0]
        print(f"lamp at {height} m: {light:.3f} ± {error:.3f} W/m² on the floor")


if __name__ == "__main__":
    main()
