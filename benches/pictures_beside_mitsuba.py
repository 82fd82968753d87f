"""Pictures of a solution beside a path-traced one by Mitsuba 3: difference of every pixel.

    pip install numpy mitsuba
    python3 benches/pictures_beside_mitsuba.py SCENE -o DIR [--rounds 16] [--samples 64] [OPTIONS OF SOLVE]

The reference is the integrator `path` of Mitsuba (variant llvm_ad_rgb) through the camera of the
exported scene, the mean over each pixel, in rounds with seeds of their own: reference.npz in DIR,
which is read where it is there and made where it is not. Fredholm's picture is image.exr (and with
`--final-gather` in OPTIONS the gathered one): linear colours, W/m².

Told of luminance, over its mean in the reference: the root of the mean square of the difference,
with the square of the reference's own noise taken off, and the differences that 1 % and 0.1 % of
the pixels exceed, with that noise in them. Pixels that show a lamp, or lie beside one that does,
are told apart: there a difference is that of the samples of a border.
"""

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
# Radiance over the largest of what is no lamp, from which on a pixel shows one.
LAMP_SHARE = 0.02


def rendered(scene_file, program, rounds, samples):
    """Sums over even and odd rounds, radiosity W/m², and the number of rounds of each."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "export", "--to", "mitsuba", scene_file, "-o", folder, "-q"], check=True)
        scene = mi.load_file(str(next(Path(folder).glob("*.xml"))), spp=samples)
    integrator = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 6})
    halves = [0.0, 0.0]
    start = time.time()
    for k in range(rounds):
        image = mi.render(scene, integrator=integrator, seed=k + 1, spp=samples)
        halves[k % 2] = halves[k % 2] + np.pi * np.array(image, dtype=np.float64)
        print(f"round {k + 1} of {rounds}, {time.time() - start:.0f} s", flush=True)
    return halves[0] / ((rounds + 1) // 2), halves[1] / (rounds // 2)


def grown(mask):
    """A mask and the pixels beside it."""
    wide = np.pad(mask, 1)
    h, w = mask.shape
    return np.any([wide[y : y + h, x : x + w] for y in range(3) for x in range(3)], axis=0)


def pictures(folder):
    for name in sorted(Path(folder).glob("*.exr")):
        yield name.name, np.array(mi.Bitmap(str(name)).convert(mi.Bitmap.PixelFormat.RGB), dtype=np.float64)


def compared(name, picture, halves, lamps):
    one, two = (half @ LUMINANCE for half in halves)
    own = picture @ LUMINANCE
    reference = 0.5 * (one + two)
    mean = reference[~lamps].mean()
    for what, where in [("no lamps", ~lamps), ("lamps", lamps)]:
        if not where.any():
            continue
        # The noises of the halves are independent: their product has none in the mean.
        square = ((own - one) * (own - two))[where].mean()
        off = np.abs(own - reference)[where] / mean
        noise = 0.5 * np.sqrt(((one - two) ** 2)[where].mean()) / mean
        tail = [100 * np.quantile(off, q) for q in (0.5, 0.9, 0.99, 0.999)]
        print(
            f"{name:16} {what:9} {where.mean():6.1%} of pixels, RMS {100 * np.sqrt(max(square, 0)) / mean:6.2f} %, "
            f"half, 10 %, 1 %, 0.1 % above {', '.join(f'{t:.2f}' for t in tail)} %, noise {100 * noise:.2f} %"
        )


def main():
    folder = Path(ASKED.output)
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / "reference.npz"
    if kept.exists():
        with np.load(kept) as file:
            halves = file["one"], file["two"]
    else:
        halves = rendered(ASKED.scene, ASKED.program, ASKED.rounds, ASKED.samples)
        np.savez(kept, one=halves[0], two=halves[1])
    reference = 0.5 * (halves[0] + halves[1])
    mi.Bitmap(reference.astype(np.float32)).write(str(folder / "reference.exr"))
    own = folder / "fredholm"
    line = [ASKED.program, "solve", ASKED.scene, "--also", "exr", "--threads", "1", "--no-report", "-q"]
    subprocess.run([*line, "-o", own, *OPTIONS], check=True)
    record = json.loads((own / "run.json").read_text())
    stages = ", ".join(f"{timing['stage']} {timing['seconds']:.2f} s" for timing in record["timings"])
    print(stages, record["picture"][:150])
    found = list(pictures(own))
    h, w = reference.shape[:2]
    shown = np.maximum(*(half @ LUMINANCE for half in halves))
    lamps = grown(shown > ASKED.lamps * np.median(shown)) if ASKED.lamps else np.zeros((h, w), bool)
    for name, picture in found:
        compared(name, picture, halves, lamps)
        off = picture @ LUMINANCE - reference @ LUMINANCE
        np.save(folder / f"off_{name}.npy", off)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--program", default="target/release/fredholm")
    parser.add_argument("--rounds", type=int, default=16)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--lamps", type=float, default=8.0, help="luminance over the median that only lamps have")
    ASKED, OPTIONS = parser.parse_known_args()
    main()
