"""Tables of a run, and all its figures as JSON."""

from figures import (OUTCOME_DEADLINE, QUANTILES, STAGES, against_median, against_usual, beyond_ms, by_scene, most_stretched,
                     overruns_us, summarize)

BUDGET_MS = 1000.0  # the thesis's, for a whole cycle
OVERRUN_AIM_MS = 1.0


def table(head, rows):
    if not rows:
        return "nothing measured"
    widths = [max(len(str(row[i])) for row in [head] + rows) for i in range(len(head))]
    line = lambda row: "| " + " | ".join(str(c).ljust(w) for c, w in zip(row, widths)) + " |"
    return "\n".join([line(head), "|" + "|".join("-" * (w + 2) for w in widths) + "|"] + [line(r) for r in rows])


def number(value):
    return "-" if value is None else f"{value:.3f}"


HEAD = ["phase", "ms"] + [name for name, _ in QUANTILES] + ["max", "max/median", "samples"]


def row_of(phase, name, samples_ms, ratio="own"):
    """`ratio`: of the greatest to the usual; by itself that is the median."""
    summary = summarize(samples_ms)
    if summary is None:
        return []
    ratio = summary.greatest_over_median if ratio == "own" else ratio
    return [[phase, name] + [number(summary.values[q]) for q, _ in QUANTILES] +
            [number(summary.greatest), "-" if ratio is None else f"{ratio:.2f}", summary.count]]


def cycle_phases(phases):
    return [phase for phase in phases if phase.what == "cycles"]


LOOPS = [("busy_ns", "busy loop"), ("memory_ns", "memory loop")]


def cycle_rows(phases):
    rows = []
    for phase in cycle_phases(phases):
        rows += row_of(phase.name, "whole cycle", phase.column("cycle_ns", 1e-6))
        for column, name in LOOPS:
            rows += row_of("", name, phase.column(column, 1e-6))
        pairs = against_usual(phase)
        rows += row_of("", "cycle, beyond the same scan's median", beyond_ms(pairs), most_stretched(pairs))
        for column, name in LOOPS:
            pairs = against_median(phase.column(column))
            rows += row_of("", f"{name}, beyond its median", beyond_ms(pairs), most_stretched(pairs))
        rows += row_of("", "waking up late", phase.column("wake_ns", 1e-6), None)
    return rows


def stage_rows(phases):
    rows = []
    for phase in cycle_phases(phases):
        for i, stage in enumerate(STAGES):
            rows += row_of(phase.name if i == 0 else "", stage, phase.column(f"{stage}_us", 1e-3))
    return rows


def scene_rows(phases, scenes):
    rows = []
    for phase in cycle_phases(phases):
        for i, (scene, times_ms) in enumerate(by_scene(phase, scenes).items()):
            rows += row_of(phase.name if i == 0 else "", scene, times_ms)
    return rows


def event_rows(phases):
    rows = []
    for phase in cycle_phases(phases):
        for i, (key, name) in enumerate([("in_cycles", "cycles"), ("in_loops", "loops")]):
            events = phase.end.get(key, {})
            share = "-" if phase.others_share is None else f"{100 * phase.others_share:.0f} %"
            rows.append([phase.name if i == 0 else "", name, len(phase.rows)] +
                        [events.get(e, "-") for e in ["minor_faults", "major_faults", "own_switches", "forced_switches"]] +
                        [share if i == 0 else ""])
    return rows


EVENT_HEAD = ["phase", "in", "count", "page faults", "from disk", "own switches", "forced switches", "others' share"]


def deadline_rows(phases):
    rows = []
    for phase in phases:
        if phase.what != "deadlines":
            continue
        overruns = overruns_us(phase)
        struck = sum(1 for row in phase.rows if row["outcome"] == OUTCOME_DEADLINE)
        found = row_of(phase.name, "", [us / 1e3 for us in overruns], None)
        late = sum(1 for us in overruns if us > 1e3 * OVERRUN_AIM_MS)
        rows += [[r[0], len(phase.rows), struck] + r[2:7] + [r[8], late] for r in found]
    return rows


DEADLINE_HEAD = (["phase", "searches", "with a match"] + [name for name, _ in QUANTILES] +
                 ["max", "past it", f"by over {OVERRUN_AIM_MS:g} ms"])


