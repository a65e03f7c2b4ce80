"""The claims of [PC], one test each, on the golf swings of data/."""

from pathlib import Path

import numpy as np
import pytest

import motionedit
from motionedit.core.bvh import read_clip, resampled_bytes
from motionedit.core.coefficients.chain import evaluate
from motionedit.core.motion import Motion
from motionedit.core.pca.model_file import read_model
from studies.lab import effector_path, joint_positions
from studies.paper.pc_pose_space import by_poses
from studies.paper.study import COMPONENTS_ALONE, GOLF, Study
from studies.paper.truth import paired

BALLS = Path(__file__).resolve().parents[2] / "data" / "golf" / "balls.tsv"
STYLES = tuple(int(line.split("\t")[1]) for line in BALLS.read_text().splitlines()[1:])


@pytest.fixture(scope="module")
def model(golf):
    return read_model(golf.model)


def head(path):
    return effector_path(path, "Club", end_site=True)


def test_a_pose_has_93_degrees_of_freedom_and_a_motion_as_many_poses_as_the_mean_duration(golf, model):
    assert model.space.size == 93
    seconds = [read_clip(clip).motion.duration for clip in golf.swings]
    assert model.timeline.frames == round(np.mean(seconds) * 25.0) + 1
    assert model.component_rows.shape[1:] == (model.timeline.frames, 93)


def test_ten_motions_make_nine_components_the_tenth_is_negligible(model):
    assert len(model.components.explained_variance) == 9
    assert model.components.explained_variance_ratio.sum() == pytest.approx(1.0, abs=1e-12)


def test_all_motions_hit_at_the_same_normalized_frame(golf, model):
    frame = dict(model.timeline.events)["hit"]
    folder = golf.lab.place()
    for clip in golf.swings:
        same = golf.edit(clip, timing="normalized")
        heights = head(same.path)[:, 1]
        window = slice(frame - 12, frame + 13)
        assert abs(int(np.argmin(heights[window])) - 12) <= 1
    assert folder.exists()


def test_motions_of_one_style_cluster_in_the_first_two_coefficients(model):
    # Figure 6: the styles' centres lie further apart than their members from their own centre.
    alpha = model.components.coefficients[:, :3]
    centres = np.stack([alpha[[s == style for s in STYLES]].mean(axis=0) for style in (1, 2, 3)])
    nearest = 1 + np.argmin(np.linalg.norm(alpha[:, None] - centres, axis=-1), axis=1)
    assert sum(int(n == s) for n, s in zip(nearest, STYLES, strict=True)) >= 8


def test_one_constraint_at_one_frame_moves_the_whole_clip_without_a_break(golf):
    clip = golf.swings[3]
    edit = golf.edit(clip, (0.0, 0.0, 10.0))
    moved = np.linalg.norm(head(edit.path) - head(clip), axis=1)
    frame = edit.record["goals"][0]["frame"]
    assert moved[frame] == pytest.approx(10.0, abs=1e-3)
    bodies = [joint_positions(path) for path in (clip, edit.path)]
    # One point may cross its own old path; the body as a whole is somewhere else at every frame.
    assert np.linalg.norm(bodies[1] - bodies[0], axis=-1).max(axis=1).min() > 0.5
    before, after = (np.abs(np.diff(body, 3, axis=0)).max() for body in bodies)
    assert after < 1.5 * before


def test_an_edited_swing_keeps_its_style(golf):
    # Figures 6 and 7: the goals are other swings' balls, the edited swing stays in its own cluster.
    hits = {clip.stem: head(clip)[golf.edit(clip).record["goals"][0]["frame"]] for clip in golf.swings}
    style = {clip.stem: s for clip, s in zip(golf.swings, STYLES, strict=True)}
    kept = total = 0
    for clip in golf.swings[:5]:
        for ball in hits.values():
            if np.linalg.norm(ball - hits[clip.stem]) < 10.0:
                edit = golf.edit(clip, goal={"position": list(map(float, ball))})
                total += 1
                kept += style[edit.record["nearest"]["after"]] == style[clip.stem]
    assert total >= 10
    assert kept / total >= 0.8


