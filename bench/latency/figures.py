"""The arithmetic of the report: samples in, quantiles out."""

import math
from collections import defaultdict
from dataclasses import dataclass, field

QUANTILES = [("median", 0.5), ("p99", 0.99), ("p99.9", 0.999), ("p99.99", 0.9999)]
STAGES = ["rectify", "features", "search", "refine", "verify"]
COLUMNS = ["scan", "cycle_ns", "busy_ns", "memory_ns", "wake_ns", "total_us"] + [f"{stage}_us" for stage in STAGES] + ["outcome"]
DEADLINE_COLUMNS = ["scan", "usual_us", "deadline_us", "elapsed_ns", "outcome"]
OUTCOME_DEADLINE = 2


def quantile(ordered, share):
    """The least sample that at least `share` of all are not above; None where that many samples cannot tell it from the
    greatest one."""
    if not ordered or len(ordered) * (1.0 - share) < 1.0 - 1e-9:
        return None
    return ordered[math.ceil(share * len(ordered) - 1e-9) - 1]


@dataclass
class Summary:
    count: int
    values: dict  # by the names of QUANTILES
    greatest: float

    @property
    def greatest_over_median(self):
        median = self.values["median"]
        return self.greatest / median if median else None


def summarize(samples):
    """None when there are none."""
    if not samples:
        return None
    ordered = sorted(samples)
    values = {name: quantile(ordered, share) for name, share in QUANTILES}
    if values["median"] is None:  # a single sample
        values["median"] = ordered[0]
    return Summary(len(ordered), values, ordered[-1])


@dataclass
class Phase:
    name: str
    what: str  # cycles or deadlines
    threads: int
    rows: list = field(default_factory=list)  # a dict each
    end: dict = field(default_factory=dict)
    others_share: float = None  # of all processors' time, taken by other programs

    def column(self, name, scale=1.0):
        return [row[name] * scale for row in self.rows]


def against_usual(phase):
    """(time, median of the same scan's) of each cycle, in nanoseconds."""
    by_scan = defaultdict(list)
    for row in phase.rows:
        by_scan[row["scan"]].append(row["cycle_ns"])
    usual = {scan: summarize(times).values["median"] for scan, times in by_scan.items()}
    return [(row["cycle_ns"], usual[row["scan"]]) for row in phase.rows]


def against_median(samples):
    """(sample, median of all) of each."""
    median = summarize(samples).values["median"] if samples else None
    return [(sample, median) for sample in samples]


def beyond_ms(pairs_ns):
    """How much longer than usual, in milliseconds; what was shorter counts as 0."""
    return [max(0.0, (time - usual) / 1e6) for time, usual in pairs_ns]


def most_stretched(pairs):
    """The greatest ratio of a time to the usual one."""
    return max((time / usual for time, usual in pairs if usual), default=None)


def overruns_us(phase):
    """How far past its deadline each search returned that did."""
    overruns = [row["elapsed_ns"] / 1000.0 - row["deadline_us"] for row in phase.rows]
    return [overrun for overrun in overruns if overrun > 0.0]


def by_scene(phase, scenes):
    """Cycle times in milliseconds by scene, in the order in which the scenes first appear in `scenes` (scan -> scene)."""
    times = {scene: [] for scene in scenes.values()}
    for row in phase.rows:
        times[scenes[row["scan"]]].append(row["cycle_ns"] / 1e6)
    return {scene: values for scene, values in times.items() if values}


def histogram(samples, low, high, bins_a_decade):
    """Counts over bins of equal ratio: (edges, counts); what lies outside goes into the first and last bin."""
    bin_count = max(1, math.ceil((math.log10(high) - math.log10(low)) * bins_a_decade))
    edges = [low * (high / low) ** (i / bin_count) for i in range(bin_count + 1)]
    counts = [0] * bin_count
    for sample in samples:
        place = math.log(max(sample, low) / low) / math.log(high / low) * bin_count
        counts[min(bin_count - 1, int(place))] += 1
    return edges, counts