def headline(phases):
    """What one wants to know first, a line each."""
    lines = []
    for phase in cycle_phases(phases):
        cycle = summarize(phase.column("cycle_ns", 1e-6))
        busy = summarize(phase.column("busy_ns", 1e-6))
        if cycle is None:
            continue
        lines.append(f"{phase.name}: {cycle.count} cycles, median {cycle.values['median']:.2f} ms, longest "
                     f"{cycle.greatest:.2f} ms, {BUDGET_MS / cycle.greatest:.0f} times inside the budget of a second; a busy "
                     f"loop of {busy.values['median']:.2f} ms took {busy.greatest:.2f} ms at most; longest against the same "
                     f"scan's median: {most_stretched(against_usual(phase)):.2f} times, busy loop "
                     f"{most_stretched(against_median(phase.column('busy_ns'))):.2f}, memory loop "
                     f"{most_stretched(against_median(phase.column('memory_ns'))):.2f}")
    for phase in phases:
        overrun = summarize(overruns_us(phase)) if phase.what == "deadlines" else None
        if overrun:
            lines.append(f"{phase.name}: {overrun.count} of {len(phase.rows)} searches returned past their deadline, by "
                         f"{overrun.values['median'] / 1e3:.3f} ms in the middle and {overrun.greatest / 1e3:.3f} ms at most "
                         f"(aim: under {OVERRUN_AIM_MS:g} ms)")
    return lines


NOTE = """A quantile is the least sample that so many are not above, and "-" where there are too few samples to tell it from the
greatest. A cycle is one call of locate(), the scan in memory. After each come two loops on as many threads, and a sleep: a
busy loop, about as long as the median cycle, that only calculates, and one that reads 8 MB a thread. Scans differ, so what
says how certain the time is is "beyond the same scan's median", in ms and, under max/median, as the greatest ratio; to be held
against the loops', which are the machine's own: also where two processors are threads of one core, and slow each other down."""

DEADLINE_NOTE = """Each search had between 2 and 98 % of the time that the same scan takes without a deadline. The figures are of
those that returned past it: how far past, in ms. A search that ends early with a verified match says `deadline`."""


def write_report(phases, scenes, notes):
    """The whole as Markdown, and the part to print."""
    cycles = table(HEAD, cycle_rows(phases))
    deadlines = table(DEADLINE_HEAD, deadline_rows(phases))
    summary = "\n".join(notes) + "\n\n" + cycles + "\n\nPast the deadline, ms\n" + deadlines + "\n\n" + "\n".join(
        headline(phases)) + "\n"
    sections = [("Whole cycles", NOTE + "\n\n" + cycles), ("Past the deadline", DEADLINE_NOTE + "\n\n" + deadlines),
                ("Page faults and context switches", table(EVENT_HEAD, event_rows(phases))),
                ("Stages", table(HEAD, stage_rows(phases))), ("Kinds of scenes", table(HEAD, scene_rows(phases, scenes)))]
    head = "# Latency\n\n" + "\n".join(notes + [""] + [f"- {line}" for line in headline(phases)]) + "\n"
    return head + "".join(f"\n## {title}\n{body}\n" for title, body in sections), summary


def as_json(summary):
    return None if summary is None else {**summary.values, "max": summary.greatest,
                                         "max_over_median": summary.greatest_over_median, "samples": summary.count}


def all_figures(phases, scenes):
    """Everything in milliseconds."""
    figures = {}
    for phase in phases:
        entry = {"threads": phase.threads, "others_share": phase.others_share, **phase.end}
        if phase.what == "cycles":
            entry["cycle_ms"] = as_json(summarize(phase.column("cycle_ns", 1e-6)))
            entry["busy_loop_ms"] = as_json(summarize(phase.column("busy_ns", 1e-6)))
            entry["memory_loop_ms"] = as_json(summarize(phase.column("memory_ns", 1e-6)))
            for name, pairs in [("cycle", against_usual(phase)), ("busy_loop", against_median(phase.column("busy_ns"))),
                                ("memory_loop", against_median(phase.column("memory_ns")))]:
                entry[f"{name}_beyond_usual_ms"] = as_json(summarize(beyond_ms(pairs)))
                entry[f"{name}_most_stretched"] = most_stretched(pairs)
            entry["wake_up_ms"] = as_json(summarize(phase.column("wake_ns", 1e-6)))
            entry["stages_ms"] = {stage: as_json(summarize(phase.column(f"{stage}_us", 1e-3))) for stage in STAGES}
            entry["scenes_ms"] = {scene: as_json(summarize(times)) for scene, times in by_scene(phase, scenes).items()}
        else:
            entry["overrun_ms"] = as_json(summarize([us / 1e3 for us in overruns_us(phase)]))
            entry["searches"] = len(phase.rows)
        figures[phase.name] = entry
    return figures
