"""What tests of every kind share: the golf database of data/, normalized and fitted once, and edits of it."""

import json
import sys
from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

# A busy machine takes its time: that is no fault of what is tested.
settings.register_profile("motionedit", deadline=None)
settings.load_profile("motionedit")

GOLF = {
    "events": {
        "hit": {
            "frames": str(ROOT / "data" / "golf" / "events.csv"),
            "detect": {"effector": {"end_site": "Club"}, "minimum_of": "height", "between": ["60%", "85%"]},
        }
    }
}


class Golf:
    """Ten swings, their normalized folder and their model, with a lab to edit them in."""

    def __init__(self, folder):
        from studies.lab import Lab

        self.lab = Lab(folder)
        self.swings = [ROOT / "data" / "golf" / f"swing{n:02d}.bvh" for n in range(1, 11)]
        self.model = self.lab.model(self.swings, GOLF)

    def edit(self, clip, shift=(0.0, 0.0, 0.0), *, goal=None, model=None, **spec):
        """Return a swing edited by one goal on the club head at the hit, and further keys of the spec."""
        ball = {"name": "ball", "at": "hit", "effector": {"end_site": "Club"}}
        ball |= goal if goal is not None else {"shift": list(map(float, shift))}
        return self.lab.edit(clip, model or self.model, {"unit": "cm", "goals": [ball], **spec})

    def spec(self, path, **content):
        """Write an edit-pc spec and return its path."""
        path.write_text(json.dumps({"schema": "motionedit/edit-pc/v1", **content}))
        return path


@pytest.fixture(scope="session")
def golf(tmp_path_factory):
    return Golf(tmp_path_factory.mktemp("golf"))
