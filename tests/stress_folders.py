"""Runs the program many times over on one folder: at once, one after the other, killed, on damaged checkpoints and
under limits of memory, and looks at what it leaves.

    python3 tests/stress_folders.py target/release/fredholm                 # 200 of each
    python3 tests/stress_folders.py target/release/fredholm --times 10 pairs kills

A folder passes where it holds no unfinished file and either no record, or the record and all other files of exactly one
run, bit for bit as that run writes them into an empty folder (times of the clock aside). Needs Python 3.9 on Linux or
macOS and nothing else; ends with exit code 1 where something is not so.
"""

import argparse
import collections
import hashlib
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOM = """bands = ["r", "g"]
[materials.wall]
reflectance = [{rho}, 0.5]
[materials.lamp]
reflectance = 0.2
exitance = [10.0, 8.0]
[[surface]]
name = "walls"
material = "wall"
box = {{ min = [0, 0, 0], max = [2, 2, 2], inward = true }}
divide = [{n}, {n}]
[[surface]]
name = "lamp"
material = "lamp"
quad = [[0.7, 0.7, 1.9], [0.7, 1.3, 1.9], [1.3, 1.3, 1.9], [1.3, 0.7, 1.9]]
two_sided = true
back_material = "wall"
[camera]
eye = [0.5, 0.5, 1.9]
target = [1.5, 1.5, 0]
up = [0, 1, 0]
width = 64
height = 48
"""

PLATE = """[wave]
frequencies_hz = [1e9]
[[source]]
kind = "plane-wave"
travel = [0, 1, 0]
polarisation = [0, 0, 1]
[[surface]]
name = "plate"
quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]
[[receiver]]
name = "point"
points = [[0, -1, 0]]
"""

SCENES = {
    "a.toml": ROOM.format(rho=0.7, n=4),
    "b.toml": ROOM.format(rho=0.3, n=3),
    "deep.toml": ROOM.format(rho=0.9, n=1).replace("width = 64", "width = 32"),
    "w.toml": PLATE,
    # For limits of memory: 2400 elements, 2000 facets, a large picture.
    "large.toml": ROOM.format(rho=0.7, n=20),
    "wide.toml": ROOM.format(rho=0.7, n=2).replace("width = 64\nheight = 48", "width = 4000\nheight = 3000"),
    "lw.toml": PLATE.replace('name = "plate"', 'name = "plate"\nedge = 0.02'),
}

# What may be run into a folder, by name.
RUNS = {
    "solve a": ["solve", "a.toml"],
    "solve b": ["solve", "b.toml", "--no-pictures", "--no-report"],
    "solve to 5 %": ["solve", "deep.toml", "--accuracy", "5%"],
    "trace": ["trace", "a.toml", "--samples", "64"],
    "trace pixels": ["trace", "a.toml", "--samples", "64", "--spp", "1"],
    "shoot": ["shoot", "b.toml"],
    "compare": ["compare", "b.toml", "--solvers", "gauss-seidel,gmres"],
    "spectrum": ["spectrum", "b.toml"],
    "converge": ["converge", "b.toml", "--levels", "2"],
    "crosscheck": ["crosscheck", "b.toml", "--samples", "64"],
    "reference": ["reference", "b.toml", "--samples", "64"],
    "waves": ["waves", "w.toml"],
}
# A cross-check of so few samples may not be able to tell; a study of two levels may not settle.
FINE = {0, 3, 6}
RECORDS = {
    "run.json", "compare.json", "spectrum.json", "shots.json", "converge.json", "crosscheck.json", "reference.json",
}


