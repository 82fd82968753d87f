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
    "nystrom": ([(n, n**2) for n in (1, 2, 4, 8, 16, 32)], "#00966c"),
    "hemicube": ([(n, 3 * n**2) for n in (8, 16, 32, 64, 128, 256)], "#c4649b"),
}
LEFT, TOP, WIDTH, HEIGHT = 84, 50, 490, 320
DECADES_ACROSS, DECADES_DOWN = 6, 14
#: Colours of the plots of the program, and those of them on a dark ground.
GROUND, INK, GRID = "#ffffff", "#1f2328", "#dee1e5"
DARK = {GROUND: "#16181d", INK: "#e6e8eb", GRID: "#434954", "#0072b2": "#3d9bd8",
        "#d55e00": "#f07f2e", "#00966c": "#2bbf94", "#c4649b": "#dd86b8"}
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


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


def text(x, y, words, anchor="middle", turned=""):
    """Words in the drawing."""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{INK}"{turned}>{words}</text>'


def power(k):
    """A power of ten."""
    return "10" + str(k).translate(RAISED)


def grid():
    """Title, lines, and numbers and names of both axes."""
    yield text(14, 28, "Unit squares at distance 1: error of their view factor", "start")
    for k in range(0, DECADES_ACROSS + 1):
        x = LEFT + WIDTH * k / DECADES_ACROSS
        yield f'<path d="M{x:.1f} {TOP}v{HEIGHT}" stroke="{GRID}"/>'
        yield text(x, TOP + HEIGHT + 20, power(k))
    for k in range(0, DECADES_DOWN + 1, 2):
        y = TOP + HEIGHT * k / DECADES_DOWN
        yield f'<path d="M{LEFT} {y:.1f}h{WIDTH}" stroke="{GRID}"/>'
        yield text(LEFT - 8, y + 5, power(-k), "end")
    yield text(LEFT + WIDTH / 2, TOP + HEIGHT + 44, "points or pixels")
    middle = TOP + HEIGHT / 2
    yield text(20, middle, "relative error", turned=f' transform="rotate(-90 20 {middle})"')


def main():
    picture, parts = Path(sys.argv[1]), list(grid())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "squares.toml").write_text(SCENE, encoding="utf-8")
        for number, (method, (settings, colour)) in enumerate(METHODS.items()):
            errors = [(n, abs(computed(folder, method, s) / exact() - 1)) for s, n in settings]
            line = " ".join(place(*value) for value in errors)
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
            x, y = 14 + 145 * number, TOP + HEIGHT + 74
            parts.append(f'<path d="M{x} {y - 5}h24" stroke="{colour}" stroke-width="2"/>')
            parts.append(text(x + 32, y, method, "start"))
            print(method, ", ".join(f"{n}: {error:.1e}" for n, error in errors))
    rules = "".join(f'[fill="{a}"]{{fill:{b}}}[stroke="{a}"]{{stroke:{b}}}' for a, b in DARK.items())
    head = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 600 456" ' \
           'font-family="sans-serif" font-size="16">'
    style = f"<style>@media screen and (prefers-color-scheme:dark){{{rules}}}</style>"
    ground = f'<rect width="600" height="456" fill="{GROUND}"/>'
    picture.write_text("\n".join([head, style, ground, *parts, "</svg>\n"]), encoding="utf-8")


if __name__ == "__main__":
    main()
