"""`motionedit diff`: the same motion, another one, or none to compare."""

import json
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_motions import make_motion

from motionedit.core import rotations as rot
from motionedit.core.body.find_anatomy import anatomy_of
from motionedit.core.bvh import new_bytes

NAMES = ("Hips", "Spine", "LeftArm", "LeftForeArm")


@pytest.fixture
def write(tmp_path):
    def to(name, motion):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(new_bytes(motion, decimals=9))
        return name

    return to


def turned(motion, *, frame, joint, degrees):
    rotations = motion.rotations.copy()
    turn = rot.exp(np.radians([0.0, 0.0, degrees]))
    rotations[frame, joint] = rot.multiply(rotations[frame, joint], turn)
    return replace(motion, rotations=rotations)


def test_a_clip_is_the_same_as_itself(run, write):
    write("a.bvh", make_motion())
    result = run("diff", "a.bvh", "a.bvh")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "a.bvh: same\n", "")


def test_a_turned_joint_is_found_with_its_frame(run, write):
    motion = make_motion(frames=90, names=NAMES)
    write("a.bvh", motion)
    write("b.bvh", turned(motion, frame=77, joint=2, degrees=5.0))
    result = run("diff", "a.bvh", "b.bvh")
    assert result.exit_code == 3
    # The forearm's joint is 10 from the arm's, so that a turn of 5 degrees about a right angle moves it at most
    # by the chord 20 sin(2.5 degrees).
    assert "turned by 5 degrees at frame 77, joint LeftArm" in result.stdout
    assert "apart at frame 77, joint LeftForeArm" in result.stdout


@pytest.mark.parametrize(("share", "code"), [(0.9e-5, 0), (1.1e-5, 3)])
def test_without_a_tolerance_places_are_the_same_to_a_hundred_thousandth_of_the_skeletons_height(
    run, write, share, code
):
    motion = make_motion(names=NAMES)
    higher = replace(motion, translations=motion.translations + share * anatomy_of(motion).height * np.array([0, 1, 0]))
    assert run("diff", write("a.bvh", motion), write("b.bvh", higher)).exit_code == code


def test_the_measures_are_the_chord_and_the_angle(run, write):
    still = make_motion(frames=3, names=NAMES)
    still = replace(still, rotations=np.broadcast_to(rot.IDENTITY, still.rotations.shape).copy())
    write("a.bvh", still)
    write("b.bvh", turned(still, frame=1, joint=1, degrees=60.0))
    run("diff", "a.bvh", "b.bvh", "--report", "r.json")
    (entry,) = json.loads(Path("r.json").read_text())["clips"]
    # Two joints of 10 each above the turned one: the chord of 60 degrees is the radius.
    assert entry["position"]["value"] == pytest.approx(20.0, abs=1e-7)
    assert entry["position"]["joint"] == "LeftForeArm"
    assert entry["angle"] == {"value": pytest.approx(60.0, abs=1e-7), "frame": 1, "joint": "Spine", "tolerance": 0.01}


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ([], 3),
        (["--tolerance-angle", "6"], 3),
        (["--tolerance-position", "20"], 3),
        (["--tolerance-angle", "6", "--tolerance-position", "20"], 0),
    ],
)
def test_both_tolerances_must_hold(run, write, options, code):
    motion = make_motion(names=NAMES)
    write("a.bvh", motion)
    write("b.bvh", turned(motion, frame=4, joint=1, degrees=5.0))
    assert run("diff", "a.bvh", "b.bvh", *options).exit_code == code


def test_another_euler_branch_is_no_difference(run, write, tmp_path):
    motion = make_motion()
    write("a.bvh", motion)
    head, rows = (tmp_path / "a.bvh").read_text().split("Frame Time:")
    time, *rows = rows.strip().split("\n")
    # Z X Y and Z + 180, 180 - X, Y + 180 are one rotation.
    values = np.array([[float(v) for v in row.split()] for row in rows])
    values[:, 6:9] = np.array([180.0, 180.0, 180.0]) + values[:, 6:9] * np.array([1.0, -1.0, 1.0])
    text = "\n".join(" ".join(f"{value:.9f}" for value in row) for row in values)
    (tmp_path / "b.bvh").write_text(f"{head}Frame Time: {time.strip()}\n{text}\n")
    assert run("diff", "a.bvh", "b.bvh").exit_code == 0


