"""The table: each figure with its aim, whether it was reached or not, and how it is measured."""

from dataclasses import dataclass

from figures import PATHS, middle

PADS = ["lone", "low", "medium", "high", "pile"]
WIDEST = "avx512"
NOT_MEASURED = "not measured"


@dataclass(frozen=True)
class Row:
    figure: str
    ours: str
    aim: str
    verdict: str  # "yes", "NO", or why there is none


def row(figure, value, aim, is_reached, form):
    if value is None:
        return Row(figure, "-", aim, NOT_MEASURED)
    return Row(figure, form(value), aim, "yes" if is_reached(value) else "NO")


def times(value):
    return f"x{value:.3g}"


def at_least(figure, value, least):
    return row(figure, value, f"x{least:g}", lambda v: v >= least, times)


def at_most_ms(figure, value_us, most_ms):
    return row(figure, value_us, f"{most_ms:g} ms", lambda v: v <= 1000.0 * most_ms, lambda v: f"{v / 1000.0:.2f} ms")


def cycle_us(figures, size, scene, path=None, stage="total", threads=""):
    name = f"cycle/{size}/{scene}"
    for candidate in [path] if path else reversed(PATHS):
        value = figures.counter(name, f"{candidate}{threads}_{stage}_us")
        if value is not None:
            return value
    return None


def pads_us(figures, size, **which):
    return middle([cycle_us(figures, size, pad, **which) for pad in PADS])


def cycle_rows(figures):
    rows = []
    for size, most_ms in [("600x500", 5), ("1536x1280", 10)]:
        rows.append(at_most_ms(f"whole cycle, median of the five pad scenes, {size}", pads_us(figures, size), most_ms))
        rows.append(at_most_ms(f"whole cycle, part absent, {size}", cycle_us(figures, size, "absent"), 2 * most_ms))
    return rows


def search_ratio(figures, scenes, path, thesis="thesis", ours="sums"):
    return middle([figures.ratio(f"search/{s}/{thesis}", f"search/{s}/{ours}_{path}") for s in scenes])


def search_rows(figures):
    rows = []
    kinds = [("all positions", PADS), ("planar positions in both", [f"{pad}_planar" for pad in PADS]),
             ("one tilt for all", ["lone_level"]), ("cylinders, 6700^2", ["cyl_loose", "cyl_grid", "cyl_brick"]),
             ("cylinders, 6700^2, planar positions in both", ["cyl_loose_planar"])]
    for kind, scenes in kinds:
        for path, least in [("avx512", 250), ("avx2", 120)]:
            rows.append(at_least(f"search against the thesis's scalar form, {kind}, {path}",
                                 search_ratio(figures, scenes, path), least))
    rows.append(row("the thesis's scalar form itself, median of the pads", middle(
        [figures.counter(f"search/{s}/thesis", "evaluations_per_s") for s in PADS + ["lone_level"]]),
        "0.3 G evaluations/s", lambda v: v >= 0.3e9, lambda v: f"{v / 1e9:.2f} G/s"))
    return rows


def roof_share(figures, row_name, path, level):
    loads = figures.counter(f"search/{row_name}/whole_{path}", "loaded_bytes_per_s")
    roof = figures.counter(f"roof/{level}/{path}", "loaded_bytes_per_s")
    return loads / roof if loads and roof else None


def roof_rows(figures):
    rows = []
    for kind, name in [("one tilt for all", "lone_level"), ("as the thesis scores", "medium_normals_level")]:
        for level in ["L1_aligned", "L1_any_byte", "L2_aligned", "L2_any_byte"]:
            rows.append(row(f"loads against the load roof, {kind}, {WIDEST}, {level.replace('_', ' ')}",
                            roof_share(figures, name, WIDEST, level), "75 %", lambda v: v >= 0.75, lambda v: f"{v:.1%}"))
    return rows


def prune_rows(figures):
    rows = []
    for angles, least in [(240, 2), (720, 5)]:
        group = f"prune/medium_{angles}"
        path = figures.best_path(f"{group}/sums_") or WIDEST
        rows.append(at_least(f"exact pruning against shifted sums without it, {angles} angles, {path}",
                             figures.ratio(f"{group}/whole_{path}", f"{group}/pruned_{path}"), least))
        early = figures.ratio(f"{group}/whole_{path}", f"{group}/sums_{path}")
        rows.append(Row(f"early termination alone, {angles} angles, {path}", "-" if early is None else times(early), "beside it",
                        NOT_MEASURED if early is None else "-"))
    return rows


def thread_rows(figures):
    rows = []
    for size in ["600x500", "1536x1280"]:
        one, two = pads_us(figures, size), pads_us(figures, size, threads="_2_threads")
        rows.append(at_least(f"2 threads against 1, whole cycle, {size}", one / two if one and two else None, 1.7))
    return rows


def image_rows(figures):
    rows = []
    for size in ["600x500", "1536x1280"]:
        for kind, least in [("Sobel", 1.5), ("chamfer", 6), ("chamfer in eight directions", 6), ("whole edge chain", 2.5),
                            ("Canny part against its 8-bit Canny", 1)]:
            group = f"image/{size}/{kind.replace(' ', '_')}"
            rows.append(at_least(f"OpenCV: {kind}, {size}", figures.ratio(f"{group}/opencv", f"{group}/ours"), least))
    return rows


def all_rows(figures):
    return (cycle_rows(figures) + search_rows(figures) + roof_rows(figures) + prune_rows(figures) + thread_rows(figures)
            + image_rows(figures))
