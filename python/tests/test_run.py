"""Runs: the interpreter is free meanwhile, two go on at once, and Ctrl-C ends one within a
second."""

import os
import signal
import threading
import time
from typing import Any, List, Tuple

import numpy as np
import pytest
from conftest import FURNACE

import fredholm

#: The light of a room with white walls, which simple schemes find only slowly.
WHITE = FURNACE.replace("0.75", "0.9999").replace("[4, 4]", "[12, 12]")
#: A room of so many elements that their form factors take longer than a test.
LARGE = FURNACE.replace("[4, 4]", "[90, 90]")


def test_two_runs_overlap_and_python_goes_on() -> None:
    told: List[Tuple[int, float]] = []
    scene = fredholm.Scene.from_toml(WHITE)

    def run(number: int) -> None:
        def listen(event: str, stage: str, share: float, text: str) -> None:
            told.append((number, time.monotonic()))

        scene.solve(
            solver="jacobi", max_iterations=3000, tolerance=1e-15, threads=1, progress=listen
        )

    ticks = 0
    with pytest.warns(fredholm.FredholmWarning, match="the tolerance was not met"):
        threads = [threading.Thread(target=run, args=(number,)) for number in (0, 1)]
        [thread.start() for thread in threads]
        while any(thread.is_alive() for thread in threads):
            ticks += 1
            time.sleep(0.001)
        [thread.join() for thread in threads]
    times = [[at for number, at in told if number == which] for which in (0, 1)]
    overlap = min(times[0][-1], times[1][-1]) - max(times[0][0], times[1][0])
    shorter = min(of[-1] - of[0] for of in times)
    assert overlap > 0.5 * shorter and ticks > 20


def interrupted(call: Any, stage: str) -> Tuple[float, Any]:
    """Seconds from Ctrl-C, which is pressed once a stage makes progress, to the exception, and what
    it kept."""
    pressed: List[float] = []

    def press() -> None:
        pressed.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    def listen(event: str, name: str, share: float, text: str) -> None:
        if not pressed and event == "begin" and name == stage:
            threading.Timer(0.3, press).start()

    with pytest.raises(KeyboardInterrupt) as raised:
        call(listen)
    assert isinstance(raised.value, fredholm.Interrupted)
    return time.monotonic() - pressed[0], raised.value.partial


@pytest.mark.filterwarnings("ignore::fredholm.FredholmWarning")
def test_ctrl_c_keeps_the_iterate() -> None:
    scene = fredholm.Scene.from_toml(WHITE)
    call = lambda listen: scene.solve(
        solver="jacobi", max_iterations=4_000_000_000, tolerance=1e-15, progress=listen
    )  # noqa: E731
    seconds, partial = interrupted(call, "solution")
    assert seconds < 1.0
    assert isinstance(partial, fredholm.Solution) and partial.ended == "interrupted"
    assert np.isfinite(partial.irradiance).all() and partial.irradiance.min() > 0.0
    assert partial.record["partial"]


def test_ctrl_c_during_the_assembly_has_nothing_to_keep() -> None:
    scene = fredholm.Scene.from_toml(LARGE)
    seconds, partial = interrupted(lambda listen: scene.solve(progress=listen), "assembly")
    assert seconds < 1.0 and partial is None


def test_ctrl_c_ends_a_solver() -> None:
    class Slow:
        shape = (2, 2)

        def matvec(self, x: Any) -> Any:
            time.sleep(0.01)
            return np.array([1.0 * x[0] + 0.9999 * x[1], 0.9999 * x[0] + 1.0 * x[1]])

    def call(listen: Any) -> Any:
        return fredholm.solvers.neumann(
            Slow(), [1.0, 2.0], tolerance=1e-15, max_iterations=100_000_000, progress=listen
        )

    seconds, partial = interrupted(call, "neumann")
    assert seconds < 1.0 and partial.reason == "interrupted"


def test_what_a_listener_raises_ends_the_run() -> None:
    def listen(event: str, stage: str, share: float, text: str) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        fredholm.Scene.from_toml(WHITE).solve(progress=listen)


@pytest.mark.filterwarnings("ignore::fredholm.FredholmWarning")
def test_progress_in_words(capsys: Any, monkeypatch: Any) -> None:
    from fredholm import _progress

    monkeypatch.setattr(_progress, "PAUSE", 0.0)
    monkeypatch.setattr(_progress, "_bars", lambda: None)
    fredholm.Scene.from_toml(WHITE).solve(progress=True)
    shown = capsys.readouterr().err
    assert "assembly: done in" in shown and "%" in shown


@pytest.mark.filterwarnings("ignore::fredholm.FredholmWarning")
def test_progress_as_bars(capsys: Any) -> None:
    pytest.importorskip("tqdm")
    fredholm.Scene.from_toml(WHITE).solve(progress=True)
    assert "assembly" in capsys.readouterr().err


def test_the_number_of_threads_changes_no_bit() -> None:
    scene = fredholm.Scene.from_toml(FURNACE)
    assert (
        scene.solve(threads=1).irradiance.tobytes() == scene.solve(threads=3).irradiance.tobytes()
    )
