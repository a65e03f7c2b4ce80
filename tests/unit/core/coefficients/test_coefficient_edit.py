"""The edit of a whole clip by goals at single frames ([PC] 4.3), on made-up strokes."""

import numpy as np
import pytest
from human import skeleton_of, with_axes
from strokes import TIMELINE, database, model_of, place, stroke

from motionedit.core import kinematics
from motionedit.core import rotations as rot
from motionedit.core.coefficients.edit import edit_by_coefficients
from motionedit.core.coefficients.goal_chains import GoalRequest
from motionedit.core.coefficients.methods import GaussNewton, Likeliest
from motionedit.core.coefficients.prior import FADE
from motionedit.core.coefficients.projection import project, project_resampled, with_rows
from motionedit.core.kinematics import Effector
from motionedit.core.measure import Measure
from motionedit.core.timeline.warp import make_warp

HAND = 22
MAP = np.arange(23)


@pytest.fixture(scope="module")
def model():
    motions, hits = database()
    return model_of(motions, TIMELINE, hits)


def projected(model, motion, hit, *, resampled=False):
    alignment, warp, _, _ = place(motion, TIMELINE, hit=hit)
    if resampled:
        return project_resampled(motion, model, joint_map=MAP, alignment=alignment, warp=warp)
    return project(motion, model, joint_map=MAP, alignment=alignment, warp=warp, first=0)


def request_of(motion, frame, shift, *, joint=HAND, offset=(0.0, -0.15, 0.0), **changes):
    effector = Effector(joint, np.array(offset))
    at = kinematics.effector_positions(kinematics.forward(motion), effector)[frame]
    return GoalRequest(frame, effector, **{"position": at + shift, "rotation": None, **changes})


def edited(model, projection, requests, *, bound=50.0, residual="keep", first=0):
    return edit_by_coefficients(projection, model, requests, solver=GaussNewton(bound), residual=residual, first=first)


def place_of(motion, request):
    return kinematics.effector_positions(kinematics.forward(motion), request.effector)[request.frame]


