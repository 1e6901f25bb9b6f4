"""The table of aims on results made by hand. Its argument: the folder of the bench."""

import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))

from aims import PADS, all_rows
from report import Figures, write_report

PATHS = ["portable", "avx2", "avx512"]
SIZES = ["600x500", "1536x1280"]
KERNELS = ["Sobel", "chamfer", "chamfer_in_eight_directions", "whole_edge_chain", "Canny_part_against_its_8-bit_Canny"]


def run(name, time_ms, repetition=0, **counters):
    return {"name": name, "run_name": f"{name}/repeats:3/real_time", "run_type": "iteration", "cpu_time": time_ms,
            "time_unit": "ms", "repetition_index": repetition} | counters


def search(name, thesis_ms, ours_ms):
    runs = [run(f"{name}/thesis", thesis_ms, evaluations_per_s=0.4e9), run(f"{name}/thesis_tabled", thesis_ms / 3)]
    for path in PATHS:
        runs.append(run(f"{name}/sums_{path}", ours_ms))
        runs.append(run(f"{name}/whole_{path}", 2 * ours_ms, loaded_bytes_per_s=80e9))
    return runs


def everything(cycle_ms=4.0, ours_ms=2.0, peer_ms=7.0):
    """Results in which every aim is reached by default."""
    runs = []
    for size in SIZES:
        for scene in PADS + ["absent", "cyl_loose", "cyl_grid"]:
            runs.append(run(f"cycle/{size}/{scene}", 1.0, pass_us=100.0, avx512_total_us=1000.0 * cycle_ms,
                            avx512_2_threads_total_us=500.0 * cycle_ms))
        for kernel in KERNELS:
            runs += [run(f"image/{size}/{kernel}/ours", 1.0), run(f"image/{size}/{kernel}/opencv", peer_ms)]
    rows = PADS + [f"{pad}_planar" for pad in PADS] + ["lone_level", "medium_normals_level", "cyl_loose", "cyl_grid",
                                                         "cyl_brick", "cyl_loose_planar"]
    for name in rows:
        runs += search(f"search/{name}", 600.0, ours_ms)
    for angles in [240, 720]:
        runs += search(f"prune/medium_{angles}", 600.0, ours_ms)
        runs += [run(f"prune/medium_{angles}/pruned_{path}", 0.3 * ours_ms) for path in PATHS]
    for level in ["L1_aligned", "L1_any_byte", "L2_aligned", "L2_any_byte"]:
        runs += [run(f"roof/{level}/{path}", 1.0, loaded_bytes_per_s=100e9) for path in PATHS]
    runs += [run(f"growth/angles/{x}", 1.0, x=x, search_us=10.0 * x) for x in [45, 90, 180]]
    return runs


def rows_of(runs):
    return {r.figure: r for r in all_rows(Figures(runs))}


# Every line of the table, as it begins here, and its aim.
ASKED = [
    ("whole cycle, median of the five pad scenes, 600x500", "5 ms"),
    ("whole cycle, median of the five pad scenes, 1536x1280", "10 ms"),
    ("whole cycle, part absent, 600x500", "10 ms"),
    ("whole cycle, part absent, 1536x1280", "20 ms"),
    ("search against the thesis's scalar form, all positions, avx512", "x250"),
    ("search against the thesis's scalar form, all positions, avx2", "x120"),
    ("search against the thesis's scalar form, cylinders, 6700^2, avx512", "x250"),
    ("the thesis's scalar form itself", "0.3 G evaluations/s"),
    ("loads against the load roof, one tilt for all, avx512, L1 aligned", "75 %"),
    ("loads against the load roof, one tilt for all, avx512, L2 aligned", "75 %"),
    ("exact pruning against shifted sums without it, 240 angles", "x2"),
    ("exact pruning against shifted sums without it, 720 angles", "x5"),
    ("early termination alone, 240 angles", "beside it"),
    ("early termination alone, 720 angles", "beside it"),
    ("2 threads against 1, whole cycle, 600x500", "x1.7"),
    ("OpenCV: Sobel, 600x500", "x1.5"),
    ("OpenCV: chamfer, 600x500", "x6"),
    ("OpenCV: whole edge chain, 600x500", "x2.5"),
    ("OpenCV: Canny part against its 8-bit Canny, 600x500", "x1"),
]


class Table(unittest.TestCase):
    def test_has_every_figure_that_is_asked_with_its_aim(self):
        for runs in [everything(), []]:
            rows = all_rows(Figures(runs))
            for figure, aim in ASKED:
                found = [r for r in rows if r.figure.startswith(figure)]
                self.assertEqual(len(found), 1, figure)
                self.assertEqual(found[0].aim, aim, figure)

    def test_says_where_an_aim_is_reached(self):
        beside = [r for r in all_rows(Figures(everything())) if r.aim == "beside it"]
        self.assertEqual([r.ours for r in beside], ["x2", "x2"])
        self.assertEqual({r.verdict for r in all_rows(Figures(everything())) if r not in beside}, {"yes"})

    def test_shows_what_falls_short(self):
        rows = rows_of(everything(cycle_ms=5.1, ours_ms=3.0, peer_ms=1.2))
        self.assertEqual(rows["whole cycle, median of the five pad scenes, 600x500"].verdict, "NO")
        self.assertEqual(rows["whole cycle, median of the five pad scenes, 600x500"].ours, "5.10 ms")
        self.assertEqual(rows["whole cycle, part absent, 600x500"].verdict, "yes")
        self.assertEqual(rows["search against the thesis's scalar form, all positions, avx512"].verdict, "NO")
        self.assertEqual(rows["search against the thesis's scalar form, all positions, avx2"].verdict, "yes")
        self.assertEqual(rows["OpenCV: Sobel, 600x500"].ours, "x1.2")
        self.assertEqual(rows["OpenCV: Sobel, 600x500"].verdict, "NO")

    def test_says_what_was_not_measured(self):
        verdicts = {r.figure: r.verdict for r in all_rows(Figures([]))}
        self.assertEqual(verdicts["OpenCV: Sobel, 600x500"], "not measured")
        self.assertEqual(verdicts["exact pruning against shifted sums without it, 240 angles, avx512"], "not measured")
        self.assertEqual(verdicts["2 threads against 1, whole cycle, 600x500"], "not measured")
        self.assertNotIn("yes", verdicts.values())


class AllFigures(unittest.TestCase):
    def test_are_medians_over_repetitions_and_leave_out_aggregates_and_errors(self):
        runs = [run("a/b", t, i) for i, t in enumerate([5.0, 1.0, 2.0])]
        runs.append(run("a/b", 99.0) | {"run_type": "aggregate"})
        runs.append(run("a/b", 99.0) | {"error_occurred": True})
        self.assertAlmostEqual(Figures(runs).time_s("a/b"), 2e-3)
        self.assertIsNone(Figures(runs).time_s("a"))
        self.assertIsNone(Figures(runs).ratio("a/b", "a/c"))


class Report(unittest.TestCase):
    def test_is_written_of_any_results(self):
        for runs in [[], everything(), everything()[:7]]:
            text, summary = write_report(Figures(runs), ["a note"])
            self.assertIn("a note", summary)
            self.assertIn("## Growth", text)
            self.assertIn(summary, text)
        self.assertIn("1.00 +- 0.00", write_report(Figures(everything()), [])[0])


unittest.main()