def test_joints_are_matched_by_name_whatever_their_order(run, tmp_path):
    header = (
        "HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n{}{}}}\nMOTION\nFrames: 1\n"
    )
    limb = "JOINT {0}\n{{\nOFFSET {1} 5 0\nCHANNELS 1 Xrotation\nEnd Site\n{{\nOFFSET 0 5 0\n}}\n}}\n"
    left, right = limb.format("Left", 3), limb.format("Right", -3)
    (tmp_path / "a.bvh").write_text(header.format(left, right) + "Frame Time: 0.1\n0 0 0 10 20\n")
    (tmp_path / "b.bvh").write_text(header.format(right, left) + "Frame Time: 0.1\n0 0 0 20 10\n")
    assert run("diff", "a.bvh", "b.bvh").exit_code == 0


@pytest.mark.parametrize(
    ("other", "says"),
    [
        ({"frames": 9}, "b.bvh: 9 frames, a.bvh has 8"),
        ({"frame_time": 1 / 29.97}, "b.bvh: 29.97 frames per second, a.bvh has 30"),
        ({"names": ("Hips", "LeftArm", "Hand")}, "lacks 'LeftForeArm' and also has 'Hand'"),
        ({"names": ("Hips", "LeftForeArm", "LeftArm")}, "hangs on"),
        ({"names": ("Hips", "LeftArm")}, "lacks 'LeftForeArm'"),
    ],
)
def test_what_cannot_be_compared_says_why(run, write, other, says):
    write("a.bvh", make_motion())
    write("b.bvh", make_motion(**other))
    result = run("diff", "a.bvh", "b.bvh")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("motionedit: error: b.bvh: ")
    assert says in result.stderr
    assert result.stderr.count("\n") == 1


def with_frame_time(text):
    """Return the bytes of a clip whose frame time is written so."""
    head, rows = new_bytes(make_motion()).split(b"Frame Time: ")
    return head + b"Frame Time: " + text.encode() + rows[rows.index(b"\n") :]


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("0.008333333333333333", "0.00833", True),
        ("0.0333333", "0.0333", True),
        ("0.0333", "0.03", False),
        ("0.0417", "0.04", False),
        ("0.033367", "0.0333", False),
        ("0.033367", "0.033333", False),
        ("0.0166667", "0.0167", True),
        ("0.0166667", "0.016", False),
    ],
)
def test_a_rate_written_with_few_digits_is_the_same_rate_and_a_near_one_is_not(run, tmp_path, one, other, same):
    (tmp_path / "a.bvh").write_bytes(with_frame_time(one))
    (tmp_path / "b.bvh").write_bytes(with_frame_time(other))
    for pair in (("a.bvh", "b.bvh"), ("b.bvh", "a.bvh")):
        result = run("diff", *pair)
        assert result.exit_code == (0 if same else 2), pair
        assert ("frames per second" in result.stderr) is not same


def test_folders_are_paired_by_path(run, write):
    for name in ("a/x.bvh", "a/deep/y.bvh", "b/x.bvh", "b/deep/y.bvh"):
        write(name, make_motion())
    result = run("diff", "a", "b")
    assert (result.exit_code, result.stdout) == (0, "2 clips: 2 same\n")
    assert run("-v", "diff", "a", "b").stdout == "deep/y.bvh: same\nx.bvh: same\n2 clips: 2 same\n"


@pytest.mark.parametrize(("a", "b", "only"), [("a", "b", "a"), ("b", "a", "a"), ("a", "empty", "a")])
def test_a_clip_missing_on_one_side_is_a_difference(run, write, tmp_path, a, b, only):
    (tmp_path / "empty").mkdir()
    write("a/x.bvh", make_motion())
    write("a/y.bvh", make_motion())
    write("b/x.bvh", make_motion())
    result = run("diff", a, b)
    assert result.exit_code == 3
    assert f"y.bvh: missing: only in {only}\n" in result.stdout


def test_folders_that_share_no_name_are_one_line_with_its_remedy(run, write, tmp_path):
    for name in ("a/x.bvh", "a/y.bvh", "b/deep/x.bvh"):
        write(name, make_motion())
    result = run("diff", "a", "b", "--report", "r.json")
    line, count = result.stdout.splitlines()
    assert line.startswith(
        "no clip of a has the name of one of b: clips are paired by their path below the two folders; "
    )
    assert (count, result.stderr, result.exit_code) == ("3 clips: 3 missing", "", 3)
    assert [one["status"] for one in json.loads((tmp_path / "r.json").read_text())["clips"]] == ["missing"] * 3
    every = ["deep/x.bvh: missing: only in b", "x.bvh: missing: only in a", "y.bvh: missing: only in a", count]
    assert run("diff", "a", "b", "-v").stdout.splitlines() == every