@pytest.mark.parametrize(("frames", "hit"), [(60, 36.0), (75, 40.5), (241, 144.0)])
def test_a_goal_at_any_frame_is_met_in_the_clips_own_timing(model, frames, hit):
    motion = stroke(20, frames=frames, hit=hit / (frames - 1), noise=0.002)
    projection = projected(model, motion, hit)
    for frame in (int(hit), frames // 4):
        request = request_of(motion, frame, np.array([0.03, 0.0, -0.02]))
        edit = edited(model, projection, [request])
        assert len(edit.motion) == frames
        np.testing.assert_allclose(place_of(edit.motion, request), request.position, atol=1e-5)
        assert edit.changes[0].solution.iterations <= 12


def test_a_projection_knows_how_long_the_clip_lasts(model):
    motion = stroke(3, frames=71, hit=0.5)
    for resampled in (False, True):
        assert projected(model, motion, 35.0, resampled=resampled).seconds == pytest.approx(70 * motion.frame_time)


def test_a_clip_that_goes_on_beyond_the_timeline_comes_to_rest_at_its_ends_without_a_corner(model):
    motion = stroke(20, frames=160, frame_time=0.01)
    alignment, whole, _, _ = place(motion, TIMELINE, hit=90.0)
    part = make_warp(TIMELINE, first=30, last=140, events={"hit": 90.0}, label="stroke")
    views = [
        project(motion, model, joint_map=MAP, alignment=alignment, warp=warp, first=0).places for warp in (whole, part)
    ]
    frames = np.arange(160.0)
    np.testing.assert_array_equal(views[0], whole.to_timeline(frames))
    np.testing.assert_allclose(views[1][55:115], part.to_timeline(frames)[55:115], atol=0.05)
    assert (views[1] >= 0.0).all()
    assert (views[1] <= TIMELINE.frames - 1).all()
    assert (np.diff(views[1]) > 0.0).all()
    own, stopped = (np.abs(np.diff(places, 2)) for places in (views[1], part.to_timeline(frames)))
    for end in (slice(10, 50), slice(120, 158)):
        assert own[end].max() < 0.15 * stopped[end].max()


def test_the_axes_that_joints_have_do_not_matter():
    skeleton = skeleton_of(ends={})
    turns = rot.exp(2.0 * np.random.default_rng(5).normal(size=(len(skeleton), 3)))
    strokes, hits = database(skeleton=skeleton)
    strokes = [*strokes, stroke(20, skeleton=skeleton, noise=0.002)]
    ways = []
    for motions in (strokes, [with_axes(each, turns) for each in strokes]):
        motion, model = motions[-1], model_of(motions[:-1], TIMELINE, hits)
        request = request_of(motion, 36, np.array([0.1, 0.1, -0.08]), offset=np.zeros(3))
        solver, asked = Likeliest(0.3, None, most=0.3), projected(model, motion, 36.0)
        edit = edit_by_coefficients(asked, model, [request], solver=solver, residual="keep", first=0)
        ways.append(kinematics.forward(edit.motion).positions)
    np.testing.assert_allclose(ways[1], ways[0], atol=1e-6)


def test_no_shift_touches_nothing(model):
    motion = stroke(21, noise=0.01)
    edit = edited(model, projected(model, motion, 36.0), [request_of(motion, 36, np.zeros(3))])
    assert not edit.touched.any()
    assert not edit.moved.any()


def test_the_edit_carries_no_jerk_of_its_own(model):
    motion = stroke(22, frames=481, frame_time=1 / 400)
    request = request_of(motion, 288, np.array([0.05, 0.02, 0.0]))
    edit = edited(model, projected(model, motion, 288.0), [request])
    before, after = (
        np.abs(np.diff(kinematics.effector_positions(kinematics.forward(m), request.effector), 3, axis=0)).max()
        for m in (motion, edit.motion)
    )
    assert after < 1.3 * before


def test_components_between_goals_are_no_faster_than_what_fades():
    motions, hits = database(noise=0.1)
    noisy = model_of(motions, TIMELINE, hits)
    motion = stroke(22, frames=121, frame_time=1 / 100)
    projection = projected(noisy, motion, 72.0)

    def times_fading(shifts):
        """Return the third derivative of a change, rms, over that of a noise that correlates as the residual does."""
        requests = [request_of(motion, frame, np.array(shift)) for frame, shift in shifts.items()]
        solver = Likeliest(0.05, None, most=0.05)
        edit = edit_by_coefficients(projection, noisy, requests, solver=solver, residual="keep", first=0)
        for request in requests:
            np.testing.assert_allclose(place_of(edit.motion, request), request.position, atol=1e-5)
        change = rot.log(rot.between(motion.rotations, edit.motion.rotations))
        third = np.diff(change, 3, axis=0) / motion.frame_time**3
        return np.sqrt(np.mean(third**2) / np.mean(change**2)) / (np.sqrt(15.0) / FADE**3)

    one, two = {72: (0.0, 0.1, 0.0)}, {57: (0.0, 0.1, 0.0), 72: (0.0, -0.1, 0.0)}
    assert times_fading(two) < 1.0 < times_fading(one)


def test_a_clip_that_faces_elsewhere_gets_the_same_edit_turned(model):
    shift = np.array([0.04, 0.01, 0.02])
    results = []
    for heading in (0.0, 2.0):
        motion = stroke(23, heading=heading)
        turn = rot.about_axis(1, np.array(heading))
        request = request_of(motion, 36, rot.rotate(turn, shift))
        results.append(edited(model, projected(model, motion, 36.0), [request]).motion.rotations[:, 1:])
    np.testing.assert_allclose(rot.angle_between(results[0], results[1]), 0.0, atol=1e-6)


def test_a_goal_along_other_axes_and_in_another_joints_frame_is_met(model):
    motion = stroke(24)
    projection = projected(model, motion, 36.0)
    poses = kinematics.forward(motion)
    turned = rot.to_matrix(rot.exp(np.array([0.3, 0.5, -0.2])))
    hand = kinematics.effector_positions(poses, Effector(HAND, np.zeros(3)))[36]
    along = request_of(
        motion,
        36,
        0.0,
        offset=(0, 0, 0),
        measure=Measure(turned, (0,)),
        position=turned @ hand + np.array([0.03, 0.0, 0.0]),
    )
    result = place_of(edited(model, projection, [along]).motion, along)
    assert (turned @ result)[0] == pytest.approx(along.position[0], abs=1e-5)
    spine = 12
    inside = rot.rotate(rot.conjugate(poses.rotations[36, spine]), hand - poses.positions[36, spine])
    further, seen_from = inside + np.array([0.02, 0.01, 0.0]), Measure(base=spine)
    relative = request_of(motion, 36, 0.0, offset=(0, 0, 0), position=further, measure=seen_from)
    after = kinematics.forward(edited(model, projection, [relative]).motion)
    seen = rot.rotate(rot.conjugate(after.rotations[36, spine]), after.positions[36, HAND] - after.positions[36, spine])
    np.testing.assert_allclose(seen, relative.position, atol=1e-5)


def test_an_orientation_goal_is_met(model):
    motion = stroke(25)
    now = kinematics.forward(motion).rotations[36, HAND]
    wanted = rot.multiply(rot.exp(np.radians([4.0, -3.0, 2.0])), now)
    request = request_of(motion, 36, 0.0, position=None, rotation=wanted)
    edit = edited(model, projected(model, motion, 36.0), [request])
    after = kinematics.forward(edit.motion).rotations[36, HAND]
    assert np.degrees(rot.angle_between(after, wanted)) < 0.01


def test_frames_of_a_rest_pose_stay_as_they_are(model):
    motion = stroke(26)
    edit = edited(model, projected(model, motion, 36.0), [request_of(motion, 36, np.array([0.05, 0, 0]))], first=2)
    assert not edit.touched[:2].any()
    assert edit.touched[2:-1, HAND].all()  # the strokes end alike


def test_without_the_residual_the_output_lies_in_the_space_of_the_components(model):
    motion = stroke(27, noise=0.02)
    projection = projected(model, motion, 36.0, resampled=True)
    request = request_of(projection.motion, 36, np.array([0.02, 0.0, 0.0]))
    edit = edited(model, projection, [request], residual="drop")
    alignment, warp, _, _ = place(motion, TIMELINE, hit=36.0)
    again = project_resampled(
        edit.motion,
        model,
        joint_map=MAP,
        alignment=alignment,
        warp=type(warp)(np.array([0.0, 60.0]), np.array([0.0, 60.0])),
    )
    rebuilt = model.mean_rows + np.tensordot(again.coefficients, model.component_rows, axes=1)
    np.testing.assert_allclose(again.rows, rebuilt, atol=1e-9)
    np.testing.assert_allclose(again.coefficients, edit.coefficients, atol=1e-9)
    np.testing.assert_allclose(place_of(edit.motion, request), request.position, atol=1e-5)


def test_rows_put_back_unchanged_are_the_motion(model):
    motion = stroke(28, heading=1.0)
    projection = projected(model, motion, 36.0)
    again = with_rows(projection, model.space, projection.rows)
    np.testing.assert_allclose(kinematics.forward(again).positions, kinematics.forward(motion).positions, atol=1e-12)
