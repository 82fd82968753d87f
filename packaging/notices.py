#!/usr/bin/env python3
"""Collects the licences of everything that is compiled into the program or the Python package.

    python3 packaging/notices.py -o THIRD-PARTY-LICENSES.txt

Whoever passes on a program that was built has to pass on these texts too; who builds it from the
sources need not. The crates are those that `cargo metadata` names for this platform, without what
only builds or tests. Where a crate may be had under several licences, MIT is taken if it is among
them. A licence that is not in ACCEPTED ends the script with exit code 1: somebody has to read it.

The licences of what is bundled into the page of a result are appended from
crates/report/viewer/dist/LICENSES.txt; every page carries them as well. Those of the font that plots
are drawn with are appended from crates/report/assets/LICENSE-plot-font.txt.

The standard library suffices, of Python 3.9 or later; cargo has to have fetched the crates.
"""

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SHIPPED = {"fredholm", "fredholm-python"}
#: Licences that ask for their text, and for nothing else of a program. The first that fits is taken.
ACCEPTED = ["MIT", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "ISC", "Zlib", "Unicode-3.0",
            "Unlicense", "0BSD", "CC0-1.0"]
NAMES = re.compile(r"^(licen[cs]e|copying|notice|unlicense)", re.IGNORECASE)
RULE = "-" * 80


def metadata():
    """What cargo knows of the crates for this platform."""
    told = subprocess.run(["rustc", "-vV"], check=True, stdout=subprocess.PIPE, text=True).stdout
    host = re.search(r"^host: (\S+)$", told, re.MULTILINE).group(1)
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", host]
    ran = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    return json.loads(ran.stdout)


def shipped(found):
    """The crates of others that are compiled in, by name and version."""
    packages = {package["id"]: package for package in found["packages"]}
    nodes = {node["id"]: node for node in found["resolve"]["nodes"]}
    waiting = [id for id, package in packages.items() if package["name"] in SHIPPED]
    seen = set()
    while waiting:
        id = waiting.pop()
        if id not in seen:
            seen.add(id)
            waiting += [dependency["pkg"] for dependency in nodes[id]["deps"]
                        if any(kind["kind"] is None for kind in dependency["dep_kinds"])]
    others = [packages[id] for id in seen if packages[id]["source"]]
    return sorted(others, key=lambda package: (package["name"], package["version"]))


def taken(expression):
    """The licences to comply with out of an SPDX expression, or None where none is accepted."""
    found = []
    for part in re.sub(r"[()]", "", expression.replace("/", " OR ")).split(" AND "):
        offered = part.strip().split(" OR ")
        chosen = next((name for name in ACCEPTED if name in offered), None)
        if chosen is None:
            return None
        found.append(chosen)
    return found


def texts(package, licences):
    """The texts of a crate: those named after its licences, else all that it has."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(file for file in folder.iterdir() if file.is_file() and NAMES.match(file.name))
    words = {licence.split("-")[0].lower() for licence in licences}
    named = [file for file in files if any(word in file.name.lower() for word in words)]
    notices = [file for file in files if file.name.lower().startswith("notice")]
    return [file.read_text(encoding="utf-8", errors="replace").strip()
            for file in dict.fromkeys((named or files) + notices)]


def without_text(package, licences):
    """What stands for the text where a crate has none: that of MIT is the same for everybody."""
    if licences != ["MIT"]:
        return f"The crate has no text of its licence; its manifest names {package['license']}."
    terms = (ROOT / "LICENSE-MIT").read_text(encoding="utf-8")
    terms = terms[terms.index("Permission is hereby granted"):].strip()
    return f"The crate has no text of its licence; its manifest names MIT:\n\n{terms}"


def described(package, licences):
    """The heading of a crate."""
    by = f", by {', '.join(package['authors'])}" if package["authors"] else ""
    where = f", {package['repository']}" if package["repository"] else ""
    return f"{package['name']} {package['version']} ({' and '.join(licences)}{by}{where})"


def main():
    parser = argparse.ArgumentParser(description="Collects the licences of what is compiled in.")
    parser.add_argument("-o", "--output", type=Path, help="file to write, else standard output")
    output = parser.parse_args().output
    users, refused = {}, []
    for package in shipped(metadata()):
        licences = taken(package["license"] or "")
        if licences is None:
            refused.append(f"{package['name']} {package['version']}: {package['license']}")
            continue
        for text in texts(package, licences) or [without_text(package, licences)]:
            users.setdefault(text, []).append(described(package, licences))
    if refused:
        print("\n".join(["licences that nobody has accepted:", *refused]), file=sys.stderr)
        return 1
    blocks = ["\n".join(names) + f"\n\n{text}" for text, names in users.items()]
    page = ROOT / "crates/report/viewer/dist/LICENSES.txt"
    blocks.append(f"In the page of a result:\n\n{page.read_text(encoding='utf-8').strip()}")
    font = ROOT / "crates/report/assets/LICENSE-plot-font.txt"
    blocks.append(f"In the pictures of plots:\n\n{font.read_text(encoding='utf-8').strip()}")
    written = f"\n\n{RULE}\n\n".join(blocks) + "\n"
    if output:
        output.write_text(written, encoding="utf-8")
    else:
        sys.stdout.write(written)
    return 0


if __name__ == "__main__":
    sys.exit(main())
