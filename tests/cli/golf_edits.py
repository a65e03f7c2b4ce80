"""What the tests of golf swings share: when each meets the ball, and a spec that moves the ball."""

import json
from pathlib import Path

EVENTS = Path(__file__).resolve().parents[2] / "data" / "golf" / "events.csv"
HITS = {name: int(frame) for name, frame in (line.split(",") for line in EVENTS.read_text().split()[1:])}


def edit_spec(path, **more):
    goal = {"name": "ball", "at": "hit", "effector": {"end_site": "Club"}, "shift": [0, 0, 10]}
    path.write_text(json.dumps({"schema": "motionedit/edit-pc/v1", "unit": "cm", "goals": [goal], **more}))
    return path
