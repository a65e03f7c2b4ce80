"""What a report says of goals and constraints becomes marks on the bodies of a page."""

import numpy as np
import pytest
from mannequin import bvh_text

from motionedit.core.body.center_of_mass import center_of_mass, find_masses
from motionedit.core.bvh import parse_clip
from motionedit.core.kinematics import Effector, effector_positions
from motionedit.errors import UsageError
from motionedit.jobs.preview import job as preview
from motionedit.jobs.preview.marks import edit_of

HAND = {"joint": "LeftHand", "offset": [0.0, 0.0, 0.0]}


def figures(*clips):
    read = [parse_clip(bvh_text(**options).encode(), label=f"{i}.bvh") for i, options in enumerate(clips)]
    return preview._figures(read, [clip.label for clip in read], {})


def constraint(**more):
    return {
        "name": "hand",
        "type": "position",
        "priority": 4,
        "error_max": 0.3,
        "tolerance": 0.5,
        "tolerance_angle": None,
        "status": "ok",
        "gave_way_to": [],
        "first_frame": 2,
        "last_frame": 4,
        "effector": HAND,
        "points": [{"mode": "hold", "first": 3, "last": 4}],
        "frames": {"error": [0.1, 0.2, 0.3], "error_angle": None, "target": [[1, 2, 3], [4, 5, 6], [7, 8, 9]]},
        **more,
    }


def marks(*constraints, clips=({}, {}), before=0, masses=None, **record):
    shown = figures(*clips)
    edited = len(clips) - 1
    record = {"status": "ok", "message": None, "unit": "cm", "constraints": constraints, **record}
    edit = edit_of(record, shown, edited=edited, before=before, masses=masses or {}, report="r.json")
    return shown, edit.marks


def test_a_constraint_keeps_its_frames_places_and_errors():
    _, (mark,) = marks(constraint())
    assert (mark.first, mark.last, mark.spans[0].first, mark.lengths.tolerance) == (2, 4, 3, 0.5)
    np.testing.assert_array_equal(mark.lengths.values, [0.1, 0.2, 0.3])
    np.testing.assert_array_equal(mark.places, [[1, 2, 3], [4, 5, 6], [7, 8, 9]])
    assert mark.angles is None


def test_the_most_important_stands_first_and_equals_in_the_order_of_the_spec():
    _, found = marks(*(constraint(name=name, priority=p) for name, p in (("a", 1), ("b", 10), ("c", 10), ("d", 5))))
    assert [mark.name for mark in found] == ["b", "c", "d", "a"]


def test_a_goal_is_a_mark_of_one_frame():
    goal = {**constraint(), "frame": 7, "error_angle_max": None, "target": [1, 2, 3]}
    _, (mark,) = marks(constraints=None, goals=[goal])
    assert (mark.kind, mark.first, mark.last, mark.spans[0].mode) == ("goal", 7, 7, "at")
    np.testing.assert_array_equal(mark.places, [[1, 2, 3]])
    np.testing.assert_array_equal(mark.lengths.values, [0.3])


@pytest.mark.parametrize(("off", "name"), [(0.005, "Club (end site)"), (0.02, "")])
def test_an_offset_is_that_of_an_end_site_to_a_ten_thousandth_of_the_leg(off, name):
    shown, (mark,) = marks(constraint(effector={"joint": "Club", "offset": [off, -70.0, 55.0]}))
    assert [shown[body].body.names[point] for body, point in mark.points] == [name, name]
    shown, (mark,) = marks(constraint(effector={"joint": "Club", "offset": [off, 0.0, 0.0]}))
    assert [shown[body].body.names[point] for body, point in mark.points] == ["Club" if name else ""] * 2


def test_an_effector_is_a_joint_an_end_site_or_a_point_of_its_own_in_both_clips():
    site = {"joint": "Club", "offset": [0.0, -70.0, 55.0]}
    point = {"joint": "Club", "offset": [0.0, -35.0, 0.0]}
    shown, found = marks(*(constraint(effector=effector) for effector in (HAND, site, point)))
    names = shown[1].body.names
    assert [names[mark.points[0][1]] for mark in found] == ["LeftHand", "Club (end site)", ""]
    assert [[body for body, _ in mark.points] for mark in found] == [[1, 0]] * 3
    for body, index in found[2].points:
        facts = shown[body].facts
        joint = facts.clip.motion.skeleton.names.index("Club")
        path = effector_positions(facts.poses, Effector(joint, np.array(point["offset"])))
        np.testing.assert_allclose(shown[body].body.positions[:, index], path)


def test_balance_is_at_the_center_of_mass_with_the_masses_of_the_spec():
    com = constraint(type="com", effector=None)
    shown, (mark,) = marks(com, masses={"Head": 4.0, "Spine": 1.0, "Nobody": 9.0})
    facts = shown[1].facts
    names = facts.clip.motion.skeleton.names
    given = {names.index("Head"): 4.0, names.index("Spine"): 1.0}
    path = center_of_mass(facts.poses, find_masses(facts.clip.motion.skeleton, facts.anatomy, given=given))
    np.testing.assert_allclose(shown[1].body.positions[:, mark.points[0][1]], path)


def test_places_are_turned_and_sized_as_the_bodies_are():
    _, (mark,) = marks(constraint(), clips=({}, {"z_up": True, "scale": 0.01}))
    x, y, z = 100.0 * np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(mark.places[0], [x, z, -y], rtol=1e-3)


def test_an_effector_on_a_clip_in_other_axes_lies_where_its_joint_does():
    shown, (plain, moved) = marks(
        constraint(),
        constraint(effector={"joint": "LeftHand", "offset": [1.0, 0.0, 0.0]}),
        clips=({}, {"z_up": True, "scale": 0.01}),
    )
    body = shown[1].body
    away = body.positions[:, plain.points[0][1]] - body.positions[:, moved.points[0][1]]
    np.testing.assert_allclose(np.linalg.norm(away, axis=1), body.scale, rtol=1e-6)


def test_a_clip_without_its_input_shows_the_edited_path_alone():
    _, (mark,) = marks(constraint(), clips=({},), before=None)
    assert [body for body, _ in mark.points] == [0]


@pytest.mark.parametrize(
    "wrong",
    [
        {"last_frame": 12},
        {"first_frame": 10, "last_frame": 12},
        {"first_frame": -1},
        {"frames": {}},
        {"frames": None},
        {"frames": {"error": [1.0], "error_angle": None, "target": None}},
        {"frames": {"error": None, "error_angle": None, "target": [[1, 2]] * 3}},
        {"frames": {"error": ["x"] * 3, "error_angle": None}},
        {"effector": {"joint": "Tail", "offset": [0, 0, 0]}},
        {"effector": "LeftHand"},
        {"gave_way_to": None},
        {"points": [{"mode": "hold"}]},
        {"priority": "high"},
    ],
    ids=str,
)
def test_a_record_of_another_clip_or_another_form_is_refused(wrong):
    with pytest.raises(UsageError, match=r"^r\.json: does not fit 1\.bvh"):
        marks(constraint(**wrong))


def test_a_report_without_places_still_has_its_intervals_and_errors():
    old = constraint()
    del old["effector"], old["points"], old["frames"]["target"]
    _, (mark,) = marks(old)
    assert (mark.places, mark.points, mark.spans, mark.first) == (None, (), (), 2)
