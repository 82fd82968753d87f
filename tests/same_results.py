#!/usr/bin/env python3
"""Compares every result of two builds of the program: files, standard output, standard error, exit code.

    python3 tests/same_results.py BEFORE AFTER               all quick cases
    python3 tests/same_results.py BEFORE AFTER --all         those that take minutes, too
    python3 tests/same_results.py BEFORE AFTER --only A,B    cases whose name holds A or B
    python3 tests/same_results.py --list                     the names of all cases

BEFORE and AFTER are two programs, such as a copy of target/release/fredholm of an older commit and
that of the working tree. Each case is a command line, run by both in folders of the same relative
name. Files have to be the same byte for byte, but for what differs between two runs of one program:

- JSON: values of the keys in TIMES;
- CSV: columns whose name holds `seconds`;
- the plots in TIMED_PLOTS, which have an axis of seconds: all but their words;
- messages: times, amounts of memory held, and progress, of which there is more or less by chance.

What differs is named; the exit code is 1 where anything does. The standard library suffices.
"""

import argparse
import csv
import io
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TIMES = {"timings", "seconds", "peak_memory_bytes", "time", "peak_bytes"}
TIMED_PLOTS = {"convergence.svg", "compare.svg", "compare_sweep.svg", "shots.svg"}
# Lines of summaries that tell times or memory held.
TIMED_LINES = re.compile(r"^  (time|peak memory|most memory held|memory .* at most$)")
SECONDS = re.compile(r"\d+\.\d+ s\b")
COMMON = ["--threads", "2", "--memory", "6GiB"]
SLOW_SCENES = {"cornell_box", "cornell_planar", "fifty_boxes", "leblond_furnished", "leblond_room_fine", "studio"}
SLOW_WAVES = {"closed_cube", "cube_map", "resonant_cube", "room", "sphere", "trihedral"}
ROOM = """
[materials.wall]
reflectance = 0.5
[materials.lamp]
reflectance = 0.1
exitance = 10
[[surface]]
name = "room"
material = "wall"
box = { min = [0, 0, 0], max = [2, 1.5, 1], inward = true }
divide = [4, 4]
[[surface]]
name = "table"
material = "wall"
box = { min = [0.8, 0.5, 0], max = [1.2, 0.9, 0.4] }
divide = [2, 2]
[[surface]]
name = "lamp"
material = "lamp"
quad = [[0.7, 0.5, 0.99], [0.7, 0.9, 0.99], [1.2, 0.9, 0.99], [1.2, 0.5, 0.99]]
divide = [2, 2]
"""
BROKEN = "[materials.wall]\nreflectance = 2\n"
FILES = {"room.toml": ROOM, "broken.toml": BROKEN}


