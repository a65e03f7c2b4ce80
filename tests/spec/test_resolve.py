"""What a spec names, found in a clip, or the line where it is named."""

import time
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motionedit.core.motion import Motion
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.errors import MotionEditErrors, SpecError
from motionedit.jobs.clip import resolve
from motionedit.jobs.clip.events import event_frames, explicit_events
from motionedit.jobs.clip.resolve import Place
from motionedit.spec.faults import nearest
from motionedit.spec.values import EffectorSpec, parse_orientation

ROTATION = ("Zrotation", "Xrotation", "Yrotation")
SKELETON = Skeleton(
    names=("Hips", "Spine1", "mix:Head", "Toe", "Toe"),
    parents=np.array([-1, 0, 1, 0, 0]),
    offsets=np.zeros((5, 3)),
    channels=(("Xposition", "Yposition", "Zposition", *ROTATION), ROTATION, ROTATION, ROTATION, ROTATION),
    end_sites=(
        EndSite(2, np.array([0.0, 10.0, 0.0])),
        EndSite(1, np.array([1.0, 0.0, 0.0])),
        EndSite(1, np.array([2.0, 0.0, 0.0])),
    ),
)
TEXT = """\
goals:
  - at: hit
    effector: {joint: Spine1, offset: [1, 2, 3]}
    shift: [0, 0, 1]
  - at: 3
    effector:
      - Spin1
      - {end_site: Spine1, index: 2}
    shift: [0, 0, 1]
    relative_to: Head
"""


@pytest.fixture
def place(load):
    loaded = load(TEXT)
    return lambda *keys: Place(loaded, keys, "walk.bvh")


def refusal(call, *args, **kwargs):
    with pytest.raises(SpecError) as caught:
        call(*args, **kwargs)
    return str(caught.value)


def test_an_effector_is_a_joint_with_an_offset_or_one_of_its_end_sites(place):
    goal = place("goals", 0, "effector")
    plain = resolve.effector(EffectorSpec("Spine1"), SKELETON, goal)
    offset = resolve.effector(EffectorSpec("Spine1", (1.0, 2.0, 3.0)), SKELETON, goal)
    site = resolve.effector(EffectorSpec("Spine1", end_site=True, index=1), SKELETON, goal)
    assert [plain.joint, offset.joint, site.joint] == [1, 1, 1]
    assert [list(e.offset) for e in (plain, offset, site)] == [[0, 0, 0], [1, 2, 3], [2, 0, 0]]


def test_a_joint_that_the_clip_lacks_is_answered_with_the_line_and_the_nearest_name(place):
    loaded_goal = place("goals", 0, "effector").loaded.model.goals[1]
    found = refusal(resolve.effector, loaded_goal.effector, SKELETON, place(*loaded_goal.effector_keys))
    assert found == "spec.yaml:8: goals.1.effector.0: no joint 'Spin1' in walk.bvh; did you mean 'Spine1'?"


def test_the_prefix_of_a_rig_is_no_hindrance_to_the_hint(place):
    found = refusal(resolve.joint, "Head", SKELETON, place("goals", 1, "relative_to"))
    assert found == "spec.yaml:11: goals.1.relative_to: no joint 'Head' in walk.bvh; did you mean 'mix:Head'?"


def test_a_joint_like_no_other_is_answered_with_all_of_them(place):
    found = refusal(resolve.joint, "Zzz", SKELETON, place("goals", 1, "relative_to"))
    assert found.endswith("no joint 'Zzz' in walk.bvh; its joints are Hips, Spine1, mix:Head, Toe")


def test_a_part_that_the_rig_calls_otherwise_is_proposed_before_a_name_of_like_letters(place):
    def hint(name, *names):
        skeleton = Skeleton(names, np.arange(-1, len(names) - 1), np.zeros((len(names), 3)), ((),) * len(names), ())
        return refusal(resolve.joint, name, skeleton, place("goals", 1, "relative_to")).partition("; ")[2]

    assert nearest("LeftHand", ["LeftHip", "LeftWrist"]) == "LeftHip"
    assert hint("LeftHand", "Hips", "LeftHip", "LeftWrist") == "did you mean 'LeftWrist'?"
    assert hint("LeftHand", "x:LeftHip", "x:LeftWrist", "x:LeftHand") == "did you mean 'x:LeftHand'?"
    assert hint("LeftHnad", "Hips", "LeftHip", "LeftHand") == "did you mean 'LeftHand'?"
    assert hint("Club", "Hips", "LeftHip") == "its joints are Hips, LeftHip"


