"""Warps, resampling, events and alignment: the normalization of [PC] section 5."""

import pickle

import numpy as np
import pytest
from strokes import TIMELINE, place, stroke

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.timeline import round_half_up
from motionedit.core.timeline.alignment import aligned, travel_path
from motionedit.core.timeline.events import Search, find_event
from motionedit.core.timeline.resample import resample
from motionedit.core.timeline.warp import Timeline, make_warp
from motionedit.errors import ClipError


def test_a_warp_takes_first_event_and_last_to_their_places_both_ways():
    warp = make_warp(Timeline(132, 25.0, (("hit", 94),)), first=1, last=120, events={"hit": 80.5}, label="a.bvh")
    np.testing.assert_allclose(warp.to_source(np.array([0.0, 94.0, 131.0])), [1.0, 80.5, 120.0])
    np.testing.assert_allclose(warp.to_timeline(np.array([0.0, 1.0, 80.5, 120.0])), [0.0, 0.0, 94.0, 131.0])


def test_a_warps_way_to_the_timeline_has_no_kink_at_the_event():
    warp = make_warp(Timeline(132, 25.0, (("hit", 94),)), first=0, last=700, events={"hit": 300.0}, label="a.bvh")
    speed = np.diff(warp.to_timeline(np.linspace(290.0, 310.0, 2001)))
    assert np.abs(np.diff(speed)).max() < 1e-4 * speed.mean() * 20


def test_events_out_of_order_are_an_error_that_names_them():
    timeline = Timeline(100, 25.0, (("top", 40), ("hit", 60)))
    with pytest.raises(ClipError, match=r"a.bvh: 'hit' at frame 30 is not after 'top' at frame 30; "):
        make_warp(timeline, first=0, last=80, events={"top": 30, "hit": 30}, label="a.bvh")
    with pytest.raises(ClipError, match="'top' at frame 0 is not after its first frame at frame 0"):
        make_warp(timeline, first=0, last=80, events={"top": 0, "hit": 30}, label="a.bvh")


def test_halves_round_up():
    assert [round_half_up(x) for x in (0.5, 1.5, 2.5, 2.49)] == [1, 2, 3, 2]


def test_a_place_on_the_timeline_has_the_nearest_of_its_frames():
    found = Timeline(11, 25.0).frames_at(np.array([-0.7, 0.49, 0.5, 9.6, 12.0]))
    assert found.tolist() == [0, 0, 1, 10, 10]


def test_resampling_at_whole_frames_gives_the_frames():
    motion = stroke(1)
    again = resample(motion, np.arange(len(motion), dtype=float), frame_time=0.02)
    np.testing.assert_allclose(rot.angle_between(again.rotations, motion.rotations), 0.0, atol=1e-7)
    np.testing.assert_allclose(again.translations, motion.translations, atol=1e-12)


def test_copies_at_other_rates_resample_to_the_same_motion():
    fine, coarse = stroke(2, frames=481, frame_time=1 / 240), stroke(2, frames=121, frame_time=1 / 60)
    at = np.linspace(0.0, 1.0, 61)
    a = kinematics.forward(resample(fine, at * 480, frame_time=1 / 30)).positions
    b = kinematics.forward(resample(coarse, at * 120, frame_time=1 / 30)).positions
    assert np.abs(a - b).max() < 1e-9


@pytest.mark.parametrize(("extreme", "sign"), [("minimum", 1.0), ("maximum", -1.0)])
def test_an_event_is_found_to_a_part_of_a_frame(extreme, sign):
    t = np.arange(100.0)
    path = np.stack((t, sign * 0.01 * (t - 40.3) ** 2, 0 * t), axis=1)
    up = np.array([0.0, 1.0, 0.0])
    found = find_event(path, Search(extreme, "height", 10, 90), up=up, frame_time=0.01)
    assert found == pytest.approx(40.3, abs=1e-9)


def test_an_event_keeps_to_its_window_and_its_point():
    t = np.linspace(0.0, 4 * np.pi, 401)
    path = np.stack((np.cos(t), np.sin(t), 0 * t), axis=1)
    up, to = np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])
    nearest = find_event(path, Search("minimum", "distance", 100, 300), up=up, frame_time=0.01, to=to)
    assert nearest == pytest.approx(200.0, abs=1e-6)
    assert find_event(path, Search("minimum", "distance", 0, 50), up=up, frame_time=0.01, to=to) == 0.0


def test_the_fastest_frame_is_found():
    t = np.arange(200.0)
    path = np.stack((np.tanh((t - 90.4) / 7.0), 0 * t, 0 * t), axis=1)
    found = find_event(path, Search("maximum", "speed", 0, 199), up=np.array([0.0, 1.0, 0.0]), frame_time=0.01)
    assert found == pytest.approx(90.4, abs=0.02)


def test_alignment_faces_every_clip_the_same_way_at_the_same_place():
    results = []
    for heading in (0.0, 1.0, np.pi):
        motion = stroke(3, heading=heading)
        alignment, _, travel, _ = place(motion, TIMELINE, hit=36.0)
        results.append(kinematics.forward(aligned(motion, alignment, travel=travel)).positions)
    np.testing.assert_allclose(results[1], results[0], atol=1e-12)
    np.testing.assert_allclose(results[2], results[0], atol=1e-12)
    hips = results[0][0, [2, 7]]
    assert (hips[0] - hips[1])[2] == pytest.approx(0.0, abs=1e-12)
    assert results[0][0, 0, 0] == pytest.approx(0.0, abs=1e-12)


def test_alignment_undoes_itself():
    alignment, _, travel, _ = place(stroke(4, heading=0.7), TIMELINE, hit=36.0)
    points = np.random.default_rng(0).normal(size=(5, 3))
    np.testing.assert_allclose(alignment.undo(alignment.apply(points)), points, atol=1e-14)
    assert travel_path(stroke(4), travel).positions.shape == (60, 3)


def test_what_another_process_gets_of_an_alignment_is_the_same_and_read_only():
    alignment, *_ = place(stroke(4, heading=0.7), TIMELINE, hit=36.0)
    other = pickle.loads(pickle.dumps(alignment))  # noqa: S301  our own
    for one, its in ((alignment.rotation, other.rotation), (alignment.origin, other.origin)):
        np.testing.assert_array_equal(its, one, strict=True)
        assert not its.flags.writeable
