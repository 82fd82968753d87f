"""Compares the time and the memory that `fredholm check` says with those of the run, on one thread.

    python3 tests/forecasts.py target/release/fredholm           # all
    python3 tests/forecasts.py target/release/fredholm waves     # those whose name has this in it

Prints a table with what is said, what the run takes in CPU seconds and holds at most, their ratios, and what `check`
itself takes. Said to be "less than a second" are runs of up to two. Ends with exit code 1 where a time is beyond a factor
of two, or a memory above 25 MiB beyond 15 %. Needs Python 3.9 and nothing else, and some minutes; other work on the
machine changes little.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = Path(__file__).parent.parent / "scenes"
# MiB of which most is the program's own.
LITTLE = 25
UNITS = {"second": 1, "minute": 60, "hour": 3600, "day": 86400}

WAVE = """[wave]
frequencies_hz = [1e9]
{settings}
[[source]]
kind = "plane-wave"
travel = [0, 1, 0]
polarisation = [0, 0, 1]
[[surface]]
name = "body"
{body}
edge = "lambda/{edge}"
{material}
[[receiver]]
name = "rcs"
{receiver}
"""
BOX = "box = {{ min = [-{0}, -{0}, -{0}], max = [{0}, {0}, {0}] }}"
SPHERE = "sphere = {{ centre = [0, 0, 0], radius = {0} }}"
QUAD = "quad = [[-{0}, 0, -{0}], [{0}, 0, -{0}], [{0}, 0, {0}], [-{0}, 0, {0}]]"
FAR = "far = { theta_degrees = 90, phi_degrees = { from = 0, to = 359, points = 360 } }"
SWEEP = "monostatic = { theta_degrees = 90, phi_degrees = { from = 0, to = 90, points = 46 } }"


def made(settings, body, edge, receiver=FAR):
    return WAVE.format(settings=settings, body=body, edge=edge, receiver=receiver, material="")


# Made scenes of waves: a method each, at sizes between those that are shipped.
MADE = {
    "dual surface, cube of 2.7 wavelengths": made('method = "dual-surface-mfie"', BOX.format(0.4), 8),
    "mfie, cube of 2 wavelengths, lu": made('method = "mfie"\nsolver = "lu"', BOX.format(0.3), 8),
    "efie, plate of 2 wavelengths": made('method = "efie"', QUAD.format(0.3), 16),
    "cfie, cube of 1 wavelength": made('method = "cfie"', BOX.format(0.15), 12),
    "one bounce, plate of 20 wavelengths": made("bounces = 1", QUAD.format(3), 10, "circle = { centre = [0, 0, 0], radius = 25, normal = [0, 0, 1], start = [1, 0, 0], points = 720 }"),
    "sweep, cube of 2 wavelengths": made('method = "dual-surface-mfie"', BOX.format(0.3), 6, SWEEP),
}
LIGHT = [
    "leblond_room", "leblond_room_fine", "leblond_furnished", "corridor", "sphere", "courtyard", "two_rooms", "white_room",
    "occluder", "furnace", "cornell_box", "cornell_planar", "fifty_boxes",
    "leblond_furnished 10%", "leblond_furnished 3%", "occluder 2%", "cornell_box 5%", "two_rooms 2%", "courtyard 2%",
    "fifty_boxes 5%", "studio 10%",
]


def used_by(command):
    """Exit code, CPU seconds, MiB held at most and what was printed."""
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    text = run.stdout.read()
    _, status, used = os.wait4(run.pid, 0)
    run.returncode = os.waitstatus_to_exitcode(status)
    return run.returncode, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, text


def said(text):
    """The words of the time, and the seconds that they mean; 1 for less than a second."""
    found = re.search(r"^\s*time\s+(less than a second|about (\S+) (second|minute|hour|day)s?) on one thread", text, re.M)
    if not found:
        return "nothing", None
    return found[1], float(found[2]) * UNITS[found[3]] if found[2] else 1.0


def memory_said(text):
    """MiB that are said."""
    found = re.search(r"^\s*memory\s+(?:about )?([\d.]+) (B|KiB|MiB|GiB):", text, re.M)
    return float(found[1]) * {"B": 2**-20, "KiB": 2**-10, "MiB": 1, "GiB": 1024}[found[2]] if found else None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("part", nargs="?", default="")
    arguments = parser.parse_args()
    program, wrong = str(arguments.program.resolve()), 0
    print("| scene | `check` says | the run took | ratio | MiB said | held | ratio | `check` took |", flush=True)
    print("|---|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as bench:
        runs = [(name, "solve", SCENES / f"{name.split()[0]}.toml", name.split()[1:]) for name in LIGHT]
        runs += [(f"waves/{scene.stem}", "waves", scene, []) for scene in sorted((SCENES / "waves").glob("*.toml"))]
        for number, (name, text) in enumerate(MADE.items()):
            scene = Path(bench) / f"{number}.toml"
            scene.write_text(text)
            runs.append((f"waves: {name}", "waves", scene, []))
        for name, verb, scene, accuracy in runs:
            if arguments.part not in name:
                continue
            options = [str(scene), "--threads", "1", *(["--accuracy", *accuracy] if accuracy else [])]
            code, checked, _, text = used_by([program, "check", *options])
            (words, seconds), expected = said(text), memory_said(text)
            ended, took, held, more = used_by([program, verb, *options, "--no-report", "-q", "-o", f"{bench}/out"])
            if code or ended:
                print(f"{name}: exit codes {code}, {ended}: {(text if code else more).strip()}", file=sys.stderr, flush=True)
            ratio = None if seconds is None else seconds / took
            holds = ratio is not None and (took < 2 if words.startswith("less") else 0.5 <= ratio <= 2)
            of_memory = expected / held if expected else 0
            fits = held <= LITTLE or 0.85 <= of_memory <= 1.15
            wrong += not (holds and fits)
            shown = "" if ratio is None or words.startswith("less") else f"{ratio:.2f}"
            time = f"{words} | {took:.2f} s | {shown}{'' if holds else ' (!)'}"
            memory = f"{expected or 0:.0f} | {held:.0f} | {of_memory:.2f}{'' if fits else ' (!)'}"
            print(f"| {name} | {time} | {memory} | {checked:.2f} s |", flush=True)
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
