"""What notebooks show of a result. Everything that comes from files is escaped."""

from __future__ import annotations

import base64
from html import escape
from typing import Iterable, Optional, Sequence, Tuple

#: Rows of a table that are shown.
ROWS = 50

Facts = Iterable[Tuple[str, str]]


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table: the first column is text, the others are numbers."""
    cells = lambda tag, row: "".join(f"<{tag}>{escape(str(cell))}</{tag}>" for cell in row)  # noqa: E731
    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows[:ROWS])
    more = f"<p>and {len(rows) - ROWS} more</p>" if len(rows) > ROWS else ""
    return f"<table><thead><tr>{cells('th', head)}</tr></thead><tbody>{body}</tbody></table>{more}"


def panel(title: str, facts: Facts, more: str = "", picture: Optional[bytes] = None) -> str:
    """A title, a small picture, facts, and a table that is folded away."""
    image = ""
    if picture is not None:
        data = base64.b64encode(picture).decode()
        image = f'<img alt="the light" style="max-width:320px" src="data:image/png;base64,{data}">'
    rows = "".join(
        f"<tr><th style='text-align:left'>{escape(label)}</th><td style='text-align:left'>{escape(text)}</td></tr>"
        for label, text in facts
    )
    folded = f"<details><summary>Values</summary>{more}</details>" if more else ""
    return f"<div><strong>{escape(title)}</strong><br>{image}<table>{rows}</table>{folded}</div>"
