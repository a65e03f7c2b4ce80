"""Masses laid on skeletons, the center of mass, and the centres of subtrees."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from human import BONES, ENDS, HIPS_HEIGHT, above, skeleton_of, split, standing, with_axes

from motionedit.core import rotations as rot
from motionedit.core.body.center_of_mass import center_of_mass, find_masses, subtree_centers
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion

CLIPS = os.environ.get("MOTIONEDIT_CLIPS")
needs_clips = pytest.mark.skipif(CLIPS is None, reason="MOTIONEDIT_CLIPS names no folder of real clips")
NOT_HUMAN = ("full_precision", "rotation_first", "test_simple", "sinusoidal")
INCH = 0.0254

# Per cent of the body: de Leva 1996, table 4, mean of women and men; the trunk is the sum of its three parts.
PER_CENT = {"head": 6.81, "trunk": 43.015, "upper arm": 2.63, "forearm": 1.5, "hand": 0.585}
PER_CENT |= {"thigh": 14.47, "shank": 4.57, "foot": 1.33}


def masses_of(skeleton, **options):
    return find_masses(skeleton, find_anatomy(skeleton), **options)


def center_standing(skeleton, *, at=(0.0, HIPS_HEIGHT, 0.0)):
    return center_of_mass(forward(standing(skeleton, 1, at=at)), masses_of(skeleton))[0]


def segments_of(skeleton, masses):
    """Return the mass of each segment in per cent, each joint's counted to the segment it stands in."""
    anatomy = find_anatomy(skeleton)
    owner = dict.fromkeys(range(len(skeleton)), "trunk")

    def claim(top, segment):
        for j in range(len(skeleton)):
            if top in skeleton.chain(j):
                owner[j] = segment

    claim(anatomy.head, "head")
    for leg in anatomy.legs:
        claim(leg.thigh, "thigh")
        claim(leg.knee, "shank")
        claim(leg.ankle, "foot")
    for arm in anatomy.arms:
        claim(arm.shoulder, "upper arm")
        claim(arm.elbow, "forearm")
        claim(arm.wrist, "hand")
    totals = {segment: 100.0 * sum(masses.shares[j] for j in owner if owner[j] == segment) for segment in PER_CENT}
    return {segment: total if segment in ("head", "trunk") else total / 2 for segment, total in totals.items()}


def test_each_segment_weighs_what_the_table_says():
    skeleton = skeleton_of()
    masses = masses_of(skeleton)
    assert masses.is_human
    assert masses.warnings == ()
    assert masses.shares.sum() == pytest.approx(1.0, abs=1e-12)
    assert segments_of(skeleton, masses) == pytest.approx(PER_CENT, abs=0.005)


def test_a_standing_persons_center_of_mass_is_at_55_to_57_per_cent_of_stature():
    stature = HIPS_HEIGHT + 0.1 + 0.2 + 0.2 + 0.1 + 0.18
    assert 0.55 < center_standing(skeleton_of())[1] / stature < 0.57


def test_a_thighs_center_is_where_the_table_says():
    masses = masses_of(skeleton := skeleton_of())
    thigh = skeleton.names.index("LeftUpLeg")
    np.testing.assert_allclose(masses.points[thigh], [0.0, -0.42 * 0.5 * (0.3612 + 0.4095), 0.0], atol=1e-12)


BONES_TO_CUT = ["LeftLeg", "LeftFoot", "LeftForeArm", "LeftHand", "Spine", "Spine1", "Neck", "Head"]


def cut_bone(name, share):
    """Return a human with a twist joint put into the bone that ends at `name`, and into its twin's."""
    rows = split(BONES, name, "Twist", share)
    if name.startswith("Left"):
        rows = split(rows, name.replace("Left", "Right"), "OtherTwist", share)
    return skeleton_of(rows)


@pytest.mark.parametrize("bone", BONES_TO_CUT)
@pytest.mark.parametrize("share", [0.4, 0.6, 0.8])
def test_a_joint_put_into_a_bone_leaves_the_center_of_mass_of_a_straight_body(bone, share):
    np.testing.assert_allclose(center_standing(cut_bone(bone, share)), center_standing(skeleton_of()), atol=1e-12)