def test_the_jacobian_has_as_many_columns_as_there_are_components(model):
    # Figure 1: p x m in place of p x n.
    from motionedit.core.coefficients.chain import CoefficientChain

    count = len(model.components.explained_variance)
    chain = CoefficientChain(
        np.eye(3),
        np.zeros(3),
        np.zeros((1, 3)),
        np.eye(3)[None],
        np.zeros((1, 3)),
        np.zeros((1, 3, count)),
        np.zeros((3, count)),
        np.zeros(3),
    )
    assert evaluate(chain, np.zeros(count)).position_rows.shape == (3, 9)


def damped(golf, clip, components, **solver):
    spec = {"solver": {"method": "damped", **solver}, "components": components}
    return golf.edit(clip, (0.0, 0.0, 6.0), **spec).record


def test_more_components_converge_in_fewer_iterations(golf):
    # Table 1: thousands of iterations below five components, hundreds from seven on; the counts are the data's own.
    few, many = (
        np.median([damped(golf, clip, m, max_iterations=3000)["iterations"] for clip in golf.swings[:4]])
        for m in (2, 9)
    )
    assert few > 4 * many


def test_without_damping_a_goal_is_met_in_less_than_twelve_iterations(golf):
    for clip in golf.swings:
        record = golf.edit(clip, (0.0, 0.0, 8.0), solver={"method": "gauss-newton"}).record
        assert record["status"] == "ok"
        assert record["iterations"] < 12


def test_damping_is_slower_and_ends_within_a_centimetre(golf):
    record = damped(golf, golf.swings[0], 8)
    assert record["stopped"] == "converged"
    assert record["iterations"] > 12
    assert record["goals"][0]["error_max"] <= 1.0
    assert all(b <= a for a, b in zip(record["history"], record["history"][1:], strict=False))


def test_an_unreachable_goal_ends_at_the_edge_of_what_the_database_knows(golf):
    record = golf.edit(golf.swings[0], (0.0, 0.0, 150.0), solver={"method": "gauss-newton"}).record
    assert record["status"] == "unreachable"
    assert record["mahalanobis"]["after"] <= record["mahalanobis"]["bound"] * (1 + 1e-4)
    assert record["goals"][0]["error_max"] < 150.0


def test_eq_3_alone_is_the_papers_output_on_the_timeline(golf, model):
    edit = golf.edit(golf.swings[2], (0.0, 0.0, 5.0), residual="drop", timing="normalized")
    motion = read_clip(edit.path).motion
    assert len(motion) == model.timeline.frames
    assert motion.frame_rate == pytest.approx(25.0)
    frame = edit.record["goals"][0]["frame"]
    assert frame == dict(model.timeline.events)["hit"]
    assert edit.record["goals"][0]["error_max"] < 1e-2


def test_without_damping_algorithm_1_is_eq_10_with_the_plain_pseudo_inverse(golf):
    # Section 6.1: xi = 0 takes less than twelve iterations, and far goals take it out of what the database knows.
    for clip in golf.swings[:4]:
        near = golf.edit(clip, (0.0, 0.0, 10.0), solver={"method": "damped", "damping": 0.0}).record
        far = golf.edit(clip, (0.0, 0.0, 45.0), solver={"method": "damped", "damping": 0.0}).record
        for record in (near, far):
            assert record["stopped"] == "converged"
            assert record["iterations"] < 12
        assert far["mahalanobis"]["after"] > 3.0 * far["mahalanobis"]["database_max"]


