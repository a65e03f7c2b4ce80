"""bvhio, an independent reader, finds the joints where this package puts them."""

from dataclasses import replace

import numpy as np
import pytest
from small_clip import HIERARCHY, TEXT, with_text

from motionedit.core import rotations as rot
from motionedit.core.bvh import check_with_bvhio, from_bvhio, new_bytes, parse_clip, to_bvhio
from motionedit.errors import BvhError

LEG = 10.0


def clip_of(data, **options):
    return parse_clip(data, label="walk.bvh", **options)


def test_a_motion_comes_back_from_bvhio():
    motion = clip_of(TEXT.encode()).motion
    again = from_bvhio(to_bvhio(motion))
    assert again.skeleton.names == motion.skeleton.names
    assert again.skeleton.channels == motion.skeleton.channels
    assert again.skeleton.parents.tolist() == motion.skeleton.parents.tolist()
    assert again.frame_time == motion.frame_time
    np.testing.assert_allclose(again.skeleton.offsets, motion.skeleton.offsets, atol=1e-6)
    np.testing.assert_allclose(again.skeleton.end_sites[0].offset, [0.0, 5.0, 0.0])
    np.testing.assert_allclose(again.translations, motion.translations, atol=1e-5)
    assert np.degrees(rot.angle_between(again.rotations, motion.rotations)).max() < 1e-4


def test_what_bvhio_writes_is_read(tmp_path):
    bvhio = pytest.importorskip("bvhio")
    motion = clip_of(TEXT.encode()).motion
    bvhio.writeBvh(str(tmp_path / "theirs.bvh"), to_bvhio(motion))
    again = clip_of((tmp_path / "theirs.bvh").read_bytes()).motion
    assert np.degrees(rot.angle_between(again.rotations, motion.rotations)).max() < 1e-3


SAME = {
    "as bvhio likes it": TEXT.encode(),
    "with what bvhio refuses: a BOM, braces beside names": b"\xef\xbb\xbf"
    + TEXT.replace("Spine\n\t{", "A b {").encode(),
    "with keywords bvhio does not know": TEXT.lower().encode(),
    "with channels bvhio passes over": TEXT.replace("Zrotation", "ZROTATION").encode(),
    "without CHANNELS": with_text("\t\tEnd", "\t\tJOINT x\n{\nOFFSET 1 1 1\n}\n\t\tEnd"),
    "with a name that is not UTF-8": with_text("Spine", "H@fte").replace(b"@", b"\xfc"),
}


@pytest.mark.parametrize("name", SAME)
def test_bvhio_agrees_with_what_was_read(name):
    result = check_with_bvhio(SAME[name], clip_of(SAME[name]).motion, leg_length=LEG)
    assert result.ok
    assert result.skipped == 0
    assert result.tolerance == 1e-3 * LEG


def test_a_wrong_frame_count_does_not_hang_bvhio():
    data = with_text("Frames: 3", "Frames: 300")
    assert check_with_bvhio(data, clip_of(data, lenient=True).motion, leg_length=LEG).ok


def test_a_difference_is_found_with_its_frame_and_joint():
    motion = clip_of(TEXT.encode()).motion
    rotations = motion.rotations.copy()
    rotations[2, 0] = rot.multiply(rotations[2, 0], rot.about_axis(0, np.radians(1.0)))
    result = check_with_bvhio(TEXT.encode(), replace(motion, rotations=rotations), leg_length=LEG)
    assert not result.ok
    assert (result.frame, result.joint) == (2, "Spine")
    assert result.distance == pytest.approx(10.5 * np.radians(1.0), rel=1e-3)


def test_frames_at_gimbal_lock_that_differ_are_skipped_and_counted():
    motion = clip_of(with_text("11 -21 31", "11 90 31")).motion
    rotations = motion.rotations.copy()
    rotations[1, 0] = rot.from_euler(np.radians([60.0, 90.0, 0.0]), (2, 0, 1))
    result = check_with_bvhio(TEXT.encode(), replace(motion, rotations=rotations), leg_length=LEG)
    assert result.ok
    assert result.skipped == 1


def test_truncated_bytes_are_refused_before_bvhio_sees_them():
    with pytest.raises(BvhError, match="the file ends inside"):
        check_with_bvhio(HIERARCHY[:150].encode(), clip_of(TEXT.encode()).motion, leg_length=LEG)


def test_another_number_of_frames_is_refused():
    motion = clip_of(TEXT.encode()).motion
    shorter = replace(motion, rotations=motion.rotations[:2], translations=motion.translations[:2])
    with pytest.raises(BvhError, match="has 3 frames, the motion 2"):
        check_with_bvhio(TEXT.encode(), shorter, leg_length=LEG)


def test_a_hierarchy_too_deep_for_bvhio_is_an_error_of_the_clip():
    depth = 1_500
    middle = "".join(f"JOINT j{i}\n{{\nOFFSET 0 1 0\n" for i in range(depth))
    data = with_text("\tJOINT Spine", middle + "JOINT Spine").replace(b"MOTION", b"}" * depth + b"MOTION")
    with pytest.raises(BvhError, match="1502 joints nested"):
        check_with_bvhio(data, clip_of(data).motion, leg_length=LEG)


def test_fresh_bytes_pass_the_check():
    motion = clip_of(TEXT.encode()).motion
    assert check_with_bvhio(new_bytes(motion), motion, leg_length=LEG).distance < 1e-4
