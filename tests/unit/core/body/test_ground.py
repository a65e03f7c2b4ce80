import numpy as np
import pytest
from human import ANKLE_HEIGHT, BONES, HIPS_HEIGHT, ROOT_CHANNELS, above, skeleton_of, standing, with_rotation
from hypothesis import given
from hypothesis import strategies as st

from motionedit.core import rotations as rot
from motionedit.core.body.anatomy import find_anatomy
from motionedit.core.body.ground import (
    axis_name,
    axis_vector,
    find_up,
    heading_frame,
    reference_axes,
    rest_pose_frames,
    travel_joint,
)
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion
from motionedit.core.skeleton import Skeleton

# Rows: the file's x, y, z of a body whose own axes are left, up, forward.
FILES = {
    "y": np.eye(3),
    "z": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "x": np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]]),
    "-y": np.diag([-1.0, -1.0, 1.0]),
    "-z": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
}


def stand(turn=None, **options):
    turn = np.eye(3) if turn is None else turn
    return standing(skeleton_of(turn=turn), at=turn @ np.array([0.3, HIPS_HEIGHT, 2.0]), **options)


def frame_of(motion, frame=0, up=None):
    poses = forward(motion)
    anatomy = find_anatomy(motion.skeleton)
    up = find_up(motion, poses, anatomy) if up is None else up
    return heading_frame(poses, anatomy, up=up, frame=frame, travel=travel_joint(motion))


@pytest.mark.parametrize("name", FILES)
def test_up_is_the_axis_and_the_sign_in_which_the_head_stands_over_the_feet(name):
    motion = stand(FILES[name])
    up = find_up(motion, forward(motion), find_anatomy(motion.skeleton))
    assert axis_name(up) == name
    np.testing.assert_array_equal(up, axis_vector(name))


def test_up_is_not_moved_by_a_fall_in_less_than_half_of_the_frames():
    motion = with_rotation(stand(frames=21), "Hips", slice(0, 10), [np.radians(150.0), 0.0, 0.0])
    anatomy = find_anatomy(motion.skeleton)
    assert axis_name(find_up(motion, forward(motion), anatomy)) == "y"


def test_up_of_a_thing_without_a_body_is_y():
    skeleton = Skeleton(("a", "b"), np.array([-1, 0]), np.array([[0.0, 0, 0], [0, 0, 1]]), (ROOT_CHANNELS, ()))
    motion = standing(skeleton)
    assert axis_name(find_up(motion, forward(motion), find_anatomy(skeleton))) == "y"


@pytest.mark.parametrize("name", FILES)
def test_heading_has_x_left_y_up_z_forward_and_its_origin_on_the_ground(name):
    motion = stand(FILES[name])
    frame = frame_of(motion)
    poses = forward(motion)
    local = frame.points(poses.positions[0])
    index = motion.skeleton.names.index
    assert np.linalg.det(frame.axes) == pytest.approx(1.0)
    np.testing.assert_allclose(local[index("Hips")], [0.0, HIPS_HEIGHT, 0.0], atol=1e-12)
    np.testing.assert_allclose(local[index("LeftFoot")], [0.1, ANKLE_HEIGHT, 0.0], atol=1e-12)
    assert local[index("LeftToeBase")][2] == pytest.approx(0.13)
    np.testing.assert_allclose(frame.world_points(local), poses.positions[0], atol=1e-12)


@given(st.floats(-179.0, 179.0))
def test_degrees_count_the_turn_about_up_from_the_files_own_axes(degrees):
    motion = with_rotation(stand(), "Hips", slice(None), [0.0, np.radians(degrees), 0.0])
    assert frame_of(motion).degrees == pytest.approx(degrees, abs=1e-9)


@pytest.mark.parametrize("name", FILES)
def test_heading_zero_is_the_reference_of_the_file(name):
    frame = frame_of(stand())
    np.testing.assert_allclose(frame.axes, reference_axes(axis_vector("y")), atol=1e-12)
    assert np.linalg.det(reference_axes(axis_vector(name))) == pytest.approx(1.0)


def test_mirroring_a_body_whose_names_are_swapped_with_it_mirrors_its_frame():
    swap = {"Left": "Right", "Right": "Left", "LHip": "RHip", "RHip": "LHip"}

    def other(name):
        return next((name.replace(a, b) for a, b in swap.items() if name.startswith(a)), name)

    turned = [0.0, 0.4, 0.0]
    plain = with_rotation(standing(skeleton_of()), "Hips", slice(None), turned)
    mirrored = standing(skeleton_of(turn=np.diag([-1.0, 1.0, 1.0]), rename=other))
    mirrored = with_rotation(mirrored, "Hips", slice(None), [0.0, -0.4, 0.0])
    forward_plain, forward_mirrored = frame_of(plain).axes[2], frame_of(mirrored).axes[2]
    np.testing.assert_allclose(forward_mirrored, forward_plain * [-1.0, 1.0, 1.0], atol=1e-12)


def test_without_names_the_toes_say_what_is_left():
    names = {name: f"joint{i}" for i, (name, _, _) in enumerate(BONES)}
    for turn in (np.eye(3), np.diag([-1.0, 1.0, 1.0])):
        frame = frame_of(standing(skeleton_of(turn=turn, rename=names.get)))
        np.testing.assert_allclose(frame.axes[2], [0.0, 0.0, 1.0], atol=1e-12)


