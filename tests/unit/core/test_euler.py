"""Euler angles come back continuous: the solution nearest the frame before, through turns, branches and gimbal lock."""

from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motionedit.core import rotations as rot
from motionedit.core.compiled import compiled, solver_name
from motionedit.core.euler import (
    DEGREES,
    GIMBAL_BAND,
    angles_near,
    joint_angles,
    other_solution,
    rows_of_tracks,
    solve_angles,
    solved_tracks,
)
from motionedit.core.euler_pieces import piece_angles, touched_angles, touched_pieces
from motionedit.core.motion import Motion
from motionedit.core.skeleton import Skeleton

ORDERS = list(permutations(range(3)))
ENOUGH = np.radians(2e-4)


@pytest.fixture
def rng():
    return np.random.default_rng(8)


def off(angles, q, axes):
    return rot.angle_between(rot.from_euler(angles, axes), q).max()


def walk(rng, frames, size, *, count=3):
    return np.cumsum(rng.normal(scale=size, size=(frames, count)), axis=0)


def slowly(q, axes, seed):
    """Return the solution nearest the frame before, frame by frame, out of all candidates."""
    result = []
    for first in solve_angles(q.T, axes).T:
        both = [first, other_solution(first)]
        near = [angles - 2 * np.pi * np.rint((angles - seed) / (2 * np.pi)) for angles in both]
        seed = min(near, key=lambda angles: np.abs(angles - seed).sum())
        result.append(seed)
    return np.array(result)


@pytest.mark.parametrize("axes", ORDERS)
def test_both_solutions_are_the_rotation(axes, rng):
    q = rot.normalize(rng.normal(size=(500, 4)))
    first = solve_angles(q.T, axes)
    assert np.abs(first[1]).max() <= np.pi / 2
    assert off(first.T, q, axes) < 1e-14
    assert off(other_solution(first).T, q, axes) < 1e-14
    order = "".join("XYZ"[axis] for axis in axes)
    theirs = Rotation.from_quat(q, scalar_first=True).as_euler(order)
    np.testing.assert_allclose(np.exp(1j * first.T), np.exp(1j * theirs), atol=1e-12)


@pytest.mark.parametrize("axes", ORDERS)
def test_a_continuous_track_comes_back_as_it_was(axes, rng):
    track = walk(rng, 2000, 0.15)
    np.testing.assert_allclose(angles_near(rot.from_euler(track, axes), axes, seed=track[0]), track, atol=1e-10)


@pytest.mark.compiled
@pytest.mark.parametrize("axes", [*ORDERS, (1, 2), (0,)])
@pytest.mark.parametrize("size", [0.05, 0.5, 3.0])
def test_the_compiled_choice_is_that_of_numpy_to_the_bit(axes, size, rng, monkeypatch):
    q = rot.from_euler(walk(rng, 400, size, count=len(axes)), axes)
    seed = rng.uniform(-9.0, 9.0, size=len(axes))
    compiled = angles_near(q, axes, seed=seed)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    np.testing.assert_array_equal(compiled, angles_near(q, axes, seed=seed))


@pytest.mark.compiled
@pytest.mark.parametrize("axes", [*ORDERS, (1, 2)])
def test_tracks_in_blocks_are_those_of_numpy_to_the_bit(axes, rng, monkeypatch):
    q = rot.normalize(rng.normal(size=(4000, 5, 4)))
    solved = solved_tracks(q, np.array([4, 0, 3]), axes)
    np.testing.assert_array_equal(solved[:, 1], solve_angles(q[:, 0].T, axes))
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    np.testing.assert_array_equal(solved, solved_tracks(q, np.array([4, 0, 3]), axes))


@pytest.mark.compiled
def test_tracks_laid_out_as_rows_are_those_of_numpy_to_the_bit(rng, monkeypatch):
    tracks, columns = rng.normal(size=(3, 2, 77)), np.array([[4, 0], [6, 1], [3, 5]])
    compiled_rows, numpys = np.full((77, 8), 7.0), np.full((77, 8), 7.0)
    rows_of_tracks(tracks, columns, factor=DEGREES, out=compiled_rows)
    monkeypatch.setenv("MOTIONEDIT_SOLVER", "numpy")
    rows_of_tracks(tracks, columns, factor=DEGREES, out=numpys)
    np.testing.assert_array_equal(compiled_rows, numpys)
    np.testing.assert_array_equal(compiled_rows[:, 6], np.degrees(tracks[1, 0]))
    assert (compiled_rows[:, [2, 7]] == 7.0).all()


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
@pytest.mark.parametrize("column", [-1, 4])
def test_rows_without_such_a_column_are_an_error_and_no_crash(column):
    with pytest.raises(ValueError, match="4 columns"):
        compiled().rows_of_tracks(np.zeros((2, 9)), np.array([0, column]), 9, 1.0, np.empty((9, 4)))
    with pytest.raises(ValueError, match="tracks"):
        compiled().rows_of_tracks(np.zeros((1, 9)), np.array([0, 1]), 9, 1.0, np.empty((9, 4)))


