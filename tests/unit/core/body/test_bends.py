"""Knees and elbows bend to their own side, also where no frame of a clip shows it."""

import numpy as np
import pytest
from human import skeleton_of, standing, with_rotation

from motionedit.core import rotations as rot
from motionedit.core.body.bends import find_bends
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.kinematics import forward
from motionedit.core.skeleton import EndSite

SKELETON = skeleton_of()
INDEX = SKELETON.names.index


def bends_of(motion, first=0):
    anatomy = find_anatomy(motion.skeleton)
    bends = find_bends(motion.skeleton, forward(motion), anatomy, first=first)
    return {motion.skeleton.names[bend.joint]: bend for bend in bends}


def moved_by(motion, bend, joint):
    """Return where a joint goes when a limb bends by a degree about the bend's axis."""
    turned = rot.multiply(rot.exp(np.radians(1.0) * bend.axis), motion.rotations[:, bend.joint])
    rotations = motion.rotations.copy()
    rotations[:, bend.joint] = turned
    after = forward(type(motion)(motion.skeleton, rotations, motion.translations, motion.frame_time))
    return (after.positions - forward(motion).positions)[0, joint]


def test_straight_legs_bend_to_the_toes_side_and_straight_arms_so_that_hands_come_to_the_front():
    motion = standing(SKELETON)
    bends = bends_of(motion)
    assert list(bends) == ["LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"]
    for side in ("Left", "Right"):
        # The toes point along z: the shank goes back, so that the knee can come forward.
        assert moved_by(motion, bends[f"{side}Leg"], INDEX(f"{side}Foot"))[2] < -5e-3
        assert moved_by(motion, bends[f"{side}ForeArm"], INDEX(f"{side}Hand"))[2] > 3e-3


@pytest.mark.parametrize("turn", [(0.0, 2.0, 0.0), (1.2, 0.0, 0.4)])
def test_the_side_turns_with_the_body(turn):
    motion = with_rotation(standing(SKELETON), "Hips", slice(None), turn)
    plain, turned = bends_of(standing(SKELETON)), bends_of(motion)
    for name, bend in plain.items():
        np.testing.assert_allclose(turned[name].axis, bend.axis, atol=1e-9)


def test_a_limb_bends_as_it_does_elsewhere_in_the_clip_and_a_rest_pose_does_not_count():
    motion = with_rotation(standing(SKELETON), "LeftForeArm", slice(8, 12), (0.0, 0.0, 0.7))
    np.testing.assert_allclose(bends_of(motion)["LeftForeArm"].axis, [0.0, 0.0, 1.0], atol=1e-9)
    rest = with_rotation(motion, "LeftForeArm", slice(0, 2), (0.0, 0.0, -1.4))
    np.testing.assert_allclose(bends_of(rest, first=2)["LeftForeArm"].axis, [0.0, 0.0, 1.0], atol=1e-9)


@pytest.fixture(params=["compiled", "numpy"])
def _both(request, monkeypatch):
    monkeypatch.setenv("MOTIONEDIT_SOLVER", request.param if request.param == "numpy" else "")


def giving_way(joint, axis, *, back, bent, frames=400):
    """Return a body with all limbs bent a little, one of which gives way by `back` degrees but in frames `bent`."""
    motion = standing(SKELETON, frames)
    for each in ("LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"):
        motion = with_rotation(motion, each, slice(None), (0.1, 0.0, 0.0))
    motion = with_rotation(motion, joint, slice(None), -np.radians(back) * np.array(axis))
    for frame, angle in bent.items():
        motion = with_rotation(motion, joint, frame, np.radians(angle) * np.array(axis))
    return motion


@pytest.mark.usefixtures("_both")
@pytest.mark.parametrize("joint", ["LeftLeg", "RightForeArm"])
@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 0.0, -1.0)])
def test_a_limb_bends_to_where_it_is_clearly_bent_however_long_it_gives_way_to_the_other_side(joint, axis):
    motion = giving_way(joint, axis, back=9.0, bent=dict(enumerate((30.0, 50.0, 60.0, 40.0), 100)))
    bend = bends_of(motion)[joint]
    np.testing.assert_allclose(bend.axis, axis, atol=1e-9)
    np.testing.assert_allclose(np.degrees(bend.bent), [-9.0, 60.0], atol=0.5)


@pytest.mark.usefixtures("_both")
@pytest.mark.parametrize(
    ("back", "bent"),
    [(9.0, {100: 60.0, 101: 60.0}), (9.0, {100: 12.0, 101: 14.0, 102: 14.0}), (20.0, dict.fromkeys(range(20), 50.0))],
    ids=["a glitch", "no more than it gives way", "clearly to both"],
)
def test_a_limb_bends_to_the_side_of_most_frames_where_few_show_the_other(back, bent):
    motion = giving_way("LeftForeArm", (1.0, 0.0, 0.0), back=back, bent=bent)
    np.testing.assert_allclose(bends_of(motion)["LeftForeArm"].axis, [-1.0, 0.0, 0.0], atol=1e-9)


