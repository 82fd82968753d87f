#!/usr/bin/env python3
"""Checks the pages of the documentation: links, width of lines, and the code in them.

    python3 tests/book.py                 everything that this machine can check
    python3 tests/book.py docs/tour.md    code of these pages only; links and widths of all

- *Links*: every relative link of every Markdown file leads to a file, and to a heading where it has
  an anchor. Pages of the book link to nothing outside docs/, which the built book would not have,
  and every page of docs/ is in docs/SUMMARY.md.
- *Width*: at most 100 columns, but for tables and for lines with a link.
- *Shell*: blocks marked `sh` are run with the program of FREDHOLM_PROGRAM, in an empty folder with a
  copy of scenes/. A block marked `toml` whose first line is `# NAME.toml` is put there first. The
  blocks of a page share the folder, in their order. Blocks marked otherwise, and indented ones, are
  not run: they need the sources, or minutes.
- *Python*: blocks marked `python` are run where the package `fredholm` and what else they import is
  installed. The blocks under one heading belong together.

The exit code is 1 where anything fails. The standard library suffices, of Python 3.9 or later.
"""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
SKIPPED_FOLDERS = {"target", "node_modules", "out", "site-packages"}
WIDTH = 100
SECONDS_A_BLOCK = 120
FENCE = re.compile(r"^ *(```+)(.*)$")
LINK = re.compile(r"!?\[(?:[^\]\[]|\[[^\]]*\])*\]\(([^()\s]*)\)")


def markdown_files():
    """All Markdown files of the repository, without what is built or downloaded."""
    for folder, folders, names in os.walk(ROOT):
        folders[:] = sorted(f for f in folders if f not in SKIPPED_FOLDERS and f[0] != ".")
        yield from (Path(folder) / name for name in sorted(names) if name.endswith(".md"))


class Block:
    """A fenced block of code: its language, the line of its first line, its text, its heading."""

    def __init__(self, language, line, heading):
        self.language, self.line, self.heading, self.lines = language, line, heading, []

    def text(self):
        return "\n".join(self.lines) + "\n"


def parts(path):
    """The lines of a page outside of fenced blocks, as (number, text), and the fenced blocks."""
    prose, blocks, fence, heading = [], [], None, ""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        found = FENCE.match(line)
        if fence is None and found:
            fence = found.group(1)
            blocks.append(Block(found.group(2).strip(), number + 1, heading))
        elif fence is not None and found and found.group(1) == fence and not found.group(2).strip():
            fence = None
        elif fence is not None:
            blocks[-1].lines.append(line)
        else:
            heading = number if line.startswith("## ") else heading
            prose.append((number, line))
    return prose, blocks


def anchors(prose):
    """The anchors that GitHub and mdBook give to headings."""
    found = {}
    for _, line in prose:
        heading = re.match(r"#{1,6} +(.*?) *#*$", line)
        if heading:
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).lower()
            name = "".join("-" if c == " " else c for c in text if c.isalnum() or c in " -_")
            count = found.get(name, 0)
            found[name] = count + 1
            if count:
                found[f"{name}-{count}"] = 1
    return set(found)


def link_faults(path, prose, known):
    """Links of a page that lead nowhere, and links out of the book."""
    for number, line in prose:
        for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = unquote(target).partition("#")
            file = (path.parent / name).resolve() if name else path
            place = f"{path.relative_to(ROOT)}:{number}: "
            if not file.exists():
                yield f"{place}no such file: {target}"
            elif DOCS in path.parents and DOCS not in file.parents:
                yield f"{place}the book holds nothing outside docs/: {target}"
            elif anchor and file.suffix == ".md" and anchor not in known[file]:
                yield f"{place}no such heading: {target}"


