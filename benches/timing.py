"""How long work takes, for the comparisons beside this file."""

import time

TRIALS = 6


def best(work):
    """Shortest time of some trials, s."""
    times = []
    for _ in range(TRIALS):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)
