"""Odd but legal files are read, value for value."""

import hashlib

import numpy as np
import pytest
from small_clip import HIERARCHY, MOTION, ROWS, TEXT, with_text

from motionedit.core.bvh import edited_bytes, parse_clip, read_clip, unedited_bytes

VALUES = np.array([[float(word) for word in line.split()] for line in ROWS.splitlines()])


def read(data, **options):
    clip = parse_clip(data, label="walk.bvh", **options)
    assert unedited_bytes(clip) == data
    return clip


def test_a_plain_file_gives_its_hierarchy_and_values():
    clip = read(TEXT.encode())
    skeleton = clip.motion.skeleton
    assert skeleton.names == ("Hips", "Spine")
    assert skeleton.parents.tolist() == [-1, 0]
    assert skeleton.offsets.tolist() == [[0.0, 0.0, 0.0], [0.0, 10.5, -0.1]]
    assert skeleton.channels[1] == ("Zrotation", "Xrotation", "Yrotation")
    assert [(site.joint, site.offset.tolist()) for site in skeleton.end_sites] == [(1, [0.0, 5.0, 0.0])]
    assert clip.motion.frame_time == 0.04
    assert clip.label == "walk.bvh"
    assert clip.warnings == ()
    np.testing.assert_array_equal(clip.values, VALUES)
    assert clip.sha256 == hashlib.sha256(TEXT.encode()).hexdigest()


