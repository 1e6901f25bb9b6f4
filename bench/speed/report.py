"""The report: the table of aims, then every figure behind it."""

from aims import PADS, all_rows, cycle_us
from figures import PATHS, Figures, middle
from fit import fit_power

__all__ = ["Figures", "write_report"]

SCENES = PADS + ["absent", "cyl_loose", "cyl_grid"]
STAGES = ["rectify", "features", "search", "refine", "verify", "total"]
SIZES = ["600x500", "1536x1280"]


def table(head, rows):
    widths = [max(len(str(row[i])) for row in [head] + rows) for i in range(len(head))]
    line = lambda row: "| " + " | ".join(str(c).ljust(w) for c, w in zip(row, widths)) + " |"
    return "\n".join([line(head), "|" + "|".join("-" * (w + 2) for w in widths) + "|"] + [line(r) for r in rows])


def number(value, scale=1.0, digits=2):
    return "-" if value is None else f"{value * scale:.{digits}f}"


def aims_table(figures):
    return table(["figure", "ours", "aim", "reached"], [[r.figure, r.ours, r.aim, r.verdict] for r in all_rows(figures)])


def search_table(figures):
    contenders = ["thesis", "thesis_tabled"] + [f"{kind}_{path}" for kind in ["whole", "sums", "search"] for path in PATHS]
    rows = []
    for group in ["search", "prune"]:
        scenes = list(dict.fromkeys(name.split("/")[1] for name in figures.names(f"{group}/")))
        for scene in scenes:
            rates = [figures.counter(f"{group}/{scene}/{c}", "evaluations_per_s") for c in contenders]
            rows.append([scene] + [number(rate, 1e-9) for rate in rates])
    return table(["G evaluations/s"] + contenders, rows)


def roof_table(figures):
    levels = ["L1_aligned", "L1_any_byte", "L2_aligned", "L2_any_byte"]
    rows = [[path] + [number(figures.counter(f"roof/{level}/{path}", "loaded_bytes_per_s"), 1e-9, 0) for level in levels]
            + [number(figures.counter(f"search/{name}/whole_{path}", "loaded_bytes_per_s"), 1e-9, 1)
               for name in ["lone_level", "medium_normals_level"]] for path in PATHS]
    return table(["GB/s"] + [level.replace("_", " ") for level in levels] + ["search", "search with normals"], rows)


def image_table(figures):
    rows = []
    for name in sorted(figures.names("image/")):
        if not name.endswith("/ours"):
            continue
        group = name.rsplit("/", 1)[0]
        ours, peer = figures.time_s(name), figures.time_s(f"{group}/opencv")
        rows.append([group[len("image/"):].replace("_", " "), number(ours, 1e3, 3), number(peer, 1e3, 3),
                     number(peer / ours if peer else None)])
    return table(["kernel", "ours ms", "OpenCV ms", "ratio"], rows)


def cycle_table(figures, size):
    rows = []
    for scene in SCENES:
        name = f"cycle/{size}/{scene}"
        for path in PATHS:
            if figures.counter(name, f"{path}_total_us") is None:
                continue
            stages = [number(figures.counter(name, f"{path}_{stage}_us"), 1e-3) for stage in STAGES]
            two = number(cycle_us(figures, size, scene, path, threads="_2_threads"), 1e-3)
            rows.append([scene, path, *stages, two, number(figures.counter(name, "pass_us"), 1e-3)])
    for path in PATHS:
        five = [middle([cycle_us(figures, size, pad, path, stage) for pad in PADS]) for stage in STAGES]
        rows.append(["five pads", path, *[number(value, 1e-3) for value in five], "", ""])
    return table(["scene", "path"] + [f"{s} ms" for s in STAGES] + ["2 threads", "plain pass"], rows)


def growth_series(figures):
    """By sweep: (x, seconds), in the order of x."""
    series = {}
    for name in figures.names("growth/"):
        sweep = name.split("/")[1]
        x = figures.counter(name, "x")
        for stage in ["total", "search"]:
            time_us = figures.counter(name, f"{stage}_us")
            if x and time_us:
                series.setdefault(f"{sweep}, {stage}", []).append((x, time_us * 1e-6))
    return {sweep: sorted(series[sweep]) for sweep in sorted(series)}


def growth_table(figures):
    rows = []
    for sweep, points in growth_series(figures).items():
        fit = fit_power(points)
        rows.append([sweep, f"{points[0][0]:g} to {points[-1][0]:g}", number(points[0][1], 1e3), number(points[-1][1], 1e3),
                     "-" if fit is None else f"{fit.exponent:.2f} +- {fit.exponent_sigma:.2f}"])
    return table(["cost against", "range", "first ms", "last ms", "exponent"], rows)


OPENCV_NOTE = """One thread, OpenCV optimised, the same height maps. What differs: our Sobel marks missing cells; the chamfer of OpenCV is
float with its own 3x3 weights, ours bytes with weights 3 and 4; our edge chain gives sub-pixel places, directions and step
heights in mm on tilted surfaces, OpenCV's (blur, Sobel, Canny) and its 8-bit Canny a mask of pixels."""

SEARCH_NOTE = """`thesis`: as written; `thesis_tabled`: all offsets in tables. `whole`: our sums without early termination; `sums`:
with it, templates turned beforehand, as table 4.1 leaves pre-computations out; `search`: the whole call, templates turned in
it. NAME: all positions at their own tilt; NAME_planar: planar ones only; _level: one tilt; _normals: normals in place of heights."""


def write_report(figures, notes):
    """The whole as Markdown, and the part to print."""
    summary = "\n".join(notes) + "\n\n" + aims_table(figures) + "\n"
    sections = [("Search", SEARCH_NOTE + "\n\n" + search_table(figures)), ("Load roof", roof_table(figures)),
                ("OpenCV", OPENCV_NOTE + "\n\n" + image_table(figures))]
    sections += [(f"Whole cycle, {size}", "Medians over seeds.\n\n" + cycle_table(figures, size)) for size in SIZES]
    sections.append(("Growth", growth_table(figures)))
    return "# Speed\n\n" + summary + "".join(f"\n## {title}\n{body}\n" for title, body in sections), summary