def test_a_bend_in_the_middle_of_a_thigh_moves_only_what_is_below_it():
    cut = cut_bone("LeftLeg", 0.5)
    masses, twist = masses_of(cut), cut.names.index("Twist")
    # Density 1 + k (2 s - 1) along the thigh, summed up by the midpoint rule from the middle down.
    s = 0.5 + (np.arange(100_000) + 0.5) / 200_000
    density = 1.0 + (6.0 * 0.5 * (0.3612 + 0.4095) - 3.0) * (2.0 * s - 1.0)
    whole = 0.01 * PER_CENT["thigh"] / 0.99995  # the table adds up to 99.995
    assert masses.shares[twist] == pytest.approx(whole * density.mean() / 2.0, rel=1e-8)
    lever = 0.42 * (np.average(s, weights=density) - 0.5)
    np.testing.assert_allclose(masses.points[twist], [0.0, -lever, 0.0], atol=1e-9)


def test_a_lower_bend_of_the_spine_moves_the_center_of_mass_further():
    skeleton = skeleton_of()
    masses = masses_of(skeleton)

    def forward_move(joint):
        motion = standing(skeleton, 1)
        rotations = motion.rotations.copy()
        rotations[:, skeleton.names.index(joint)] = rot.exp(np.array([0.5, 0.0, 0.0]))
        bent = Motion(skeleton, rotations, motion.translations, 0.01)
        return (center_of_mass(forward(bent), masses) - center_of_mass(forward(motion), masses))[0, 2]

    moves = [forward_move(joint) for joint in ("Head", "Spine1", "Spine")]
    assert 0.0 < moves[0] < moves[1] < moves[2]


def test_what_a_hand_holds_weighs_nothing():
    club = ("Club", "LeftHand", (0.1, -0.5, 0.7))
    plain, holding = skeleton_of(), skeleton_of([*BONES, club], ENDS | {"Club": (0.0, -0.4, 0.0)})
    masses = masses_of(holding)
    np.testing.assert_allclose(masses.shares, [*masses_of(plain).shares, 0.0], atol=1e-15)
    np.testing.assert_allclose(center_standing(holding), center_standing(plain), atol=1e-3)
    hand = masses.points[holding.names.index("LeftHand")]
    assert hand @ [0.0, -1.0, 0.0] > 0.8 * np.linalg.norm(hand), "a long club does not pull the hand's centre to it"


def test_names_do_not_matter():
    numbers = {name: f"joint{i}" for i, (name, _, _) in enumerate(BONES)}
    known, unknown = masses_of(skeleton_of()), masses_of(skeleton_of(rename=numbers.__getitem__))
    np.testing.assert_array_equal(unknown.shares, known.shares)
    np.testing.assert_array_equal(unknown.points, known.points)


def test_units_and_axes_do_not_matter():
    turn = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    metres, inches = masses_of(skeleton_of()), masses_of(skeleton_of(turn=turn, scale=1.0 / INCH))
    np.testing.assert_allclose(inches.shares, metres.shares, atol=1e-14)
    np.testing.assert_allclose(inches.points, metres.points @ turn.T / INCH, atol=1e-12)


def test_the_axes_that_joints_have_do_not_matter():
    rows = [row for row in BONES if row[0] not in {"LeftHandIndex1", "RightHandIndex1"}]
    skeleton, rng = skeleton_of(rows, {}), np.random.default_rng(3)
    motion = standing(skeleton, 30)
    rotations = rot.exp(0.2 * rng.normal(size=(30, len(skeleton), 3)) + 0.3 * rng.normal(size=(len(skeleton), 3)))
    motion = Motion(skeleton, rotations, motion.translations, motion.frame_time)
    other = with_axes(motion, rot.exp(2.0 * rng.normal(size=(len(skeleton), 3))))
    anatomy = find_anatomy(skeleton)
    one, same = (find_masses(each.skeleton, anatomy, rotations=each.rotations) for each in (motion, other))
    assert one.is_human
    np.testing.assert_allclose(same.shares, one.shares, atol=1e-12)
    centers = [center_of_mass(forward(each), masses) for each, masses in ((motion, one), (other, same))]
    np.testing.assert_allclose(centers[1], centers[0], atol=1e-9)


@pytest.mark.parametrize("way", ["static root", "legs beside the spine", "root in the chest"])
def test_the_way_the_tree_goes_does_not_matter(way):
    rows, at = BONES, (0.0, HIPS_HEIGHT, 0.0)
    if way == "static root":
        rows = above(BONES, "Root")
    elif way == "legs beside the spine":
        legs = {"LHipJoint", "RHipJoint"}
        rows = [("Root", None, (0.0, 0.0, 0.0)), ("Pelvis", "Root", (0.0, 0.0, 0.0))]
        rows += [(n, "Pelvis" if n in legs else {"Hips": "Root"}.get(p, p), o) for n, p, o in BONES[1:]]
    else:
        up = {"Spine1": None, "Spine": "Spine1", "Hips": "Spine"}
        offsets = {"Spine1": (0.0, 0.0, 0.0), "Spine": (0.0, -0.2, 0.0), "Hips": (0.0, -0.1, 0.0)}
        rows = [(n, up[n], offsets[n]) for n in up] + [row for row in BONES if row[0] not in up]
        at = (0.0, HIPS_HEIGHT + 0.3, 0.0)
    skeleton = skeleton_of(rows)
    assert masses_of(skeleton).is_human
    np.testing.assert_allclose(center_standing(skeleton, at=at), center_standing(skeleton_of()), atol=1e-12)
    assert segments_of(skeleton, masses_of(skeleton)) == pytest.approx(PER_CENT, abs=0.005)