def test_hips_that_stand_on_edge_leave_it_to_the_shoulders():
    # The hips' line is upright but for 3 degrees, which lean it to the front: no left to be had from it.
    edge = rot.multiply(rot.exp(np.radians([3.0, 0.0, 0.0])), rot.exp(np.radians([0.0, 0.0, 90.0])))
    motion = with_rotation(standing(skeleton_of()), "Hips", slice(None), rot.log(edge))
    motion = with_rotation(motion, "Spine", slice(None), -rot.log(edge))
    np.testing.assert_allclose(frame_of(motion, up=axis_vector("y")).axes[0], [1.0, 0.0, 0.0], atol=1e-9)


def test_a_frames_rotation_turns_its_coordinates_into_the_worlds():
    frame = frame_of(with_rotation(stand(), "Hips", slice(None), [0.0, 0.7, 0.0]))
    local = np.array([1.0, 2.0, 3.0])
    world = frame.world_points(local) - frame.origin
    np.testing.assert_allclose(rot.rotate(frame.rotation, local), world, atol=1e-12)
    np.testing.assert_allclose(frame.vectors(world), local, atol=1e-12)


def test_travel_is_carried_by_the_joint_that_moves_below_a_static_root():
    bones = above(BONES, "joint_Root")
    skeleton = skeleton_of(bones)
    channels = (ROOT_CHANNELS, ROOT_CHANNELS, *skeleton.channels[2:])
    skeleton = Skeleton(skeleton.names, skeleton.parents, skeleton.offsets, channels, skeleton.end_sites)
    translations = np.zeros((20, 2, 3))
    translations[:, 0, 0] = 1e-4 * np.arange(20)  # jitter
    translations[:, 1] = np.linspace([0, 1, 0], [0, 1, 2], 20)
    motion = Motion(skeleton, standing(skeleton).rotations, translations, 0.01)
    assert skeleton.names[travel_joint(motion)] == "Hips"
    moved = Motion(skeleton, motion.rotations, translations[:, ::-1], 0.01)
    assert skeleton.names[travel_joint(moved)] == "joint_Root"


def test_travel_of_a_clip_that_stands_still_is_at_the_first_joint_with_positions():
    assert travel_joint(standing(skeleton_of())) == 0
    skeleton = Skeleton(("a", "b"), np.array([-1, 0]), np.zeros((2, 3)), ((), ROOT_CHANNELS))
    assert travel_joint(standing(skeleton)) == 1
    still = Skeleton(("a", "b"), np.array([-1, 0]), np.zeros((2, 3)), ((), ()))
    assert travel_joint(standing(still)) == 0


@pytest.mark.parametrize(
    ("joint", "first", "angle", "expected"),
    [
        ("LeftArm", 1, 1.4, 1),
        ("LeftArm", 2, 1.4, 2),
        ("LeftArm", 3, 1.4, 3),
        ("LeftArm", 4, 1.4, 0),  # too late: a defect, no rest pose
        ("LeftArm", 1, 0.59, 0),
        ("LeftArm", 1, 0.61, 1),
        ("LeftFoot", 1, 1.4, 1),  # an ankle counts
        ("LeftHand", 1, 1.4, 0),  # a wrist does not
        ("RightToeBase", 1, 1.4, 0),
        ("LeftArm", 0, 1.4, 0),
    ],
)
def test_a_rest_pose_ends_with_a_step_of_the_body_in_the_first_frames(joint, first, angle, expected):
    motion = with_rotation(standing(skeleton_of()), joint, slice(first, None), [0.0, 0.0, angle])
    assert rest_pose_frames(motion, find_anatomy(motion.skeleton)) == expected


def test_another_euler_branch_is_no_step():
    motion = standing(skeleton_of())
    rotations = motion.rotations.copy()
    rotations[1:] *= -1.0
    motion = Motion(motion.skeleton, rotations, motion.translations, motion.frame_time)
    assert rest_pose_frames(motion, find_anatomy(motion.skeleton)) == 0


def test_one_frame_has_no_rest_pose():
    motion = standing(skeleton_of(), frames=1)
    assert rest_pose_frames(motion, find_anatomy(motion.skeleton)) == 0


def test_up_leaves_the_rest_pose_out():
    # A T-pose upright, then a take of one frame in a file whose body lies along z.
    motion = with_rotation(standing(skeleton_of(), frames=2), "Hips", slice(1, None), [np.pi / 2, 0.0, 0.0])
    assert axis_name(find_up(motion, forward(motion), find_anatomy(motion.skeleton))) == "z"


def test_where_a_lean_makes_no_axis_clear_the_offsets_have_a_say():
    lean = np.radians(47.0)
    motion = with_rotation(standing(skeleton_of()), "Hips", slice(None), [lean, 0.0, 0.0])
    assert axis_name(find_up(motion, forward(motion), find_anatomy(motion.skeleton))) == "y"
    fallen = with_rotation(standing(skeleton_of()), "Hips", slice(None), [np.radians(60.0), 0.0, 0.0])
    assert axis_name(find_up(fallen, forward(fallen), find_anatomy(fallen.skeleton))) == "z"