def test_a_file_is_read_under_its_path_or_its_label(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_bytes(TEXT.encode())
    assert read_clip(path).label == str(path)
    assert read_clip(path, label="folder/walk.bvh").label == "folder/walk.bvh"
    np.testing.assert_array_equal(read_clip(path).values, VALUES)


SAME = {
    "CR LF": TEXT.replace("\n", "\r\n").encode(),
    "CR alone": TEXT.replace("\n", "\r").encode(),
    "a BOM": b"\xef\xbb\xbf" + TEXT.encode(),
    "no final newline": TEXT[:-1].encode(),
    "blank lines after": (TEXT + "\n \n\r\n\t").encode(),
    "blank lines between": TEXT.replace("\n", "\n\n").encode(),
    "blanks around": TEXT.replace("\n", "  \t\n   ").encode(),
    "tabs between values": (HIERARCHY + MOTION.replace(" ", "\t").replace("Frame\tTime", "Frame Time")).encode(),
    "vertical tabs and form feeds": with_text("2 3 10.5", "2\v3\f10.5"),
    "a brace on the name's line": TEXT.replace("Spine\n\t{", "Spine {").replace("Hips\n{", "Hips{").encode(),
    "no blanks after the colon": with_text("Frames: 3\nFrame Time: ", "Frames:3\nFrame Time:"),
    "blanks before the colon": with_text("Frames: 3\nFrame Time: ", "Frames  :\t3\nFrame   Time  : \t"),
    "lower case": TEXT.lower().replace("hips", "Hips").replace("spine", "Spine").encode(),
    "upper case": TEXT.upper().replace("HIPS", "Hips").replace("SPINE", "Spine").encode(),
    "a wrapped OFFSET": with_text("0.0 10.5 -1e-1", "0.0\n10.5\n-1e-1"),
    "everything on one line": (
        " ".join(HIERARCHY.split("\n")).replace("Hips ", "Hips").replace("Spine ", "Spine") + MOTION
    ).encode(),
    "plus signs and bare points": with_text("10.5 -20.25 30 4", "+10.5 -20.250 30. +004"),
    "exponents": with_text("10.5 -20.25 30 4", "1.05e1 -2025E-2 3e+1 0.04e2"),
    "many digits": with_text("10.5 -20.25", "10.500000000000000000000000 -20.24999999999999999999"),
    "leading zeros": with_text("10.5", "0" * 40 + "10.5"),
    "a numbered End": with_text("End Site", "End Site4"),
    "a named End": with_text("End Site", "End l_toes_End"),
    "a bare End": with_text("End Site", "End"),
    "a bare End and its brace": with_text("End Site\n\t\t{", "END{"),
    "a final Ctrl-Z": TEXT.encode() + b"\x1a",
    "a final Ctrl-Z after the last number": TEXT[:-1].encode() + b"\x1a",
    "a final Ctrl-Z and a newline": TEXT.encode() + b"\x1a\r\n",
    "a last record filled up with Ctrl-Z": TEXT.encode() + b"\x1a" * 100,
    "a final Ctrl-Z and blank lines": TEXT[:-1].encode() + b"\r\n\r\n \x1a\n\t\n",
}


@pytest.mark.parametrize("name", SAME)
def test_another_way_of_writing_gives_the_same_clip(name):
    clip = read(SAME[name])
    np.testing.assert_array_equal(clip.values, VALUES)
    assert clip.motion.skeleton.names == ("Hips", "Spine")
    assert clip.motion.skeleton.channels == read(TEXT.encode()).motion.skeleton.channels
    assert [(site.joint, site.offset.tolist()) for site in clip.motion.skeleton.end_sites] == [(1, [0.0, 5.0, 0.0])]
    assert clip.motion.frame_time == 0.04


@pytest.mark.parametrize("end", [b"\x1a", b"\n\x1a", b"\x1a\n", b"\n\x1a\r\n \n", b"\n\x1a\x1a\x1a"])
def test_a_final_ctrl_z_stays_where_it_is_in_an_edit(end):
    data = TEXT[:-1].encode() + end
    clip = parse_clip(data, label="walk.bvh")
    touched = np.zeros((3, 2), dtype=bool)
    touched[2, 1] = True
    written = edited_bytes(clip, clip.motion, touched=touched)
    assert written == data.replace(b"32 4 5 6", b"32 4.000000 5.000000 6.000000")


@pytest.mark.parametrize("name", ["mixamorig:Hips", "Left Up Leg", "MOTION", "JOINT", "ROOT OFFSET", "Hüfte", "腰"])
def test_names_keep_their_blanks_colons_and_letters(name):
    assert read(with_text("Spine", f" {name} \t")).motion.skeleton.names[1] == name


def test_a_name_in_latin_1_is_read():
    assert read(with_text("Spine", "H@fte").replace(b"@", b"\xfc")).motion.skeleton.names[1] == "Hüfte"


def test_a_leaf_may_have_no_end_site_or_several_beside_a_child():
    assert read(with_text("\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0.0 5.0 0.0\n\t\t}\n", "")).motion.skeleton.end_sites == ()
    site = "End Site\n{\nOFFSET 1 2 3\n}\n"
    clip = read(with_text("\tJOINT", site + site + "\tJOINT"))
    assert [s.joint for s in clip.motion.skeleton.end_sites] == [0, 0, 1]


def test_channels_may_be_none_and_positions_on_any_joint_in_any_order():
    channels = "4 Xrotation Zposition Yrotation Xposition"
    clip = read(
        with_text("3 Zrotation Xrotation Yrotation\n", f"{channels}\n\t\tJOINT Fixed\n{{\nOFFSET 7 8 9\n}}\n").replace(
            ROWS.encode(), b"1 2 3 4 5 6 10 -5 20 6\n" * 3
        )
    )
    skeleton = clip.motion.skeleton
    assert skeleton.channels[2] == ()
    assert skeleton.rotation_axes[1] == (0, 1)
    assert skeleton.translated.tolist() == [0, 1]
    # A position channel replaces that axis of OFFSET alone.
    assert clip.motion.translations[0, 1].tolist() == [6.0, 10.5, -5.0]
    assert clip.motion.rotations[0, 2].tolist() == [1.0, 0.0, 0.0, 0.0]


def test_a_chain_of_joints_longer_than_any_recursion_is_read():
    depth = 1_900
    middle = "".join(f"JOINT j{i}\n{{\nOFFSET 0 1 0\n" for i in range(depth))
    clip = read(with_text("\tJOINT Spine", middle + "JOINT Spine").replace(b"MOTION", b"}" * depth + b"MOTION"))
    assert len(clip.motion.skeleton.levels) == depth + 2


def test_more_or_fewer_rows_than_declared_are_used_leniently_with_a_warning():
    for declared in (2, 5, 1_000_000_000):
        clip = read(with_text("Frames: 3", f"Frames: {declared}"), lenient=True)
        assert len(clip.motion) == 3
        assert clip.warnings == (f"walk.bvh:17: Frames: says {declared}, the file has 3 rows, which are used",)


@pytest.mark.parametrize("end", ["12 -22.125 32 4 5", "12 -", "12 1e", "12 .", "12 -22.125 32\x1a", "12 -\n\x1a\n"])
def test_a_last_row_that_is_cut_short_is_left_out_leniently_with_a_warning(end):
    data = TEXT[: TEXT.index("12 -22.125")].encode() + end.encode()
    clip = read(data, lenient=True)
    np.testing.assert_array_equal(clip.values, VALUES[:2])
    assert clip.warnings == (
        "walk.bvh:21: the last row is cut short and left out",
        "walk.bvh:17: Frames: says 3, the file has 2 rows, which are used",
    )


def test_nothing_but_a_cut_row_leaves_no_frames():
    with pytest.raises(Exception, match="17: the file has no frames"):
        read(TEXT[: TEXT.index("-20.25")].encode(), lenient=True)
