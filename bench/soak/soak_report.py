"""The tables of a soak."""

TIMES = ["p50_us", "p99_us", "p999_us", "max_us"]


def table(head, rows):
    widths = [max(len(str(row[i])) for row in [head] + rows) for i in range(len(head))]
    line = lambda row: "| " + " | ".join(str(c).ljust(w) for c, w in zip(row, widths)) + " |"
    return "\n".join([line(head), "|" + "|".join("-" * (w + 2) for w in widths) + "|"] + [line(r) for r in rows])


def ms(us):
    return "-" if us is None else f"{us / 1000:.3f}"


def quantile(values, share):
    """The least that so many are not above."""
    values = sorted(values)
    return values[max(-(-int(share * 1000) * len(values) // 1000) - 1, 0)] if values else None


LOCATE = ["rectify", "features", "search", "refine", "verify"]


def stage_rows(pairs):
    """[(stage, median, p99, greatest)] of trips and records of the same numbers, in us."""
    stages = {"write -> accepted": [], "accepted -> acquired": [], "acquired -> search begins": []}
    stages |= {f"  {name}": [] for name in LOCATE}
    stages |= {"search begins -> ends": [], "search ends -> posted on the board": [], "posted -> read by the PLC": [],
               "acquired -> read by the PLC": [], "(before: file -> memory)": [], "(after: copy for the record)": []}
    for trip, record in pairs:
        at = record["times_us"]
        if None in (at["acquired"], at["begun"], at["posted"]) or trip["read_us"] < at["posted"]:
            continue
        stages["write -> accepted"].append(at["accepted"] - trip["written_us"])
        stages["accepted -> acquired"].append(at["acquired"] - at["accepted"])
        stages["acquired -> search begins"].append(at["begun"] - at["acquired"])
        for name in LOCATE:
            stages[f"  {name}"].append(record["timings_us"][name])
        stages["search begins -> ends"].append(at["ended"] - at["begun"])
        stages["search ends -> posted on the board"].append(at["posted"] - at["ended"])
        stages["posted -> read by the PLC"].append(trip["read_us"] - at["posted"])
        stages["acquired -> read by the PLC"].append(trip["read_us"] - at["acquired"])
        stages["(before: file -> memory)"].append(record["timings_us"]["load"])
        stages["(after: copy for the record)"].append(at["copied"] - at["said"])
    return [[name, len(v), quantile(v, 0.5), quantile(v, 0.99), quantile(v, 1.0)] for name, v in stages.items()]


def time_row(name, figures):
    if not figures:
        return [name] + ["-"] * 5
    return [name, figures["count"]] + [ms(figures[key]) for key in TIMES]


def fault_row(name, row):
    if "failure" in row:
        return [name, row["failure"]] + ["-"] * 9
    read, echo = row["read"], row["echo"]
    return [name, row["done"], row["refused"], row["lost"], row["doubled"], row["torn"], ms(read["p50_us"]),
            ms(read["p99_us"]), ms(read["max_us"]), ms(echo["p99_us"]), ms(echo["max_us"])]


def is_right(row):
    return "failure" not in row and row["done"] > 0 and not (row["refused"] or row["lost"] or row["doubled"] or row["torn"])


def write_report(results):
    soak, killed = results["soak"], results["killed"]
    text = ["# Soak", "", f"{results['machine']}. {results.get('took_s', 0):.0f} s. Polled every {results['poll_us']} us.", ""]
    is_sound = is_right(soak) and all(is_right(row) for row in results["faults"].values())
    if "failure" in soak:
        text += [f"THE SOAK FAILED: {soak['failure']}", ""]
    else:
        text += [f"{soak['done']} triggers answered, {soak['refused']} refused, {soak['lost']} lost, {soak['doubled']} executed "
                 f"twice, {soak['torn']} torn; statuses {soak['statuses']}. The daemon ended with {soak['exit_code']}.",
                 f"Memory {soak['before']['rss_kb']} kB before, {soak['most']['rss_kb']} kB at most, "
                 f"{soak['after']['rss_kb']} kB after; descriptors {soak['before']['fds']}, {soak['most']['fds']}, "
                 f"{soak['after']['fds']}.", "", "Until the answer is there, ms; the echo is of as many bytes, read and echo in turn:",
                 "", table(["", "count", "p50", "p99", "p99.9", "max"],
                           [time_row("read of the result block", soak["read"]), time_row("plain echo", soak["echo"]),
                            time_row("write that triggers", soak["write"])]), ""]
    text += ["## From the end of the acquisition to the register read, ms", "",
             table(["stage", "count", "median", "p99", "max"],
                   [[row[0], row[1]] + [ms(us) for us in row[2:]] for row in results["stages"]]), "",
             "## Under faults", "", "Of a well-behaved PLC beside each; times in ms.", "",
             table(["fault", "answered", "refused", "lost", "twice", "torn", "read p50", "p99", "max", "echo p99", "max"],
                   [fault_row(name, row) for name, row in results["faults"].items()]), "",
             f"kill -9 in mid-search, {killed['kills']} times: {killed['refused']} numbers left over were refused as of a session "
             f"before, {killed['done']} next ones done, {killed['sessions']} sessions, {killed['boots']} boots counted.",
             f"Full disk: {results['faults']['full disk'].get('log_lines')} line in the log.", ""]
    is_sound = is_sound and killed["kills"] == killed["refused"] == killed["done"]
    return "\n".join(text), is_sound
