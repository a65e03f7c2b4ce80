"""Bodies, axes, rest poses, plants and hinges of real clips, read from the folder that MOTIONEDIT_CLIPS names.

What is right stands in bodies_of_real_clips.yaml, written down by hand.
"""

import os
import re
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml

from motionedit.core import rotations as rot
from motionedit.core.body.anatomy import NOTHING_GIVEN
from motionedit.core.body.bends import find_bends
from motionedit.core.body.contacts import foot_plants
from motionedit.core.body.ground import axis_name
from motionedit.core.body.hinges import find_hinges
from motionedit.core.body.mirrored import as_it_points
from motionedit.core.body.quality import find_defects
from motionedit.core.bvh import read_clip
from motionedit.dataclass import replace
from motionedit.jobs.clip.facts import facts_of

FOLDER = Path(os.environ.get("MOTIONEDIT_CLIPS", ""))
pytestmark = pytest.mark.skipif(
    "MOTIONEDIT_CLIPS" not in os.environ, reason="MOTIONEDIT_CLIPS names no folder of real clips"
)
WRITTEN = yaml.safe_load(Path(__file__).with_name("bodies_of_real_clips.yaml").read_text(encoding="utf-8"))
BODIES, CLIPS = WRITTEN["bodies"], WRITTEN["clips"]
WITH_PLANTS = [name for name, clip in CLIPS.items() if "plants" in clip]
WITHOUT_LEGS = [name for name, clip in CLIPS.items() if BODIES[clip["body"]]["left_leg"] is None]
NO_LEGS = ("no legs found: half the height stands for the leg length; body: in a spec says which joints are the legs",)

# Where a border is written down to a few frames, so many seconds on both sides of it say nothing.
BORDER = 0.035
MOST_OFF, MEAN_OFF = 0.09, 0.008  # of the frames of a clip


@cache
def facts(name):
    return facts_of(read_clip(FOLDER / name))


def body_of(found):
    """Return the names of a body's joints as the file of bodies has them."""
    names = found.clip.motion.skeleton.names

    def called(limb, *parts):
        joints = [getattr(limb, part) for part in parts]
        return [None if joint is None else names[joint] for joint in joints]

    body = {"head": None if found.anatomy.head is None else names[found.anatomy.head]}
    for side, leg in zip(("left", "right"), found.anatomy.legs or (None, None), strict=True):
        body[f"{side}_leg"] = None if leg is None else called(leg, "thigh", "knee", "ankle", "toe")
    for side, arm in zip(("left", "right"), found.anatomy.arms or (None, None), strict=True):
        body[f"{side}_arm"] = None if arm is None else called(arm, "clavicle", "shoulder", "elbow", "wrist")
    return body


@pytest.mark.parametrize("name", CLIPS)
def test_a_body_is_the_one_that_is_written_down(name):
    assert body_of(facts(name)) == BODIES[CLIPS[name]["body"]]


@pytest.mark.parametrize("name", CLIPS)
def test_up_and_the_frames_of_a_rest_pose_are_those_that_are_written_down(name):
    assert axis_name(facts(name).up) == CLIPS[name]["up"]
    assert facts(name).first == CLIPS[name]["rest_pose_frames"]


@pytest.mark.parametrize("name", [name for name, clip in CLIPS.items() if clip["heading"] is not None])
def test_a_heading_is_the_one_that_is_written_down(name):
    apart = facts(name).heading_frame().degrees - CLIPS[name]["heading"]
    assert abs((apart + 180.0) % 360.0 - 180.0) <= 3.0


@pytest.mark.parametrize("name", CLIPS)
def test_nothing_is_said_of_clips_of_whole_bodies(name):
    warnings = facts(name).warnings
    if name in WITHOUT_LEGS:
        assert warnings == NO_LEGS
    elif "karate" in name or "tpose" in name:
        # Over OFFSETs along z one body stands along y, the other, by shifts for places, lies in a heap.
        assert all(line.startswith(("up is taken to be ", "position channels put most joints")) for line in warnings)
    else:
        assert warnings == ()


def stretches(spans, frames):
    there = np.zeros(frames, dtype=bool)
    for start, stop in spans:
        there[start : stop + 1] = True
    return there


def off(name):
    """Return for each foot of a clip the shares of frames that stand for sure and are not found, and the reverse."""
    found, clip = facts(name), CLIPS[name]
    frames, border = len(found.clip.motion), max(1, round(BORDER / found.clip.motion.frame_time))
    shares = []
    for foot in ("left", "right"):
        written = stretches(clip["plants"].get(foot, ()), frames)
        planted = stretches([(p.start, p.stop) for p in foot_plants(found.plants) if p.foot == foot], frames)
        sure = ~stretches(clip.get("doubt", {}).get(foot, ()), frames)
        around = np.lib.stride_tricks.sliding_window_view(np.pad(written, border, mode="edge"), 2 * border + 1)
        missed, invented = around.all(axis=1) & ~planted, ~around.any(axis=1) & planted
        shares.append((np.mean(missed & sure), np.mean(invented & sure)))
    return shares


