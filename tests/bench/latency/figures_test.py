"""The report's arithmetic on samples made by hand. Its argument: the folder of the bench."""

import random
import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))

from figures import (COLUMNS, DEADLINE_COLUMNS, Phase, against_median, against_usual, beyond_ms, by_scene, histogram,
                     most_stretched, overruns_us, quantile, summarize)
from report import all_figures, headline, write_report


def cycles(rows, name="idle", **end):
    """Rows of (scan, cycle in ms, busy loop in ms)."""
    phase = Phase(name, "cycles", 1, end=end)
    for scan, cycle_ms, busy_ms in rows:
        values = [scan, cycle_ms * 1e6, busy_ms * 1e6, 5e5, 2e3, cycle_ms * 1e3, cycle_ms * 500, cycle_ms * 300, 10.0, 20.0, 30.0, 0]
        phase.rows.append(dict(zip(COLUMNS, values)))
    return phase


def deadlines(rows):
    """Rows of (deadline in us, elapsed in us, outcome)."""
    phase = Phase("late", "deadlines", 1)
    for deadline_us, elapsed_us, outcome in rows:
        phase.rows.append(dict(zip(DEADLINE_COLUMNS, [0, 1000, deadline_us, elapsed_us * 1e3, outcome])))
    return phase


def quantile_by_counting(samples, share):
    """By the definition, sample by sample."""
    for sample in sorted(samples):
        if sum(1 for other in samples if other <= sample) >= share * len(samples) - 1e-9:
            return sample


class Quantiles(unittest.TestCase):
    def test_of_known_samples(self):
        ordered = list(range(1, 10001))
        self.assertEqual(quantile(ordered, 0.5), 5000)
        self.assertEqual(quantile(ordered, 0.99), 9900)
        self.assertEqual(quantile(ordered, 0.999), 9990)
        self.assertEqual(quantile(ordered, 0.9999), 9999)

    def test_are_what_counting_gives(self):
        rng = random.Random(3)
        for count in list(range(2, 40)) + [100, 333]:
            samples = [rng.choice([1.0, 2.0, 2.5, 7.0]) for _ in range(count)]
            for share in [0.5, 0.9, 0.99]:
                found = quantile(sorted(samples), share)
                if found is not None:
                    self.assertEqual(found, quantile_by_counting(samples, share))

    def test_are_not_made_up_where_samples_are_few(self):
        self.assertIsNone(quantile([], 0.5))
        self.assertIsNone(quantile(list(range(99)), 0.99))
        self.assertEqual(quantile(list(range(100)), 0.99), 98)
        self.assertIsNone(quantile(list(range(9999)), 0.9999))

    def test_summary(self):
        self.assertIsNone(summarize([]))
        self.assertEqual(summarize([4.0]).values["median"], 4.0)
        summary = summarize([3.0, 1.0, 2.0, 12.0])
        self.assertEqual((summary.count, summary.values["median"], summary.greatest), (4, 2.0, 12.0))
        self.assertEqual(summary.greatest_over_median, 6.0)


class Samples(unittest.TestCase):
    def test_jitter_is_against_the_same_scan(self):
        phase = cycles([(0, 1.0, 1), (1, 50.0, 1), (0, 1.5, 1), (1, 50.0, 1), (0, 1.0, 1), (1, 53.0, 1)])
        self.assertEqual(beyond_ms(against_usual(phase)), [0.0, 0.0, 0.5, 0.0, 0.0, 3.0])
        self.assertEqual(most_stretched(against_usual(phase)), 1.5)
        self.assertEqual(beyond_ms(against_median([2e6, 1e6, 5e6])), [0.0, 0.0, 3.0])
        self.assertEqual(most_stretched(against_median([2e6, 1e6, 5e6])), 2.5)
        self.assertEqual(against_median([]), [])
        self.assertIsNone(most_stretched([]))

    def test_overruns_are_of_those_past_their_deadline(self):
        self.assertEqual(overruns_us(deadlines([(100, 150.0, 2), (100, 99.0, 0), (100, 100.0, 0)])), [50.0])

    def test_by_scene_keeps_all(self):
        phase = cycles([(0, 1.0, 1), (1, 2.0, 1), (2, 3.0, 1)])
        self.assertEqual(by_scene(phase, {0: "pile", 1: "lone", 2: "pile", 3: "empty"}), {"pile": [1.0, 3.0], "lone": [2.0]})

    def test_histogram_loses_nothing(self):
        rng = random.Random(5)
        samples = [10 ** rng.uniform(-3, 4) for _ in range(1000)]
        edges, counts = histogram(samples, 0.01, 1000.0, 7)
        self.assertEqual(len(edges), len(counts) + 1)
        self.assertEqual(sum(counts), len(samples))
        for i in range(1, len(counts) - 1):
            inside = sum(1 for s in samples if edges[i] * (1 + 1e-9) < s < edges[i + 1] * (1 - 1e-9))
            self.assertLessEqual(abs(inside - counts[i]), 1)


class Report(unittest.TestCase):
    SCENES = {0: "pile", 1: "absent"}

    def test_is_written_of_any_phases(self):
        some = [cycles([(0, 4.0, 4.0), (1, 8.0, 4.1)] * 100, in_cycles={"minor_faults": 5}),
                deadlines([(100, 1350.0, 2), (100, 99.0, 0)])]
        for phases in [[], some, [Phase("none", "cycles", 1), Phase("none", "deadlines", 1)]]:
            text, summary = write_report(phases, self.SCENES, ["a note"])
            self.assertIn("a note", summary)
            self.assertIn("## Kinds of scenes", text)
        text, summary = write_report(some, self.SCENES, [])
        for part in ["| absent ", "| pile ", "| rectify ", "| busy loop ", "| 5 "]:
            self.assertIn(part, text)
        self.assertIn("| late  | 2        | 1            | 1.250 ", summary)

    def test_says_the_longest_beside_the_budget(self):
        lines = headline([cycles([(0, 4.0, 5.0), (0, 4.0, 5.0), (0, 10.0, 7.0)]), deadlines([(100, 1350.0, 2)])])
        self.assertIn("longest 10.00 ms, 100 times inside", lines[0])
        self.assertIn("took 7.00 ms at most", lines[0])
        self.assertIn("scan's median: 2.50 times, busy loop 1.40, memory loop 1.00", lines[0])
        self.assertIn("1 of 1 searches returned past their deadline, by 1.250 ms", lines[1])

    def test_figures_hold_every_part(self):
        figures = all_figures([cycles([(0, 4.0, 5.0), (1, 6.0, 5.0)]), deadlines([(100, 1350.0, 2)])], self.SCENES)
        self.assertEqual(figures["idle"]["cycle_ms"]["max"], 6.0)
        self.assertEqual(figures["idle"]["stages_ms"]["rectify"]["max"], 3.0)
        self.assertEqual(figures["idle"]["memory_loop_ms"]["median"], 0.5)
        self.assertEqual(figures["idle"]["cycle_most_stretched"], 1.0)
        self.assertEqual(figures["idle"]["scenes_ms"]["absent"]["samples"], 1)
        self.assertEqual(figures["late"]["overrun_ms"]["max"], 1.25)


unittest.main()
