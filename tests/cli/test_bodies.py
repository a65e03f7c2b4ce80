"""Bodies at the command line: what a spec says of them, up, OFFSETs that channels replace, odd channels."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "unit" / "core"))

from human import BONES, ROOT_CHANNELS, above, skeleton_of, standing, with_rotation

from motionedit.core import rotations as rot
from motionedit.core.bvh import new_bytes, read_clip
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion

SCALE = 100.0
MEANINGLESS = {name: f"b{i:02d}" for i, (name, _, _) in enumerate(BONES)}


def person(*, bones=BONES, rename=str, frames=40, travels=True):
    """Return a person in centimetres who sways and swings an arm."""
    skeleton = skeleton_of(bones, scale=SCALE, rename=rename)
    motion = standing(skeleton, frames, frame_time=1 / 30, at=(0.0, SCALE * 0.98, 0.0))
    for frame in range(frames):
        swing = 0.4 * np.sin(frame / 6.0)
        motion = with_rotation(motion, rename("LeftArm"), [frame], (swing, 0.2, 0.3))
        motion = with_rotation(motion, rename("LeftLeg"), [frame], (0.2 + 0.1 * swing, 0.0, 0.0))
    translations = motion.translations.copy()
    translations[..., 2] += np.linspace(0.0, 30.0 * travels, frames)[:, None]
    return Motion(skeleton, motion.rotations, translations, motion.frame_time)


@pytest.fixture
def write(tmp_path):
    def write_it(name, motion):
        path = tmp_path / name
        path.write_bytes(new_bytes(motion))
        return path

    return write_it


def spec(tmp_path, *constraints, **keys):
    path = tmp_path / "spec.yaml"
    path.write_text(json.dumps({"schema": "motionedit/edit-prioritized/v1", "constraints": constraints, **keys}))
    return path


def record(run, *arguments):
    done = run(*arguments, "--report", "r.json")
    (entry,) = json.loads(Path("r.json").read_text())["clips"]
    return done, entry


def limb(*parts):
    return [MEANINGLESS[part] for part in parts]


BODY = {
    "head": MEANINGLESS["Head"],
    # The other way round than it is: what a user says holds.
    "left_leg": limb("RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"),
    "right_leg": limb("LeftUpLeg", "LeftLeg", "LeftFoot"),
    "left_arm": limb("RightArm", "RightForeArm", "RightHand"),
    "right_arm": limb("LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"),
}


def test_a_spec_says_which_joint_is_what(run, write, tmp_path):
    clip = write("odd.bvh", person(rename=MEANINGLESS.get))
    reach = {"type": "position", "effector": MEANINGLESS["LeftHand"], "frame": "heading"}
    reach |= {"points": [{"at": 20, "shift": [0, 10, 10]}]}
    moved = []
    for body in ({}, BODY):
        done, entry = record(run, "edit-prioritized", clip, "-s", spec(tmp_path, reach, body=body), "-o", "out.bvh")
        assert (done.exit_code, entry["status"]) == (0, "ok")
        hand = MEANINGLESS["LeftHand"]
        tracks = [forward(read_clip(Path(path)).motion).positions for path in (clip, "out.bvh")]
        moved.append((tracks[1] - tracks[0])[20, list(MEANINGLESS.values()).index(hand)])
    # Left and right are exchanged, so the character faces the other way.
    np.testing.assert_allclose(moved[0], [0.0, 10.0, 10.0], atol=0.01)
    np.testing.assert_allclose(moved[1], [0.0, 10.0, -10.0], atol=0.01)


def mirrored(motion):
    """Return a motion with x negated, and the names as they were: left is on the right."""
    flip = np.array([-1.0, 1.0, 1.0])
    offsets = motion.skeleton.offsets * flip
    sites = tuple(replace(site, offset=site.offset * flip) for site in motion.skeleton.end_sites)
    skeleton = replace(motion.skeleton, offsets=offsets, end_sites=sites)
    rotations = motion.rotations * np.array([1.0, 1.0, -1.0, -1.0])
    return Motion(skeleton, rotations, motion.translations * flip, motion.frame_time)


def test_a_body_whose_left_is_on_the_right_goes_where_its_toes_point_and_is_warned_about(run, write, tmp_path):
    clip = write("mirrored.bvh", mirrored(person()))
    warning = "what is taken for left is on the right, as toes and knees point"
    for command in ("info", "check"):
        _, entry = record(run, command, clip)
        assert [line.startswith(warning) for line in entry["warnings"]] == [True]
    assert "heading     0 degrees" in run("info", clip).stdout.replace("-0 ", "0 ")
    reach = {
        "type": "position",
        "effector": "LeftHand",
        "frame": "heading",
        "points": [{"at": 20, "shift": [3, 10, 10]}],
    }
    done = run("edit-prioritized", clip, "-s", spec(tmp_path, reach), "-o", "out.bvh")
    assert warning in done.stderr
    assert "swap left and right in the names" in done.stderr
    tracks = [forward(read_clip(Path(path)).motion).positions for path in (clip, "out.bvh")]
    moved = (tracks[1] - tracks[0])[20, read_clip(clip).motion.skeleton.names.index("LeftHand")]
    np.testing.assert_allclose(moved, [3.0, 10.0, 10.0], atol=0.01)


@pytest.mark.parametrize("exchanged", [True, False])
def test_body_says_which_limbs_are_left_and_a_warning_that_toes_point_back(run, write, tmp_path, exchanged):
    clip = write("mirrored.bvh", mirrored(person()))
    left, right = ("Right", "Left") if exchanged else ("Left", "Right")
    body = {
        f"{side}_leg": [f"{name}{part}" for part in ("UpLeg", "Leg", "Foot")]
        for side, name in (("left", left), ("right", right))
    }
    done = run("edit-prioritized", clip, "-s", spec(tmp_path, body=body), "-o", "out.bvh")
    assert done.exit_code == 0
    assert ("body: calls left what is on the right" in done.stderr) != exchanged
    assert "what is taken for left" not in done.stderr


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ({"head": "Skul"}, "body.head: no joint 'Skul' in odd.bvh"),
        (
            {**BODY, "left_leg": limb("RightLeg", "RightUpLeg", "RightFoot")},
            f"body.left_leg: '{MEANINGLESS['RightUpLeg']}' does not hang on '{MEANINGLESS['RightLeg']}' in odd.bvh",
        ),
        ({"left_leg": limb("LeftUpLeg", "LeftLeg", "LeftFoot")}, "body.left_leg: stands without right_leg"),
        ({"left_leg": "none", "right_leg": limb("LeftUpLeg", "LeftLeg", "LeftFoot")}, "body.left_leg: must be none"),
        ({"left_leg": ["a", "b"], "right_leg": "none"}, "body.left_leg: must be a leg's joints"),
        ({"tail": "T"}, "body.tail: unknown key"),
    ],
)
def test_what_a_spec_says_of_a_body_is_checked(run, write, tmp_path, body, message):
    write("odd.bvh", person(rename=MEANINGLESS.get))
    done = run("edit-prioritized", "odd.bvh", "-s", spec(tmp_path, body=body), "-o", "out.bvh")
    assert done.exit_code == 2
    assert message in done.stderr
    assert not Path("out.bvh").exists()


def test_a_body_may_be_said_to_have_no_arms(run, write, tmp_path):
    clip = write("person.bvh", person())
    com = {"type": "com", "axes": ["x", "z"]}
    asked = spec(tmp_path, com, body={"left_arm": "none", "right_arm": "none"})
    done = run("edit-prioritized", clip, "-s", asked, "-o", "out.bvh")
    assert "is not a human's" in done.stderr
    assert "is not a human's" not in run("edit-prioritized", clip, "-s", spec(tmp_path, com), "-o", "o.bvh").stderr


def test_what_normalize_is_told_of_a_body_goes_with_the_model(run, write, tmp_path):
    for i in range(3):
        motion = person(rename=MEANINGLESS.get, frames=30 + 2 * i)
        write(f"c{i}.bvh", with_rotation(motion, MEANINGLESS["Spine"], slice(None), (0.1 * i, 0.05, 0.0)))
    told = tmp_path / "normalize.yaml"
    told.write_text(json.dumps({"schema": "motionedit/normalize/v1", "body": BODY}))
    clips = [f"c{i}.bvh" for i in range(3)]
    assert run("normalize", *clips, "-s", told, "-o", "n").exit_code == 0
    assert json.loads(Path("n/normalization.json").read_text())["rules"]["body"] == BODY
    assert run("fit-pca", "n", "-o", "m.npz").exit_code == 0
    goal = {"at": 10, "effector": MEANINGLESS["LeftHand"], "frame": "heading", "shift": [0, 0, 1.0]}
    edit = tmp_path / "edit.yaml"
    edit.write_text(json.dumps({"schema": "motionedit/edit-pc/v1", "goals": [goal], "plausibility": "off"}))
    assert run("edit-pc", "c1.bvh", "-m", "m.npz", "-s", edit, "-o", "out.bvh").exit_code == 0
    hand = list(MEANINGLESS.values()).index(MEANINGLESS["LeftHand"])
    tracks = [forward(read_clip(Path(path)).motion).positions for path in ("c1.bvh", "out.bvh")]
    # Ahead is where they say.
    assert (tracks[1] - tracks[0])[10, hand, 2] < -0.5


def static_root(offset):
    """Return a person whose hips travel below a root that stands at the origin."""
    motion = person(bones=above(BONES, "Root"))
    skeleton = motion.skeleton
    offsets = skeleton.offsets.copy()
    offsets[1] = offset
    channels = (ROOT_CHANNELS, ROOT_CHANNELS, *skeleton.channels[2:])
    skeleton = replace(skeleton, offsets=offsets, channels=channels)
    translations = np.concatenate((np.zeros_like(motion.translations), motion.translations), axis=1)
    return Motion(skeleton, motion.rotations, translations, motion.frame_time)


def test_an_offset_that_channels_replace_changes_no_byte_but_its_own_line(run, write, tmp_path):
    constraints = [
        {"type": "position", "effector": "LeftHand", "priority": 2, "points": [{"at": 20, "shift": [5, 8, 10]}]},
        {"type": "position", "effector": ["LeftFoot", "RightFoot"], "priority": 3},
        {"type": "com", "priority": 1, "axes": ["x", "z"]},
        {"type": "position", "effector": "Hips", "points": [{"at": 10, "shift": [0, 3, 0]}]},
    ]
    asked = spec(tmp_path, *constraints)
    texts, names = [], ("far.bvh", "near.bvh")
    for name, offset in zip(names, ((5.0, 94.0, -450.0), (0.0, 0.0, 0.0)), strict=True):
        write(name, static_root(offset))
        assert run("edit-prioritized", name, "-s", asked, "-o", f"out-{name}").exit_code == 0
        texts.append(Path(f"out-{name}").read_text().splitlines())
    differing = [one for one, other in zip(*texts, strict=True) if one != other]
    assert [line.split()[0] for line in differing] == ["OFFSET"]
    before, after = (read_clip(Path(path)).motion for path in ("far.bvh", "out-far.bvh"))
    np.testing.assert_array_equal(after.rotations[:, 0], before.rotations[:, 0])
    np.testing.assert_array_equal(after.translations[:, 0], before.translations[:, 0])


def test_what_stands_above_the_travelling_joint_is_not_recruited_when_asked_for(run, write, tmp_path):
    write("far.bvh", static_root((0.0, 0.0, -450.0)))
    hand = {"type": "position", "effector": "LeftHand", "recruit": {"joints": ["LeftArm", "Root"]}}
    hand |= {"points": [{"at": 20, "shift": [0, 3, 0]}]}
    done = run("edit-prioritized", "far.bvh", "-s", spec(tmp_path, hand), "-o", "out.bvh")
    assert "LeftHand: Root is not recruited: it does not hang on Hips, which carries the travel" in done.stderr
    before, after = (read_clip(Path(path)).motion for path in ("far.bvh", "out.bvh"))
    np.testing.assert_array_equal(after.rotations[:, 0], before.rotations[:, 0])


def test_what_cannot_be_moved_is_said(run, write, tmp_path):
    motion = person()
    names = motion.skeleton.names
    channels = list(motion.skeleton.channels)
    channels[0] = ("Xposition", "Zposition", *channels[0][3:])
    channels[names.index("LeftForeArm")] = ()
    write("odd.bvh", Motion(replace(motion.skeleton, channels=tuple(channels)), *astuple(motion)))
    hand = {"type": "position", "effector": "LeftHand", "points": [{"at": 20, "shift": [0, 3, 0]}]}
    listed = {**hand, "name": "listed", "recruit": {"joints": ["LeftForeArm"]}}
    done = run("edit-prioritized", "odd.bvh", "-s", spec(tmp_path, hand, listed), "-o", "out.bvh")
    assert "listed: LeftForeArm is not recruited: it has no rotation channels" in done.stderr
    assert "Hips has position channels for x and z alone: the body is shifted along those" in done.stderr


def astuple(motion):
    return motion.rotations, motion.translations, motion.frame_time


def lying():
    """Return a person who lies on his back in a file whose y is up."""
    return with_rotation(person(travels=False), "Hips", slice(None), (-np.pi / 2, 0.0, 0.0))


def test_up_may_be_given_to_info_and_preview(run, write):
    write("lies.bvh", lying())
    _, found = record(run, "info", "lies.bvh")
    _, given = record(run, "info", "lies.bvh", "--up", "z")
    assert (found["up"], given["up"]) == ("y", "z")
    assert any("up is taken to be y, but the body mostly stands along -z" in line for line in found["warnings"])
    write("stands.bvh", person())
    _, plain = record(run, "info", "stands.bvh", "--up", "z")
    assert "up is given as z, but the clip plainly has y up" in plain["warnings"]
    pages = []
    for up in ("auto", "y", "z"):
        assert run("preview", "stands.bvh", "-o", f"{up}.html", "--up", up).exit_code == 0
        pages.append(Path(f"{up}.html").read_bytes())
    assert pages[0] == pages[1] != pages[2]


def test_a_page_is_drawn_with_the_up_of_the_edits_spec(run, write, tmp_path):
    write("stands.bvh", person())
    asked = spec(tmp_path, up="z")
    run("edit-prioritized", "stands.bvh", "-s", asked, "-o", "out.bvh", "--report", "r.json", "--preview")
    run("preview", "stands.bvh", "out.bvh", "-o", "page.html", "--report", "r.json")
    assert Path("page.html").read_bytes() == Path("out.html").read_bytes()
    run("preview", "stands.bvh", "out.bvh", "-o", "other.html")
    assert Path("page.html").read_bytes() != Path("other.html").read_bytes()


def test_what_was_not_found_is_said_by_info_with_its_consequence(run, write):
    bones = [row for row in BONES if not any(word in row[0] for word in ("Shoulder", "Arm", "Hand", "Neck", "Head"))]
    skeleton = skeleton_of(bones, scale=SCALE)
    write("legs.bvh", standing(skeleton, at=(0.0, 98.0, 0.0)))
    _, entry = record(run, "info", "legs.bvh")
    assert any(line.startswith("no arms found: elbows are no hinges") for line in entry["warnings"])
    # The tip of the spine would be taken for a head: there is none above it.
    assert entry["anatomy"]["left_leg"]["knee"] == "LeftLeg"
    text = run("info", "legs.bvh").stdout
    assert text.count("no arms found") == 1


@pytest.mark.parametrize("legs", [True, False])
def test_info_says_how_feet_stand_of_bodies_that_have_any(run, write, legs):
    bones = [row for row in BONES if legs or not any(word in row[0] for word in ("Leg", "Foot", "Toe"))]
    write("body.bvh", standing(skeleton_of(bones, scale=SCALE), at=(0.0, 98.0, 0.0)))
    text = run("info", "body.bvh").stdout
    assert "quality     jerk 0 units/s^3" in text
    assert ("toes skate at" in text) == ("planted feet slide" in text) == legs


def test_a_body_without_length_is_shown_and_an_edit_that_changes_nothing_copies_it(run, write, tmp_path):
    flat = skeleton_of(scale=0.0)
    write("flat.bvh", standing(replace(flat, end_sites=()), at=(0.0, 0.0, 0.0)))
    assert run("info", "flat.bvh").exit_code == 0
    assert run("preview", "flat.bvh", "-o", "flat.html").exit_code == 0
    done = run("edit-prioritized", "flat.bvh", "-s", spec(tmp_path), "-o", "out.bvh")
    assert done.exit_code == 0
    assert Path("out.bvh").read_bytes() == Path("flat.bvh").read_bytes()


@pytest.mark.parametrize("limb_of", [("Hips", "Spine", "Spine1"), ("Spine1", "Neck", "Head")])
def test_limbs_that_hang_on_each_other_are_refused(run, write, tmp_path, limb_of):
    write("person.bvh", person())
    body = {"left_leg": ["Hips", "Spine", "Spine1"], "right_leg": list(limb_of)}
    done = run("edit-prioritized", "person.bvh", "-s", spec(tmp_path, body=body), "-o", "out.bvh")
    assert done.exit_code == 2
    assert "body.left_leg: must part from right_leg: neither limb hangs on the other" in done.stderr


@pytest.mark.parametrize("damaged", [[1, 2], {"head": 5}, {"left_leg": ["a", "b", "c"]}, None])
def test_damaged_rules_for_a_body_are_said_to_be_damaged(run, write, damaged):
    for i in range(3):
        write(f"c{i}.bvh", with_rotation(person(), "Spine", slice(None), (0.1 * i, 0.05, 0.0)))
    Path("normalize.yaml").write_text("schema: motionedit/normalize/v1\n")
    run("normalize", "c0.bvh", "c1.bvh", "c2.bvh", "-s", "normalize.yaml", "-o", "n")
    listed = json.loads(Path("n/normalization.json").read_text())
    listed["rules"]["body"] = damaged
    Path("n/normalization.json").write_text(json.dumps(listed))
    done = run("fit-pca", "n", "-o", "m.npz")
    assert done.exit_code != 0
    assert "normalization.json: its rules for the body are damaged" in done.stderr


def test_a_knee_of_two_channels_bends_no_further_than_a_knee(run, write, tmp_path):
    motion = person()
    skeleton = motion.skeleton
    channels = list(skeleton.channels)
    knee = skeleton.names.index("LeftLeg")
    channels[knee] = ("Xrotation", "Yrotation")
    write("knee.bvh", Motion(replace(skeleton, channels=tuple(channels)), *astuple(motion)))
    up = {"type": "position", "effector": "LeftFoot", "recruit": {"up_to": "LeftUpLeg"}}
    up |= {"points": [{"hold": [10, 30], "shift": [0, 60, 60]}]}
    run("edit-prioritized", "knee.bvh", "-s", spec(tmp_path, up), "-o", "out.bvh")
    after = read_clip(Path("out.bvh")).motion.rotations[:, knee]
    assert np.degrees(rot.log(after)[:, 0]).min() > -1.0


def test_rows_that_put_all_joints_onto_their_parents_are_told(run, write):
    motion = person()
    channels = tuple(ROOT_CHANNELS for _ in motion.skeleton.names)
    skeleton = replace(motion.skeleton, channels=channels)
    translations = np.zeros((len(motion), len(skeleton), 3))
    translations[:, 0] = motion.translations[:, 0]
    write("heap.bvh", Motion(skeleton, motion.rotations, translations, motion.frame_time))
    _, entry = record(run, "info", "heap.bvh")
    assert entry["leg_length"] == pytest.approx(85.0)
    assert any("position channels put most joints onto their parents" in line for line in entry["warnings"])
