"""Progress of a study: bars of tqdm where it is installed, else lines of text."""

from __future__ import annotations

import sys
import time
import warnings
from typing import Any, Callable, Optional, Union

from ._errors import FredholmWarning

#: What a study tells: event ("begin", "advance", "end" or "warn"), stage, share from 0 to 1 (the
#: seconds of a stage that has ended), text.
Listener = Callable[[str, str, float, str], None]

#: Seconds between two lines of a stage.
PAUSE = 2.0


def listener(progress: Union[bool, Listener, None]) -> Listener:
    """What listens to a study: warnings become warnings of Python in any case.

    Without a wish, progress is shown where a person looks on: on a terminal and in a notebook.
    """
    if callable(progress):
        shown: Optional[Listener] = progress
    elif progress or (progress is None and _somebody_looks()):
        shown = _bars() or _Lines()
    else:
        shown = None

    def listen(event: str, stage: str, share: float, text: str) -> None:
        if event == "warn":
            warnings.warn(text, FredholmWarning, stacklevel=3)
        if shown is not None:
            shown(event, stage, share, text)

    return listen


def _somebody_looks() -> bool:
    return "ipykernel" in sys.modules or bool(getattr(sys.stderr, "isatty", lambda: False)())


def _bars() -> Optional[Listener]:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return _Bars(tqdm)


class _Bars:
    """A bar of tqdm for each stage that tells of progress."""

    def __init__(self, tqdm: Any) -> None:
        self.tqdm: Any = tqdm
        self.bar: Any = None
        self.stage = ""

    def __call__(self, event: str, stage: str, share: float, text: str) -> None:
        if event == "begin":
            self.close()
            self.stage = stage
        elif event == "advance":
            self.advance(share, text)
        elif event == "end":
            self.close()

    def advance(self, share: float, text: str) -> None:
        if self.bar is None:
            layout = "{desc:>16} {percentage:3.0f} % |{bar}| {elapsed} {postfix}"
            self.bar = self.tqdm(total=1.0, desc=self.stage, leave=False, bar_format=layout)
        self.bar.set_postfix_str(text, refresh=False)
        self.bar.update(max(0.0, share - self.bar.n))

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
        self.bar = None


class _Lines:
    """Lines of text on standard error: of stages that take long, and of their way."""

    def __init__(self) -> None:
        self.stage, self.told = "", time.monotonic()

    def __call__(self, event: str, stage: str, share: float, text: str) -> None:
        if event == "begin":
            self.stage, self.told = stage, time.monotonic()
        elif event == "advance" and time.monotonic() - self.told >= PAUSE:
            self.told = time.monotonic()
            print(f"{self.stage}: {100 * share:.0f} %, {text}", file=sys.stderr, flush=True)
        elif event == "end" and share >= PAUSE:
            print(f"{stage}: done in {share:.1f} s", file=sys.stderr, flush=True)
