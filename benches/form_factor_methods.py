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
#: Settings of every method with the points that they stand for, and the colour of the line.
METHODS = {
    "area-gauss": ([(n, n**4) for n in (1, 2, 3, 4, 5, 6, 8, 10)], "#0072b2"),
    "monte-carlo": ([(4**k, 4**k) for k in range(2, 10)], "#d55e00"),
    "nystrom": ([(n, n**2) for n in (1, 2, 4, 8, 16, 32)], "#009e73"),
    "hemicube": ([(n, 3 * n**2) for n in (8, 16, 32, 64, 128, 256)], "#cc79a7"),
}
LEFT, TOP, WIDTH, HEIGHT = 70, 20, 460, 300
DECADES_ACROSS, DECADES_DOWN = 6, 14


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


def place(points, error):
    """Where a value lies in the picture."""
    x = LEFT + WIDTH * math.log10(points) / DECADES_ACROSS
    y = TOP - HEIGHT * math.log10(max(error, 10.0**-DECADES_DOWN)) / DECADES_DOWN
    return f"{x:.1f},{y:.1f}"


def grid():
    """Lines and numbers of both axes."""
    for k in range(0, DECADES_ACROSS + 1):
        x = LEFT + WIDTH * k / DECADES_ACROSS
        yield f'<line x1="{x:.1f}" y1="{TOP}" x2="{x:.1f}" y2="{TOP + HEIGHT}" stroke="#dddddd"/>'
        yield f'<text x="{x:.1f}" y="{TOP + HEIGHT + 18}" text-anchor="middle">1e{k}</text>'
    for k in range(0, DECADES_DOWN + 1, 2):
        y = TOP + HEIGHT * k / DECADES_DOWN
        yield f'<line x1="{LEFT}" y1="{y:.1f}" x2="{LEFT + WIDTH}" y2="{y:.1f}" stroke="#dddddd"/>'
        yield f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">1e{-k}</text>'
    middle = LEFT + WIDTH / 2
    yield f'<text x="{middle}" y="{TOP + HEIGHT + 40}" text-anchor="middle">points or pixels</text>'
    yield f'<text transform="translate(18,{TOP + HEIGHT / 2}) rotate(-90)" ' \
          'text-anchor="middle">relative error</text>'


def main():
    picture, parts = Path(sys.argv[1]), list(grid())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "squares.toml").write_text(SCENE, encoding="utf-8")
        for number, (method, (settings, colour)) in enumerate(METHODS.items()):
            errors = [(n, abs(computed(folder, method, s) / exact() - 1)) for s, n in settings]
            line = " ".join(place(*value) for value in errors)
            style = f'fill="none" stroke="{colour}" stroke-width="2"'
            parts.append(f'<polyline points="{line}" {style}/>')
            y = TOP + 20 + 20 * number
            parts.append(f'<text x="{LEFT + WIDTH + 12}" y="{y}" fill="{colour}">{method}</text>')
            print(method, ", ".join(f"{n}: {error:.1e}" for n, error in errors))
    head = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 380" ' \
           'font-family="sans-serif" font-size="13">'
    white = '<rect width="640" height="380" fill="white"/>'
    picture.write_text("\n".join([head, white, *parts, "</svg>\n"]), encoding="utf-8")


if __name__ == "__main__":
    main()
