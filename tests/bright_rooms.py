"""Solves closed rooms of bright walls to an accuracy and compares the balance of energy with the stated error.

    python3 tests/bright_rooms.py target/release/fredholm             # all
    python3 tests/bright_rooms.py target/release/fredholm furnished   # those whose name has this in it

The balance is (absorbed - emitted)/emitted in the worst band, 0 in truth. Ends with exit code 1 where it is larger than
the stated error. Prints a table; needs Python 3.9 and nothing else, and some minutes.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = Path(__file__).parent.parent / "scenes"
ROOMS = {"white room": "white_room", "room and plate": "occluder", "furnished room": "leblond_furnished"}


def brightened(text, rho):
    """The scene with all that emits nothing of one reflectance, in every band."""
    def material(block):
        if "exitance" in block[0]:
            return block[0]
        return re.sub(r"reflectance = .*", f"reflectance = {rho}", block[0])

    return re.sub(r"\[materials\.\w+\]\n(?:[^\[\n].*\n)*", material, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("part", nargs="?", default="")
    parser.add_argument("--limit", default="600s", help="time limit of a run")
    arguments = parser.parse_args()
    program, wrong = str(arguments.program.resolve()), 0
    print("| scene | ρ | accuracy | exit code | stated | balance | CPU s | elements |\n|---|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as bench:
        for name, file in ROOMS.items():
            for rho in [0.99, 0.999, 0.9999] if arguments.part in name else []:
                scene = Path(bench) / "scene.toml"
                scene.write_text(brightened((SCENES / f"{file}.toml").read_text(), rho))
                for accuracy in [5, 1]:
                    folder = Path(bench) / "out"
                    asked = ["--accuracy", f"{accuracy}%", "--time-limit", arguments.limit, "--memory", "4GiB"]
                    run = subprocess.Popen([program, "solve", str(scene), *asked, "--threads", "1", "--no-report", "-q", "-o", str(folder)])
                    _, status, used = os.wait4(run.pid, 0)
                    run.returncode = code = os.waitstatus_to_exitcode(status)
                    record = json.loads((folder / "run.json").read_text())
                    stated = max(record["mesh_error"]["relative_l2"])
                    bands = [band for band in record["energy"] if band["emitted"] > 0]
                    balance = max(((band["absorbed"] - band["emitted"]) / band["emitted"] for band in bands), key=abs)
                    wrong += abs(balance) > stated
                    cpu, elements = used.ru_utime + used.ru_stime, record["counts"]["elements"]
                    print(f"| {name} | {rho} | {accuracy} % | {code} | {100 * stated:.2g} % | {100 * balance:.2g} % | {cpu:.0f} | {elements} |", flush=True)
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
