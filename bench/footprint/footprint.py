"""What a controller must have ready: footprint.py check|report OBJECTS ARCHIVE... -- PROGRAM [WORDS...]

OBJECTS   a file that lists the library's objects, a line each; beside each lies its call graph
PROGRAM   searches, and prints what that took
check     ends with 1 and says why when the stack is deeper than stack.toml allows, cannot be told, or was deeper in a
          search than the graph says
report    prints all: the stack of each public call with its deepest path, what the archives take, what searches took
"""
import json
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path

from call_graph import CallGraph, Depth, Rule

HERE = Path(__file__).resolve().parent
LIB = HERE.parents[1] / "lib" / "flatpose"
PATH_BYTES_MIN = 8192  # what takes less is not drawn
CALLER_BYTES = 256  # the frames from which a measured call is made
REMEDY = ("Put what is large in the deepest path into the arena; raise stack_bytes_max in bench/footprint/stack.toml only "
          "where that would be worse, and say why in the commit.")


def read_graph(objects, rules):
    graph = CallGraph(LIB)
    for line in Path(objects).read_text().splitlines():
        graph.read(Path(line).with_suffix(".ci").read_text())
    graph.resolve([Rule(**rule) for rule in rules["indirect"]], rules["external"],
                  [(rule["function"], rule["calls_max"]) for rule in rules.get("recursion", [])])
    return graph


def depths_of(graph, entries):
    """(entry, depth) of each public call; what is wrong is added to the graph's faults."""
    found = []
    for entry in entries:
        titles = graph.titles(entry["function"])
        if not titles:
            graph.faults.append(f"{entry['name']}: there is no such function; mend its entry in stack.toml")
        depth = max((graph.depth(title) for title in titles), key=lambda d: d.total_bytes, default=Depth(0, ()))
        found.append((entry, depth))
    return found


def faults_of_searches(found, searches):
    """A real search must stay within what the graph says: else an edge is missing."""
    told = {entry["name"]: depth.total_bytes for entry, depth in found}
    for search in searches:
        for call, key in [("Locator::locate", "locate_stack_bytes"), ("Teacher::teach", "teach_stack_bytes")]:
            if search[key] > told[call] + CALLER_BYTES:
                yield f"{call} took {search[key]} bytes of stack where the call graph has {told[call]} at most"


def faults_of(graph, found):
    deep = [f"{entry['name']} takes {depth.total_bytes} bytes of stack, and may take {entry['stack_bytes_max']}:"
            + path_text(depth) for entry, depth in found if depth.total_bytes > entry["stack_bytes_max"]]
    return graph.faults + deep + [REMEDY] * bool(deep)


def path_text(depth):
    return "".join(f"\n{size:12}  {short_name(name)}" for name, size in depth.path if size >= 64)


def short_name(name):
    """Without parameters and template arguments."""
    name = name.split(" [with ")[0].replace("flatpose::", "").replace("{anonymous}::", "").replace("constexpr ", "")
    text, level = "", 0
    for c in name:
        level += c in "<("
        text += c if level == 0 else ""
        level -= c in ">)"
    return text.replace(" const", "").strip(":").split(" ")[-1]


def sizes_of(archive):
    """Bytes by kind of section."""
    kinds = {".text": "code", ".rodata": "constants", ".data.rel.ro": "constants", ".data": "data", ".bss": "data"}
    sizes = Counter()
    for line in subprocess.run(["size", "-A", archive], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines():
        words = line.split()
        kind = next((k for start, k in kinds.items() if words and words[0].startswith(start)), None)
        if kind:
            sizes[kind] += int(words[1])
    return sizes


def table(head, rows):
    widths = [max(len(str(row[i])) for row in [head] + rows) for i in range(len(head))]
    line = lambda row: "| " + " | ".join(str(c).ljust(w) for c, w in zip(row, widths)) + " |"
    return "\n".join([line(head), "|" + "|".join("-" * (w + 2) for w in widths) + "|"] + [line(r) for r in rows])


def report(found, archives, searches):
    print("Worst stack by the call graph (x86-64, every vector path, the caller's thread does all the work)\n")
    print(table(["call", "bytes", "may take"],
                [[entry["name"], depth.total_bytes, entry["stack_bytes_max"]] for entry, depth in found]))
    for entry, depth in found:
        if depth.total_bytes > PATH_BYTES_MIN:
            print(f"\n{entry['name']}:{path_text(depth)}")
    print("\nWhat is linked, at most (all of it, with every vector path)\n")
    kinds = ["code", "constants", "data"]
    print(table(["archive"] + kinds, [[Path(a).name] + [sizes_of(a)[k] for k in kinds] for a in archives]))
    print("\nMemory that the caller gives, and what a search took of it and of the stack\n")
    head = ["scan", "cells at most", "Locator::required_bytes", "Teacher::required_bytes", "peak_bytes of a search",
            "its stack", "stack of teaching"]
    print(table(head, [[s["scan"], s["cell_count"], s["locator_bytes"], s["teacher_bytes"], s["peak_bytes"],
                        s["locate_stack_bytes"], s["teach_stack_bytes"]] for s in searches]))


def main():
    what, objects, *rest = sys.argv[1:]
    split = rest.index("--")
    archives, program = rest[:split], rest[split + 1:]
    rules = tomllib.loads((HERE / "stack.toml").read_text())
    graph = read_graph(objects, rules)
    found = depths_of(graph, rules["entry"])
    measured = subprocess.run(program, stdout=subprocess.PIPE, text=True, check=True).stdout
    searches = [json.loads(line) for line in measured.splitlines()]
    if what == "report":
        report(found, archives, searches)
    else:
        print("\n".join(f"{depth.total_bytes:8}  {entry['name']}" for entry, depth in found))
        print(measured)
    faults = faults_of(graph, found) + list(faults_of_searches(found, searches))
    sys.exit("\n".join(faults) if faults else 0)


if __name__ == "__main__":
    main()
