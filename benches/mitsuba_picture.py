#!/usr/bin/env python3
"""A scene as Mitsuba 3 traces it, for picture_error.py.

    pip install numpy mitsuba
    python3 benches/mitsuba_picture.py SCENE -o DIR [--rounds 16] [--samples 64] \\
        [--tiles 200 --lamps 4.5]
    fredholm solve SCENE --also exr -o out/solved
    python3 benches/picture_error.py DIR out/solved

The integrator `path` (variant llvm_ad_rgb, as many threads as there are) through the camera of the
exported scene: the mean over each pixel, in rounds with seeds of their own, whose scatter is the
standard error. Then the square tile with the largest mean square error, without pixels that show
lamps as in picture_error.py, gets as many paths as its pixels have, again and again. Writes
pixels.npz into DIR: radiosity and standard_error, height × width × 3, W/m², and luminance_error,
covered, paths and rounds, height × width. Goes on from what DIR has of it: `--rounds 0` adds tiles
alone.
"""

import argparse
import pathlib
import subprocess
import tempfile
import time
from xml.etree import ElementTree

import mitsuba as mi
import numpy as np

from picture_error import LUMINANCE, beside_lamps

mi.set_variant("llvm_ad_rgb")


TILE = 64
# Paths that are traced together, at most.
MOST_PATHS = 1 << 23


class Pixels:
    """Sums over the rounds, each with a number of paths as its weight."""

    def __init__(self, file):
        self.file = file
        self.paths = self.rounds = self.first = self.second = 0.0
        if file.exists():
            old = np.load(file)
            self.paths, self.rounds = (old[name].astype(float)[..., None] for name in ("paths", "rounds"))
            means = with_luminance(old["radiosity"])
            errors = np.concatenate([old["standard_error"], old["luminance_error"][..., None]], axis=2)
            self.first = self.paths * means
            self.second = errors**2 * self.paths * (self.rounds - 1.0) + self.paths * means**2

    def add(self, radiosity, paths, place=np.s_[:, :]):
        radiosity = with_luminance(radiosity)
        if np.isscalar(self.paths):
            shape = radiosity.shape
            self.paths, self.rounds = np.zeros((*shape[:2], 1)), np.zeros((*shape[:2], 1))
            self.first, self.second = np.zeros(shape), np.zeros(shape)
        self.paths[place] += paths
        self.rounds[place] += 1.0
        self.first[place] += paths * radiosity
        self.second[place] += paths * radiosity**2

    def mean(self):
        """Red, green, blue and luminance."""
        return self.first / self.paths

    def error(self):
        """The standard errors of these; unknown, and so infinite, after one round."""
        squares = np.maximum(self.second - self.first**2 / self.paths, 0.0)
        known = np.sqrt(squares / (self.paths * np.maximum(self.rounds - 1.0, 1.0)))
        return np.where(self.rounds > 1.0, known, np.inf)

    def write(self):
        self.file.parent.mkdir(parents=True, exist_ok=True)
        paths, rounds = self.paths[..., 0], self.rounds[..., 0]
        mean, error = self.mean(), self.error()
        unfinished = self.file.with_name("unfinished.npz")
        np.savez(unfinished, radiosity=mean[..., :3], standard_error=error[..., :3],
                 luminance_error=error[..., 3], covered=np.ones(paths.shape), paths=paths, rounds=rounds)
        unfinished.replace(self.file)


def with_luminance(colours):
    """Colours with their luminance behind them."""
    return np.concatenate([colours, (colours @ LUMINANCE)[..., None]], axis=2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--program", default="target/release/fredholm")
    parser.add_argument("--rounds", type=int, default=16)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--tiles", type=int, default=0)
    parser.add_argument("--lamps", type=float, default=np.inf, help="W/m²")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([asked.program, "export", "--to", "mitsuba", asked.scene, "-o", folder, "-q"], check=True)
        file = next(pathlib.Path(folder).glob("*.xml"))
        scene = mi.load_file(str(file), spp=asked.samples)
        tree = ElementTree.parse(file)
        for name in ("crop_width", "crop_height", "crop_offset_x", "crop_offset_y"):
            ElementTree.SubElement(tree.find(".//film"), "integer", name=name, value=f"${name}")
        tree.write(file)
        integrator = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 6})
        pixels, start = Pixels(pathlib.Path(asked.output) / "pixels.npz"), time.time()

        def render(scene, paths):
            # Radiosity of what reflects diffusely is π times its radiance. No seed is used twice.
            seed = int(np.sum(pixels.rounds)) % (1 << 32)
            return np.pi * np.array(mi.render(scene, integrator=integrator, seed=seed, spp=paths), dtype=float)

        for k in range(asked.rounds):
            pixels.add(render(scene, asked.samples), asked.samples)
            pixels.write()
            print(f"round {k + 1} of {asked.rounds}, {time.time() - start:.0f} s", flush=True)
        for k in range(asked.tiles):
            beside = beside_lamps(pixels.mean()[..., :3], asked.lamps)
            variance = np.where(beside, 0.0, pixels.error()[..., 3] ** 2)
            height, width = variance.shape
            corners = [(y, x) for y in range(0, height, TILE) for x in range(0, width, TILE)]
            y, x = max(corners, key=lambda at: variance[at[0] : at[0] + TILE, at[1] : at[1] + TILE].mean())
            tile = np.s_[y : min(y + TILE, height), x : min(x + TILE, width)]
            rows, columns = variance[tile].shape
            crop = {"crop_width": columns, "crop_height": rows, "crop_offset_x": x, "crop_offset_y": y}
            paths = int(pixels.paths[tile].min())
            together = max(min(paths, MOST_PATHS // (rows * columns)), 1)
            part = mi.load_file(str(file), **{name: str(value) for name, value in crop.items()})
            for _ in range(-(-paths // together)):
                pixels.add(render(part, together), together, tile)
            pixels.write()
            print(f"tile {k + 1} of {asked.tiles} at {x}, {y}, {time.time() - start:.0f} s", flush=True)


if __name__ == "__main__":
    main()
