"""The program itself in its shortest form: it runs what it is told and counts right. Of time nothing is asserted. Its
arguments: the folder of the bench, the program."""

import subprocess
import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))
BINARY = sys.argv.pop(1)

from figures import by_scene
from report import write_report
from run_latency import Program

SMALL = [BINARY, "--scenes", "single,empty", "--seeds", "2", "--cols", "150", "--rows", "120"]


class ShortForm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.program = Program(SMALL)
        seconds = 0.5
        cls.idle = cls.program.run("cycles", "idle", 1, seconds)
        while len(cls.idle.rows) < len(cls.program.scenes) and seconds < 60:  # a busy machine goes round less often
            seconds *= 2
            cls.idle = cls.program.run("cycles", "idle", 1, seconds)
        cls.two = cls.program.run("cycles", "2 threads, idle", 2, 0.2)
        cls.late = cls.program.run("deadlines", "late", 1, 0.5)
        cls.program.end()

    def test_looks_at_every_scan(self):
        self.assertEqual(self.program.scenes, {0: "single", 1: "empty", 2: "single", 3: "empty"})
        self.assertEqual({row["scan"] for row in self.idle.rows}, {0, 1, 2, 3})
        found = {row["scan"]: row["outcome"] for row in self.idle.rows}
        self.assertEqual([found[i] >= 0 for i in range(4)], [True, False, True, False])

    def test_stages_are_parts_of_the_cycle(self):
        for row in self.idle.rows + self.two.rows:
            stages = sum(row[f"{stage}_us"] for stage in ["rectify", "features", "search", "refine", "verify"])
            self.assertLessEqual(stages, row["total_us"] + 5)
            self.assertLessEqual(row["total_us"], row["cycle_ns"] / 1000 + 1)
            self.assertGreater(row["busy_ns"], 0)
            self.assertGreater(row["memory_ns"], 0)
            self.assertGreaterEqual(row["wake_ns"], 0)

    def test_events_are_counted(self):
        for part in ["in_cycles", "in_loops"]:
            for count in self.idle.end[part].values():
                self.assertGreaterEqual(count, 0)

    def test_deadlines_are_short_of_the_usual_time(self):
        self.assertTrue(self.late.rows)
        for row in self.late.rows:
            self.assertTrue(1 <= row["deadline_us"] <= max(1, row["usual_us"]))
            self.assertGreater(row["elapsed_ns"], 0)

    def test_report_is_made_of_it(self):
        text, _ = write_report([self.idle, self.two, self.late], self.program.scenes, [])
        self.assertIn("| empty ", text)
        self.assertEqual(sum(len(times) for times in by_scene(self.idle, self.program.scenes).values()), len(self.idle.rows))


class Refusal(unittest.TestCase):
    def test_of_what_is_no_command(self):
        for line in ["dance x 1 1", "cycles x 1 nan"]:
            done = subprocess.run([BINARY, "--scenes", "empty", "--seeds", "1", "--cols", "40", "--rows", "40"],
                                  input=line + "\n", capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, line)
            self.assertIn(line, done.stderr)


unittest.main()
