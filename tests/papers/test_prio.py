"""The claims of [PRIO], one test each, on the walk and the kick of data/."""

from pathlib import Path

import numpy as np
import pytest

from motionedit.core.bvh import read_clip
from studies.demonstrations import config
from studies.lab import Lab
from studies.paper.prio_clips import Shown

ROOT = Path(__file__).resolve().parents[2]
WALK = ROOT / "data" / "walk.bvh"
ARM = {"up_to": "LeftShoulder"}


@pytest.fixture
def lab(tmp_path):
    return Lab(tmp_path)


def edited(lab, constraints, *, clip=WALK, **spec):
    return lab.edit_prioritized(clip, {"constraints": constraints, **spec})


def hand(**more):
    point = {"hold": [40, 100], "shift": [20.0, 40.0, 20.0]}
    return {"name": "hand", "type": "position", "effector": "LeftHand", "priority": 3, "points": [point], **more}


def test_section_4_1_a_constraint_moves_the_joints_that_it_recruits_and_no_others(lab):
    arm = {**hand(recruit=ARM), "points": [{"at": 60, "shift": [5.0, 10.0, 5.0]}]}
    before, after = (read_clip(path).motion for path in (WALK, edited(lab, [arm]).path))
    names = before.skeleton.names
    moved = {names[j] for j in np.flatnonzero(np.any(before.rotations != after.rotations, axis=(0, 2)))}
    assert moved == {"LeftShoulder", "LeftArm", "LeftForeArm"}
    np.testing.assert_array_equal(before.translations, after.translations)


def test_section_4_2_a_held_point_stands_still_and_comes_from_and_goes_back_to_its_own_path(lab):
    edit = edited(lab, [hand()], smoothing={"method": "passes", "passes": 0})
    path, own = (Shown(clip).point("LeftHand") for clip in (edit.path, WALK))
    np.testing.assert_allclose(path[40:101], np.tile(own[40] + [20.0, 40.0, 20.0], (61, 1)), atol=1e-3)
    ease = round(0.8 / read_clip(WALK).motion.frame_time)
    ends = [40 - ease, 100 + ease]
    np.testing.assert_allclose(path[ends], own[ends], atol=1e-3)


def test_section_4_3_the_center_of_mass_goes_with_the_barycenter_of_its_support(lab):
    # P' - mean(A') = P - mean(A), on the level, with the walk lifted onto stairs.
    source, climb = Shown(WALK), Shown(lab.edit_prioritized(WALK, config("stairs")).path)
    apart = [(clip.com - clip.barycenter)[:, [0, 2]] for clip in (source, climb)]
    np.testing.assert_allclose(apart[1], apart[0], atol=1e-3)
    assert np.ptp(climb.com[:, 1]) > np.ptp(source.com[:, 1]) + 30.0


def test_section_4_3_a_displacement_map_is_added_to_the_path_of_the_center_of_mass(lab):
    points = [{"at": 0}, {"at": 70, "shift": [0.0, 0.0, 4.0]}, {"at": 144}]
    com = {"type": "com", "priority": 1, "relative_to": "world", "axes": ["x", "z"], "points": points}
    source, leaning = Shown(WALK), Shown(edited(lab, [com]).path)
    np.testing.assert_allclose((leaning.com - source.com)[70, [0, 2]], [0.0, 4.0], atol=1e-3)


def test_eq_4_a_controlled_joint_starts_where_it_was_in_the_frame_before(lab):
    # One iteration a frame is one step a frame: frames that start from the last get there, those of the input do not.
    few = {"solver": {"max_iterations": 1}, "attraction": 0.0, "defaults": {"ease_in": 0, "ease_out": 0}}
    rise = {"during": [40, 100], "shift": [10.0, 60.0, 20.0]}
    ride = [hand(tolerance="off", recruit=ARM, points=[rise])]
    own, left = Shown(WALK).point("LeftHand"), {}
    for name, smoothing in (("before", {"method": "paper", "passes": 1}), ("input", {"method": "passes", "passes": 0})):
        path = Shown(edited(lab, ride, smoothing=smoothing, **few).path).point("LeftHand")
        left[name] = np.linalg.norm((path - own)[60:100] - rise["shift"], axis=1).max()
    assert left["before"] < 0.2 * left["input"]


@pytest.mark.slow
def test_section_5_2_filtering_the_root_disturbs_the_feet_and_a_second_pass_repairs_them(lab):
    feet = {}
    for passes in (1, 2):
        spec = {**config("reach"), "smoothing": {"method": "paper", "passes": passes}}
        record = lab.edit_prioritized(WALK, spec).record
        feet[passes] = max(c["error_max"] for c in record["constraints"] if c["name"].startswith("feet"))
    assert feet[1] > 0.1
    assert feet[2] < 1e-3