def width_faults(path):
    """Lines that are too wide."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if len(line) > WIDTH and not line.startswith("|") and not LINK.search(line):
            yield f"{path.relative_to(ROOT)}:{number}: {len(line)} columns, more than {WIDTH}"


def summary_faults(pages):
    """Pages of docs/ that the book leaves out."""
    listed = LINK.findall((DOCS / "SUMMARY.md").read_text(encoding="utf-8"))
    for page in pages:
        if DOCS in page.parents and page.name != "SUMMARY.md":
            name = page.relative_to(DOCS).as_posix()
            if name not in listed:
                yield f"docs/{name}: not in docs/SUMMARY.md"


def run(page, block, command, environment, folder):
    """Runs a block, and what is wrong with it."""
    began = time.monotonic()
    try:
        ran = subprocess.run(
            command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, text=True,
            encoding="utf-8", stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            timeout=SECONDS_A_BLOCK,
        )
        code, told = ran.returncode, ran.stdout
    except subprocess.TimeoutExpired as late:
        code, told = f"none after {SECONDS_A_BLOCK} s", str(late.stdout or "")
    place = f"{page.relative_to(ROOT)}:{block.line}"
    print(f"{place}: {block.language}, {time.monotonic() - began:.1f} s", flush=True)
    if code == 0:
        return []
    return [f"{place}: exit code {code} of\n{block.text()}{told[-4000:]}"]


def shell_faults(page, blocks, program):
    """Runs the shell blocks of a page."""
    faults = []
    with tempfile.TemporaryDirectory() as name:
        folder, tools = Path(name) / "page", Path(name) / "bin"
        folder.mkdir()
        tools.mkdir()
        shutil.copytree(ROOT / "scenes", folder / "scenes")
        (tools / "fredholm").symlink_to(program)
        environment = {**os.environ, "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}"}
        for block in blocks:
            title = re.match(r"# ([\w-]+\.toml)$", block.lines[0]) if block.lines else None
            if block.language == "toml" and title:
                (folder / title.group(1)).write_text(block.text(), encoding="utf-8")
            elif block.language == "sh":
                command = ["bash", "-euo", "pipefail", "-c", block.text()]
                faults += run(page, block, command, environment, folder)
    return faults


def python_faults(page, blocks):
    """Runs the Python blocks of a page, those under one heading together."""
    sections, faults = {}, []
    for block in blocks:
        if block.language == "python":
            sections.setdefault(block.heading, []).append(block)
    for together in sections.values():
        # Lines keep their numbers, so that messages lead to the page.
        text = ""
        for block in together:
            text += "\n" * (block.line - 1 - text.count("\n")) + block.text()
        wanted = set(re.findall(r"^\s*(?:import|from) (\w+)", text, re.MULTILINE))
        missing = sorted(n for n in wanted if importlib.util.find_spec(n) is None)
        place = f"{page.relative_to(ROOT)}:{together[0].line}"
        if missing:
            print(f"{place}: skipped, not installed: {', '.join(missing)}")
            continue
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(ROOT / "scenes", Path(folder) / "scenes")
            code = f"exec(compile({text!r}, {str(page)!r}, 'exec'), {{'__name__': '__main__'}})"
            command = [sys.executable, "-c", code]
            faults += run(page, together[0], command, dict(os.environ), folder)
    return faults


def main():
    pages = list(markdown_files())
    read = {page: parts(page) for page in pages}
    known = {page: anchors(prose) for page, (prose, _) in read.items()}
    faults = list(summary_faults(pages))
    for page, (prose, _) in read.items():
        faults += [*link_faults(page, prose, known), *width_faults(page)]
    chosen = {Path(name).resolve() for name in sys.argv[1:]} or set(pages)
    program = os.environ.get("FREDHOLM_PROGRAM")
    if not program:
        print("FREDHOLM_PROGRAM is not set: the shell blocks are not run")
    for page, (_, blocks) in read.items():
        if DOCS not in page.parents or page not in chosen:
            continue
        if program and any(block.language == "sh" for block in blocks):
            faults += shell_faults(page, blocks, Path(program).resolve())
        faults += python_faults(page, blocks)
    for fault in faults:
        print(fault, file=sys.stderr)
    print(f"{len(pages)} pages, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
