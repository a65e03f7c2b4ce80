"""Which clips can be warped to a common timeline, and what is said of those that cannot."""

from dataclasses import dataclass, field

import pytest

from motionedit.core.timeline.warp import Timeline
from motionedit.jobs.normalize.common_timeline import events_out_of_order


@dataclass
class Measured:
    """As much of a measured clip as this asks for."""

    label: str = "a.bvh"
    first: int = 0
    last: int = 50
    events: dict = field(default_factory=lambda: {"top": 10, "hit": 30})


def timeline(*places, frames=100):
    return Timeline(frames, 25.0, tuple(zip(("top", "hit"), places, strict=False)))


@pytest.mark.parametrize("places", [(1, 98), (40, 41), (98,), (1,), ()])
def test_events_strictly_inside_the_timeline_are_in_order(places):
    assert events_out_of_order([Measured()], timeline(*places)) == {}


@pytest.mark.parametrize(
    ("places", "named"),
    [
        ((0, 50), "'top' at 0, 'hit' at 50"),
        ((50, 99), "'top' at 50, 'hit' at 99"),
        ((50, 50), "'top' at 50, 'hit' at 50"),
        ((120,), "'top' at 120"),
    ],
)
def test_of_events_elsewhere_no_clip_can_be_warped(places, named):
    clips = [Measured("a.bvh"), Measured("b.bvh")]
    failures = events_out_of_order(clips, timeline(*places))
    said = "events must lie strictly inside the timeline of 100 frames, one after the other"
    assert {label: str(error) for label, error in failures.items()} == {
        label: f"{label}: {said}: {named}" for label in ("a.bvh", "b.bvh")
    }


def test_a_clip_whose_own_events_stand_otherwise_fails_alone():
    clips = [Measured("a.bvh"), Measured("b.bvh", events={"top": 30, "hit": 10}), Measured("c.bvh", last=30)]
    failures = events_out_of_order(clips, timeline(40, 60))
    assert list(failures) == ["b.bvh", "c.bvh"]
    assert "'hit' at frame 10 is not after 'top' at frame 30" in str(failures["b.bvh"])
    assert "its last frame at frame 30 is not after 'hit' at frame 30" in str(failures["c.bvh"])
