import pickle

import numpy as np
import pytest
from human import ANKLE_HEIGHT, BONES, HIPS_HEIGHT, skeleton_of, standing, with_rotation
from hypothesis import given
from hypothesis import strategies as st
from rigs import FILES

from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import find_anatomy
from motionedit.core.body.ground import axis_name, axis_vector, heading_frame, reference_axes, stance_frame
from motionedit.core.kinematics import forward


def stand(name="y"):
    turn = FILES[name]
    return standing(skeleton_of(turn=turn), at=turn @ np.array([0.3, HIPS_HEIGHT, 2.0]))


def frame_of(motion, *, up="y"):
    poses, anatomy = forward(motion), find_anatomy(motion.skeleton)
    return heading_frame(poses, anatomy, up=axis_vector(up), frame=0, travel=0)


@pytest.mark.parametrize("name", [*FILES, "-x"])
def test_an_axis_is_its_name(name):
    assert axis_name(axis_vector(name)) == name
    assert np.abs(axis_vector(name)).sum() == 1.0
    assert axis_vector(name)["xyz".index(name[-1])] == (-1.0 if name[0] == "-" else 1.0)


@pytest.mark.parametrize("name", FILES)
def test_heading_has_x_left_y_up_z_forward_and_its_origin_on_the_ground(name):
    motion = stand(name)
    frame = frame_of(motion, up=name)
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


def test_heading_zero_is_the_reference_of_the_file():
    frame = frame_of(stand())
    np.testing.assert_allclose(frame.axes, reference_axes(axis_vector("y")), atol=1e-12)
    assert frame.degrees == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", FILES)
def test_reference_axes_are_right_handed_and_have_up_in_their_middle(name):
    axes = reference_axes(axis_vector(name))
    np.testing.assert_array_equal(axes[1], axis_vector(name))
    np.testing.assert_array_equal(axes @ axes.T, np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1.0)


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
    np.testing.assert_allclose(frame_of(motion).axes[0], [1.0, 0.0, 0.0], atol=1e-9)


def test_a_frames_rotation_turns_its_coordinates_into_the_worlds():
    frame = frame_of(with_rotation(stand(), "Hips", slice(None), [0.0, 0.7, 0.0]))
    local = np.array([1.0, 2.0, 3.0])
    world = frame.world_points(local) - frame.origin
    np.testing.assert_allclose(rot.rotate(frame.rotation, local), world, atol=1e-12)
    np.testing.assert_allclose(frame.vectors(world), local, atol=1e-12)


def test_the_frame_of_the_feet_stands_between_them_with_left_along_their_line():
    motion = with_rotation(stand(), "Hips", slice(None), [0.0, 0.7, 0.0])
    motion = with_rotation(motion, "Spine", slice(None), [0.0, -1.4, 0.3])
    poses, anatomy = forward(motion), find_anatomy(motion.skeleton)
    frame = stance_frame(poses, anatomy, up=axis_vector("y"), frame=0)
    ankles = frame.points(poses.positions[0, [leg.ankle for leg in anatomy.legs]])
    np.testing.assert_allclose(ankles, [[0.1, ANKLE_HEIGHT, 0.0], [-0.1, ANKLE_HEIGHT, 0.0]], atol=1e-12)


def test_feet_at_one_place_and_a_body_without_legs_give_no_frame_of_the_feet():
    crossed = with_rotation(stand(), "LHipJoint", slice(None), [0.0, np.radians(180.0), 0.0])
    assert stance_frame(forward(crossed), find_anatomy(crossed.skeleton), up=axis_vector("y"), frame=0) is None
    thing = standing(skeleton_of([("Hips", None, (0, 0, 0)), ("Tip", "Hips", (0, 1, 0))]))
    assert stance_frame(forward(thing), find_anatomy(thing.skeleton), up=axis_vector("y"), frame=0) is None


def test_what_another_process_gets_of_a_frame_is_the_same_and_read_only():
    frame = frame_of(stand())
    other = pickle.loads(pickle.dumps(frame))  # noqa: S301  our own
    for one, its in ((frame.axes, other.axes), (frame.origin, other.origin), (frame.up, other.up)):
        np.testing.assert_array_equal(its, one, strict=True)
        assert not its.flags.writeable
