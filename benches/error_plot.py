#!/usr/bin/env python3
"""Draws the true error of ways to the light of a scene over their CPU seconds, from the tables of a
page.

    python3 benches/error_plot.py docs/rays.md PICTURE.svg

The tables are those whose first column names a scene and the others are `CPU s` and `true`; the
standard library suffices.
"""

import re
import sys
from pathlib import Path

from plots import SERIES, Panel, drawing, legend, text

WAYS = {"rays": "rays", "`trace": "trace, light", "Mitsuba, particles": "Mitsuba, particles",
        "links": "links", "matrix": "matrix"}
HEIGHT, STEP, TOP = 230, 330, 50


def tables(page):
    """Scenes, and the points of each way in them: CPU seconds and true error."""
    found = {}
    for row in page.splitlines():
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        if row.startswith("| scenes/") and cells[1:3] == ["CPU s", "true"]:
            points = found.setdefault(cells[0], {})
        elif not row.startswith("|"):
            points = None
        elif points is not None and (way := next((way for way in WAYS if cells[0].startswith(way)), None)):
            points.setdefault(WAYS[way], []).append((float(cells[1]), float(re.sub("[ %]", "", cells[2])) / 100))
    return found


def main():
    found = tables(Path(sys.argv[1]).read_text(encoding="utf-8"))
    parts, used = [], {}
    for k, (scene, ways) in enumerate(found.items()):
        top = TOP + STEP * k
        panel = Panel(top, HEIGHT, (0.2, 100), (0.005, 0.1))
        parts.append(text(14, top - 16, f"Irradiance of faces, {scene}", "start"))
        numbers = [[(x, f"{x:g}") for x in (0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)],
                   [(y, f"{100 * y:g} %") for y in (0.005, 0.01, 0.02, 0.05, 0.1)]]
        parts += panel.axes(("CPU time of one thread, s", "true error (L2)"), numbers)
        for name, colour in zip(WAYS.values(), SERIES):
            if name in ways:
                used[name] = colour
                parts += panel.line(sorted(ways[name]), colour, marks=True)
    below = TOP + STEP * len(found) - 10
    parts += legend(used.items(), below, 3)
    Path(sys.argv[2]).write_text(drawing(parts, below + 36), encoding="utf-8")


if __name__ == "__main__":
    main()
