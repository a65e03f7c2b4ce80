"""Bodies at the command line: which side is left, up, OFFSETs that channels replace, odd channels."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from people import (
    BONES,
    ROOT_CHANNELS,
    SCALE,
    above,
    mirrored,
    person,
    record,
    skeleton_of,
    spec,
    standing,
    with_rotation,
)

from motionedit.core import rotations as rot
from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import forward
from motionedit.core.motion import Motion


def test_a_body_whose_left_is_on_the_right_goes_where_its_toes_point_and_is_warned_about(run, write_motion, tmp_path):
    clip = write_motion("mirrored.bvh", mirrored(person()))
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


def test_an_offset_that_channels_replace_changes_no_byte_but_its_own_line(run, write_motion, tmp_path):
    constraints = [
        {"type": "position", "effector": "LeftHand", "priority": 2, "points": [{"at": 20, "shift": [5, 8, 10]}]},
        {"type": "position", "effector": ["LeftFoot", "RightFoot"], "priority": 3},
        {"type": "com", "priority": 1, "axes": ["x", "z"]},
        {"type": "position", "effector": "Hips", "points": [{"at": 10, "shift": [0, 3, 0]}]},
    ]
    asked = spec(tmp_path, *constraints)
    texts, names = [], ("far.bvh", "near.bvh")
    for name, offset in zip(names, ((5.0, 94.0, -450.0), (0.0, 0.0, 0.0)), strict=True):
        write_motion(name, static_root(offset))
        assert run("edit-prioritized", name, "-s", asked, "-o", f"out-{name}").exit_code == 0
        texts.append(Path(f"out-{name}").read_text().splitlines())
    differing = [one for one, other in zip(*texts, strict=True) if one != other]
    assert [line.split()[0] for line in differing] == ["OFFSET"]
    before, after = (read_clip(Path(path)).motion for path in ("far.bvh", "out-far.bvh"))
    np.testing.assert_array_equal(after.rotations[:, 0], before.rotations[:, 0])
    np.testing.assert_array_equal(after.translations[:, 0], before.translations[:, 0])


def test_what_stands_above_the_travelling_joint_is_not_recruited_when_asked_for(run, write_motion, tmp_path):
    write_motion("far.bvh", static_root((0.0, 0.0, -450.0)))
    hand = {"type": "position", "effector": "LeftHand", "recruit": {"joints": ["LeftArm", "Root"]}}
    hand |= {"points": [{"at": 20, "shift": [0, 3, 0]}]}
    done = run("edit-prioritized", "far.bvh", "-s", spec(tmp_path, hand), "-o", "out.bvh")
    assert "LeftHand: Root is not recruited: it does not hang on Hips, which carries the travel" in done.stderr
    before, after = (read_clip(Path(path)).motion for path in ("far.bvh", "out.bvh"))
    np.testing.assert_array_equal(after.rotations[:, 0], before.rotations[:, 0])


def test_what_cannot_be_moved_is_said(run, write_motion, tmp_path):
    motion = person()
    names = motion.skeleton.names
    channels = list(motion.skeleton.channels)
    channels[0] = ("Xposition", "Zposition", *channels[0][3:])
    channels[names.index("LeftForeArm")] = ()
    write_motion("odd.bvh", Motion(replace(motion.skeleton, channels=tuple(channels)), *astuple(motion)))
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


def test_up_may_be_given_to_info_and_preview(run, write_motion):
    write_motion("lies.bvh", lying())
    _, found = record(run, "info", "lies.bvh")
    _, given = record(run, "info", "lies.bvh", "--up", "z")
    assert (found["up"], given["up"]) == ("y", "z")
    assert any("up is taken to be y, but the body mostly stands along -z" in line for line in found["warnings"])
    write_motion("stands.bvh", person())
    _, plain = record(run, "info", "stands.bvh", "--up", "z")
    assert "up is given as z, but the clip plainly has y up" in plain["warnings"]
    pages = []
    for up in ("auto", "y", "z"):
        assert run("preview", "stands.bvh", "-o", f"{up}.html", "--up", up).exit_code == 0
        pages.append(Path(f"{up}.html").read_bytes())
    assert pages[0] == pages[1] != pages[2]


def test_a_page_is_drawn_with_the_up_of_the_edits_spec(run, write_motion, tmp_path):
    write_motion("stands.bvh", person())
    asked = spec(tmp_path, up="z")
    run("edit-prioritized", "stands.bvh", "-s", asked, "-o", "out.bvh", "--report", "r.json", "--preview")
    run("preview", "stands.bvh", "out.bvh", "-o", "page.html", "--report", "r.json")
    assert Path("page.html").read_bytes() == Path("out.html").read_bytes()
    run("preview", "stands.bvh", "out.bvh", "-o", "other.html")
    assert Path("page.html").read_bytes() != Path("other.html").read_bytes()


def test_what_was_not_found_is_said_by_info_with_its_consequence(run, write_motion):
    bones = [row for row in BONES if not any(word in row[0] for word in ("Shoulder", "Arm", "Hand", "Neck", "Head"))]
    skeleton = skeleton_of(bones, scale=SCALE)
    write_motion("legs.bvh", standing(skeleton, at=(0.0, 98.0, 0.0)))
    _, entry = record(run, "info", "legs.bvh")
    assert any(line.startswith("no arms found: elbows are no hinges") for line in entry["warnings"])
    # The tip of the spine would be taken for a head: there is none above it.
    assert entry["anatomy"]["left_leg"]["knee"] == "LeftLeg"
    text = run("info", "legs.bvh").stdout
    assert text.count("no arms found") == 1


@pytest.mark.parametrize("legs", [True, False])
def test_info_says_how_feet_stand_of_bodies_that_have_any(run, write_motion, legs):
    bones = [row for row in BONES if legs or not any(word in row[0] for word in ("Leg", "Foot", "Toe"))]
    write_motion("body.bvh", standing(skeleton_of(bones, scale=SCALE), at=(0.0, 98.0, 0.0)))
    text = run("info", "body.bvh").stdout
    assert "quality     jerk 0 units/s^3" in text
    assert ("toes near the floor" in text) == ("planted feet slide" in text) == legs


def test_a_body_without_length_is_shown_and_an_edit_that_changes_nothing_copies_it(run, write_motion, tmp_path):
    flat = skeleton_of(scale=0.0)
    write_motion("flat.bvh", standing(replace(flat, end_sites=()), at=(0.0, 0.0, 0.0)))
    assert run("info", "flat.bvh").exit_code == 0
    assert run("preview", "flat.bvh", "-o", "flat.html").exit_code == 0
    done = run("edit-prioritized", "flat.bvh", "-s", spec(tmp_path), "-o", "out.bvh")
    assert done.exit_code == 0
    assert Path("out.bvh").read_bytes() == Path("flat.bvh").read_bytes()


def test_a_knee_of_two_channels_bends_no_further_than_a_knee(run, write_motion, tmp_path):
    motion = person()
    skeleton = motion.skeleton
    channels = list(skeleton.channels)
    knee = skeleton.names.index("LeftLeg")
    channels[knee] = ("Xrotation", "Yrotation")
    write_motion("knee.bvh", Motion(replace(skeleton, channels=tuple(channels)), *astuple(motion)))
    up = {"type": "position", "effector": "LeftFoot", "recruit": {"up_to": "LeftUpLeg"}}
    up |= {"points": [{"hold": [10, 30], "shift": [0, 60, 60]}]}
    run("edit-prioritized", "knee.bvh", "-s", spec(tmp_path, up), "-o", "out.bvh")
    after = read_clip(Path("out.bvh")).motion.rotations[:, knee]
    assert np.degrees(rot.log(after)[:, 0]).min() > -1.0


def test_rows_that_put_all_joints_onto_their_parents_are_told(run, write_motion):
    motion = person()
    channels = tuple(ROOT_CHANNELS for _ in motion.skeleton.names)
    skeleton = replace(motion.skeleton, channels=channels)
    translations = np.zeros((len(motion), len(skeleton), 3))
    translations[:, 0] = motion.translations[:, 0]
    write_motion("heap.bvh", Motion(skeleton, motion.rotations, translations, motion.frame_time))
    _, entry = record(run, "info", "heap.bvh")
    assert entry["leg_length"] == pytest.approx(85.0)
    assert any("position channels put most joints onto their parents" in line for line in entry["warnings"])
