"""Numbers of reports, computed again as the pages define them, from the report's own plants and plain kinematics."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward

DATA = Path(__file__).parents[2] / "data"
GROUND = [0, 2]


@pytest.fixture
def told(run):
    """Return a runner of info with contacts: the clip's record."""

    def invoke(clip):
        return json.loads(run("info", clip, "--contacts", "--report", "-").stdout)["clips"][0]

    return invoke


def soles(record, clip):
    """Return the paths of heels and toes by foot and part, metres at a leg of 0.85 m, up being y."""
    motion = read_clip(clip).motion
    positions, names = forward(motion).positions * 0.85 / record["leg_length"], motion.skeleton.names
    return {
        (foot, part): positions[:, names.index(record["anatomy"][f"{foot}_leg"][joint])]
        for foot in ("left", "right")
        for part, joint in (("heel", "ankle"), ("toe", "toe"))
    }


def held(record):
    """Yield the foot, the part, and the frames of each time that a heel or toe is held."""
    for plant in record["plants"]:
        for part, spans in plant["held"].items():
            for first, last in spans:
                yield plant["foot"], part, slice(first, last + 1)


def speeds(path, frame_time):
    """Return the speeds on the ground from each frame to the next."""
    return np.linalg.norm(np.diff(path[:, GROUND], axis=0), axis=1) / frame_time


@pytest.mark.parametrize("name", ["walk.bvh", "walk-skating.bvh", "kick.bvh", "golf/swing04.bvh"])
def test_feet_are_measured_while_they_are_held_from_frame_to_frame(told, name):
    record = told(DATA / name)
    paths, dt, metrics = soles(record, DATA / name), record["frame_time"], record["metrics"]
    every = [(part, paths[foot, part][span]) for foot, part, span in held(record)]
    toes = [path for part, path in every if part == "toe"]
    slides = np.concatenate([speeds(path, dt) for path in toes])
    assert metrics["foot_sliding_share"] == pytest.approx((slides > 0.01).mean())
    fastest = max(speeds(path, dt).max(initial=0.0) for _, path in every) * record["leg_length"] / 0.85
    assert metrics["foot_slide_max"] == pytest.approx(fastest, rel=1e-5)
    drift = max(np.linalg.norm(path - path.mean(axis=0), axis=1).max() for _, path in every)
    assert metrics["foot_drift_max"] == pytest.approx(drift, rel=1e-5, abs=1e-8)
    assert metrics["foot_floating_max"] == pytest.approx(max(path[:, 1].mean() for path in toes), rel=1e-6)


@pytest.mark.parametrize("name", ["walk.bvh", "walk-skating.bvh", "kick.bvh"])
def test_toes_skate_where_they_are_near_the_floor_in_a_frame_and_in_the_next(told, name):
    record = told(DATA / name)
    skating = []
    for (_, part), path in soles(record, DATA / name).items():
        near = path[:, 1] < 0.05
        if part == "toe":
            skating.append(speeds(path, record["frame_time"])[[a and b for a, b in pairwise(near)]])
    found = np.concatenate(skating)
    assert record["metrics"]["foot_skate_mean"] == pytest.approx(found.mean(), rel=1e-5)
    assert record["metrics"]["foot_skate_ratio"] == pytest.approx((found > 0.2).mean())


def test_a_plant_lasts_as_long_as_all_its_frames(told):
    record = told(DATA / "walk.bvh")
    for each in (*record["contacts"], *record["plants"]):
        first, last = each["frames"]
        assert each["seconds"] == pytest.approx((last - first + 1) * record["frame_time"])


def test_a_clip_is_as_far_from_the_others_as_what_they_leave_of_it_is_long(run, tmp_path):
    run("normalize", DATA / "golf", "-s", DATA.parent / "configs" / "golf-normalize.yaml", "-o", tmp_path / "n")
    run("fit-pca", tmp_path / "n", "-o", "m.npz", "--report", "r.json")
    found = json.loads((tmp_path / "r.json").read_text())["left_out"]
    with np.load(tmp_path / "m.npz") as model:
        # All of rank are kept: the coefficients have all of each clip.
        clips, lengths = model["coefficients"], []
    for i, clip in enumerate(clips):
        others = np.delete(clips, i, axis=0)
        ways = (others - others.mean(axis=0)).T
        offset = clip - others.mean(axis=0)
        lengths.append(np.linalg.norm(offset - ways @ np.linalg.lstsq(ways, offset, rcond=1e-9)[0]))
    times = np.array(lengths) / np.median(np.square(lengths)) ** 0.5
    np.testing.assert_allclose([each["times"] for each in found["clips"]], times, rtol=1e-4)
    assert found["furthest"] == found["clips"][int(np.argmax(times))]["clip"]