def test_all_joints_that_are_not_there_are_told_with_one_list(load):
    loaded = load("exclude_joints: [Hips, Zzz, Spine2, Yyy]", "fit-pca")
    with pytest.raises(MotionEditErrors) as caught:
        resolve.joints(loaded.model.exclude_joints, SKELETON, Place(loaded, ("exclude_joints",), "walk.bvh"))
    assert str(caught.value).splitlines() == [
        "spec.yaml:2: exclude_joints.1: no joint 'Zzz' in walk.bvh; its joints are Hips, Spine1, mix:Head, Toe",
        "spec.yaml:2: exclude_joints.2: no joint 'Spine2' in walk.bvh; did you mean 'Spine1'?",
        "spec.yaml:2: exclude_joints.3: no joint 'Yyy' in walk.bvh",
    ]


def test_a_name_that_has_but_letters_in_common_is_not_what_was_meant():
    assert nearest("Club", ["Hips", "LThumb"]) is None
    assert nearest("LeftHnad", ["Hips", "LeftHand"]) == "LeftHand"


def test_a_name_that_two_joints_share_is_refused(place):
    found = refusal(resolve.joint, "Toe", SKELETON, place("goals", 1, "relative_to"))
    assert found.endswith("walk.bvh has 2 joints named 'Toe'; a spec needs their names to differ")


@pytest.mark.parametrize(
    ("joint", "index", "expected"),
    [
        (
            "Spine1",
            2,
            "spec.yaml:9: goals.1.effector.1.index: 'Spine1' in walk.bvh has 2 end sites, index 0 to 1; not index 2",
        ),
        (
            "mix:Head",
            1,
            "spec.yaml:9: goals.1.effector.1.index: 'mix:Head' in walk.bvh has one end site, index 0; not index 1",
        ),
        ("Hips", 0, "spec.yaml:9: goals.1.effector.1.index: 'Hips' in walk.bvh has no end site; not index 0"),
    ],
)
def test_an_end_site_that_is_not_there_is_refused(joint, index, expected, place):
    spec = EffectorSpec(joint, end_site=True, index=index)
    assert refusal(resolve.effector, spec, SKELETON, place("goals", 1, "effector", 1)) == expected


def test_a_list_of_joints_is_answered_at_the_one_that_is_missing(load):
    loaded = load("exclude_joints: [Hips, Spine2]", "fit-pca")
    found = refusal(
        resolve.joints, loaded.model.exclude_joints, SKELETON, Place(loaded, ("exclude_joints",), "walk.bvh")
    )
    assert found == "spec.yaml:2: exclude_joints.1: no joint 'Spine2' in walk.bvh; did you mean 'Spine1'?"


