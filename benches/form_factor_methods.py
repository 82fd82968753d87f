#!/usr/bin/env python3
"""Draws the error of form-factor methods over their points, on unit squares facing each other at
distance 1.

    FREDHOLM_PROGRAM=target/release/fredholm python3 benches/form_factor_methods.py PICTURE.svg

The exact view factor is the closed form of two parallel squares (J. R. Howell's catalogue, C-11).
The standard library suffices.
"""

import csv
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from plots import SERIES, Panel, drawing, legend, power, text

SCENE = """
[materials.grey]
reflectance = 0.5
[[surface]]
name = "floor"
material = "grey"
quad = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
[[surface]]
name = "ceiling"
material = "grey"
quad = [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]
"""
#: Settings of every method with the points that they stand for.
METHODS = {
    "area-gauss": [(n, n**4) for n in (1, 2, 3, 4, 5, 6, 8, 10)],
    "monte-carlo": [(4**k, 4**k) for k in range(2, 10)],
    "nystrom": [(n, n**2) for n in (1, 2, 4, 8, 16, 32)],
    "hemicube": [(n, 3 * n**2) for n in (8, 16, 32, 64, 128, 256)],
}


def exact():
    """The view factor of unit squares at distance 1: with X = Y = 1 in the catalogue's formula."""
    two = math.sqrt(2)
    return (math.log(2 / math.sqrt(3)) + 2 * two * math.atan(1 / two) - math.pi / 2) * 2 / math.pi


def computed(folder, method, setting):
    """The view factor by a method."""
    command = [os.environ["FREDHOLM_PROGRAM"], "viewfactors", str(folder / "squares.toml"), "-o",
               str(folder / "F.csv"), "--quiet", "--method", method, "--setting", str(setting)]
    subprocess.run(command, check=True)
    with open(folder / "F.csv", encoding="utf-8") as file:
        return float(next(csv.DictReader(file))["ceiling"])


def main():
    panel = Panel(50, 320, (1, 1e6), (1e-14, 1))
    parts = [text(14, 28, "Unit squares at distance 1: error of their view factor", "start")]
    numbers = [[(10.0**k, power(k)) for k in range(0, 7)], [(10.0**k, power(k)) for k in range(-14, 1, 2)]]
    parts += panel.axes(("points or pixels", "relative error"), numbers)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "squares.toml").write_text(SCENE, encoding="utf-8")
        for (method, settings), colour in zip(METHODS.items(), SERIES):
            errors = [(n, abs(computed(folder, method, s) / exact() - 1)) for s, n in settings]
            parts += panel.line(errors, colour)
            print(method, ", ".join(f"{n}: {error:.1e}" for n, error in errors))
    parts += legend(zip(METHODS, SERIES), 444, 4)
    Path(sys.argv[1]).write_text(drawing(parts, 456), encoding="utf-8")


if __name__ == "__main__":
    main()
