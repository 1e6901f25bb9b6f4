"""The report's verdicts on trials made by hand. Its argument: the folder of the report."""

import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))

from cases import all_cases
from report import demands, quantile, write_report


def trial(coarse=True, fine=True, sensor="standard", matches=1, expects_target=True, scene="medium", has_match=True, **several):
    verdict = {"wanted": 0, "found": several.get("wanted", 0), "missed": [], "wrong": [], "double": []} | several
    error = dict.fromkeys(["position_mm", "in_plane_mm", "z_mm", "tilt_deg", "turn_deg"], 0.1)
    return {"scene": scene, "part": "pad", "seed": 1, "sensor": sensor, "max_matches": matches, "threshold": 0.7,
            "expects_target": expects_target, "status": "ok", "cause": "" if coarse else "not_found", "best_rejected": 0.0,
            "first": {"coarse": coarse, "fine": fine, "error": error}, "all": verdict, "lost": [], "picture": "",
            "matches": [{"score": 0.9}] if has_match else [],
            "timings_us": dict.fromkeys(["rectify", "features", "search", "refine", "verify", "total"], 1000)}


def verdicts(trials):
    return {row[0]: row[-1] for row in demands(trials)}


class Demands(unittest.TestCase):
    def test_first_answers_must_all_be_coarse_and_nearly_all_fine(self):
        name, fine = "first answer coarsely right", "first answer within the fine bounds"
        good = [trial() for _ in range(97)]
        self.assertEqual(verdicts(good + [trial(fine=False)] * 3)[name], "yes")
        self.assertEqual(verdicts(good + [trial(fine=False)] * 3)[fine], "yes")
        self.assertEqual(verdicts(good + [trial(fine=False)] * 4)[fine], "NO")
        self.assertEqual(verdicts(good + [trial(coarse=False, fine=False)])[name], "NO")

    def test_worse_sensors_have_a_demand_of_their_own(self):
        trials = [trial(sensor="lost")] * 19 + [trial(coarse=False, fine=False, sensor="lost")]
        self.assertEqual(verdicts(trials)["sensor 'lost': coarsely right"], "yes")
        self.assertEqual(verdicts(trials[1:])["sensor 'lost': coarsely right"], "NO")
        self.assertEqual(verdicts(trials)["first answer coarsely right"], "not run")

    def test_of_several_nearly_all_are_found_and_none_is_wrong_or_double(self):
        name = "several: instances found"
        self.assertEqual(verdicts([trial(matches=20, wanted=50, found=49)])[name], "yes")
        self.assertEqual(verdicts([trial(matches=20, wanted=49, found=48)])[name], "NO")
        self.assertEqual(verdicts([trial(matches=20, wanted=20, found=22), trial(matches=20, wanted=20, found=19)])[name], "NO")
        self.assertEqual(verdicts([trial(matches=20, wanted=5, wrong=[0])])["several: wrong"], "NO")
        self.assertEqual(verdicts([trial(matches=20, wanted=5, double=[0])])["several: double"], "NO")
        self.assertEqual(verdicts([trial(matches=20, wanted=5)])["several: double"], "yes")

    def test_where_nothing_is_any_match_breaks_it(self):
        nothing = [trial(scene="absent", expects_target=False, has_match=False)] * 3
        self.assertEqual(verdicts(nothing)["absent: scans with a match"], "yes")
        alarm = trial(scene="absent", expects_target=False, coarse=False, fine=False)
        self.assertEqual(verdicts(nothing + [alarm])["absent: scans with a match"], "NO")
        self.assertEqual(verdicts(nothing)["empty: scans with a match"], "not run")


class Report(unittest.TestCase):
    def test_is_written_of_any_trials(self):
        some = [trial(), trial(coarse=False, fine=False, has_match=False), trial(matches=20, wanted=3),
                trial(scene="empty", expects_target=False, has_match=False)]
        for trials in [[], some]:
            self.assertIn("## Failures", write_report(trials, ["a note"]))
        self.assertIn("not_found", write_report(some, []))

    def test_quantiles_are_of_the_sorted_values(self):
        self.assertEqual(quantile([5, 1, 3], 0.5), 3)
        self.assertEqual(quantile(range(100), 0.95), 95)
        self.assertEqual(quantile([], 0.5), None)


class Cases(unittest.TestCase):
    def test_are_as_many_as_asked(self):
        cases = all_cases()
        self.assertEqual(sum(c.shot_count for c in cases if c.has_target and c.sensor == "standard"), 40 * (10 + 18))
        self.assertEqual(sum(c.shot_count for c in cases if not c.has_target), 400)
        self.assertEqual(sum(c.shot_count for c in cases if c.sensor != "standard"), 3 * 7 * 40)
        self.assertTrue(all(c.seeds == (0, 5) for c in all_cases((0, 5))))


unittest.main()
