"""What is evaluated: scenes, parts and sensors, each with the seeds that are run when none are given."""

from dataclasses import dataclass

PAD_SCENES = ["lone", "low", "medium", "high", "pile", "steep", "buried"]
CYLINDER_SCENES = ["cyl_loose", "cyl_grid", "cyl_brick"]
SEVERAL_SCENES = ["medium", "high", "pile"] + CYLINDER_SCENES  # searched for all instances too
CROWDED_SCENES = ["cyl_grid", "cyl_brick"]  # hold more than SEVERAL
OTHER_PARTS = ["bracket", "flange", "washer", "strip", "triangle", "plate"]
OTHER_SCENES = ["medium", "high", "buried"]
SCENES_WITHOUT = ["absent", "empty"]  # hold no part: every match is wrong
WORSE_SENSORS = ["noise", "lost", "half"]

SEEDS = (1000, 1040)
SEEDS_WITHOUT = (1000, 1200)
SEVERAL = 20
MOST = 64  # that a search may return


@dataclass(frozen=True)
class Case:
    scene: str
    part: str
    sensor: str
    seeds: tuple
    max_matches: tuple
    has_target: bool = True

    @property
    def name(self):
        return f"{self.scene} {self.part} {self.sensor}"

    @property
    def shot_count(self):
        return self.seeds[1] - self.seeds[0]


def all_cases(seeds=None):
    """Every case, with the given seeds instead of each case's own."""
    usual = seeds or SEEDS
    cases = []
    for scene in PAD_SCENES + CYLINDER_SCENES:
        part = "cylinder" if scene in CYLINDER_SCENES else "pad"
        counts = (1,) + (SEVERAL,) * (scene in SEVERAL_SCENES) + (MOST,) * (scene in CROWDED_SCENES)
        cases.append(Case(scene, part, "standard", usual, counts))
    for part in OTHER_PARTS:
        cases += [Case(scene, part, "standard", usual, (1,)) for scene in OTHER_SCENES]
    for scene in SCENES_WITHOUT:
        cases.append(Case(scene, "pad", "standard", seeds or SEEDS_WITHOUT, (1,), has_target=False))
    for sensor in WORSE_SENSORS:
        cases += [Case(scene, "pad", sensor, usual, (1,)) for scene in PAD_SCENES]
    return cases