@pytest.mark.skipif(solver_name() == "numpy", reason="nothing compiled here")
def test_wrong_sizes_axes_and_joints_are_errors_and_no_crash():
    q, sums = np.zeros((2, 3, 4)), np.empty((6, 1, 2))
    for joint, axes, out in ((3, (0, 1, 2), sums), (-1, (0, 1, 2), sums), (0, (0, 1, 1), sums), (0, (0, 1, 2), q)):
        with pytest.raises(ValueError, match=r"joints|axes|sums"):
            compiled().euler_sums(q, 3, np.array([joint]), *axes, out)
    for tangents, axes in ((np.zeros(5), (0, 1, 2)), (np.zeros(6), (0, 3, 1))):
        with pytest.raises(ValueError, match=r"tangents|axes"):
            compiled().from_tangents(tangents, *axes, np.empty((2, 4)))


@pytest.mark.parametrize("size", [0.3, 1.5, 10.0])
def test_the_running_choice_is_the_choice_frame_by_frame(size, rng):
    q = rot.from_euler(walk(rng, 1500, size), (2, 0, 1))
    seed = rng.uniform(-9.0, 9.0, size=3)
    np.testing.assert_allclose(angles_near(q, (2, 0, 1), seed=seed), slowly(q, (2, 0, 1), seed), atol=1e-9)


def test_the_seed_decides_the_branch_and_the_turn(rng):
    track = walk(rng, 50, 0.05) + np.array([1.0, 0.2, -0.5])
    q = rot.from_euler(track, (2, 0, 1))
    turned = track + 2 * np.pi * np.array([3, -1, 0])
    np.testing.assert_allclose(angles_near(q, (2, 0, 1), seed=turned[0]), turned, atol=1e-12)
    other = other_solution(track.T).T
    np.testing.assert_allclose(angles_near(q, (2, 0, 1), seed=other[0]), other, atol=1e-12)


@pytest.mark.parametrize("axes", ORDERS)
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_at_gimbal_lock_the_last_angle_stays_and_the_rotation_is_kept(axes, sign, rng):
    track = walk(rng, 60, 0.02)
    track[:, 1] = sign * np.pi / 2 * 0.9
    track[20:40, 1] = sign * (np.pi / 2 - np.linspace(-0.99, 0.99, 20) * GIMBAL_BAND)
    # The outer angles may run away together there, and hardly turn the joint.
    parity = 1.0 if (axes[1] - axes[0]) % 3 == 1 else -1.0
    run_away = np.linspace(0.0, 2.5, 20)
    track[20:40] += np.column_stack((-sign * parity * run_away, np.zeros(20), run_away))
    q = rot.from_euler(track, axes)
    assert rot.angle_between(q[20:39], q[21:40]).max() < 0.2
    angles = angles_near(q, axes, seed=track[0])
    assert off(angles, q, axes) < ENOUGH
    np.testing.assert_array_equal(angles[20:40, 2], np.full(20, angles[19, 2]))
    assert np.abs(np.diff(angles[:40], axis=0)).max() < 0.7


def test_a_clip_that_is_at_gimbal_lock_throughout_keeps_the_seed(rng):
    track = np.column_stack((walk(rng, 30, 0.1, count=1), np.full(30, np.pi / 2), np.full(30, 0.4)))
    angles = angles_near(rot.from_euler(track, (2, 0, 1)), (2, 0, 1), seed=track[0])
    np.testing.assert_allclose(angles, track, atol=1e-7)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_one_channel_gives_the_angle_about_its_axis(axis, rng):
    track = walk(rng, 300, 0.4, count=1)
    q = rot.from_euler(track, (axis,)) * rng.choice([-1.0, 1.0], size=(300, 1))
    np.testing.assert_allclose(angles_near(q, (axis,), seed=track[0]), track, atol=1e-12)