def cases():
    """Name, whether it takes minutes, and arguments after the program; `+` stands for a following run."""
    for path in sorted((ROOT / "scenes").glob("*.toml")):
        scene, slow = str(path), path.stem in SLOW_SCENES
        yield f"check-{path.stem}", False, ["check", scene, "-o", "out", *COMMON]
        yield f"solve-{path.stem}", slow, ["solve", scene, "-o", "out", *COMMON]
    for path in sorted((ROOT / "scenes/waves").glob("*.toml")):
        yield f"waves-{path.stem}", path.stem in SLOW_WAVES, ["waves", str(path), "-o", "out", *COMMON]
    room, out = "room.toml", ["-o", "out", *COMMON]
    plate, facing = str(ROOT / "scenes/waves/plate.toml"), str(ROOT / "scenes/waves/facing_plates.toml")
    fields = ["surface-sampling", "field-particles", "amplitude-particles"]
    light = ["path", "light", "bidirectional", "photon", "jacobi", "walk-gathering", "walk-shooting"]
    samples = ["--samples", "64"]
    yield "accuracy", False, ["solve", room, "--accuracy", "5%", *out]
    yield "accuracy-occluder", False, ["solve", str(ROOT / "scenes/occluder.toml"), "--accuracy", "3%", *out]
    yield "accuracy-furnished", True, ["solve", str(ROOT / "scenes/leblond_furnished.toml"), "--accuracy", "1%", *out]
    yield "accuracy-cornell", True, ["solve", str(ROOT / "scenes/cornell_box.toml"), "--accuracy", "1%", *out]
    yield "goal", False, ["solve", room, "--accuracy", "3%", "--goal", "table", *out]
    yield "gather", False, ["solve", room, "--final-gather", "--discontinuity", "--point", "1,1,0.5,0,0,1",
                            "--plane", "0.1,0.1,0.8,1,0,0,0,1,0,4,3", *out]
    yield "gather-accuracy", False, ["solve", room, "--accuracy", "5%", "--final-gather", "--point", "1,1,0.5,0,0,1", *out]
    yield "no-pictures", False, ["solve", room, "--no-pictures", "--storage", "f32", *out]
    yield "json-log", False, ["solve", room, "--accuracy", "5%", "--log", "json", *out]
    yield "quiet", False, ["solve", room, "--quiet", *out]
    for name in ["galerkin-1", "nystrom-2", "collocation-1"]:
        yield f"discretisation-{name}", False, ["solve", room, "--discretisation", name, *out]
    yield "not-converged", False, ["solve", room, "--max-iterations", "1", *out]
    yield "resume-nothing", False, ["resume", "nowhere"]
    yield "converge", False, ["converge", room, "--levels", "3", *out]
    yield "converge-galerkin", False, ["converge", room, "--levels", "2", "--discretisation", "galerkin-1", *out]
    yield "compare", False, ["compare", room, *out]
    yield "compare-sweep", False, ["compare", room, "--solvers", "gauss-seidel,cg-theta", "--sweep",
                                   "reflectance=0.2..0.9:3", *out]
    yield "spectrum", False, ["spectrum", room, *out]
    yield "spectrum-lanczos", False, ["spectrum", room, "--dense", "0", *out]
    yield "shoot", False, ["shoot", room, "--pictures", "1,10", *out]
    yield "viewfactors", False, ["viewfactors", room, "-o", "F.npz", *COMMON]
    yield "viewfactors-csv", False, ["viewfactors", room, "-o", "F.csv", "--rows", "surface", "--close",
                                     "--tolerance", "1e-6", *COMMON]
    yield "viewfactors-sky", False, ["viewfactors", room, "-o", "F.txt", "--sky", "--threshold", "1e-3",
                                     "--point", "1,1,0.5,0,0,1", *COMMON]
    yield "viewfactors-hemicube", False, ["viewfactors", room, "-o", "F.npz", "--method", "hemicube",
                                          "--setting", "64", *COMMON]
    for name in light:
        yield f"trace-{name}", False, ["trace", room, "--method", name, *samples, *out]
    yield "trace-control", False, ["trace", room, "--control", *samples, *out]
    yield "trace-pixels", True, ["trace", room, "--spp", "16", *samples, *out]
    for name in fields:
        yield f"trace-{name}", name != "surface-sampling", ["trace", plate, "--method", name, "--samples", "4096", *out]
    yield "crosscheck", False, ["crosscheck", room, "--to", "2%", *out]
    yield "crosscheck-patchwise", False, ["crosscheck", room, "--method", "jacobi", "--to", "5%", *out]
    yield "crosscheck-accuracy", False, ["crosscheck", room, "--accuracy", "5%", "--to", "3%", *out]
    yield "crosscheck-waves", True, ["crosscheck", plate, "--to", "5%", *out]
    yield "reference", False, ["reference", room, "--to", "2%", *out]
    yield "waves-compare", False, ["waves", facing, "--compare", "neumann,gmres,lu", *out]
    yield "info", False, ["solve", room, *out, "+", "info", "out"]
    yield "info-matrix", False, ["viewfactors", room, "-o", "F.npz", *COMMON, "+", "info", "F.npz"]
    yield "continued-trace", False, ["trace", room, *samples, *out, "+", "trace", room, "--samples", "128",
                                     "--continue", *out]
    verbs = ["solve", "resume", "check", "converge", "compare", "shoot", "spectrum", "viewfactors", "waves",
             "trace", "crosscheck", "reference", "info", "schema", "completions", "solvers", "discretisations"]
    for verb in verbs:
        yield f"help-{verb}", False, [verb, "--help"]
    yield "help", False, ["--help"]
    yield "schema", False, ["schema"]
    yield "solvers", False, ["solvers"]
    yield "discretisations", False, ["discretisations"]
    yield "completions", False, ["completions", "bash"]
    wrong = [
        ["solve", "none.toml"], ["solve", "broken.toml"], ["solve", room, "--goal", "table"],
        ["solve", room, "--accuracy", "1%", "--goal", "tabel"], ["solve", room, "--accuracy", "1%", "--solver", "lu"],
        ["solve", room, "--accuracy", "1%", "--storage", "f32"], ["solve", room, "--memory", "1MB"],
        ["solve", room, "--discretisation", "galerkin-1", "--storage", "f32"], ["solve", room, "-o", "room.toml"],
        ["solve", room, "--point", "1,1,1,0,0,0"], ["solve", room, "--discretisation", "magic"],
        ["check", room, "--memory", "11MB"], ["converge", room, "--levels", "9", "--memory", "300MB"],
        ["compare", room, "--solvers", "sor:omega=3"], ["spectrum", "none.toml"], ["shoot", room, "--memory", "1MB"],
        ["viewfactors", room, "-o", "F.png"], ["viewfactors", room, "-o", "F.what"],
        ["viewfactors", room, "--method", "hemicube", "--setting", "x", "-o", "F.npz"],
        ["viewfactors", room, "--method", "hemicube", "--tolerance", "1e-3", "-o", "F.npz"],
        ["waves", room], ["waves", "none.toml"], ["waves", plate, "--memory", "10MB"],
        ["waves", plate, "--compare", "sor"], ["trace", room, "--method", "light", "--control"],
        ["trace", room, "--method", "light", "--spp", "4"], ["trace", room, "--continue"],
        ["trace", plate, "--method", "surface-sampling", "--spp", "4"], ["trace", plate, "--method", "path"],
        ["crosscheck", plate, "--points", "jittered"], ["reference", "broken.toml"], ["info", "none"],
        ["info", "room.toml"], ["info", "."],
    ]
    for number, line in enumerate(wrong):
        yield f"wrong-{number}-{line[0]}", False, line