def test_eq_8_in_the_space_of_poses_meets_the_goal_at_its_frame_alone(golf):
    study = Study(golf.lab)
    edit = by_poses(study, 3, np.array([10.0, 0.0, 10.0]), damping=10.0)
    moved = np.linalg.norm(head(edit.path) - head(golf.swings[3]), axis=1)
    assert moved[study.hits[3]] == pytest.approx(np.hypot(10.0, 10.0), abs=1.0)
    assert np.delete(moved, study.hits[3]).max() == 0.0


def test_the_key_frame_is_the_mean_and_the_duration_too(golf, model):
    # Eq. (13) and (14), with the last sample counted.
    study = Study(golf.lab)
    motions = [read_clip(clip).motion for clip in golf.swings]
    assert model.timeline.frames == round(np.mean([m.duration for m in motions]) * 25.0) + 1
    shares = [hit / (len(m) - 1) for hit, m in zip(study.hits, motions, strict=True)]
    assert dict(model.timeline.events)["hit"] == round(np.mean(shares) * (model.timeline.frames - 1))


FOUR = tuple(
    {"name": f"g{k}", "at": at, "effector": {"end_site": "Club"}, "shift": shift}
    for k, (at, shift) in enumerate(((20, [0, 5, 0]), (50, [5, 0, 5]), ("hit", [8, 0, 0]), ("hit + 20", [0, 5, 0])))
)


@pytest.mark.parametrize("coefficients", ["constant", "per_goal"])
def test_section_7_goals_at_several_frames_are_all_met_together_or_interpolated(golf, coefficients):
    edit = golf.lab.edit(golf.swings[3], golf.model, {"goals": list(FOUR), "coefficients": coefficients})
    assert max(goal["error_max"] for goal in edit.record["goals"]) < 1e-2
    assert edit.record["metrics"]["foot_drift_max"] < 0.5
    assert edit.record["metrics"]["after"]["jerk_rms"] < 1.1 * edit.record["metrics"]["before"]["jerk_rms"]


def test_goals_at_several_frames_that_no_swing_goes_through_are_a_local_matter(golf):
    def share(goals, **spec):
        return golf.lab.edit(golf.swings[3], golf.model, {"goals": goals, **spec}).record["change"]["residual_share"]

    alone, *_ = [share([goal]) for goal in FOUR[:2]]
    astray = [{**goal, "shift": [0, 0, way]} for goal, way in zip(FOUR, (15, -15, 15, -15), strict=True)]
    assert share(astray) > 2.0 * alone
    assert share(astray, residual_share=0.1) == share(list(FOUR), residual_share=0.1) == 0.1


def test_section_7_of_goals_of_differing_priority_the_larger_is_met(golf):
    ahead = {"name": "ahead", "at": "hit", "effector": {"end_site": "Club"}, "shift": [10, 0, 0], "priority": 2}
    back = {**ahead, "name": "back", "shift": [-10, 0, 0], "priority": 1}
    record = golf.lab.edit(golf.swings[3], golf.model, {"goals": [back, ahead]}).record
    lower, upper = record["goals"]
    assert (upper["status"], lower["status"], lower["gave_way_to"]) == ("ok", "out_of_tolerance", ["ahead"])
    assert upper["error_max"] < 1e-2
    assert lower["error_max"] == pytest.approx(20.0, abs=0.01)


def test_a_swing_that_the_database_does_not_hold_comes_nearer_to_the_players_own(golf):
    lab = Study(golf.lab)
    swing, ball = 3, lab.near_balls(3, least=5.0, most=15.0)[0]
    model = golf.lab.model([clip for i, clip in enumerate(lab.swings) if i != swing], GOLF)
    truth = joint_positions(paired(lab, swing, lab.balls[ball]))
    goal, events = {"position": lab.balls[ball].tolist(), "at": lab.hits[swing]}, {"hit": lab.hits[swing]}
    apart = {}
    for name, spec in (("map", {}), ("gauss-newton", COMPONENTS_ALONE)):
        edit = lab.edit(swing, goal, model=model, events=events, **spec)
        apart[name] = np.sqrt(np.mean((joint_positions(edit.path) - truth) ** 2))
    assert apart["map"] < apart["gauss-newton"]


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_the_share_of_the_residual_may_be_nothing_or_all(golf, share):
    record = golf.edit(golf.swings[2], (0.0, 0.0, 5.0), residual_share=share).record
    assert record["goals"][0]["error_max"] < 1e-2
    before, after = (np.array(record["alpha"][side]) for side in ("before", "after"))
    assert np.allclose(before, after) == (share == 1.0)


