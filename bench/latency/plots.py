"""The picture of a run: how often a cycle took how long, what the machine adds, and how far past a deadline a search ran."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator

from figures import against_median, against_usual, beyond_ms, by_scene, histogram, overruns_us, summarize
from report import BUDGET_MS, OVERRUN_AIM_MS, cycle_phases

COLORS = ["tab:blue", "tab:red", "tab:green", "tab:purple", "tab:brown", "tab:orange"]


def plain(axis):
    """Numbers as people write them on a logarithmic axis."""
    axis.set_major_locator(LogLocator(subs=(1.0,)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(FuncFormatter(lambda value, _: ""))


def finish(axis, **legend):
    """Counts from 1, room for the legend above the highest."""
    top = axis.get_ylim()[1]
    axis.set_ylim(0.7, top * (top / 0.7) ** 0.45)
    plain(axis.xaxis)
    plain(axis.yaxis)
    axis.grid(alpha=0.25)
    axis.legend(fontsize=8, **legend)


def steps(axis, samples, low, high, bins_a_decade, **style):
    edges, counts = histogram(samples, low, high, bins_a_decade)
    axis.stairs(counts, edges, **style)


def draw_cycles(axis, phases):
    samples = [value for phase in phases for value in phase.column("cycle_ns", 1e-6) + phase.column("busy_ns", 1e-6)]
    low, high = 0.8 * max(min(samples), 1e-3), 1.6 * max(max(samples), BUDGET_MS)
    for phase, color in zip(phases, COLORS):
        steps(axis, phase.column("cycle_ns", 1e-6), low, high, 40, color=color, label=f"{phase.name}: cycle", linewidth=1.4)
        steps(axis, phase.column("busy_ns", 1e-6), low, high, 40, color=color, alpha=0.8, linestyle=":",
              label=f"{phase.name}: busy loop")
    axis.axvline(BUDGET_MS, color="black", linestyle="--")
    axis.annotate("the thesis's budget: 1 s ", (BUDGET_MS, 0.5), xycoords=("data", "axes fraction"), ha="right")
    axis.set(xscale="log", yscale="log", xlabel="ms", ylabel="count", title="Whole cycles", xlim=(low, high))
    finish(axis, ncol=3, loc="upper left")


def exceeding(axis, samples, low, **style):
    """Which share of all samples is above a value."""
    ordered = sorted(max(sample, low) for sample in samples)
    shares = [1.0 - i / len(ordered) for i in range(len(ordered))]
    axis.plot(ordered + ordered[-1:], shares + [0.5 / len(ordered)], drawstyle="steps-post", **style)


def draw_jitter(axis, phases):
    low = 1e-3
    for phase, color in zip(phases, COLORS):
        busy = beyond_ms(against_median(phase.column("busy_ns")))
        memory = beyond_ms(against_median(phase.column("memory_ns")))
        exceeding(axis, beyond_ms(against_usual(phase)), low, color=color, label=f"{phase.name}: cycle", linewidth=1.8)
        exceeding(axis, busy, low, color=color, linestyle=":", linewidth=1.2, label=f"{phase.name}: busy loop")
        exceeding(axis, memory, low, color=color, alpha=0.6, linestyle="--", linewidth=1.0,
                  label=f"{phase.name}: memory loop")
    axis.set(xscale="log", yscale="log", xlabel="ms beyond the median", ylabel="share that took longer", xlim=(low, None),
             title="Beyond the same scan's median, and beyond the loops' (the machine's own)")
    axis.set_ylim(bottom=axis.get_ylim()[0] / 10.0)  # room for the legend
    plain(axis.xaxis)
    plain(axis.yaxis)
    axis.grid(alpha=0.25)
    axis.legend(fontsize=8, ncol=3, loc="lower left")


def draw_overruns(axis, phases):
    low, high = 1e-3, 2.0 * OVERRUN_AIM_MS
    high = max([high] + [us / 1e3 for phase in phases for us in overruns_us(phase)])
    for phase, color in zip(phases, COLORS):
        steps(axis, [us / 1e3 for us in overruns_us(phase)], low, 1.3 * high, 12, color=color, label=phase.name, linewidth=1.4)
    axis.axvline(OVERRUN_AIM_MS, color="black", linestyle="--")
    axis.annotate(f" aim: {OVERRUN_AIM_MS:g} ms", (OVERRUN_AIM_MS, 0.92), xycoords=("data", "axes fraction"))
    axis.set(xscale="log", yscale="log", xlabel="ms", ylabel="count", title="How far past its deadline a search returned")
    finish(axis, loc="upper left")


def draw_scenes(axis, phase, scenes):
    """From the median to the longest, by kind of scene."""
    times = {scene: summarize(values) for scene, values in by_scene(phase, scenes).items()}
    names = list(times)
    places = range(len(names))
    axis.vlines(places, [times[n].values["median"] for n in names], [times[n].greatest for n in names], color="lightgray",
                linewidth=6)
    for quantile, mark in [("median", "o"), ("p99", "_"), ("max", "^")]:
        heights = [times[n].greatest if quantile == "max" else times[n].values[quantile] for n in names]
        shown = [(place, height) for place, height in zip(places, heights) if height is not None]
        axis.plot([p for p, _ in shown], [h for _, h in shown], mark, label=quantile, markersize=7)
    axis.set(yscale="log", ylabel="ms", title=f"Kinds of scenes, {phase.name}")
    axis.set_xticks(list(places), names, rotation=30, ha="right")
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.yaxis.set_minor_formatter(FuncFormatter(lambda value, _: ""))
    axis.grid(axis="y", alpha=0.4)
    axis.legend(fontsize=8, ncol=3, loc="upper left")


def draw_all(phases, scenes, path):
    cycles = [phase for phase in cycle_phases(phases) if phase.rows]
    deadlines = [phase for phase in phases if phase.what == "deadlines" and overruns_us(phase)]
    panels = ([lambda axis: draw_cycles(axis, cycles), lambda axis: draw_jitter(axis, cycles),
               lambda axis: draw_scenes(axis, cycles[0], scenes)] if cycles else [])
    panels += [lambda axis: draw_overruns(axis, deadlines)] if deadlines else []
    if not panels:
        return False
    fig, axes = plt.subplots(len(panels), 1, figsize=(9, 3.9 * len(panels)), squeeze=False)
    for axis, panel in zip(axes[:, 0], panels):
        panel(axis)
    fig.tight_layout()
    fig.savefig(path, dpi=100)
    plt.close(fig)
    return True
