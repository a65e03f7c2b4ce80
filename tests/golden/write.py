"""Write the golden files anew: what a few sessions come to, in numbers that any machine and both solvers reproduce.

Run it with `make golden`, and look at the difference before you commit it.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
HERE = Path(__file__).parent
# Which clip each spec of configs/ is an edit of: holds, rides, aims, distances, limits, what gives way.
EDITS = {"reach": "walk", "karate": "kick", "stairs": "walk", "carry": "walk", "look": "walk", "floor": "walk"}
JOINTS = ("Hips", "Head", "LeftHand", "RightHand", "LeftFoot", "RightToeBase")
EVERY = 24  # frames


def golf_session(folder: Path) -> dict[str, Any]:
    """Return the figures of the golf session: variances, coefficients, and one edit, rounded."""
    from data.generator.players import SEED
    from motionedit.core.pca.model_file import read_model
    from studies.lab import Lab, effector_path

    lab = Lab(folder)
    swings = [ROOT / "data" / "golf" / f"swing{n:02d}.bvh" for n in range(1, 11)]
    path = lab.model(swings, {"events": {"hit": {"frames": str(ROOT / "data" / "golf" / "events.csv")}}})
    model = read_model(path)
    goal = {"name": "ball", "at": "hit", "effector": {"end_site": "Club"}, "shift": [0, 0, 10]}
    edit = lab.edit(swings[3], path, {"unit": "cm", "goals": [goal], "solver": {"method": "gauss-newton"}})
    likeliest = lab.edit(swings[3], path, {"unit": "cm", "goals": [goal]})
    return {
        "about": f"data/golf (generator seed {SEED}), cm, y up; club head moved 10 cm along z at the hit of swing04",
        "explained_variance": [round(float(x), 6) for x in model.components.explained_variance],
        "coefficients_swing04": [round(float(x), 5) for x in model.components.coefficients[3]],
        "alpha_after": [round(float(x), 4) for x in edit.record["alpha"]["after"]],
        "iterations": edit.record["iterations"],
        "club_head_after": effector_path(edit.path, "Club", end_site=True)[::20].round(3).tolist(),
        "left_out": round(float(likeliest.record["change"]["residual_share"]), 6),
        "club_head_after_map": effector_path(likeliest.path, "Club", end_site=True)[::20].round(3).tolist(),
    }


def prioritized_session(name: str) -> dict[str, Any]:
    """Return what a spec of configs/ makes of its clip: verdicts, errors, and places of joints, rounded."""
    import motionedit
    from motionedit.core.kinematics import forward

    edit = motionedit.edit_prioritized(ROOT / "data" / f"{EDITS[name]}.bvh", ROOT / "configs" / f"{name}.yaml")
    motion = edit.clip.motion
    places = forward(motion).positions[::EVERY].round(3)
    return {
        "about": f"data/{EDITS[name]}.bvh by configs/{name}.yaml, cm, y up; every {EVERY}th frame",
        "status": edit.report["status"],
        "constraints": {each["name"]: each["status"] for each in edit.report["constraints"]},
        "error_max": [None if x is None else round(x, 3) for x in (e["error_max"] for e in edit.report["constraints"])],
        **{joint: places[:, motion.skeleton.names.index(joint)].tolist() for joint in JOINTS},
    }


def written(content: dict[str, Any]) -> str:
    """Return a golden file: a list of numbers on one line."""
    text = json.dumps(content, indent=1)
    return re.sub(r"\[\s*([-\d.,\s]|null)+\]", lambda found: f"[{' '.join(found[0][1:-1].split())}]", text) + "\n"


def main() -> None:
    """Write the files."""
    with tempfile.TemporaryDirectory() as folder:
        golf = golf_session(Path(folder))
    (HERE / "golf.json").write_text(written(golf), encoding="utf-8")
    for name in EDITS:
        (HERE / f"{name}.json").write_text(written(prioritized_session(name)), encoding="utf-8")


if __name__ == "__main__":
    main()
