"""What the tests of edit-prioritized share: what is often asked of the walk of data/, and what comes of a run."""

import json
from pathlib import Path

from motionedit.core.bvh import read_clip

DATA = Path(__file__).resolve().parents[2] / "data"
WALK = DATA / "walk.bvh"
FEET = ("LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase")

FEET_AS_CAPTURED = {"name": "feet", "type": "position", "effector": list(FEET), "priority": 10}
ARM_ONLY = {"joints": ["LeftArm", "LeftForeArm"]}


def hand(*points, **more):
    return {"name": "hand", "type": "position", "effector": "LeftHand", "priority": 4, "points": list(points), **more}


RAISED = hand({"hold": [66, 72], "shift": [5, 20, 10]})


class Edited:
    """A run of the command, the file it wrote and the clip's entry in its report."""

    def __init__(self, result, folder):
        self.result, self.path = result, folder / "e.bvh"
        report = folder / "r.json"
        self.record = json.loads(report.read_text())["clips"][0] if report.exists() else None

    def constraint(self, name):
        return next(each for each in self.record["constraints"] if each["name"] == name)

    def line_of(self, key):
        lines = (self.path.parent / "s.yaml").read_text().splitlines()
        return 1 + next(n for n, text in enumerate(lines) if f'"{key}"' in text)

    @property
    def warnings(self):
        return [line for line in self.result.stderr.splitlines() if "warning" in line]

    @property
    def errors(self):
        return [line for line in self.result.stderr.splitlines() if "error:" in line]


def edits_in(folder, run):
    """Return a runner in a folder: constraints, options of the command, and further keys of the spec."""

    def invoke(constraints, *arguments, clip=WALK, **keys):
        spec = {"schema": "motionedit/edit-prioritized/v1", **keys, "constraints": constraints}
        (folder / "s.yaml").write_text(json.dumps(spec, indent=1))
        for name in ("e.bvh", "r.json"):
            (folder / name).unlink(missing_ok=True)
        result = run(
            "edit-prioritized", clip, "-s", "s.yaml", "-o", "e.bvh", "--report", "r.json", *map(str, arguments)
        )
        return Edited(result, folder)

    return invoke


def rows(path):
    """Return the values' text, a list per frame."""
    lines = path.read_text().splitlines()
    return [line.split() for line in lines[lines.index("MOTION") + 3 :]]


def columns_of(path, *joints):
    skeleton = read_clip(path).motion.skeleton
    return {c for name in joints for c in skeleton.columns(skeleton.names.index(name), "rotation")}
