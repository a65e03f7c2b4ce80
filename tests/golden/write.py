"""Write the golden file anew: what the golf session comes to, in numbers that any machine reproduces.

Run it with `make golden`, and look at the difference before you commit it.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
PATH = Path(__file__).with_name("golf.json")


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


def main() -> None:
    """Write the file."""
    with tempfile.TemporaryDirectory() as folder:
        content = golf_session(Path(folder))
    PATH.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