@pytest.mark.parametrize("name", WITH_PLANTS)
def test_feet_stand_when_it_is_written_down(name):
    assert max(sum(shares) for shares in off(name)) <= MOST_OFF, off(name)


def test_feet_of_all_clips_stand_when_it_is_written_down():
    missed, invented = np.mean([shares for name in WITH_PLANTS for shares in off(name)], axis=0)
    assert missed <= MEAN_OFF
    assert invented <= MEAN_OFF


@pytest.mark.parametrize(
    "name", [name for name in CLIPS if re.search(r"cmu_07_\d+_walk|cmu_12_01_walk|av_8walk", name)]
)
def test_the_feet_of_walks_stand_in_turn_for_sane_times(name):
    found = facts(name)
    stands = foot_plants(found.plants)
    assert len(stands) >= 4
    assert all(one.foot != other.foot for one, other in pairwise(stands)), stands
    # The first and the last may be cut by the clip's ends.
    times = [(stand.stop - stand.start + 1) * found.clip.motion.frame_time for stand in stands[1:-1]]
    assert 0.3 < min(times) <= max(times) < 1.1, times


@pytest.mark.parametrize(
    "name",
    # One of them dives, one folds its body up.
    [n for n, c in CLIPS.items() if (BODIES[c["body"]]["left_leg"] or [None])[-1] and not re.search("Files|tpose", n)],
)
def test_toes_point_forward(name):
    found = facts(name)
    count, ahead = len(found.clip.motion), []
    for frame in range(found.first, count, max(1, count // 20)):
        places = found.poses.positions[frame]
        toes = sum(places[leg.toe] - places[leg.ankle] for leg in found.anatomy.legs)
        ahead.append(toes @ found.heading_frame(frame).axes[2] / np.linalg.norm(toes))
    assert np.median(ahead) > 0.5


# In one pose of one file a leg is straight and has no toe: nothing shows where it points.
@pytest.mark.parametrize("name", [name for name in CLIPS if name not in WITHOUT_LEGS and "tpose" not in name])
def test_a_body_whose_left_is_on_the_right_is_found_and_no_other(name):
    found = facts(name)
    left, right = found.anatomy.legs
    exchanged = replace(found.anatomy, legs=(right, left))
    for anatomy, mirrored in ((found.anatomy, False), (exchanged, True)):
        assert as_it_points(anatomy, found.poses, first=found.first, given=NOTHING_GIVEN).mirrored == mirrored


def hinges_of(found):
    return find_hinges(find_bends(found.clip.motion.skeleton, found.poses, found.anatomy, first=found.first))


# In one pose of one file a leg is straight and has no toe: nothing shows to which side it bends.
@pytest.mark.parametrize("name", [name for name in CLIPS if "tpose" not in name])
def test_knees_and_elbows_are_hinges_also_where_a_clip_turns_them_as_balls(name):
    found = facts(name)
    hinges = hinges_of(found)
    knees, elbows = ([leg.knee for leg in found.anatomy.legs or ()], [arm.elbow for arm in found.anatomy.arms or ()])
    assert [hinge.joint for hinge in hinges] == knees + elbows
    for hinge in hinges:
        assert np.linalg.norm(hinge.axis) == pytest.approx(1.0, abs=1e-12)
        assert hinge.limits[0] <= np.radians(3.0) < np.radians(150.0) <= hinge.limits[1]


# One of them turns its elbows all the way round.
@pytest.mark.parametrize("name", [name for name in CLIPS if "Files" not in name])
def test_no_limb_of_a_clip_bends_far_to_its_other_side(name):
    found = facts(name)
    names = found.clip.motion.skeleton.names
    far = {names[hinge.joint]: np.degrees(hinge.limits[0]) for hinge in hinges_of(found)}
    assert {joint: back for joint, back in far.items() if back < -20.0} == {}


@pytest.mark.parametrize("name", [name for name in CLIPS if re.search(r"cmu_(63|13|12|131|02|03|07)_", name)])
def test_knees_of_a_skeleton_that_was_solved_with_hinges_turn_about_the_axis_that_was_found(name):
    found = facts(name)
    for hinge in hinges_of(found)[:2]:
        v = rot.log(found.clip.motion.rotations[found.first :, hinge.joint])
        along = (v @ hinge.axis) ** 2
        assert 1.0 - along.sum() / np.sum(v * v) < 0.01


def test_the_thumb_of_the_golfer_flips():
    motion = facts("golf/cmu_63_01.bvh").clip.motion
    (defect,) = find_defects(motion)
    assert motion.skeleton.names[defect.joint] == "LThumb"
    assert defect.flips == len(defect.frames) == 5
    assert np.degrees(defect.angle) > 179.0
