"""How feet skate, slide, drift, float and sink, of tracks whose measures are known."""

import numpy as np
import pytest
from human import skeleton_of

from motionedit.core.body.contacts import Plant
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.ground import axis_vector
from motionedit.core.body.quality import foot_drift, foot_slide_max
from motionedit.core.compiled import compiled, solver_name
from motionedit.core.feet.measures import foot_measures

ANATOMY = find_anatomy(skeleton_of())
POINTS = ANATOMY.sole_points
HEEL, TOE = (
    next(p for p, point in enumerate(POINTS) if (point.foot, point.part) == ("left", part)) for part in ("heel", "toe")
)
FRAMES, RATE = 20, 50.0
T = np.arange(FRAMES) / RATE


def tracks_of(toe, heel=None):
    """Return tracks (F, P, 3) in which all points are a metre high, but for the left toe and heel."""
    tracks = np.zeros((FRAMES, len(POINTS), 3))
    tracks[..., 1] = 1.0
    tracks[:, TOE] = np.stack(np.broadcast_arrays(*toe), axis=-1)
    if heel is not None:
        tracks[:, HEEL] = np.stack(np.broadcast_arrays(*heel), axis=-1)
    return tracks


def measured(tracks, *plants, first=0, up="y", scale=1.0):
    planted = [Plant("left", part, POINTS[p].joint, p, start, stop, 0.0) for part, p, start, stop in plants]
    turn = {"y": [0, 1, 2], "z": [0, 2, 1]}[up]
    anatomy = find_anatomy(skeleton_of(scale=scale))
    return foot_measures(
        scale * tracks[..., turn], planted, anatomy, up=axis_vector(up), first=first, frame_time=1.0 / RATE
    )


@pytest.mark.parametrize(("up", "scale"), [("y", 1.0), ("z", 1.0), ("y", 100.0)])
@pytest.mark.parametrize(("speed", "ratio"), [(0.5, 1.0), (0.02, 0.0)])
def test_skating_is_the_level_speed_of_a_toe_near_the_floor(speed, ratio, up, scale):
    found = measured(tracks_of((speed * T, 0.01 + 0.02 * np.sin(9.0 * T) ** 2, 0.0 * T)), up=up, scale=scale)
    assert found.skate_mean == pytest.approx(speed)
    assert found.skate_ratio == ratio
    assert (found.sliding_share, found.drift_max, found.floating_max) == (0.0, 0.0, 0.0)


def test_a_toe_in_the_air_skates_not_and_a_heel_is_not_asked():
    found = measured(tracks_of((2.0 * T, 0.5, 0.0 * T), heel=(3.0 * T, 0.0, 0.0 * T)))
    assert (found.skate_mean, found.skate_ratio) == (0.0, 0.0)


def test_a_plant_slides_in_the_steps_that_are_fast_and_floats_as_high_as_it_is():
    x = np.where(T[5] > T, 0.0, np.where(T[10] > T, 0.5 * (T - T[4]), 0.5 * (T[9] - T[4])))
    found = measured(tracks_of((x, 0.03, 0.0 * T)), ("toe", TOE, 0, FRAMES - 1))
    assert found.sliding_share == pytest.approx(5 / (FRAMES - 1))
    assert found.floating_max == pytest.approx(0.03)


def test_drift_is_the_way_from_a_plants_own_mean_place_in_all_directions():
    tracks = tracks_of((0.1 * np.arange(FRAMES), 0.02, 0.0), heel=(0.0, 0.1 * np.arange(FRAMES), 0.0))
    assert measured(tracks, ("toe", TOE, 0, 4)).drift_max == pytest.approx(0.2)
    assert measured(tracks, ("toe", TOE, 0, 4), ("heel", HEEL, 2, 8)).drift_max == pytest.approx(0.3)
    assert measured(tracks).drift_max == 0.0


