"""Which events make a common timeline, which clips can be warped to it, and what is said of those that cannot."""

from dataclasses import dataclass, field

import pytest

from motionedit.core.timeline.warp import Timeline
from motionedit.errors import SpecError
from motionedit.jobs.normalize.common_timeline import common_timeline, events_out_of_order
from motionedit.spec.load import load_spec


@dataclass
class Measured:
    """As much of a measured clip as this asks for."""

    label: str = "a.bvh"
    first: int = 0
    last: int = 50
    events: dict = field(default_factory=lambda: {"top": 10, "hit": 30})
    frame_time: float = 0.04

    @property
    def duration(self):
        return (self.last - self.first) * self.frame_time


def spec_of(*places):
    events = {name: {"frames": 10, "target": at} for name, at in zip(("top", "hit"), places, strict=False)}
    return load_spec({"frames": 100, "events": events}, "normalize")


@pytest.mark.parametrize("places", [(1, 98), (40, 41), (41, 40), (98,), (1,), ()])
def test_events_strictly_inside_the_timeline_are_in_order(places):
    timeline, _ = common_timeline(spec_of(*places), [Measured()])
    assert sorted(places) == [frame for _, frame in timeline.events]


@pytest.mark.parametrize(
    ("places", "named"),
    [
        ((0, 50), "'top' at 0, 'hit' at 50"),
        ((50, 99), "'top' at 50, 'hit' at 99"),
        ((50, 50), "'top' at 50, 'hit' at 50"),
        ((0,), "'top' at 0"),
    ],
)
def test_events_elsewhere_are_a_fault_of_the_spec(places, named):
    with pytest.raises(SpecError, match="events: must lie strictly inside the timeline of 100 frames") as caught:
        common_timeline(spec_of(*places), [Measured("a.bvh"), Measured("b.bvh")])
    assert str(caught.value).endswith(f"one after the other: {named}")


def test_a_clip_whose_own_events_stand_otherwise_fails_alone():
    clips = [Measured("a.bvh"), Measured("b.bvh", events={"top": 30, "hit": 10}), Measured("c.bvh", last=30)]
    timeline = Timeline(100, 25.0, (("top", 40), ("hit", 60)))
    failures = events_out_of_order(spec_of(40, 60), clips, timeline)
    assert {label: (error.key, type(error)) for label, error in failures.items()} == {
        "b.bvh": ("events.top", SpecError),
        "c.bvh": ("events.hit", SpecError),
    }
    assert "in b.bvh: 'hit' at frame 10 is not after 'top' at frame 30" in str(failures["b.bvh"])
    assert "in c.bvh: its last frame at frame 30 is not after 'hit' at frame 30" in str(failures["c.bvh"])
