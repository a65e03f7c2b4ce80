"""A fault that clips share is told once, at its place in the spec, and no other fault is made of it."""

import json

import pytest
from prioritized_edits import DATA, hand

from motionedit.cli.finish import show_failures
from motionedit.errors import ClipError

SWINGS = [DATA / "golf" / f"swing0{n}.bvh" for n in (1, 2, 3)]
HEAD = "goals: [{at: hit, effector: Head, shift: [0, 1, 0]}]"


@pytest.fixture
def errors(run, tmp_path):
    """Return a runner of a command on three swings: its exit code, and the lines of its errors."""

    def invoke(command, text, *arguments):
        (tmp_path / "s.yaml").write_text(f"schema: motionedit/{command}/v1\n{text}\n")
        done = run(command, *SWINGS, "-s", "s.yaml", "-o", "out", *arguments)
        begin = "motionedit: error: "
        return done.exit_code, [line[len(begin) :] for line in done.stderr.splitlines() if line.startswith(begin)]

    return invoke


@pytest.fixture
def model(run, tmp_path):
    """Return the model of the three swings, whose event the spec of normalize finds by a rule."""
    rule = "{effector: {end_site: Club}, minimum_of: height, between: [60%, 85%]}"
    (tmp_path / "n.yaml").write_text(f"schema: motionedit/normalize/v1\nevents: {{hit: {{detect: {rule}}}}}\n")
    assert run("normalize", *SWINGS, "-s", "n.yaml", "-o", "n", "-q").exit_code == 0
    assert run("fit-pca", "n", "-o", "m.npz", "-q").exit_code == 0
    return tmp_path / "m.npz"


@pytest.mark.parametrize(
    "events", ["{a: {frames: 5, target: 0}}", "{a: 0}", "{a: 5, b: 5}", "{a: {frames: 5, target: 100%}}"]
)
def test_events_that_make_no_timeline_are_a_fault_of_the_spec(errors, events):
    code, (line,) = errors("normalize", f"events: {events}")
    assert code == 2
    assert line.startswith("s.yaml:2: events: must lie strictly inside the timeline of ")


def test_events_in_another_order_are_told_at_their_line(errors, model):
    one = "{swing01: 5, swing02: 40, swing03: 5}"
    code, (line, about) = errors("normalize", f"events:\n  a: {{frames: {one}}}\n  b: 30")
    assert code == 1
    assert line.startswith(f"s.yaml:3: events.a: in {SWINGS[1]}: 'b' at frame 30 is not after 'a' at frame 40")
    assert about.startswith("nothing was written")
    code, (line,) = errors("edit-pc", f"{HEAD}\nevents: {{hit: 0}}", "-m", model)
    assert code == 2
    assert line.startswith(f"s.yaml:3: events.hit: in {SWINGS[0]}: 'hit' at frame 0 is not after its first frame")
    assert line.endswith("(and in 2 more clips)")


def test_a_fault_of_rules_that_a_model_keeps_is_told_once(capsys):
    clips = ("a.bvh", "b.bvh")
    show_failures([ClipError(f"no joint 'Club' in {clip}", file="m.npz", key="events.hit") for clip in clips])
    show_failures([ClipError("is cut short", file=clip) for clip in clips])
    lines = ["m.npz: events.hit: no joint 'Club' in a.bvh (and in 1 more clip)", "a.bvh: is cut short"]
    assert capsys.readouterr().err.splitlines() == [
        f"motionedit: error: {line}" for line in (*lines, "b.bvh: is cut short")
    ]


def test_a_clip_that_lacks_the_frame_of_an_event_is_told_so(errors):
    asked = hand({"hold": [3, "hit + 3"], "shift": [0, 2, 0]})
    events = {"hit": {"frames": {"swing01": 40, "swing03": 9999}}}
    code, lines = errors("edit-prioritized", f"constraints: {json.dumps([asked])}\nevents: {json.dumps(events)}")
    assert code == 1
    lacks = "event 'hit' has no frame; add one to its frames, or give it detect"
    assert lines == [
        f"s.yaml:2: constraints.0.points.0.hold: in {SWINGS[1]}: {lacks}",
        f"s.yaml:3: events.hit: in {SWINGS[2]}: frame 9999 is outside the take, whose frames are 0 to 133",
    ]
