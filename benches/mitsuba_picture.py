#!/usr/bin/env python3
"""A scene as Mitsuba 3 traces it, for picture_error.py.

    pip install numpy mitsuba
    python3 benches/mitsuba_picture.py SCENE -o DIR [--rounds 16] [--samples 64]
    fredholm solve SCENE --also exr -o out/solved
    python3 benches/picture_error.py DIR out/solved

The integrator `path` (variant llvm_ad_rgb, as many threads as there are) through the camera of the
exported scene: the mean over each pixel, in rounds with seeds of their own, whose scatter is the
standard error. Writes pixels.npz into DIR: radiosity and standard_error, height × width × 3, W/m²,
and covered, height × width.
"""

import argparse
import pathlib
import subprocess
import tempfile
import time

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--program", default="target/release/fredholm")
    parser.add_argument("--rounds", type=int, default=16)
    parser.add_argument("--samples", type=int, default=64)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([asked.program, "export", "--to", "mitsuba", asked.scene, "-o", folder, "-q"], check=True)
        scene = mi.load_file(str(next(pathlib.Path(folder).glob("*.xml"))), spp=asked.samples)
    integrator = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 6})
    total, squares, start = 0.0, 0.0, time.time()
    for k in range(asked.rounds):
        image = mi.render(scene, integrator=integrator, seed=k + 1, spp=asked.samples)
        # Radiosity of what reflects diffusely is π times its radiance.
        radiosity = np.pi * np.array(image, dtype=np.float64)
        total, squares = total + radiosity, squares + radiosity**2
        print(f"round {k + 1} of {asked.rounds}, {time.time() - start:.0f} s", flush=True)
    mean = total / asked.rounds
    error = np.sqrt(np.maximum(squares / asked.rounds - mean**2, 0.0) / (asked.rounds - 1))
    out = pathlib.Path(asked.output)
    out.mkdir(parents=True, exist_ok=True)
    np.savez(out / "pixels.npz", radiosity=mean, standard_error=error, covered=np.ones(mean.shape[:2]))


if __name__ == "__main__":
    main()
