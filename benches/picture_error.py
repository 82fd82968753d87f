#!/usr/bin/env python3
"""How far a picture of a solution is from one that was traced pixel by pixel.

    fredholm trace SCENE --method path --samples 8 --spp 64 -o out/traced   # or mitsuba_picture.py
    fredholm solve SCENE --accuracy 5% --final-gather -o out/solved     # or --also exr
    python3 benches/picture_error.py out/traced out/solved [--lamps 4.5]

The difference of luminance, over the mean of the traced picture, as root mean square over square
blocks of pixels, without what the noise of the traced picture brings to it: its standard errors are
known. Whatever the size of the blocks, what is left is the error of the solved picture. Of the
differences of single blocks, that are exceeded by 1 and by 0.1 % of them, it cannot be taken out:
where it is small, they are the worst. Pixels from
which the radiosity is above that of `--lamps` (W/m²) in any band, and those two pixels round them,
are left out. Bands have to be grey or red, green and blue, as in the colours of the picture. Needs
NumPy, and OpenEXR for pictures without pixels.npz.
"""

import argparse
import pathlib

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
BLOCKS = (1, 4, 8, 16)


def colours(folder):
    """Linear colours of a solved picture, height × width × 3, W/m²."""
    pixels = pathlib.Path(folder) / "pixels.npz"
    if pixels.exists():
        return np.load(pixels)["colour"].astype(float)
    import OpenEXR

    channels = OpenEXR.File(str(pathlib.Path(folder) / "image.exr")).channels()
    if "RGB" in channels:
        return channels["RGB"].pixels.astype(float)
    return np.stack([channels[name].pixels for name in "RGB"], axis=-1).astype(float)


def means(values, side):
    """Means over blocks of pixels."""
    height, width = (length // side * side for length in values.shape)
    parts = values[:height, :width].reshape(height // side, side, width // side, side)
    return parts.mean((1, 3))


def beside_lamps(radiosity, lamps):
    """Pixels that show a lamp, height × width, and those two pixels round them."""
    bright = radiosity.max(2) > lamps
    for _ in range(2):
        bright = bright | np.roll(bright, 1, 0) | np.roll(bright, -1, 0)
        bright = bright | np.roll(bright, 1, 1) | np.roll(bright, -1, 1)
    return bright


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("traced")
    parser.add_argument("solved", nargs="+")
    parser.add_argument("--lamps", type=float, default=np.inf, help="W/m²")
    asked = parser.parse_args()
    file = np.load(pathlib.Path(asked.traced) / "pixels.npz")
    radiosity, error = (np.broadcast_to(file[name], (*file["covered"].shape, 3))
                        for name in ("radiosity", "standard_error"))
    used = (file["covered"] > 0.999) & ~beside_lamps(radiosity, asked.lamps)
    traced = radiosity @ LUMINANCE
    # The channels of a pixel come from the same paths. Where the error of their luminance is not
    # told, their errors are added up, which is more than it is in coloured light.
    noise = (file["luminance_error"] if "luminance_error" in file else error @ LUMINANCE) ** 2
    mean = traced[used].mean()
    print(f"mean luminance {mean:.4g} W/m², {used.mean():.1%} of the pixels")
    for folder in asked.solved:
        off = np.where(used, colours(folder) @ LUMINANCE - traced, 0.0)
        print(f"{folder}: mean {off[used].mean() / mean:+.2%}")
        for side in BLOCKS:
            whole = means(used.astype(float), side) > 0.999
            squares, own = means(off, side)[whole] ** 2, means(noise, side)[whole] / side**2
            left = (squares - own).mean()
            sure = (squares - own).std() / len(own) ** 0.5
            print(f"  blocks of {side} × {side}: {np.sqrt(max(left, 0)) / mean:.2%} root mean square"
                  f" ({np.sqrt(max(left - sure, 0)) / mean:.2%} to {np.sqrt(left + sure) / mean:.2%}),"
                  f" noise of the traced picture {np.sqrt(own.mean()) / mean:.2%};"
                  f" 1 and 0.1 % above {', '.join(f'{np.sqrt(q) / mean:.1%}' for q in np.quantile(squares, (0.99, 0.999)))}")


if __name__ == "__main__":
    main()
