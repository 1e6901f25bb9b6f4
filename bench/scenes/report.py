"""Tables of trials, and whether they keep what is asked of them."""

from collections import defaultdict

COARSE_SHARE = 1.0
FINE_SHARE = 0.97
FOUND_SHARE = 0.98
WORSE_SENSOR_SHARE = 0.95
STAGES = ["rectify", "features", "search", "refine", "verify", "total"]


def quantile(values, share):
    """The value that `share` of the values do not exceed; None of none."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else None


def number(value, digits=3):
    return "-" if value is None else f"{value:.{digits}f}"


def table(head, rows):
    widths = [max(len(str(row[i])) for row in [head] + rows) for i in range(len(head))]
    line = lambda row: "| " + " | ".join(str(c).ljust(w) for c, w in zip(row, widths)) + " |"
    return "\n".join([line(head), "|" + "|".join("-" * (w + 2) for w in widths) + "|"] + [line(r) for r in rows])


def grouped(trials):
    groups = defaultdict(list)
    for t in trials:
        groups[t["scene"], t["part"], t["sensor"]].append(t)
    return groups


def by_count(trials):
    groups = defaultdict(list)
    for t in trials:
        groups[t["scene"], t["part"], t["sensor"], t["max_matches"]].append(t)
    return groups


def wanted_and_found(trials):
    """Instances visible enough, as many as may be reported, and of these those found."""
    wanted = sum(t["all"]["wanted"] for t in trials)
    return wanted, sum(min(t["all"]["found"], t["all"]["wanted"]) for t in trials)


def first_answers(trials):
    return [t for t in trials if t["max_matches"] == 1 and t["expects_target"]]


def several_answers(trials):
    return [t for t in trials if t["max_matches"] > 1 and t["expects_target"]]


def without_target(trials):
    return [t for t in trials if not t["expects_target"]]


def first_table(trials):
    head = ["scene", "part", "sensor", "trials", "coarse", "fine", "mm 50 %", "95 %", "tilt deg 50 %", "95 %",
            "turn deg 50 %", "95 %", "lowest score", "threshold"]
    rows = []
    for key, group in grouped(first_answers(trials)).items():
        right = [t for t in group if t["first"]["coarse"]]
        error = lambda name: [t["first"]["error"][name] for t in right]
        row = [*key, len(group), len(right), sum(t["first"]["fine"] for t in group)]
        for name in ["position_mm", "tilt_deg", "turn_deg"]:
            row += [number(quantile(error(name), 0.5)), number(quantile(error(name), 0.95))]
        scores = [t["matches"][0]["score"] for t in right]
        rows.append(row + [number(min(scores, default=None), 2), number(group[0]["threshold"], 2)])
    return table(head, rows) if rows else "none run"


def several_table(trials):
    head = ["scene", "part", "sensor", "matches", "trials", "wanted", "found", "share", "wrong", "double"]
    rows = []
    for key, group in by_count(several_answers(trials)).items():
        wanted, found = wanted_and_found(group)
        rows.append([*key, len(group), wanted, found, number(found / wanted if wanted else None, 4),
                     sum(len(t["all"]["wrong"]) for t in group), sum(len(t["all"]["double"]) for t in group)])
    return table(head, rows) if rows else "none run"


def without_table(trials):
    head = ["scene", "part", "trials", "with a match", "highest rejected score", "threshold"]
    rows = []
    for (scene, part, _), group in grouped(without_target(trials)).items():
        rows.append([scene, part, len(group), sum(bool(t["matches"]) for t in group),
                     number(max(t["best_rejected"] for t in group), 2), number(group[0]["threshold"], 2)])
    return table(head, rows) if rows else "none run"


def time_table(trials):
    head = ["scene", "part", "sensor", "matches"] + [f"{s} ms" for s in STAGES] + ["total 95 %", "max"]
    rows = []
    for key, group in by_count(trials).items():
        times = [t["timings_us"] for t in group]
        total = [t["total"] / 1000 for t in times]
        medians = [number(quantile([t[s] / 1000 for t in times], 0.5), 1) for s in STAGES]
        rows.append([*key, *medians, number(quantile(total, 0.95), 1), number(max(total), 1)])
    return table(head, rows) if rows else "none run"


def failure_table(trials):
    head = ["scene", "part", "seed", "sensor", "matches", "cause", "lost: score, visible, stage", "status", "picture"]
    rows = []
    for t in trials:
        if not t["cause"]:
            continue
        lost = "; ".join(f"T{one['instance']} {one['score']:.2f}, {one['visible']:.2f}, {one['stage']}" for one in t["lost"])
        rows.append([t["scene"], t["part"], t["seed"], t["sensor"], t["max_matches"], t["cause"], lost, t["status"],
                     t["picture"].rsplit("/", 1)[-1]])
    return table(head, rows) if rows else "none"


def demand(name, good, count, share):
    if count == 0:
        return [name, "-", "-", f"{share:.0%}", "not run"]
    return [name, f"{good} of {count}", f"{good / count:.2%}", f"{share:.0%}", "yes" if good >= share * count else "NO"]


def none_of(name, bad, trials):
    return [name, f"{bad} in {trials}", "-", "none", "not run" if trials == 0 else ("yes" if bad == 0 else "NO")]


def demands(trials):
    """What is asked, a row each, the verdict last."""
    first = first_answers(trials)
    standard = [t for t in first if t["sensor"] == "standard"]
    several = several_answers(trials)
    coarse = lambda group: sum(t["first"]["coarse"] for t in group)
    rows = [demand("first answer coarsely right", coarse(standard), len(standard), COARSE_SHARE),
            demand("first answer within the fine bounds", sum(t["first"]["fine"] for t in standard), len(standard), FINE_SHARE)]
    wanted, found = wanted_and_found(several)
    rows.append(demand("several: instances found", found, wanted, FOUND_SHARE))
    rows.append(none_of("several: wrong", sum(len(t["all"]["wrong"]) for t in several), len(several)))
    rows.append(none_of("several: double", sum(len(t["all"]["double"]) for t in several), len(several)))
    for scene in ["absent", "empty"]:
        group = [t for t in without_target(trials) if t["scene"] == scene]
        rows.append(none_of(f"{scene}: scans with a match", sum(bool(t["matches"]) for t in group), len(group)))
    for sensor in ["noise", "lost", "half"]:
        group = [t for t in first if t["sensor"] == sensor]
        rows.append(demand(f"sensor '{sensor}': coarsely right", coarse(group), len(group), WORSE_SENSOR_SHARE))
    return rows


def write_report(trials, notes):
    """The whole as Markdown."""
    sections = [
        ("Demands", table(["demand", "got", "share", "asked", "kept"], demands(trials))),
        ("First answer", "Errors over the coarsely right ones.\n\n" + first_table(trials)),
        ("Several answers", "Wanted: visible to 60 % or more, at most as many as matches were asked for.\n\n" + several_table(trials)),
        ("Nothing there", without_table(trials)),
        ("Times", "Medians, one thread of two that ran side by side.\n\n" + time_table(trials)),
        ("Failures", failure_table(trials)),
    ]
    text = "# Scenes\n\n" + "\n".join(notes) + "\n"
    for title, body in sections:
        text += f"\n## {title}\n{body}\n"
    return text
