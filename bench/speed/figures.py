"""Figures out of Google Benchmark's results: medians over repetitions, by the benchmark's own name.

Times are the processor's, so that what other programs take of it does not count; those of whole cycles, which come as
counters, are the clock's."""

import re
from collections import defaultdict
from statistics import median

UNIT_S = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
TAIL = re.compile(r"(/iterations:\d+|/repeats:\d+|/real_time|/min_time:[\d.]+)+$")
PATHS = ["portable", "avx2", "avx512"]


def plain_name(run_name):
    return TAIL.sub("", run_name)


class Figures:
    """Times in seconds and counters; None where nothing was measured."""

    def __init__(self, benchmarks):
        self._times = defaultdict(list)
        self._counters = defaultdict(list)
        for b in benchmarks:
            if b.get("run_type", "iteration") != "iteration" or b.get("error_occurred"):
                continue
            name = plain_name(b["run_name"])
            self._times[name].append(b["cpu_time"] * UNIT_S[b["time_unit"]])
            for key, value in b.items():
                if isinstance(value, (int, float)) and not isinstance(value, bool):
                    self._counters[name, key].append(value)

    def names(self, prefix):
        return [name for name in self._times if name.startswith(prefix)]

    def time_s(self, name):
        return median(self._times[name]) if name in self._times else None

    def counter(self, name, key):
        return median(self._counters[name, key]) if (name, key) in self._counters else None

    def ratio(self, slower, faster):
        """How many times as long the first takes."""
        a, b = self.time_s(slower), self.time_s(faster)
        return a / b if a is not None and b else None

    def best_path(self, prefix):
        """The widest path under which something was measured, e.g. of search/lone/sums_."""
        found = [path for path in PATHS if self.time_s(prefix + path) is not None]
        return found[-1] if found else None


def middle(values):
    """The median of those that were measured."""
    known = [v for v in values if v is not None]
    return median(known) if known else None