def test_penetration_is_the_depth_below_the_floor_and_its_share_of_the_frames():
    y = np.where(np.arange(FRAMES) % 4 == 1, -0.05, 0.01)
    found = measured(tracks_of((0.0 * T, y, 0.0)))
    assert found.penetration_max == pytest.approx(0.05)
    assert found.penetration_share == pytest.approx(0.25)
    later = measured(tracks_of((0.0 * T, np.where(np.arange(FRAMES) < 4, -0.5, 0.01), 0.0)), first=4)
    assert (later.penetration_max, later.penetration_share) == (0.0, 0.0)


@pytest.mark.compiled
@pytest.mark.parametrize("seed", range(12))
def test_compiled_measures_are_those_of_numpy(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    tracks = np.cumsum(rng.normal(scale=0.004, size=(FRAMES, len(POINTS), 3)), axis=0)
    plants = [("toe", TOE, 2, 5), ("heel", HEEL, 0, 9), ("toe", TOE, 8, FRAMES - 1), ("heel", HEEL, 12, 12)]
    how = {"first": seed % 3, "up": "yz"[seed % 2]}
    found = measured(tracks, *plants[: seed % 5], **how)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    assert vars(found) == pytest.approx(vars(measured(tracks, *plants[: seed % 5], **how)), rel=1e-12, abs=1e-12)


@pytest.mark.compiled
@pytest.mark.parametrize("seed", range(8))
def test_compiled_slides_and_drifts_are_those_of_numpy_to_the_bit(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    before, after = rng.normal(size=(2, FRAMES, len(POINTS), 3))
    spans = [sorted(rng.integers(0, FRAMES, 2).tolist()) for _ in range(seed % 4)]
    plants = [Plant("left", "toe", 0, point, *span, 0.0) for point, span in enumerate(spans)]
    up = np.eye(3)[seed % 3]

    def found():
        return foot_slide_max(before, plants, up=up, frame_time=0.01), foot_drift(before, after, tuple(plants))

    compiled_ones = found()
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    assert compiled_ones == found()


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
@pytest.mark.parametrize("span", [(2, 0, 1), (-1, 0, 1), (1, 0, 3), (0, -1, 0), (0, 2, 1)])
def test_plants_at_no_frames_or_of_no_points_are_an_error_and_no_crash(span):
    tracks, given = np.zeros((3, 2, 3)), (np.array([span]), 3, 2, 1)
    calls = {"foot_figures": (np.ones(2, bool), 0, (1.0,) * 6), "foot_slide": (), "foot_drift": (tracks,)}
    for call, more in calls.items():
        with pytest.raises(ValueError, match="plant 0 is at no frames, or of no point"):
            getattr(compiled(), call)(tracks, np.zeros(3), *given, *more)


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
def test_feet_without_up_or_with_tracks_of_another_size_are_an_error_and_no_crash():
    tracks, given = np.zeros((3, 2, 3)), (np.array([(0, 0, 1)]), 3, 2, 1)
    with pytest.raises(ValueError, match="no up"):
        compiled().foot_slide(tracks, None, *given)
    with pytest.raises(ValueError, match="no up"):
        compiled().foot_figures(tracks, None, *given, np.ones(2, bool), 0, (1.0,) * 6)
    with pytest.raises(ValueError, match="other tracks has 24 bytes instead of"):
        compiled().foot_drift(tracks, None, *given, np.zeros(3))
    with pytest.raises(ValueError, match="no such frames or points"):
        compiled().foot_slide(tracks, np.zeros(3), given[0], -1, 2, 1)
    with pytest.raises(ValueError, match="no such frames"):
        compiled().foot_figures(tracks, np.zeros(3), *given, np.ones(2, bool), -1, (1.0,) * 6)


def test_a_foot_that_stands_far_from_the_origin_does_not_drift_at_all():
    tracks = np.full((FRAMES, len(POINTS), 3), 1234.5678)
    assert measured(tracks, ("toe", TOE, 1, 18), scale=0.7).drift_max == 0.0