@pytest.mark.parametrize("axes", [order[:2] for order in ORDERS])
def test_two_channels_give_the_nearest_rotation(axes, rng):
    track = walk(rng, 300, 0.2, count=2)
    np.testing.assert_allclose(angles_near(rot.from_euler(track, axes), axes, seed=track[0]), track, atol=1e-12)
    q = rot.normalize(rng.normal(size=(40, 4)))
    best = angles_near(q, axes, seed=np.zeros(2))
    grid = np.stack(np.meshgrid(*[np.linspace(-np.pi, np.pi, 121)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    candidates = rot.from_euler(grid, axes)
    for frame in range(40):
        least = rot.angle_between(candidates, q[frame]).min()
        assert rot.angle_between(rot.from_euler(best[frame], axes), q[frame]) <= least + 1e-12


def test_joint_angles_fill_every_column():
    skeleton = Skeleton(
        ("a", "b", "c", "d"),
        np.array([-1, 0, 1, 2]),
        np.zeros((4, 3)),
        (
            ("Yposition", "Zrotation", "Xrotation", "Yrotation"),
            ("Xrotation", "Zposition", "Yrotation"),
            (),
            ("Yrotation",),
        ),
    )
    rng = np.random.default_rng(4)
    values = np.cumsum(rng.normal(scale=8.0, size=(100, 8)), axis=0)
    from channels import motion_from_channels

    motion = motion_from_channels(skeleton, values, frame_time=0.01)
    np.testing.assert_allclose(joint_angles(motion, start=values[0]), values, atol=1e-9)


AXES = (2, 0, 1)
SKELETON = Skeleton(("j",), np.array([-1]), np.zeros((1, 3)), (("Zrotation", "Xrotation", "Yrotation"),))


def solved(values, q, touched, *, size=None):
    """Return the channel values with the touched frames solved anew from rotations q, all at once or in pieces."""
    motion = Motion(SKELETON, q[:, None], np.empty((len(q), 0, 3)), 0.01)
    result = values.copy()
    if size is None:
        rows = np.empty((len(q), 3))
        touched_angles(motion, touched[:, None], given=lambda a, b: values[a:b], columns=np.arange(3), out=rows)
        result[touched] = rows[touched]
        return result
    pieces = touched_pieces(motion, touched[:, None], given=lambda a, b: values[a:b], size=size)
    for piece in pieces[0]:
        result[piece.start : piece.stop] = piece_angles(motion, 0, piece=piece)
    return result


def mask(frames, *spans):
    result = np.zeros(frames, dtype=bool)
    for start, stop in spans:
        result[start:stop] = True
    return result


def rotations_of(values):
    return rot.from_euler(np.radians(values), AXES)


def wrapped(values):
    """Return angles as many programs write them, between -180 and 180 degrees."""
    return values - 360.0 * np.rint(values / 360.0)


def test_several_runs_start_from_the_frame_before_each(rng):
    values = np.degrees(walk(rng, 300, 0.05))
    touched = mask(300, (0, 40), (100, 101), (150, 220), (280, 300))
    np.testing.assert_allclose(solved(values, rotations_of(values), touched), values, atol=1e-9)
    for size in (10, 64):
        np.testing.assert_allclose(solved(values, rotations_of(values), touched, size=size), values, atol=1e-9)


def test_a_run_in_which_the_input_wraps_meets_the_next_frame_by_wrapping_with_it():
    values = np.zeros((200, 3))
    values[:, 0] = np.linspace(0.0, 900.0, 200)
    values[:, 1] = 20.0
    file_values = wrapped(values)
    edited = values.copy()
    edited[20:150, 0] += 8.0 * np.hanning(130)
    touched = mask(200, (20, 150))
    result = solved(file_values, rotations_of(edited), touched)
    np.testing.assert_allclose(result, edited - (values - file_values), atol=1e-9)
    # To the clip's end nothing has to be met: the angles go on without a jump.
    result = solved(file_values, rotations_of(edited), mask(200, (20, 200)))
    assert np.abs(np.diff(result[20:], axis=0)).max() < 6.0


@pytest.mark.parametrize("size", [None, 16])
def test_an_edit_that_winds_the_other_way_round_meets_the_next_frame_all_the_same(size):
    values = np.zeros((120, 3))
    values[:, 0] = 30.0
    edited = values.copy()
    edited[10:100, 0] += np.linspace(0.0, 360.0, 90)
    result = solved(values, rotations_of(edited), mask(120, (10, 100)), size=size)
    assert off(np.radians(result), rotations_of(edited), AXES) < 1e-12
    assert np.abs(result[100] - result[99]).max() < 6.0
    steps = np.abs(np.diff(result, axis=0)).max(axis=1)
    assert np.count_nonzero(steps > 180.0) == 1


def test_an_edit_through_gimbal_lock_onto_the_other_branch_meets_the_next_frame():
    values = np.zeros((120, 3))
    values[:, 1] = 60.0
    edited = values.copy()
    edited[10:60, 1] = np.linspace(60.0, 120.0, 50)
    # The way back is by the other solution: the track ends on another branch than the input's.
    edited[60:100] = np.linspace([0.0, 120.0, 0.0], [180.0, 120.0, 180.0], 40)
    result = solved(values, rotations_of(edited), mask(120, (10, 100)))
    assert off(np.radians(result), rotations_of(edited), AXES) < ENOUGH
    assert np.abs(result[100] - result[99]).max() < 12.0


def test_an_edit_that_keeps_the_inputs_own_jump_at_its_end_is_left_alone():
    values = np.zeros((50, 3))
    values[:, 0] = wrapped(np.linspace(150.0, 208.8, 50))
    jump = int(np.argmax(np.abs(np.diff(values[:, 0])))) + 1
    result = solved(values, rotations_of(values), mask(50, (5, jump)))
    np.testing.assert_allclose(result, values, atol=1e-9)