@pytest.mark.usefixtures("_both")
@pytest.mark.parametrize(("bent", "clearly"), [({}, False), ({3: 40.0, 4: 40.0}, False), ({3: 16, 4: 16, 5: 16}, True)])
def test_knees_that_are_only_ever_past_straight_bend_to_the_toes_side(bent, clearly):
    # The toes point along z, which is a bend about x; the clear frames are to the other side.
    motion = giving_way("LeftLeg", (-1.0, 0.0, 0.0), back=-6.0, bent=bent)
    bend = bends_of(motion)["LeftLeg"]
    np.testing.assert_allclose(bend.axis, [-1.0 if clearly else 1.0, 0.0, 0.0], atol=1e-9)
    angles = np.degrees(np.unique(bend.angles.round(9)))
    np.testing.assert_allclose(angles if clearly else -angles[::-1], sorted({6.0, *bent.values()}), atol=1e-6)


@pytest.mark.usefixtures("_both")
def test_a_rest_pose_that_is_clearly_bent_does_not_count():
    motion = giving_way("LeftForeArm", (1.0, 0.0, 0.0), back=9.0, bent=dict.fromkeys(range(4), 50.0))
    np.testing.assert_allclose(bends_of(motion, first=4)["LeftForeArm"].axis, [-1.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(bends_of(motion, first=1)["LeftForeArm"].axis, [1.0, 0.0, 0.0], atol=1e-9)


def test_a_foot_without_a_toe_joint_shows_the_side_by_its_end_site():
    bones = [row for row in human_bones() if "Toe" not in row[0]]
    ends = {"LeftFoot": (0.0, -0.06, 0.13), "RightFoot": (0.0, -0.06, 0.13), "Head": (0.0, 0.18, 0.0)}
    motion = standing(skeleton_of(bones, ends))
    bend = bends_of(motion)["LeftLeg"]
    assert moved_by(motion, bend, motion.skeleton.names.index("LeftFoot"))[2] < -5e-3


def human_bones():
    from human import BONES

    return BONES


@pytest.mark.parametrize(("degrees", "straight"), [(0.0, True), (0.1, True), (0.3, False), (40.0, False)])
def test_a_limb_is_straight_up_to_a_fifth_of_a_degree(degrees, straight):
    motion = with_rotation(standing(SKELETON), "LeftLeg", slice(None), (np.radians(degrees), 0.0, 0.0))
    bend = bends_of(motion)["LeftLeg"]
    assert bend.straight.tolist() == [straight] * len(motion)


def test_angles_are_those_between_the_bones_and_negative_where_a_limb_is_bent_back():
    degrees = np.linspace(-20.0, 140.0, 9)
    motion = standing(SKELETON, 11)
    for frame, angle in enumerate(degrees):
        motion = with_rotation(motion, "LeftLeg", frame + 2, (np.radians(angle), 0.0, 0.0))
    # The hips and the thigh turn, too: nothing of that is a bend of the knee.
    motion = with_rotation(motion, "Hips", slice(None), (0.3, 1.2, -0.4))
    motion = with_rotation(motion, "LeftUpLeg", slice(None), (-0.7, 0.2, 0.1))
    bend = bends_of(motion, first=2)["LeftLeg"]
    np.testing.assert_allclose(np.degrees(bend.angles), degrees, atol=0.2)
    places = forward(motion).positions[2:]
    hip, knee, ankle = (places[:, INDEX(name)] for name in ("LeftUpLeg", "LeftLeg", "LeftFoot"))
    thigh, shank = knee - hip, ankle - knee
    cosines = np.sum(thigh * shank, axis=1) / np.linalg.norm(thigh, axis=1) / np.linalg.norm(shank, axis=1)
    np.testing.assert_allclose(np.abs(bend.angles), np.arccos(np.clip(cosines, -1.0, 1.0)), atol=1e-2)
    assert np.linalg.norm([bend.upper, bend.lower], axis=1) == pytest.approx([1.0, 1.0])


def test_a_straight_limb_has_no_angle_to_speak_of():
    for bend in bends_of(standing(SKELETON)).values():
        np.testing.assert_allclose(bend.angles, 0.0, atol=1e-9)


def test_a_body_without_limbs_has_no_bends():
    assert bends_of(standing(skeleton_of([("Hips", None, (0, 0, 0)), ("Tip", "Hips", (0, 1, 0))]))) == {}


def test_limbs_of_no_length_have_no_bends():
    flat = skeleton_of(scale=0.0)
    sites = tuple(EndSite(site.joint, np.zeros(3)) for site in flat.end_sites)
    motion = standing(type(flat)(flat.names, flat.parents, flat.offsets, flat.channels, sites))
    anatomy = find_anatomy(SKELETON)
    assert find_bends(motion.skeleton, forward(motion), anatomy, first=0) == ()