@pytest.mark.parametrize("missing", [{"Neck", "Head"}, {"Neck"}, {"LeftToeBase", "RightToeBase"}])
def test_a_body_without_a_joint_is_still_a_human(missing):
    names = {name: (parent, offset) for name, parent, offset in BONES}
    rows = []
    for name, parent, offset in BONES:
        if name in missing:
            continue
        if parent in missing:
            rows.append((name, names[parent][0], tuple(np.add(offset, names[parent][1]))))
        else:
            rows.append((name, parent, offset))
    ends = ENDS | {"LeftFoot": (0.0, -0.06, 0.2), "RightFoot": (0.0, -0.06, 0.2)}
    skeleton = skeleton_of(rows, ends)
    masses = masses_of(skeleton)
    assert masses.is_human
    np.testing.assert_allclose(center_standing(skeleton), center_standing(skeleton_of()), atol=0.02)


def test_bare_hands_and_feet_lie_at_their_joints():
    skeleton = skeleton_of([row for row in BONES if "Toe" not in row[0]], {"Head": ENDS["Head"]})
    masses = masses_of(skeleton)
    foot, hand = skeleton.names.index("LeftFoot"), skeleton.names.index("LeftHand")
    np.testing.assert_allclose(masses.points[foot], np.zeros(3), atol=1e-12)
    assert masses.points[hand] @ skeleton.offsets[hand] > 0.0


def test_a_body_with_a_dogs_proportions_is_weighed_by_its_bones_with_a_warning():
    stretched = [(n, p, tuple(np.multiply(o, 3.0)) if n.startswith("Spine") else o) for n, p, o in BONES]
    skeleton = skeleton_of(stretched)
    assert find_anatomy(skeleton).arms is not None
    masses = masses_of(skeleton)
    assert not masses.is_human
    assert "not a human's" in masses.warnings[0]
    assert masses.shares.sum() == pytest.approx(1.0)


