"""What notebooks show of a result. Everything that comes from files is escaped."""

from __future__ import annotations

import base64
import os
import tempfile
from html import escape
from typing import Callable, Iterable, Optional, Sequence, Tuple

from ._errors import wrong

#: Rows of a table that are shown.
ROWS = 50

Facts = Iterable[Tuple[str, str]]


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table: the first column is text, the others are numbers."""
    body = "".join(f"<tr>{_cells('td', row)}</tr>" for row in rows[:ROWS])
    more = f"<p>and {len(rows) - ROWS} more</p>" if len(rows) > ROWS else ""
    return f"<table><thead><tr>{_cells('th', head)}</tr></thead><tbody>{body}</tbody></table>{more}"


class Page:
    """A page for the browser, which notebooks show in a frame of its own."""

    def __init__(self, html: str, height: int) -> None:
        self.html, self.height = html, height

    def _repr_html_(self) -> str:
        """A frame that can run the scripts of the page, and reach nothing of the notebook."""
        style = f"width:100%;height:{self.height}px;border:0"
        page = escape(self.html)
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{page}"></iframe>'

    def __repr__(self) -> str:
        return f"<Page of {len(self.html)} characters>"


def written(write: Callable[[str], None], height: int) -> Page:
    """The page among the files that a result writes."""
    with tempfile.TemporaryDirectory() as folder:
        write(folder)
        path = os.path.join(folder, "report.html")
        if not os.path.exists(path):
            raise wrong("the solution was asked for without its page", "solve with report=True")
        with open(path, encoding="utf-8") as file:
            return Page(file.read(), height)


def _cells(tag: str, row: Sequence[str]) -> str:
    return "".join(f"<{tag}>{escape(str(cell))}</{tag}>" for cell in row)


def panel(title: str, facts: Facts, more: str = "", picture: Optional[bytes] = None) -> str:
    """A title, a small picture, facts, and a table that is folded away."""
    image = ""
    if picture is not None:
        data = base64.b64encode(picture).decode()
        image = f'<img alt="the light" style="max-width:320px" src="data:image/png;base64,{data}">'
    left = "style='text-align:left'"
    rows = "".join(
        f"<tr><th {left}>{escape(label)}</th><td {left}>{escape(text)}</td></tr>"
        for label, text in facts
    )
    folded = f"<details><summary>Values</summary>{more}</details>" if more else ""
    return f"<div><strong>{escape(title)}</strong><br>{image}<table>{rows}</table>{folded}</div>"
