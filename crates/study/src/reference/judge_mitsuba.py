"""Renders the scene of this bundle with Mitsuba 3 and judges the pictures by the reference.

    pip install mitsuba numpy
    python judge_mitsuba.py
    python judge_mitsuba.py --seeds 16 --spp 1024 --save mitsuba.npy
    fredholm judge . mitsuba.npy

Every seed gives an independent picture. Their mean over all seeds is compared with the reference,
pixel by pixel and band by band and for the whole picture:

    t = (mean - reference) / sqrt(standard error^2 + error of the reference^2 + rounding^2)

z is the normal score of t, which follows Student's law with one degree of freedom less than there
are seeds (D. L. Wallace, Ann. Math. Stat. 30 (1959) 1121). The pictures disagree where a pixel is
significantly apart after Holm's correction for the number of pixels. The exit code is 0 where they
agree and 6 where they do not, 3 where all of the reference is black. `fredholm judge` looks at parts of the picture, too.
"""

import argparse
import json
import math
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
# Standard deviation of rounding in single precision over many samples, relative to the value.
ROUNDING = 1e-5


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=16, help="independent pictures (16)")
    parser.add_argument("--spp", type=int, default=256, help="samples per pixel of each (256)")
    parser.add_argument("--scene", default=str(HERE / "scene.xml"), help="scene file (scene.xml)")
    parser.add_argument("--variant", default="scalar_rgb", help="variant of Mitsuba (scalar_rgb)")
    parser.add_argument("--significance", type=float, default=0.01, help="chance of a false alarm")
    parser.add_argument("--save", metavar="FILE", help="also write the pictures as a NumPy file")
    return parser.parse_args()


def render(scene_file, seeds, spp, variant):
    """The pictures: seeds x height x width x 3, radiance in W/(m^2 sr)."""
    import mitsuba as mi

    mi.set_variant(variant)
    scene = mi.load_file(scene_file)
    pictures = [np.array(mi.render(scene, seed=seed, spp=spp)) for seed in range(seeds)]
    return np.array(pictures, dtype=np.float64)


def normal_scores(t, freedom):
    """Scores of the normal law that are as improbable as these of Student's law."""
    size = np.sqrt(freedom * np.log1p(t * t / freedom))
    return np.sign(t) * size * (8 * freedom + 1) / (8 * freedom + 3)


def holm(scores, significance):
    """How many scores are significant, all tests together."""
    p = np.sort([math.erfc(abs(z) / math.sqrt(2)) for z in scores])
    passes = p <= significance / np.arange(len(p), 0, -1)
    return len(p) if passes.all() else int(np.argmin(passes))


def main():
    asked = arguments()
    record = json.loads((HERE / "reference.json").read_text())
    stored = np.load(HERE / "pixels.npz")
    # A radiosity is pi times the radiance of a diffuse surface.
    known, error = stored["radiosity"] / np.pi, stored["standard_error"] / np.pi
    if not known.any():
        print("undecided: all pixels of the reference are black")
        return 3
    pictures = render(asked.scene, asked.seeds, asked.spp, asked.variant)
    if asked.save:
        np.save(asked.save, pictures)
    if known.shape[2] == 1:
        # Grey: all three channels are the same.
        pictures = pictures.mean(axis=3, keepdims=True)

    def compare(known, error, pictures):
        mean = pictures.mean(axis=0)
        spread = pictures.std(axis=0, ddof=1) / math.sqrt(len(pictures))
        sigma = np.sqrt(spread**2 + error**2 + (ROUNDING * known) ** 2)
        apart = np.divide(mean - known, sigma, out=np.zeros_like(known), where=sigma > 0)
        apart[(sigma == 0) & (mean != known)] = np.inf
        freedom = min(len(pictures), record["pixels"]["batches"]) - 1
        return normal_scores(apart, freedom)

    pixels = compare(known, error, pictures)
    count = known.shape[0] * known.shape[1]
    whole = compare(
        known.mean(axis=(0, 1)),
        np.sqrt((error**2).sum(axis=(0, 1))) / count,
        pictures.mean(axis=(1, 2)),
    )
    scores = np.concatenate([pixels.ravel(), whole.ravel()])
    found = holm(scores, asked.significance)
    y, x, band = np.unravel_index(np.argmax(np.abs(pixels)), pixels.shape)
    print(f"{len(scores)} tests: mean z {pixels.mean():+.3f}, mean z^2 {(pixels**2).mean():.3f}")
    print(f"worst pixel: row {y}, column {x}, band {record['bands'][band]}, z {pixels[y, x, band]:+.2f}")
    print("whole picture: z " + ", ".join(f"{z:+.2f}" for z in whole))
    print(f"{'agrees' if found == 0 else 'disagrees'}: {found} significantly apart")
    return 0 if found == 0 else 6


if __name__ == "__main__":
    sys.exit(main())