def test_without_a_human_a_joint_weighs_as_much_as_its_bones_are_long():
    rows = [("a", None, (5.0, 0.0, 0.0)), ("b", "a", (0.0, 2.0, 0.0)), ("c", "b", (0.0, 0.0, 4.0))]
    masses = masses_of(skeleton_of(rows, {"c": (2.0, 0.0, 0.0)}))
    np.testing.assert_allclose(masses.shares, [0.25, 0.5, 0.25])
    np.testing.assert_allclose(masses.points, [[0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [1.0, 0.0, 0.0]])


def test_a_bone_that_position_channels_move_weighs_nothing():
    rows = [("a", None, (5.0, 0.0, 0.0)), ("b", "a", (0.0, 2.0, 0.0)), ("c", "b", (0.0, 0.0, 4.0))]
    skeleton = skeleton_of(rows, {})
    carried = replace(skeleton, channels=(skeleton.channels[1], skeleton.channels[0], skeleton.channels[1]))
    np.testing.assert_array_equal(masses_of(carried).shares, [0.0, 1.0, 0.0])


def test_a_single_point_weighs_at_its_root():
    masses = masses_of(skeleton_of([("a", None, (1.0, 2.0, 3.0))], {}))
    np.testing.assert_array_equal(masses.shares, [1.0])
    np.testing.assert_array_equal(masses.points, np.zeros((1, 3)))


def test_given_masses_replace_the_table():
    skeleton = skeleton_of()
    spine, thigh, toe = (skeleton.names.index(name) for name in ("Spine", "LeftUpLeg", "LeftToeBase"))
    table, masses = masses_of(skeleton), masses_of(skeleton, given={spine: 12.5, thigh: 6.25, toe: 6.25})
    assert dict(zip(np.flatnonzero(masses.shares), masses.shares[masses.shares > 0], strict=True)) == {
        spine: 0.5,
        thigh: 0.25,
        toe: 0.25,
    }
    np.testing.assert_array_equal(masses.points[[spine, thigh]], table.points[[spine, thigh]])
    np.testing.assert_allclose(masses.points[toe], [0.0, 0.0, 0.03])


def test_given_masses_need_no_human_and_no_warning():
    skeleton = skeleton_of(BONES[:3], {})
    assert masses_of(skeleton, given={1: 2.0}).warnings == ()
    assert masses_of(skeleton, given={1: 0.0, 2: 1e-3}).warnings == ()
    assert masses_of(skeleton, given={}).warnings


@pytest.mark.parametrize("given", [{1: 0.0, 2: 0.0}, {1: -1.0, 2: 2.0}, {1: np.inf}])
def test_given_masses_that_make_no_body_are_refused(given):
    with pytest.raises(ValueError, match="masses must be 0 or more, and not 0 for all"):
        masses_of(skeleton_of(), given=given)


def test_subtrees_weigh_what_is_at_and_below_their_joint():
    rng = np.random.default_rng(3)
    skeleton = skeleton_of([*BONES, ("Club", "LeftHand", (0.0, -1.0, 0.0))])
    masses = masses_of(skeleton)
    rotations = rot.exp(rng.normal(size=(4, len(skeleton), 3)))
    poses = forward(Motion(skeleton, rotations, rng.normal(size=(4, 1, 3)), 0.01))
    centers, shares = subtree_centers(poses, masses)
    lumps = poses.positions + rot.rotate(poses.rotations, masses.points)
    for joint in range(len(skeleton)):
        below = [j for j in range(len(skeleton)) if joint in skeleton.chain(j)]
        assert shares[joint] == pytest.approx(masses.shares[below].sum(), abs=1e-15)
        if skeleton.names[joint] in ("Club", "LeftToeBase", "RightToeBase"):
            np.testing.assert_array_equal(centers[:, joint], poses.positions[:, joint])
        else:
            expected = np.average(lumps[:, below], axis=1, weights=masses.shares[below])
            np.testing.assert_allclose(centers[:, joint], expected, atol=1e-12)
    np.testing.assert_allclose(centers[:, 0], center_of_mass(poses, masses), atol=1e-12)


def test_the_center_of_mass_goes_with_the_body():
    skeleton = skeleton_of()
    motion, masses = standing(skeleton, 2), masses_of(skeleton)
    turn = rot.exp(np.array([0.3, -0.7, 1.1]))
    rotations = motion.rotations.copy()
    rotations[:, 0] = rot.multiply(np.broadcast_to(turn, (2, 4)), rotations[:, 0])
    translations = rot.rotate(np.broadcast_to(turn, (2, 1, 4)), motion.translations) + 5.0
    moved = replace(motion, rotations=rotations, translations=translations)
    expected = rot.rotate(turn, center_of_mass(forward(motion), masses)) + 5.0
    np.testing.assert_allclose(center_of_mass(forward(moved), masses), expected, atol=1e-12)


@needs_clips
@pytest.mark.parametrize("number", [32, 39, 40, 41, 42])
def test_a_jumping_persons_center_of_mass_falls_freely(number):
    clip = read_clip(Path(CLIPS) / "motions" / "cmu13" / f"cmu_13_{number}_jump.bvh")
    motion, anatomy = clip.motion, find_anatomy(clip.motion.skeleton)
    poses = forward(motion)
    metres = INCH / 0.45
    # The first frame is a T-pose. In flight every ankle and toe is 8 cm above where it stands.
    feet = metres * poses.positions[1:, [joint for _, joint in anatomy.foot_points], 1]
    flight = np.flatnonzero((feet - np.percentile(feet, 2, axis=0)).min(axis=1) > 0.08) + 1
    assert len(flight) > 40
    assert np.all(np.diff(flight) == 1)
    height = metres * center_of_mass(poses, find_masses(motion.skeleton, anatomy))[flight, 1]
    seconds = motion.frame_time * (flight - flight.mean())
    parabola = np.polyfit(seconds, height, 2)
    assert -2.0 * parabola[0] == pytest.approx(9.81, rel=0.04)
    np.testing.assert_allclose(np.polyval(parabola, seconds), height, atol=0.005)


@needs_clips
def test_every_real_human_is_weighed_by_the_table():
    seen = 0
    for path in sorted(Path(CLIPS).rglob("*.bvh")):
        skeleton = read_clip(path, lenient=True).motion.skeleton
        masses = masses_of(skeleton)
        assert masses.is_human == (not any(word in path.name for word in NOT_HUMAN)), path.name
        assert masses.shares.sum() == pytest.approx(1.0, abs=1e-12)
        assert np.all(np.isfinite(masses.points))
        if masses.is_human:
            seen += 1
            assert segments_of(skeleton, masses) == pytest.approx(PER_CENT, abs=0.005), path.name
    assert seen > 40
