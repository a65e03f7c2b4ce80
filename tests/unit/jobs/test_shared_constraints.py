"""Clips that share a skeleton share what a spec asks of them, but for what is their own."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motionedit.core.bvh import read_clip
from motionedit.errors import MotionEditError
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.clip.faults import Faults
from motionedit.jobs.edit_prioritized.constraints import clip_constraints
from motionedit.spec.load import load_spec

WALK = Path(__file__).resolve().parents[3] / "data" / "walk.bvh"
HAND = {"type": "position", "effector": "LeftHand", "points": [{"at": "100%", "shift": [0, 10, 0]}]}
SCALE = 0.01


def asked(**more):
    return load_spec({"constraints": [{**HAND, **more}]}, "edit-prioritized")


def found(loaded, clip=None, *, events=None, scale=SCALE, relative="walk.bvh"):
    faults = Faults()
    facts = facts_of(read_clip(WALK) if clip is None else clip)
    constraints = clip_constraints(loaded, facts, events or {}, scale=scale, faults=faults, relative=relative)
    faults.raise_all("what the spec names and the clip lacks")
    return constraints


def with_frames(clip, frames):
    return replace(clip, motion=clip.motion.at(frames))


def test_clips_of_one_skeleton_and_length_share_their_constraints():
    loaded = asked()
    assert found(loaded)[0].constraint is found(loaded, relative="other.bvh")[0].constraint
    assert found(asked())[0].constraint is not found(loaded)[0].constraint


def test_what_makes_a_difference_is_the_clips_own():
    loaded, clip = asked(), read_clip(WALK)
    whole = found(loaded)[0].constraint
    assert whole.points[0].start == len(clip.motion) - 1
    assert found(loaded, with_frames(clip, slice(0, 50)))[0].constraint.points[0].start == 49
    assert found(loaded, scale=2.0 * SCALE)[0].constraint.points[0].shift[1] == 2.0 * whole.points[0].shift[1]
    slower = replace(clip, motion=replace(clip.motion, frame_time=2.0 * clip.motion.frame_time))
    assert found(loaded, slower)[0].constraint.ease_in == 0.5 * whole.ease_in
    assert found(loaded)[0].constraint is whole


def test_events_are_the_clips_own():
    points = [{"at": "top", "shift": [0, 10, 0]}]
    spec = {"events": {"top": {"frames": 30}}, "constraints": [{**HAND, "points": points}]}
    loaded = load_spec(spec, "edit-prioritized")
    starts = [found(loaded, events={"top": frame})[0].constraint.points[0].start for frame in (30.0, 40.0, 30.0)]
    assert starts == [30, 40, 30]


def test_a_heading_is_the_clips_own():
    loaded, clip = asked(frame="heading", axes=["x", "z"]), read_clip(WALK)
    one, other = (found(loaded, with_frames(clip, frames))[0].constraint for frames in (slice(0, 60), slice(60, 120)))
    assert one is not other
    assert np.abs(one.measure.axes - other.measure.axes).max() > 1e-3


def test_a_clip_that_lacks_something_is_told_so_by_its_own_name_each_time():
    loaded = asked(relative_to="Tail")
    for label in ("a.bvh", "b.bvh"):
        with pytest.raises(MotionEditError, match=label):
            found(loaded, replace(read_clip(WALK), label=label))
