"""The call graph on graphs made by hand. Its argument: the folder of the bench."""
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, sys.argv.pop(1))

from call_graph import CallGraph, Rule

SOURCE = """void run() {
  table.kernel(1);
  host.task(context, 2);
}
"""


def node(title, frame_bytes, kind="static", name=None):
    return f'node: {{ title: "{title}" label: "{name or title}\\na.cpp:1:1\\n{frame_bytes} bytes ({kind})" }}'


def edge(caller, callee):
    return f'edge: {{ sourcename: "{caller}" targetname: "{callee}" label: "a.cpp:2:3" }}'


class OfCallGraph(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "a.cpp").write_text(SOURCE)

    def graph(self, *lines, rules=(), externals=None, recursions=(), source="a.cpp", of=None):
        of = of or CallGraph(self.root)
        of.read("\n".join([f'graph: {{ title: "{self.root}/{source}"', *lines, "}"]))
        of.resolve(list(rules), externals or {}, recursions)
        return of

    def pointer(self, caller, line, column):
        return f'edge: {{ sourcename: "{caller}" targetname: "__indirect_call" label: "{self.root}/a.cpp:{line}:{column}" }}'

    def test_the_deepest_path_counts(self):
        graph = self.graph(node("top", 10), node("left", 100), node("right", 50), node("leaf", 60),
                           edge("top", "left"), edge("top", "right"), edge("right", "leaf"), edge("top", "memset"),
                           externals={"memset": 119})
        depth = graph.depth("top")
        self.assertEqual((depth.total_bytes, [n for n, _ in depth.path]), (129, ["top", "memset"]))
        graph = self.graph(node("top", 10), node("left", 100), node("right", 50), node("leaf", 60),
                           edge("top", "left"), edge("top", "right"), edge("right", "leaf"))
        self.assertEqual(graph.depth("top").total_bytes, 120)
        self.assertEqual(graph.faults, [])

    def test_a_function_in_two_objects_takes_the_larger_frame_and_all_calls(self):
        graph = self.graph(node("inline", 10), node("leaf", 7), edge("inline", "leaf"))
        self.graph(node("inline", 30), source="b.cpp", of=graph)
        self.assertEqual(graph.depth("inline").total_bytes, 37)

    def test_recursion_is_a_fault_unless_its_depth_is_stated(self):
        lines = [node("top", 1), node("a", 10), edge("top", "a"), edge("a", "a")]
        graph = self.graph(*lines)
        graph.depth("top")
        self.assertTrue(any("recursion: a -> a" in f or "recursion: a" in f for f in graph.faults))
        graph = self.graph(*lines, recursions=[("^a$", 5)])
        self.assertEqual(graph.depth("top").total_bytes, 51)
        self.assertEqual(graph.faults, [])

    def test_recursion_through_others_is_a_fault_even_where_a_depth_is_stated(self):
        graph = self.graph(node("a", 10), node("b", 10), edge("a", "b"), edge("b", "a"), recursions=[("^a$", 5)])
        graph.depth("a")
        self.assertTrue(any("recursion: a -> b" in f for f in graph.faults))

    def test_frames_without_bound_are_a_fault_and_those_with_one_are_rounded_up(self):
        self.assertIn("no bound", self.graph(node("a", 10, "dynamic")).faults[0])
        graph = self.graph(node("a", 10, "dynamic,bounded"))
        self.assertEqual((graph.faults, graph.depth("a").total_bytes), ([], 74))

    def test_a_call_of_what_is_not_known_is_a_fault(self):
        self.assertIn("of which no stack is known", self.graph(node("a", 10), edge("a", "printf")).faults[0])

    def test_a_constructor_is_found_under_its_twin(self):
        graph = self.graph(node("a", 10), node("_ZN1XC2Ei", 20), edge("a", "_ZN1XC1Ei"))
        self.assertEqual((graph.faults, graph.depth("a").total_bytes), ([], 30))

    def test_a_call_by_pointer_that_no_rule_names_is_a_fault(self):
        graph = self.graph(node("a", 10), self.pointer("a", 2, 15))
        self.assertEqual(graph.faults, ["a calls by a pointer: kernel in a.cpp"])

    def test_a_rule_leads_to_functions_of_the_pointers_name(self):
        rule = Rule("*.cpp", ["kernel"], "^CALLEE_", "", allowance_bytes=3)
        graph = self.graph(node("a", 10), node("kernel_one", 20), node("kernel_two", 30), node("other", 90),
                           self.pointer("a", 2, 15), rules=[rule])
        self.assertEqual((graph.faults, graph.depth("a").total_bytes), ([], 40))

    def test_a_rule_may_stay_in_the_callers_object(self):
        rule = Rule("*", ["task"], "^job", "", same_object=True)
        graph = CallGraph(self.root)
        graph.read(f'graph: {{ title: "{self.root}/b.cpp"\n' + node("job_b", 500) + "}")
        self.graph(node("a", 10), node("job_a", 20), self.pointer("a", 3, 12), rules=[rule], of=graph)
        self.assertEqual((graph.faults, graph.depth("a").total_bytes), ([], 30))

    def test_rules_that_nothing_uses_or_that_lead_nowhere_are_faults(self):
        graph = self.graph(node("a", 10), rules=[Rule("*", ["gone"], "^a$", "")])
        self.assertIn("has no call left", graph.faults[0])
        graph = self.graph(node("a", 10), self.pointer("a", 2, 15), rules=[Rule("*", ["kernel"], "^nothing", "")])
        self.assertIn("leads nowhere", graph.faults[0])


unittest.main()