class Stress:
    def __init__(self, program, bench, seed):
        self.program, self.bench, self.chance = program, bench, random.Random(seed)
        self.count, self.faults = 0, []
        for name, text in SCENES.items():
            (bench / name).write_text(text)
        self.known, self.seconds = {}, {}
        for name in RUNS:
            self.learn(name)

    def command(self, name, folder):
        return [self.program, *RUNS[name], "-o", str(folder), "--threads", "1", "--quiet"]

    def run(self, command, **more):
        return subprocess.run(command, cwd=self.bench, capture_output=True, text=True, **more)

    def learn(self, name):
        """What a run leaves in an empty folder, and which of its files are always the same."""
        found = []
        for _ in range(2):
            folder = self.fresh()
            started = time.monotonic()
            done = self.run(self.command(name, folder))
            self.seconds[name] = time.monotonic() - started
            if done.returncode not in FINE:
                sys.exit(f"{name} ends with {done.returncode}: {done.stderr}")
            found.append(contents(folder))
        first, second = found
        # Records and pages tell times, which may be the same by chance.
        fixed = {file for file, sum_ in first.items() if second.get(file) == sum_ and not timed(file)}
        self.known[name] = {file: sum_ if file in fixed else None for file, sum_ in first.items()}

    def fresh(self):
        folder = self.bench / "out"
        shutil.rmtree(folder, ignore_errors=True)
        return folder

    def state(self, folder):
        """The name of the run whose result it is, `` for none, and what is wrong."""
        found = contents(folder)
        left = [name for name in os.listdir(folder) if name.endswith(".tmp")] if folder.exists() else []
        records = RECORDS & found.keys()
        if not records:
            return "", found, left
        for name, known in self.known.items():
            same = all(sum_ is None or sum_ == found.get(file) for file, sum_ in known.items())
            if same and found.keys() - {"checkpoint.bin"} == known.keys():
                return name, found, left
        return None, found, left

    def expect(self, what, holds):
        if not holds:
            self.faults.append(what)
            print("FAULT:", what)

    def pairs(self, times):
        ends = collections.Counter()
        for _ in range(times):
            folder, names = self.fresh(), [self.chance.choice(list(RUNS)) for _ in range(2)]
            children = []
            for name in names:
                error = subprocess.PIPE
                children.append(subprocess.Popen(self.command(name, folder), cwd=self.bench, stderr=error, text=True))
                time.sleep(self.chance.random() * 0.05)
            texts = [child.communicate()[1] for child in children]
            codes = [child.returncode for child in children]
            name, found, left = self.state(folder)
            busy = ["another run of Fredholm writes" in text for text in texts]
            for code, text, refused in zip(codes, texts, busy):
                self.expect(f"pair {names}: {code} {text}", code in FINE or (code == 5 and refused))
            done = [name for name, refused in zip(names, busy) if not refused]
            self.expect(f"pair {names}: {codes}, mixed: {sorted(found)}", name in done and not left)
            ends["one refused" if any(busy) else "one after the other"] += 1
        return dict(ends)

    def sequences(self, times):
        for _ in range(times):
            folder, names = self.fresh(), [self.chance.choice(list(RUNS)) for _ in range(3)]
            for last in names:
                done = self.run(self.command(last, folder))
                name, found, left = self.state(folder)
                self.expect(f"sequence {names}: {done.returncode} {done.stderr}", done.returncode in FINE)
                self.expect(f"sequence {names} at {last}: {name} {sorted(found)}", name == last and not left)
                told = self.run([self.program, "info", str(folder)])
                scene = RUNS[last][1]
                self.expect(f"info after {last}: {told.stdout}", told.returncode != 0 or scene in told.stdout)
        return {"runs": 3 * times}

    def kills(self, times):
        ends = collections.Counter()
        for _ in range(times):
            folder, names = self.fresh(), [self.chance.choice(list(RUNS)) for _ in range(3)]
            before, killed, after = names
            self.run(self.command(before, folder))
            child = subprocess.Popen(self.command(killed, folder), cwd=self.bench, stderr=subprocess.DEVNULL)
            # Files are written at the end.
            time.sleep(self.seconds[killed] * (1.1 - self.chance.random() ** 2))
            child.send_signal(signal.SIGKILL)
            child.wait()
            name, found, _ = self.state(folder)
            self.expect(f"killed {killed} over {before}: {sorted(found)}", name in ("", before, killed))
            state = "no record" if name == "" else "the one before" if name == before else "done"
            ends[state] += 1
            done = self.run(self.command(after, folder))
            name, found, left = self.state(folder)
            self.expect(f"after the kill: {done.returncode} {done.stderr}", done.returncode in FINE)
            self.expect(f"after the kill: {name}, not {after}: {sorted(found)} {left}", name == after and not left)
        return dict(ends)

    def flips(self, times):
        folder = self.checkpoint()
        whole = (folder / "checkpoint.bin").read_bytes()
        for _ in range(times):
            bit = self.chance.randrange(8 * len(whole))
            bytes_ = bytearray(whole)
            bytes_[bit // 8] ^= 1 << (bit % 8)
            (folder / "checkpoint.bin").write_bytes(bytes_)
            done = self.run([self.program, "resume", str(folder), "--quiet"])
            refused = done.returncode == 2 and "checkpoint.bin" in done.stderr and "solve the scene again" in done.stderr
            self.expect(f"bit {bit} of {8 * len(whole)}: {done.returncode} {done.stderr}", refused)
        (folder / "checkpoint.bin").write_bytes(whole)
        return {"bytes of the checkpoint": len(whole)}

    def checkpoint(self):
        """The folder of a run that was stopped after a round."""
        folder = self.fresh()
        command = [self.program, "solve", "deep.toml", "--accuracy", "0.05%", "-o", str(folder), "--no-pictures"]
        child = subprocess.Popen(command, cwd=self.bench, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        while not (folder / "checkpoint.bin").exists() and child.poll() is None:
            time.sleep(0.01)
        child.send_signal(signal.SIGINT)
        child.wait()
        return folder

    def memory(self, _):
        ends = collections.Counter()
        large = {"a.toml": "large.toml", "b.toml": "large.toml", "w.toml": "lw.toml"}
        runs = {name: [large.get(word, word) for word in run] for name, run in RUNS.items()}
        files = {
            "wide picture": ["solve", "wide.toml"],
            "wide trace": ["trace", "wide.toml", "--samples", "64"],
            "check": ["check", "large.toml"],
            "viewfactors": ["viewfactors", "large.toml"],
            "export": ["export", "a.toml", "--to", "obj", "--band", "r"],
            "schema": ["schema"],
        }
        for name, arguments in {**runs, **files}.items():
            limited = name not in ("export", "schema")
            for mib in [16, 40, 80, 150, 400] if limited else []:
                place = ["-o", str(self.fresh() / ("F.npz" if name == "viewfactors" else ""))]
                command = [self.program, *arguments, *place, "--threads", "1", "--memory", f"{mib}MiB"]
                code, peak, text = peak_of(command, self.bench, None)
                # What is loaded of the program itself is not what a scene takes.
                within = code == 4 or peak <= (mib + 20) * 2**20
                self.expect(f"{name} --memory {mib}MiB: {code}, {peak >> 20} MiB, {text}", code in FINE | {4} and within)
                ends[f"--memory: {code}"] += 1
            for mib in [60, 150, 300, 500, 2000]:
                place = [] if name == "schema" else ["-o", str(self.fresh() / ("F.npz" if name == "viewfactors" else ""))]
                command = [self.program, *arguments, *place]
                code, peak, text = peak_of(command, self.bench, mib * 2**20)
                self.expect(f"{name} ulimit -v {mib}MiB: {code} {text}", code in FINE | {4})
                ends[f"ulimit -v: {code}"] += 1
        return dict(ends)


def timed(file):
    return file.endswith((".html", ".json"))


def contents(folder):
    """Checksums of the files of a folder by their names; hidden ones are no results."""
    found = {}
    for path in sorted(folder.rglob("*")) if folder.exists() else []:
        if path.is_file() and not path.name.startswith("."):
            found[str(path.relative_to(folder))] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


def peak_of(command, folder, addresses):
    """Exit code, peak of resident memory and messages of a run under a limit of its addresses."""

    def limit():
        if addresses:
            resource.setrlimit(resource.RLIMIT_AS, (addresses, addresses))

    with tempfile.TemporaryFile("w+") as told:
        child = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=told, preexec_fn=limit)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        told.seek(0)
        unit = 1 if sys.platform == "darwin" else 1024
        return child.returncode, used.ru_maxrss * unit, told.read()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    kinds = ["pairs", "sequences", "kills", "flips", "memory"]
    parser.add_argument("kinds", nargs="*", help=f"some of {', '.join(kinds)}; all where none is given")
    parser.add_argument("--times", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_intermixed_args()
    if set(asked.kinds) - set(kinds):
        parser.error(f"the kinds are {', '.join(kinds)}")
    with tempfile.TemporaryDirectory() as bench:
        stress = Stress(str(Path(asked.program).resolve()), Path(bench), asked.seed)
        for kind in asked.kinds or kinds:
            started = time.monotonic()
            before = len(stress.faults)
            told = getattr(stress, kind)(asked.times)
            faults = len(stress.faults) - before
            print(f"{kind}: {faults} faults, {told}, {time.monotonic() - started:.0f} s", flush=True)
    sys.exit(1 if stress.faults else 0)


if __name__ == "__main__":
    main()