def test_of_many_clips_on_one_side_a_few_are_named_and_every_difference_is(run, write, tmp_path):
    for n in range(5):
        write(f"a/d{n}.bvh", make_motion())
        write(f"b/d{n}.bvh", make_motion(seed=1))
        write(f"b/n{n}.bvh", make_motion())
    for n in range(31):
        write(f"a/m{n:02d}.bvh", make_motion())
    lines = run("diff", "a", "b").stdout.splitlines()
    assert [line.split(": ")[:2] for line in lines[:5]] == [[f"d{n}.bvh", "different"] for n in range(5)]
    assert lines[5:] == [
        *(f"m{n:02d}.bvh: missing: only in a" for n in range(3)),
        "28 more only in a; -v names all",
        *(f"n{n}.bvh: missing: only in b" for n in range(3)),
        "2 more only in b; -v names all",
        "41 clips: 5 different, 36 missing",
    ]
    assert len(run("diff", "a", "b", "-v").stdout.splitlines()) == 42
    (tmp_path / "a/m00.bvh").unlink()
    assert len(run("diff", "a", "b").stdout.splitlines()) == 41


def test_an_unreadable_clip_does_not_hide_the_other_differences(run, write, tmp_path):
    for folder, seed in (("a", 0), ("b", 1)):
        write(f"{folder}/x.bvh", make_motion(seed=seed))
        write(f"{folder}/y.bvh", make_motion())
    (tmp_path / "b/y.bvh").write_text("HIERARCHY\n")
    result = run("diff", "a", "b", "--report", "r.json")
    assert result.exit_code == 2
    assert "x.bvh: different: " in result.stdout
    assert "2 clips: 1 different, 1 not comparable" in result.stdout
    assert result.stderr.startswith("motionedit: error: b/y.bvh:")
    clips = json.loads((tmp_path / "r.json").read_text())["clips"]
    assert [clip["status"] for clip in clips] == ["different", "not_comparable"]


def test_the_report_replaces_the_lines(run, write):
    write("a.bvh", make_motion())
    report = json.loads(run("diff", "a.bvh", "a.bvh", "--report", "-").stdout)
    assert list(report) == ["schema", "version", "command", "spec", "clips"]
    assert report["clips"][0]["status"] == "same"


def test_a_report_named_xml_is_junit(run, write, tmp_path):
    for folder, seed in (("a", 0), ("b", 1)):
        write(f"{folder}/different.bvh", make_motion(seed=seed))
        write(f"{folder}/same & 1.bvh", make_motion())
        write(f"{folder}/short.bvh", make_motion(frames=5 + seed))
    write("a/missing.bvh", make_motion())
    assert run("diff", "a", "b", "--report", "r.xml").exit_code == 2
    suite = ET.parse(tmp_path / "r.xml").getroot()[0]  # noqa: S314  written a line above
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("4", "2", "1")
    problems = {case.get("name"): [child.tag for child in case] for case in suite}
    assert problems == {
        "different.bvh": ["failure"],
        "missing.bvh": ["failure"],
        "same & 1.bvh": [],
        "short.bvh": ["error"],
    }
    assert "frame" in suite[0][0].get("message")


def test_one_side_may_be_standard_input(run, write, tmp_path):
    write("a.bvh", make_motion())
    data = (tmp_path / "a.bvh").read_bytes()
    assert run("diff", "a.bvh", "-", stdin=data).exit_code == 0
    assert "only one of A and B" in run("diff", "-", "-", stdin=data).stderr


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["a", "a/x.bvh"], "a: is a folder, and the other is a file"),
        (["a", "nope"], "nope: no such file or folder"),
        (["empty", "empty"], "no .bvh file in empty and empty"),
        (["a", "a", "--report", "a/x.bvh"], "a/x.bvh: is an input of this run"),
    ],
)
def test_what_is_no_pair_is_a_usage_error(run, write, tmp_path, arguments, says):
    (tmp_path / "empty").mkdir()
    write("a/x.bvh", make_motion())
    result = run("diff", *arguments)
    assert result.exit_code == 2
    assert says in result.stderr