def without_times(value):
    """A JSON value without what tells times."""
    if isinstance(value, dict):
        return {key: None if key in TIMES else without_times(part) for key, part in value.items()}
    return [without_times(part) for part in value] if isinstance(value, list) else value


def table_without_times(text):
    """A table without its columns of seconds."""
    rows = list(csv.reader(io.StringIO(text)))
    timed = {i for row in rows[:1] for i, name in enumerate(row) if "seconds" in name}
    return [[cell for i, cell in enumerate(row) if i not in timed] for row in rows]


def comparable(path):
    """What of a file two runs have in common."""
    data = path.read_bytes()
    if path.suffix == ".json":
        return without_times(json.loads(data))
    if path.suffix == ".csv":
        return table_without_times(data.decode())
    if path.name in TIMED_PLOTS:
        return sorted(set(re.findall(r">([^<>\d⁰¹²³⁴⁵⁶⁷⁸⁹]+)<", data.decode())))
    return data


def message(text):
    """What of a text two runs have in common."""
    lines = []
    for line in text.splitlines():
        if line.startswith('{"'):
            event = without_times(json.loads(line))
            if event.get("event") != "progress" and not (event.get("event") == "memory" and "peak_bytes" in event):
                lines.append(event)
        elif not re.match(r"^[^:]*: \d+ %, ", line):
            timed = TIMED_LINES.match(line)
            lines.append(timed.group(1)[:6] if timed else SECONDS.sub("# s", line))
    return lines


def commands(line):
    """The command lines of a case."""
    while "+" in line:
        end = line.index("+")
        yield line[:end]
        line = line[end + 1:]
    yield line


def run(program, line, folder):
    """Runs a case; what was said, and the files by their names."""
    for name, text in FILES.items():
        (folder / name).write_text(text)
    said = []
    for command in commands(line):
        done = subprocess.run([program, *command], cwd=folder, capture_output=True, text=True, check=False)
        seconds = command[0] == "compare" or "--compare" in command
        out = re.sub(r"\d+\.\d{3}", "#", done.stdout) if seconds else done.stdout
        said.append((done.returncode, message(out), message(done.stderr)))
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name not in FILES)
    return said, {str(path.relative_to(folder)): path for path in files}


def differences(before, after, line):
    """What differs between the two programs."""
    with tempfile.TemporaryDirectory() as scratch:
        folders = [Path(scratch) / name for name in ("before", "after")]
        programs = [Path(scratch) / f"{folder.name}-program" / "fredholm" for folder in folders]
        for folder, program, build in zip(folders, programs, (before, after)):
            # Help and usage name the program as it was called.
            folder.mkdir()
            program.parent.mkdir()
            program.symlink_to(build)
        (said, files), (said_after, files_after) = (
            run(str(program), line, folder) for program, folder in zip(programs, folders))
        found = [f"{what}: {a!r} became {b!r}" for one, other in zip(said, said_after)
                 for what, a, b in zip(("exit code", "standard output", "standard error"), one, other) if a != b]
        found += [f"{name} is only in one" for name in sorted(set(files) ^ set(files_after))]
        same = sorted(set(files) & set(files_after))
        found += [f"{name} differs" for name in same if comparable(files[name]) != comparable(files_after[name])]
        return found, len(same), said[-1][0]


def main():
    """Compares the cases asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", nargs="?")
    parser.add_argument("after", nargs="?")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only", type=lambda text: text.split(","))
    parser.add_argument("--list", action="store_true")
    args = parser.parse_args()
    chosen = [(name, slow, line) for name, slow, line in cases() if args.all or args.only or not slow]
    if args.only:
        chosen = [case for case in chosen if any(part in case[0] for part in args.only)]
    if args.list:
        print("\n".join(f"{name}{' (slow)' if slow else ''}" for name, slow, _ in cases()))
        return 0
    programs = [str(Path(path).resolve()) for path in (args.before, args.after)]
    failed, files = 0, 0
    for name, _, line in chosen:
        found, count, code = differences(*programs, line)
        failed, files = failed + bool(found), files + count
        print(f"{name}: {'DIFFERS' if found else 'same'}, {count} files, exit code {code}", flush=True)
        for text in found:
            print(f"    {text[:2000]}")
    print(f"{len(chosen)} cases, {files} files, {failed} differ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
