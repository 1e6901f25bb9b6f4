"""The call graph that GCC writes with -fcallgraph-info=su, one file an object, joined to one of the whole library, and the
deepest stack below a function in it.

Calls through pointers are resolved by rules, each with its reason; what no rule names is a fault, as are recursion, frames
of no known size, and calls of functions that are neither in the graph nor among those with an allowance.
"""
import re
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "([^"]+)"')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"(?: label: "([^"]+)")?')
FRAME = re.compile(r"(\d+) bytes \(([a-z,]+)\)")
INDIRECT = "__indirect_call"
# GCC's figure leaves out what rounding the stack to a wide vector's boundary may skip.
REALIGN_BYTES = 64


@dataclass
class Function:
    name: str
    frame_bytes: int = 0
    is_bounded: bool = True
    objects: set = field(default_factory=set)
    calls: set = field(default_factory=set)  # titles of functions
    indirect: set = field(default_factory=set)  # (object, (file, callee))


@dataclass
class Rule:
    """Where the pointers called `callees` in files like `files` may lead: `to` is a pattern of function names, in which
    CALLEE stands for the pointer's. With `same_object` only to functions of the caller's own object; `allowance_bytes`
    is for code of the user's."""
    files: str
    callees: list
    to: str
    reason: str
    same_object: bool = False
    allowance_bytes: int = 0
    used: set = field(default_factory=set)


@dataclass
class Depth:
    total_bytes: int
    path: tuple  # of (name, bytes)


def callee_at(location, root):
    """(file, callee) of the call at "path:line:column": where its bracket opens, or the callee begins."""
    path, line, column = location.rsplit(":", 2)
    text = Path(path).read_text().splitlines()[int(line) - 1]
    start = int(column) - 1
    callee = re.search(r"(\w+)\)?\s*$", text[:start]) or re.match(r"(\w+)", text[start:])
    return short_path(path, root), callee[1] if callee else text.strip()


def short_path(path, root):
    path = Path(path)
    if path.is_relative_to(root):
        return str(path.relative_to(root))
    return "/".join(path.parts[-2:])


class CallGraph:
    """`root`: the folder that paths are given from."""

    def __init__(self, root):
        self.root = Path(root)
        self.functions = {}
        self.faults = []
        self._depths = {}
        self._titles = {}
        self._externals = {}
        self._rules = []
        self._recursions = []

    def read(self, text):
        """Adds the graph of one object, whose title is its source."""
        source = short_path(re.match(r'graph: \{ title: "([^"]+)"', text)[1], self.root)
        for title, label in NODE.findall(text):
            frame = FRAME.search(label)
            if frame:
                self._add_function(title, label.split("\\n")[0], int(frame[1]), frame[2], source)
        for caller, callee, location in EDGE.findall(text):
            function = self.functions[caller]
            if callee == INDIRECT:
                function.indirect.add((source, callee_at(location, self.root)))
            else:
                function.calls.add(callee)

    def _known(self, title):
        """The title under which a function stands in the graph: of two constructors that are alike GCC writes one."""
        if title in self.functions:
            return title
        twin = re.sub(r"(C|D)1E", r"\g<1>2E", title)
        return twin if twin in self.functions else title

    def _add_function(self, title, name, frame_bytes, kind, source):
        function = self.functions.setdefault(title, Function(name))
        if kind == "dynamic,bounded":
            frame_bytes += REALIGN_BYTES
        function.frame_bytes = max(function.frame_bytes, frame_bytes)
        function.is_bounded &= kind != "dynamic"
        function.objects.add(source)

    def resolve(self, rules, externals, recursions=()):
        """`externals`: bytes by name. `recursions`: (pattern of a function that calls itself, how deep at most)."""
        self._rules, self._externals, self._recursions = rules, externals, recursions
        for function in self.functions.values():
            if not function.is_bounded:
                self.faults.append(f"{function.name}: its frame has no bound (alloca, or an array whose length varies)")
            for call in sorted(function.calls):
                if self._known(call) not in self.functions and call not in externals:
                    self.faults.append(f"{function.name} calls {call}, of which no stack is known")
            for _, (file, callee) in sorted(function.indirect):
                if not self._rule_for(file, callee):
                    self.faults.append(f"{function.name} calls by a pointer: {callee} in {file}")
        for rule in rules:
            for callee in rule.callees:
                if callee not in rule.used:
                    self.faults.append(f"the rule for {rule.files} {callee} has no call left")
                if rule.to and not self._targets(rule, callee):
                    self.faults.append(f"the rule for {rule.files} {callee} leads nowhere: {rule.to}")

    def _rule_for(self, file, callee):
        for rule in self._rules:
            if callee in rule.callees and fnmatch(file, rule.files):
                rule.used.add(callee)
                return rule
        return None

    def _targets(self, rule, callee):
        return self.titles(rule.to.replace("CALLEE", callee)) if rule.to else []

    def titles(self, pattern):
        """Of the functions whose name holds the pattern."""
        if pattern not in self._titles:
            form = re.compile(pattern)
            self._titles[pattern] = [t for t, f in self.functions.items() if form.search(f.name)]
        return self._titles[pattern]

    def depth(self, title, above=()):
        """The deepest stack from the call of a function on, its own frame included."""
        title = self._known(title)
        if title in self._depths:
            return self._depths[title]
        if title not in self.functions:
            return Depth(self._externals.get(title, 0), ((title, self._externals.get(title, 0)),))
        function = self.functions[title]
        if title in above:
            cycle = " -> ".join(self.functions[t].name for t in above[above.index(title):])
            fault = f"recursion: {cycle}"
            if fault not in self.faults:
                self.faults.append(fault)
            return Depth(0, ())
        count = self._calls_of_itself(function.name)
        below = [self.depth(call, above + (title,)) for call in sorted(function.calls)
                 if not (count > 1 and call == title)]
        for source, call in sorted(function.indirect):
            below += self._depths_by_pointer(source, call, above + (title,))
        deepest = max(below, key=lambda d: d.total_bytes, default=Depth(0, ()))
        own_bytes = function.frame_bytes * count
        depth = Depth(own_bytes + deepest.total_bytes, ((function.name, own_bytes),) + deepest.path)
        self._depths[title] = depth
        return depth

    def _calls_of_itself(self, name):
        return max((count for pattern, count in self._recursions if re.search(pattern, name)), default=1)

    def _depths_by_pointer(self, source, call, above):
        rule = self._rule_for(*call)
        if not rule:
            return []
        targets = self._targets(rule, call[1])
        if rule.same_object:
            targets = [t for t in targets if source in self.functions[t].objects]
        below = [self.depth(target, above) for target in targets]
        if rule.allowance_bytes:
            below.append(Depth(rule.allowance_bytes, ((f"{call[1]} of the user's", rule.allowance_bytes),)))
        return below
