"""Drawings of the documents by scripts, in the colours of crates/report/src/plot/theme.rs and the
sizes of the plots of the program: light, or dark on screens that ask for it. The standard library
suffices."""

import math

WIDTH = 600
#: Colours of the ground, of words, of lines behind, and of series; and those on a dark ground.
GROUND, INK, GRID = "#ffffff", "#1f2328", "#dee1e5"
SERIES = ["#0072b2", "#d55e00", "#00966c", "#c4649b", "#b07a00"]
DARK = dict(zip([GROUND, INK, GRID, *SERIES],
                ["#16181d", "#e6e8eb", "#434954", "#3d9bd8", "#f07f2e", "#2bbf94", "#dd86b8", "#d9a02a"]))
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def text(x, y, words, anchor="middle", turned=""):
    """Words in the drawing."""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{INK}"{turned}>{words}</text>'


def power(k):
    """A power of ten."""
    return "10" + str(k).translate(RAISED)


class Panel:
    """A part of a drawing with two logarithmic axes, each from one value to another."""

    LEFT, RIGHT = 84, 26

    def __init__(self, top, height, across, down):
        self.top, self.height, self.across, self.down = top, height, across, down
        self.width = WIDTH - self.LEFT - self.RIGHT

    def x(self, value):
        low, high = map(math.log10, self.across)
        return self.LEFT + self.width * (math.log10(value) - low) / (high - low)

    def y(self, value):
        low, high = map(math.log10, self.down)
        value = max(value, self.down[0])
        return self.top + self.height * (high - math.log10(value)) / (high - low)

    def axes(self, names, numbers):
        """Lines, numbers (pairs of a value and its words, across and upwards) and names."""
        for value, words in numbers[0]:
            x = self.x(value)
            yield f'<path d="M{x:.1f} {self.top}v{self.height}" stroke="{GRID}"/>'
            yield text(x, self.top + self.height + 20, words)
        for value, words in numbers[1]:
            y = self.y(value)
            yield f'<path d="M{self.LEFT} {y:.1f}h{self.width}" stroke="{GRID}"/>'
            yield text(self.LEFT - 8, y + 5, words, "end")
        yield text(self.LEFT + self.width / 2, self.top + self.height + 44, names[0])
        middle = self.top + self.height / 2
        yield text(20, middle, names[1], turned=f' transform="rotate(-90 20 {middle})"')

    def line(self, points, colour, marks=False):
        """A line through points, with a mark at each."""
        places = [(self.x(x), self.y(y)) for x, y in points]
        along = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        yield f'<polyline points="{along}" fill="none" stroke="{colour}" stroke-width="2"/>'
        for x, y in places if marks else []:
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"/>'


def legend(entries, y, columns):
    """Names of the series with their colours, so many in a row."""
    for k, (name, colour) in enumerate(entries):
        x, below = 14 + (WIDTH - 28) / columns * (k % columns), y + 24 * (k // columns)
        yield f'<path d="M{x:.1f} {below - 5}h24" stroke="{colour}" stroke-width="2"/>'
        yield text(x + 32, below, name, "start")


def drawing(parts, height):
    """The whole file."""
    rules = "".join(f'[fill="{a}"]{{fill:{b}}}[stroke="{a}"]{{stroke:{b}}}' for a, b in DARK.items())
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        'font-family="sans-serif" font-size="16">',
        f"<style>@media screen and (prefers-color-scheme:dark){{{rules}}}</style>",
        f'<rect width="{WIDTH}" height="{height}" fill="{GROUND}"/>', *parts, "</svg>\n"])