@pytest.mark.parametrize("order", ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"])
def test_euler_values_are_about_x_y_z_in_the_order_of_bvh_channels(order):
    angles = dict(zip("XYZ", (10.0, -20.0, 35.0), strict=True))
    found = resolve.orientation(parse_orientation({"euler": list(angles.values()), "order": order}))
    expected = Rotation.from_euler(order, [angles[axis] for axis in order], degrees=True)
    assert angle(found, expected) < 1e-9


def test_a_rotation_vector_is_in_degrees_and_a_quaternion_is_made_a_unit_one():
    vector = resolve.orientation(parse_orientation({"rotation_vector": [0, 0, 90]}))
    quaternion = resolve.orientation(parse_orientation({"quaternion": [2, 0, 0, 2]}))
    expected = Rotation.from_rotvec([0, 0, 90], degrees=True)
    assert angle(vector, expected) < 1e-9
    assert angle(quaternion, expected) < 1e-9


def test_a_quaternion_is_a_unit_one_from_the_start():
    assert parse_orientation({"quaternion": [0, 3, 0, 4]}).values == (0.0, 0.6, 0.0, 0.8)


def angle(found, expected):
    w, x, y, z = found
    assert np.isclose(np.linalg.norm(found), 1.0)
    return (Rotation.from_quat([x, y, z, w]).inv() * expected).magnitude()


def motion_of(frames):
    """Return a motion of so many frames, 25 a second."""
    return Motion(SKELETON, np.zeros((frames, 5, 4)), np.zeros((frames, 1, 3)), 0.04)


def test_a_time_outside_the_clip_has_the_spec_s_line(place):
    time = place().loaded.model.goals[0].at
    there = resolve.frame(time, place("goals", 0, "at"), motion_of(50), events={"hit": 40.0})
    assert there == 40
    found = refusal(resolve.frame, time, place("goals", 0, "at"), motion_of(20), events={"hit": 40.0})
    assert found == "spec.yaml:3: goals.0.at: in walk.bvh: hit (frame 40) is outside the clip, whose frames are 0 to 19"
    found = refusal(resolve.frame, time, place("goals", 0, "at"), motion_of(20), events={})
    assert found == "spec.yaml:3: goals.0.at: in walk.bvh: no event 'hit'; there are no events"


def test_an_interval_outside_the_clip_has_the_spec_s_line(load):
    loaded = load("constraints:\n  - {type: pose, effector: A, points: [{hold: [3, 90]}]}", "edit-prioritized")
    hold = loaded.model.constraints[0].points[0].hold
    place = Place(loaded, ("constraints", 0, "points", 0, "hold"), "walk.bvh")
    assert resolve.frame_range(hold, place, motion_of(91), events={}) == (3, 90)
    found = refusal(resolve.frame_range, hold, place, motion_of(90), events={})
    assert (
        found
        == "spec.yaml:3: constraints.0.points.0.hold: in walk.bvh: 90 is outside the clip, whose frames are 0 to 89"
    )


def test_recruited_joints_may_name_the_root_s_translation(load):
    loaded = load(
        "defaults: {recruit: {joints: [Spine1]}}\nconstraints:\n"
        "  - {type: com, recruit: {joints: [Spine1, Hips.position]}}\n  - {type: com}\n",
        "edit-prioritized",
    )
    constraint = loaded.model.constraints[0]
    place = resolve.recruit_place(Place(loaded, constraint.keys, "walk.bvh")).at("joints")
    assert place.keys == ("constraints", 0, "recruit", "joints")
    assert resolve.recruited_joints(constraint.recruit.joints, SKELETON, place) == ((1,), True)
    assert resolve.recruited_joints(("Spine1", "Hips"), SKELETON, place) == ((1, 0), False)
    assert resolve.recruited_joints(("ROOT.position",), SKELETON, place) == ((), True)
    found = refusal(resolve.recruited_joints, ("Hips", "Spine1.position"), SKELETON, place)
    assert found == (
        "spec.yaml:4: constraints.0.recruit.joints.1: only the root has a position to recruit: Hips.position, "
        "not Spine1.position"
    )
    default = resolve.recruit_place(Place(loaded, loaded.model.constraints[1].keys, "walk.bvh"))
    assert default.keys == ("defaults", "recruit")


def test_a_constraint_that_recruits_all_has_its_own_place(load):
    loaded = load("constraints: [{type: com}]", "edit-prioritized")
    assert resolve.recruit_place(Place(loaded, ("constraints", 0), "walk.bvh")).keys == ("constraints", 0)


EVENTS = """\
events:
  every: 7
  found: {detect: {effector: Hips, minimum_of: speed}}
  hit:
    frames: {swing01: 1, sub/swing02: 2, swing03.BVH: 3, sub/swing04.bvh: 4, nobody: 5}
"""


class Clip(list):
    """A clip as far as times ask for it: its frames, of which 25 are a second."""

    frame_time = 0.04
    label = "walk.bvh"
    motion = property(lambda self: self)


def given_in(loaded, relative, *, others=()):
    """Return what a spec gives for a clip of 101 frames."""
    return explicit_events(loaded, Clip(range(101)), relative=relative, others=others)


@pytest.mark.parametrize(
    ("clip", "hit"),
    [
        *(("swing01.bvh", 1), ("deep/swing01.BVH", 1), ("swing01", 1), ("deep\\swing01.bvh", 1)),
        *(("sub/swing02.bvh", 2), ("swing02.bvh", None), ("other/swing02.bvh", None)),
        *(("swing03.BVH", 3), ("sub/swing03.BVH", 3)),
        *(("sub/swing04.bvh", 4), ("other.bvh", None)),
    ],
)
def test_a_clip_of_a_table_is_named_by_path_or_stem(clip, hit, load):
    found = given_in(load(EVENTS, "normalize"), clip)
    assert found == ({"every": 7} if hit is None else {"every": 7, "hit": hit})


@pytest.mark.parametrize(
    ("event", "frame"),
    [("2s", 50), ("50%", 50), ("100%", 100), ("'7'", 7), (" 1.5 s", 38), ("{frames: {a: 3s, b: 9}}", 75)],
)
def test_a_time_stands_where_a_frame_of_an_event_may(load, event, frame):
    for command in ("normalize", "edit-prioritized"):
        more = "" if command == "normalize" else "\nconstraints: []"
        assert given_in(load(f"events: {{hit: {event}}}{more}", command), "a.bvh") == {"hit": frame}


@pytest.mark.parametrize(("event", "key"), [("5s", "hit"), ("{frames: {a: 5s}}", "hit.frames.a")])
def test_a_time_of_an_event_outside_its_clip_is_refused(load, event, key):
    found = refusal(given_in, load(f"events: {{hit: {event}}}", "normalize"), "a.bvh")
    assert found == (
        f"spec.yaml:2: events.{key}: in walk.bvh: 5s (frame 125) is outside the clip, whose frames are 0 to 100"
    )


def test_a_stem_that_two_clips_share_is_refused(load):
    loaded = load(EVENTS, "normalize")
    clips = ("a/swing01.bvh", "b/swing01.bvh", "c/swing02.bvh")
    found = refusal(given_in, loaded, clips[0], others=clips)
    assert found == (
        "spec.yaml:6: events.hit.frames.swing01: 'swing01' may be a/swing01.bvh or b/swing01.bvh; give the clip's path"
    )
    assert given_in(loaded, clips[2], others=clips) == {"every": 7}


def test_a_name_that_is_another_clip_s_whole_path_is_not_this_one_s(load):
    clips = ("swing01.bvh", "b/swing01.bvh")
    loaded = load(EVENTS, "normalize")
    assert given_in(loaded, clips[0], others=clips) == {"every": 7, "hit": 1}
    assert given_in(loaded, clips[1], others=clips) == {"every": 7}


def test_an_event_outside_its_clip_is_refused(load):
    def events(loaded, clip, *, frames):
        facts = SimpleNamespace(first=0, last=frames - 1)
        known = given_in(loaded, clip)
        given = {name: event for name, event in loaded.model.events.items() if event.detect is None}
        return event_frames(given, facts, Place(loaded, ("events",), clip), known=known)

    loaded = load(EVENTS, "normalize")
    assert events(loaded, "swing01.bvh", frames=8) == {"every": 7, "hit": 1}
    found = refusal(events, loaded, "swing01.bvh", frames=7)
    assert found == "spec.yaml:3: events.every: in swing01.bvh: frame 7 is outside the take, whose frames are 0 to 6"
    found = refusal(events, load("events: {hit: {frames: {a: 7}}}", "normalize"), "a.bvh", frames=7)
    assert found == "spec.yaml:2: events.hit: in a.bvh: frame 7 is outside the take, whose frames are 0 to 6"


def test_a_clip_of_thousands_is_found_in_a_table_of_thousands_without_looking_at_all(load, tmp_path):
    clips = tuple(f"take{i}/swing{i}.bvh" for i in range(3000))
    (tmp_path / "hits.csv").write_text("clip,frame\n" + "".join(f"swing{i},{i}\n" for i in range(3000)))
    loaded = load("events: {hit: {frames: hits.csv}}", "normalize")
    started = time.process_time()
    found = [given_in(loaded, clip, others=clips)["hit"] for clip in clips]
    assert found == list(range(3000))
    assert time.process_time() - started < 5.0  # every clip beside every row takes a minute
