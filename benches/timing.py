"""How long work takes, for the comparisons beside this file."""

import time

TRIALS = 6


def best(work, trials=TRIALS):
    """Shortest time of some trials, s."""
    times = []
    for _ in range(trials):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)
