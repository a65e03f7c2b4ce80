"""Fresh and resampled files read back as the motion that was written."""

from dataclasses import replace

import numpy as np
import pytest
from small_clip import HIERARCHY, TEXT, with_text

from motionedit.core import rotations as rot
from motionedit.core.arrays import frozen
from motionedit.core.bvh import new_bytes, parse_clip, resampled_bytes
from motionedit.errors import BvhError


def read(data):
    return parse_clip(data, label="walk.bvh")


def same_motion(a, b):
    assert np.degrees(rot.angle_between(a.rotations, b.rotations)).max() < 2e-6
    np.testing.assert_allclose(a.translations, b.translations, atol=1e-6)
    return a.frame_time == b.frame_time


def every_other_frame(motion):
    return replace(
        motion,
        rotations=motion.rotations[::2],
        translations=motion.translations[::2],
        frame_time=1.0 / 30.0,
    )


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_a_resampled_file_keeps_the_header_and_line_ending(ending):
    clip = read(TEXT.replace("Frames: 3", "Frames:\t3").replace("\n", ending).encode())
    written = resampled_bytes(clip, every_other_frame(clip.motion))
    expected = (
        f"{HIERARCHY}MOTION\nFrames:\t2\nFrame Time: 0.03333333333333333\n"
        "1.000000 2.000000 3.000000 10.500000 -20.250000 30.000000 4.000000 5.000000 6.000000\n"
        "2.000000 2.000000 3.000000 12.000000 -22.125000 32.000000 4.000000 5.000000 6.000000\n"
    )
    assert written.decode() == expected.replace("\n", ending)
    assert same_motion(read(written).motion, every_other_frame(clip.motion))


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_a_clip_without_its_rows_is_enough_to_write_others(ending):
    clip = read(TEXT.replace("\n", ending).encode())
    motion = every_other_frame(clip.motion)
    lean = clip.without_rows()
    assert resampled_bytes(lean, motion) == resampled_bytes(clip, motion)
    assert lean.text.data.startswith(clip.text.data[: clip.text.header.rows_start])
    assert len(lean.text.data) <= clip.text.header.rows_start + 2
    assert (lean.motion, len(lean.text.values)) == (clip.motion, 1)


def test_an_unchanged_rate_keeps_the_text_of_the_frame_time():
    clip = read(with_text("0.04", "4.0E-2"))
    assert b"Frame Time: 4.0E-2\n" in resampled_bytes(clip, clip.motion)


def test_frame_times_are_written_in_full_without_an_exponent():
    clip = read(TEXT.encode())
    written = resampled_bytes(clip, replace(clip.motion, frame_time=1e-5 / 3.0))
    assert b"Frame Time: 0.000003333333333333333" in written
    assert read(written).motion.frame_time == 1e-5 / 3.0


def test_a_fresh_file_has_tabs_and_six_decimals():
    clip = read(TEXT.encode())
    written = new_bytes(clip.motion).decode()
    assert written.startswith(
        "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0.000000 0.000000 0.000000\n"
        "\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
        "\tJOINT Spine\n\t{\n\t\tOFFSET 0.000000 10.500000 -0.100000\n"
        "\t\tCHANNELS 3 Zrotation Xrotation Yrotation\n"
        "\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0.000000 5.000000 0.000000\n\t\t}\n\t}\n}\n"
        "MOTION\nFrames: 3\nFrame Time: 0.04\n1.000000 2.000000 3.000000 10.500000 "
    )
    assert same_motion(read(written.encode()).motion, clip.motion)


def test_a_fresh_file_keeps_a_branching_tree():
    leaf = "JOINT {0}\n{{\nOFFSET 1 2 3\n}}\n"
    inner = "JOINT a\n{\nOFFSET 1 0 0\n" + leaf.format("b") + leaf.format("c") + "}\n" + leaf.format("d")
    site = "End Site\n{\nOFFSET 1 2 3\n}\n"
    clip = read(with_text("\tJOINT Spine", inner + site + site + "\tJOINT Spine"))
    again = read(new_bytes(clip.motion, decimals=2))
    assert again.motion.skeleton.names == clip.motion.skeleton.names == ("Hips", "a", "b", "c", "d", "Spine")
    assert again.motion.skeleton.parents.tolist() == clip.motion.skeleton.parents.tolist()
    assert [site.joint for site in again.motion.skeleton.end_sites] == [0, 0, 5]


def test_a_motion_that_is_not_finite_is_not_written():
    motion = read(TEXT.encode()).motion
    with pytest.raises(BvhError, match="not finite"):
        new_bytes(replace(motion, translations=frozen(np.full((3, 1, 3), np.inf))))


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_huge_values_are_written_out(ending):
    clip = read(TEXT.replace("\n", ending).encode())
    far = replace(clip.motion, translations=np.full((3, 1, 3), -2.5e17))
    written = resampled_bytes(clip, far)
    assert written.count(f"{ending}-250000000000000000.000000 ".encode()) == 3
    assert same_motion(read(written).motion, far)
