"""Pictures of the figures: how the cost grows, and where a cycle's time goes."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from aims import PADS
from fit import fit_power
from report import PATHS, SCENES, SIZES, STAGES, growth_series


def draw_growth(figures, folder):
    by_sweep = {}
    for name, points in growth_series(figures).items():
        sweep, stage = name.split(", ")
        by_sweep.setdefault(sweep, []).append((stage, points))
    if not by_sweep:
        return
    fig, axes = plt.subplots(1, len(by_sweep), figsize=(3.4 * len(by_sweep), 3.6), squeeze=False)
    for axis, (sweep, series) in zip(axes[0], by_sweep.items()):
        for stage, points in series:
            xs = [x for x, _ in points]
            fit = fit_power(points)
            dots = axis.plot(xs, [1e3 * t for _, t in points], "o")[0]
            if fit:
                axis.plot(xs, [1e3 * fit.at(x) for x in xs], color=dots.get_color(), label=f"{stage}: x^{fit.exponent:.2f}")
        axis.set(xscale="log", yscale="log", xlabel=sweep.replace("_", " "), ylabel="ms")
        axis.legend()
    fig.tight_layout()
    fig.savefig(folder / "growth.png", dpi=110)
    plt.close(fig)


def draw_cycles(figures, folder):
    fig, axes = plt.subplots(1, len(SIZES), figsize=(12, 4))
    for axis, size in zip(axes, SIZES):
        path = next((p for p in reversed(PATHS) if figures.counter(f"cycle/{size}/{PADS[0]}", f"{p}_total_us")), None)
        if path is None:
            continue
        bottom = [0.0] * len(SCENES)
        for stage in STAGES[:-1]:
            heights = [(figures.counter(f"cycle/{size}/{s}", f"{path}_{stage}_us") or 0.0) / 1000 for s in SCENES]
            axis.bar(SCENES, heights, bottom=bottom, label=stage)
            bottom = [b + h for b, h in zip(bottom, heights)]
        axis.set(title=f"{size}, {path}", ylabel="ms")
        axis.tick_params(axis="x", rotation=30)
        axis.legend()
    fig.tight_layout()
    fig.savefig(folder / "cycle.png", dpi=110)
    plt.close(fig)


def draw_all(figures, folder):
    draw_growth(figures, folder)
    draw_cycles(figures, folder)
