"""`motionedit info`: what is in a clip, as text and as JSON."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from channels import motion_from_channels

from motionedit.core import rotations as rot
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.core.kinematics import forward
from motionedit.core.skeleton import EndSite, Skeleton
from motionedit.spec.edit_pc import PcGoal

ROOT = ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation")
BONES = [
    ("Hips", -1, (0, 0, 0), ROOT),
    ("LeftUpLeg", 0, (10, 0, 0), ROOT[3:]),
    ("LeftLeg", 1, (0, -42, 0), ROOT[3:]),
    ("LeftFoot", 2, (0, -43, 0), ROOT[3:]),
    ("LeftToeBase", 3, (0, -6, 13), ROOT[3:]),
    ("RightUpLeg", 0, (-10, 0, 0), ROOT[3:]),
    ("RightLeg", 5, (0, -42, 0), ("Xrotation",)),
    ("RightFoot", 6, (0, -43, 0), ROOT[3:]),
    ("RightToeBase", 7, (0, -6, 13), ()),
    ("Spine", 0, (0, 30, 0), ("Yrotation", "Xrotation", "Zrotation")),
    ("LeftArm", 9, (18, 18, 0), ROOT[3:]),
    ("LeftForeArm", 10, (0, -29, 0), ROOT[3:]),
    ("LeftHand", 11, (0, -25, 0), ROOT[3:]),
    ("RightArm", 9, (-18, 18, 0), ROOT[3:]),
    ("RightForeArm", 13, (0, -29, 0), ROOT[3:]),
    ("RightHand", 14, (0, -25, 0), ROOT[3:]),
    ("Head", 9, (0, 30, 0), ROOT[3:]),
]
INDEX = {name: j for j, (name, *_) in enumerate(BONES)}


def skeleton():
    return Skeleton(
        names=tuple(name for name, *_ in BONES),
        parents=np.array([parent for _, parent, *_ in BONES]),
        offsets=np.array([offset for _, _, offset, _ in BONES], dtype=float),
        channels=tuple(channels for *_, channels in BONES),
        end_sites=(
            EndSite(INDEX["Head"], np.array([0.0, 20.0, 0.0])),
            EndSite(INDEX["RightHand"], np.array([0.0, -8.0, 0.0])),
            EndSite(INDEX["RightHand"], np.array([0.0, -92.0, 5.0])),
        ),
    )


def person(*, frames=60, facing=90.0):
    """Return somebody who turns slowly, bends the left knee, and stands; 100 Hz, centimetres."""
    body = skeleton()
    values = np.zeros((frames, body.channel_count))
    start = body.channel_starts
    values[:, :3] = [5.0, 93.0, -7.0]
    values[:, start[0] + 5] = facing
    values[:, start[INDEX["Spine"]] : start[INDEX["Spine"]] + 3] = [20.0, 10.0, 5.0]
    values[:, start[INDEX["RightForeArm"]]] = np.linspace(0.0, 60.0, frames)
    return motion_from_channels(body, values, frame_time=0.01)


def jumping(motion, joint, frame, degrees):
    rotations = motion.rotations.copy()
    rotations[frame:, INDEX[joint]] = rot.exp(np.radians([degrees, 0.0, 0.0]))
    return replace(motion, rotations=rotations)


@pytest.fixture
def write(tmp_path):
    def to(name, motion):
        (tmp_path / name).write_bytes(new_bytes(motion))
        return name

    return to


def fact(text, name):
    return re.search(rf"^  {name} +(.*)$", text, flags=re.MULTILINE)[1]


def test_the_facts_of_a_clip_are_told_with_their_names(run, write):
    result = run("info", write("stand.bvh", person()))
    assert (result.exit_code, result.stderr) == (0, "")
    text = result.stdout
    assert text.startswith("stand.bvh\n")
    assert fact(text, "frames") == "60, numbered 0 to 59"
    assert fact(text, "rate") == "100 Hz (0.01 s a frame)"
    assert fact(text, "duration") == "0.59 s"
    assert fact(text, "up") == "y"
    assert fact(text, "heading") == "90 degrees at frame 0, 0 faces +z"
    assert fact(text, "travel") == "carried by Hips"
    assert fact(text, "leg length").startswith("85 ")
    assert fact(text, "unit") == "likely cm (the leg is 0.85 m)"
    assert fact(text, "rest pose") == "none"
    assert fact(text, "defects") == "none"
    assert fact(text, "left leg") == "LeftUpLeg > LeftLeg > LeftFoot > LeftToeBase"
    assert fact(text, "right arm") == "RightArm > RightForeArm > RightHand"
    assert fact(text, "head") == "Head"
    assert fact(text, "hinges") == "LeftLeg about [1, 0, 0], 0 to 150 degrees"
    assert re.findall(r"^ {14}(\S+) about (.*)$", text, flags=re.MULTILINE) == [
        ("RightLeg", "[1, 0, 0], 0 to 150 degrees"),
        ("LeftForeArm", "[-1, 0, 0], 0 to 150 degrees"),
        ("RightForeArm", "[0, 0, 1], 0 to 150 degrees"),
    ]


def test_the_tree_has_every_joint_with_its_channels_in_their_order(run, write):
    text = run("info", write("stand.bvh", person())).stdout
    assert fact(text, "joints") == f"{len(BONES)}, {person().skeleton.channel_count} channels"
    lines = text[text.index("  joints ") :].splitlines()
    for name, _, offset, _ in BONES:
        (line,) = [line for line in lines if line.startswith("    ") and line.split()[0] == name]
        assert line.endswith("[" + ", ".join(map(str, offset)) + "]")
    assert re.search(r"^    Hips +position XYZ, rotation ZXY +\[0, 0, 0\]$", text, flags=re.MULTILINE)
    assert re.search(r"^      Spine +rotation YXZ ", text, flags=re.MULTILINE)
    assert re.search(r"^        RightLeg +rotation X ", text, flags=re.MULTILINE)
    assert re.search(r"^            RightToeBase +none ", text, flags=re.MULTILINE)
    assert re.search(r"^ +\(end site 1\) +\[0, -92, 5\]$", text, flags=re.MULTILINE)


def test_a_rest_pose_and_defects_are_told(run, write):
    motion = person()
    motion = jumping(motion, "LeftArm", 1, 80.0)
    motion = jumping(motion, "LeftHand", 30, 179.0)
    motion = jumping(motion, "Head", 40, 70.0)
    motion = jumping(motion, "Head", 50, 150.0)
    text = run("info", write("odd.bvh", motion)).stdout
    assert fact(text, "rest pose") == "frame 0, left out of all that follows"
    assert "degrees at frame 1," in fact(text, "heading")
    assert fact(text, "defects") == "LeftHand flips by 179 degrees into frame 30"
    assert "Head jumps 2 times, by 80 degrees into frame 50 (frames 40, 50)" in text


def test_poses_are_yaml_that_a_spec_takes_and_say_where_the_effector_is(run, write):
    clip = write("stand.bvh", person())
    effectors = ["Spine", "{joint: RightHand, offset: [0, -92, 0.5]}", "{end_site: RightHand, index: 1}"]
    options = [option for effector in effectors for option in ("--joint", effector)]
    text = run("info", clip, "--at", 40, "--at", "0.5s", "--at", "100%", *options).stdout
    goals = yaml.safe_load(text[text.index("# Poses") :])
    assert [goal["at"] for goal in goals] == [40] * 6 + [50] * 6 + [59] * 6
    assert [goal["effector"] for goal in goals[:6:2]] == [yaml.safe_load(effector) for effector in effectors]
    assert [goal["frame"] for goal in goals[:2]] == ["world", "heading"]
    motion = read_clip(Path(clip)).motion
    poses = forward(motion)
    local = {"RightHand": {0: [0.0, -92.0, 0.5], 1: [0.0, -92.0, 5.0]}, "Spine": {0: [0.0, 0.0, 0.0]}}
    for goal in goals:
        PcGoal.parse(goal)
        effector = goal["effector"] if isinstance(goal["effector"], dict) else {"joint": goal["effector"]}
        name = effector.get("joint") or effector["end_site"]
        j = INDEX[name]
        point = np.array(local[name][effector.get("index", 0)])
        position = poses.positions[goal["at"], j] + rot.rotate(poses.rotations[goal["at"], j], point)
        turn = poses.rotations[goal["at"], j]
        if goal["frame"] == "heading":
            # The person faces +x and stands at (5, ., -7): left is -z.
            x, y, z = position
            position = np.array([-(z + 7.0), y, x - 5.0])
            turn = rot.multiply(rot.exp(np.radians([0.0, -90.0, 0.0])), turn)
        np.testing.assert_allclose(goal["position"], position, atol=6e-4)
        order = goal["orientation"]["order"]
        assert order == ("YXZ" if name == "Spine" else "ZXY")
        axes = rot.euler_axes(order)
        told = rot.from_euler(np.radians(np.array(goal["orientation"]["euler"])[list(axes)]), axes)
        assert np.degrees(rot.angle_between(told, turn)) < 2e-3


def test_the_quaternion_beside_it_is_the_same_orientation(run, write):
    text = run("info", write("stand.bvh", person()), "--at", 3, "--joint", "Spine").stdout
    block = text[text.index("# Poses") :].splitlines()
    euler = yaml.safe_load(next(line for line in block if line.startswith("  orientation")))["orientation"]
    other = yaml.safe_load(next(line for line in block if line.startswith("  # orient"))[4:])["orientation"]
    axes = rot.euler_axes(euler["order"])
    turn = rot.from_euler(np.radians(np.array(euler["euler"])[list(axes)]), axes)
    assert np.degrees(rot.angle_between(turn, np.array(other["quaternion"]))) < 2e-3


def test_a_joint_without_three_axes_is_told_in_the_usual_order(run, write):
    text = run("info", write("stand.bvh", person()), "--at", 3, "--joint", "RightLeg").stdout
    assert "order: ZXY" in text


def test_contacts_list_the_plants_of_each_foot(run, write):
    text = run("info", write("stand.bvh", person()), "--contacts").stdout
    rows = [line.split() for line in text[text.index("contacts") :].splitlines()[1:] if line.strip()]
    whole = ["0", "to", "59", "0.600", "heel", "0", "to", "59;", "toe", "0", "to", "59"]
    assert rows == [[side, *whole] for side in ("left", "right")]
    assert "  contacts " not in run("info", "stand.bvh").stdout
    assert fact(run("info", write("short.bvh", person(frames=1)), "--contacts").stdout, "contacts") == "none"


def test_the_report_says_the_same(run, write):
    clip = write("stand.bvh", person())
    run("info", clip, "--contacts", "--at", 4, "--joint", "Head", "--report", "r.json")
    (entry,) = json.loads(Path("r.json").read_text())["clips"]
    assert entry["clip"] == clip
    assert entry["status"] == "ok"
    assert (entry["frames"], entry["up"], entry["travel_joint"]) == (60, "y", "Hips")
    assert entry["heading"] == pytest.approx(90.0)
    assert entry["leg_length"] == pytest.approx(85.0)
    assert entry["unit"]["name"] == "cm"
    assert [joint["name"] for joint in entry["joints"]] == [name for name, *_ in BONES]
    assert entry["joints"][0]["channels"] == list(ROOT)
    assert entry["joints"][INDEX["RightHand"]]["end_sites"] == [[0.0, -8.0, 0.0], [0.0, -92.0, 5.0]]
    named = [(each["foot"], each["part"], each["joint"]) for each in entry["contacts"]]
    assert named[:2] == [("left", "heel", "LeftFoot"), ("left", "toe", "LeftToeBase")]
    assert all(each["frames"] == [0, 59] for each in entry["contacts"])
    assert entry["plants"][1]["foot"] == "right"
    assert entry["plants"][1]["toe"] == [[0, 59]]
    assert entry["poses"][0]["world"]["position"] == pytest.approx(
        forward(person()).positions[4, INDEX["Head"]].tolist(), abs=1e-3
    )
    assert [each["joint"] for each in entry["hinges"]] == ["LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"]
    assert entry["hinges"][3]["axis"] == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)
    assert entry["metrics"]["foot_slide_max"] == pytest.approx(0.0, abs=1e-9)


def test_clips_stand_under_their_names_with_a_blank_line_between(run, write):
    write("a.bvh", person())
    write("b.bvh", person())
    text = run("info", "a.bvh", "b.bvh").stdout
    first, second = text.split("\n\nb.bvh\n")
    assert first.startswith("a.bvh\n")
    facts = first.removeprefix("a.bvh\n").partition("  joints ")[0]
    assert facts == second.partition("  joints ")[0]


def test_a_clip_that_cannot_be_read_is_one_line_and_the_others_go_on(run, write):
    write("a.bvh", person())
    Path("bad.bvh").write_text("HIERARCHY\n")
    result = run("info", "bad.bvh", "a.bvh", "--report", "r.json")
    assert result.exit_code == 1
    assert result.stdout.startswith("a.bvh\n")
    error, count = result.stderr.splitlines()
    assert error.startswith("motionedit: error: bad.bvh:")
    assert count == "2 clips: 1 failed, 1 ok"
    entries = json.loads(Path("r.json").read_text())["clips"]
    assert [(entry["clip"], entry["status"]) for entry in entries] == [("bad.bvh", "failed"), ("a.bvh", "ok")]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--at", "3", "--joint", "Haed"), "--joint: no joint 'Haed' in a.bvh; did you mean 'Head'?"),
        (("--at", "60", "--joint", "Head"), "--at: in a.bvh: 60 is outside the clip, whose frames are 0 to 59"),
        (("--at", "hit", "--joint", "Head"), "--at: in a.bvh: no event 'hit'; there are no events"),
        (("--at", "-3", "--joint", "Head"), "--at: "),
        (("--at", "3", "--joint", "{joint: Head, ofset: 1}"), "--joint: unknown key; did you mean 'offset'?"),
        (("--at", "3", "--joint", "{joint: Head"), "--joint: not valid YAML"),
        (("--at", "3", "--joint", "{end_site: Head, index: 1}"), "--joint: 'Head' in a.bvh has one end site"),
    ],
)
def test_what_no_clip_has_is_a_usage_error(run, write, options, message):
    write("a.bvh", person())
    result = run("info", "a.bvh", *options)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert f"motionedit: error: {message}" in result.stderr


def test_what_one_clip_lacks_fails_that_clip(run, write):
    write("long.bvh", person())
    write("short.bvh", person(frames=20))
    result = run("info", "long.bvh", "short.bvh", "--at", 40, "--joint", "Head", "--report", "r.json")
    assert result.exit_code == 1
    assert "in short.bvh: 40 is outside the clip" in result.stderr
    assert result.stdout.count("# Poses") == 1
    entries = json.loads(Path("r.json").read_text())["clips"]
    assert [entry["status"] for entry in entries] == ["ok", "failed"]


def test_joints_of_one_name_are_warned_of_and_cannot_be_asked_for(run, write):
    motion = person()
    names = tuple("Twin" if name in ("LeftHand", "RightHand") else name for name in motion.skeleton.names)
    clip = write("twins.bvh", replace(motion, skeleton=replace(motion.skeleton, names=names)))
    assert fact(run("info", clip).stdout, "warning") == "2 joints are called 'Twin'"
    result = run("info", clip, "--at", 3, "--joint", "Twin")
    assert result.exit_code == 2
    assert "2 joints named 'Twin'" in result.stderr


def test_a_thing_without_a_body_is_described_too(run, write):
    chain = Skeleton(("a", "b"), np.array([-1, 0]), np.array([[0.0, 0, 0], [0, 2, 0]]), (ROOT, ROOT[3:]))
    text = run("info", write("chain.bvh", motion_from_channels(chain, np.zeros((2, 9)), frame_time=0.04))).stdout
    assert "no legs found" in fact(text, "warning")
    assert fact(text, "hinges") == "none"
    assert fact(text, "unit") == "likely m (the leg is 1.00 m)"


@pytest.mark.parametrize(
    ("length", "told"), [(4.0, "unclear; the nearest is cmu, with a leg of 0.226 m"), (0.0, "unknown")]
)
def test_a_unit_that_is_no_humans_is_told_as_unclear(run, write, length, told):
    chain = Skeleton(("a", "b"), np.array([-1, 0]), np.array([[0.0, 0, 0], [0, 2 * length, 0]]), (ROOT, ROOT[3:]))
    text = run("info", write("chain.bvh", motion_from_channels(chain, np.zeros((2, 9)), frame_time=0.04))).stdout
    assert fact(text, "unit") == told


def test_the_tree_that_clips_share_is_printed_once(run, clip):
    clip("in/a.bvh")
    clip("in/b.bvh", seed=1)
    clip("in/c.bvh", names=("Hips", "RightArm"))
    shown = run("info", "in").stdout
    assert shown.count("LeftForeArm") == run("info", "in/a.bvh").stdout.count("LeftForeArm")
    assert "  joints      3, 12 channels, as in in/a.bvh\n" in shown
    assert "RightArm" in shown