def test_feet_are_left_to_the_solver_where_that_is_asked_for(golf):
    drifts = {
        feet: golf.edit(golf.swings[3], (0.0, 0.0, 10.0), feet=feet).record["metrics"]["foot_drift_max"]
        for feet in ("keep", "move", "off")
    }
    assert drifts["keep"] < 0.01 < drifts["move"] < drifts["off"]


def test_a_part_of_each_clip_may_be_normalized_and_edits_find_it_again(golf):
    crop = {"from": "hit - 1s", "to": "hit + 0.8s", **GOLF}
    model = golf.lab.model(golf.swings[:5], crop)
    assert read_model(model).timeline.frames == 46
    for shift in (0.0, 5.0):
        goal = {"at": "hit", "effector": {"end_site": "Club"}, "shift": [shift, 0.0, 0.0]}
        edit = golf.lab.edit(golf.swings[7], model, {"goals": [goal], "events": {"hit": 91}})
        assert edit.record["goals"][0]["error_max"] < 1e-2
        assert (edit.path.read_bytes() == golf.swings[7].read_bytes()) == (shift == 0.0)


def test_clips_cut_at_events_of_their_own_make_a_model_and_are_edited_at_these(golf):
    events = {name: {"frames": {clip.stem: f for clip in golf.swings[:4]}} for name, f in (("one", 30), ("next", 95))}
    folder = golf.lab.normalized(golf.swings[:4], {"from": "one", "to": "next", "events": events})
    model = motionedit.fit_pca(folder).write(golf.lab.place() / "cycle.npz")
    assert read_model(model).timeline.events == ()
    goal = {"at": "one + 1s", "effector": {"end_site": "Club"}, "shift": [3.0, 0.0, 0.0]}
    edit = golf.lab.edit(golf.swings[1], model, {"goals": [goal]})
    assert edit.record["goals"][0]["frame"] == 55
    assert edit.record["goals"][0]["error_max"] < 1e-2


def test_a_model_of_before_the_left_out_error_is_read_and_says_what_it_lacks(golf, tmp_path):
    with np.load(golf.model) as archive:
        kept = {name: archive[name] for name in archive.files if not name.startswith("left_out")}
    np.savez(tmp_path / "old.npz", **kept)
    goal = {"at": "hit", "effector": {"end_site": "Club"}, "shift": [5.0, 0.0, 0.0]}
    edit = golf.lab.edit(golf.swings[3], tmp_path / "old.npz", {"goals": [goal]})
    assert edit.record["change"]["residual_share"] == 0.25
    assert any("no left-out error" in warning for warning in edit.warnings)


def test_a_take_that_is_squeezed_into_a_stroke_is_never_ok(golf):
    clip = read_clip(golf.swings[3])
    slow = Motion(clip.motion.skeleton, clip.motion.rotations, clip.motion.translations, 5.0 * clip.motion.frame_time)
    path = golf.lab.place() / "slow.bvh"
    path.write_bytes(resampled_bytes(clip, slow))
    goal = {"at": "hit", "effector": {"end_site": "Club"}, "shift": [5.0, 0.0, 0.0]}
    edit = golf.lab.edit(path, golf.model, {"goals": [goal], "events": {"hit": 85}})
    assert edit.record["status"] == "rough"
    assert any("is it one of them?" in warning for warning in edit.warnings)
