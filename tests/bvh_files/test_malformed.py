"""Files that are not legal BVH: each is refused with its line and a true reason, quickly however large it is."""

import time

import pytest
from small_clip import HIERARCHY, ROWS, TEXT, with_text

from motionedit.core.bvh import parse_clip, read_clip
from motionedit.errors import BvhError

SECONDS = 1.0
MANY = 50_000_000


def refusal(data, *, lenient=False):
    started = time.process_time()
    with pytest.raises(BvhError) as caught:
        parse_clip(data, label="walk.bvh", lenient=lenient)
    assert time.process_time() - started < SECONDS
    assert "\n" not in str(caught.value)
    return str(caught.value)


HEADERS = [
    ("an empty file", b"", "1: the file is empty"),
    ("blanks alone", b" \r\n\n\t", "1: the file is empty"),
    (
        "NUL bytes",
        bytes(1000),
        "1: NUL bytes: this is no text file (UTF-16 or binary); a BVH file is plain text",
    ),
    ("UTF-16", TEXT.encode("utf-16"), "1: this is UTF-16 text; save the file as UTF-8 or plain ASCII"),
    (
        "UTF-16 without a mark",
        TEXT.encode("utf-16-le"),
        "1: NUL bytes: this is no text file (UTF-16 or binary); a BVH file is plain text",
    ),
    ("a picture", b"\x89PNG\r\n\x1a\n", "1: expected HIERARCHY, found '\\x89PNG': not a BVH file"),
    ("no HIERARCHY", TEXT[10:].encode(), "1: expected HIERARCHY, found 'ROOT': not a BVH file"),
    ("HIERARCHY alone", b"HIERARCHY\n", "1: expected ROOT after HIERARCHY, found nothing"),
    ("a cut hierarchy", HIERARCHY[:-4].encode(), "13: the file ends inside joint 'Spine': 2 '}' missing"),
    ("no MOTION", HIERARCHY.encode(), "15: the file ends before MOTION"),
    ("a brace too many", with_text("MOTION", "}\nMOTION"), "16: a '}' too many"),
    (
        "a brace too few",
        with_text("\t}\n}\nM", "\t}\nM"),
        "15: MOTION inside joint 'Hips': 1 '}' missing",
    ),
    ("no brace after a name", with_text("Spine\n\t{", "Spine"), "7: expected '{' after joint 'Spine', found 'OFFSET'"),
    (
        "a second ROOT",
        with_text("MOTION", "ROOT b\n{\nOFFSET 0 0 0\n}\nMOTION"),
        "16: a second ROOT; only one skeleton a file can be read",
    ),
    ("a ROOT inside", with_text("JOINT", "ROOT"), "6: a ROOT inside joint 'Hips'; only one ROOT can be read"),
    ("a ROOT without a name", with_text("ROOT Hips", "ROOT"), "2: ROOT without a name"),
    ("a JOINT without a name", with_text("JOINT Spine\n\t{", "JOINT {"), "6: JOINT without a name"),
    ("a NUL in a name", with_text("Spine", "Sp\0ine"), "6: NUL bytes in a joint's name: a BVH file is plain text"),
    ("no OFFSET", with_text("\t\tOFFSET 0.0 10.5 -1e-1\n", ""), "13: joint 'Spine' has no OFFSET"),
    ("a short OFFSET", with_text(" -1e-1", ""), "8: OFFSET of joint 'Spine' has 2 values, it needs 3"),
    ("a long OFFSET", with_text("-1e-1", "1 2"), "8: OFFSET of joint 'Spine' has more than 3 values, it needs 3"),
    ("nan in OFFSET", with_text("-1e-1", "nan"), "8: OFFSET of joint 'Spine': 'nan' is not a finite number"),
    ("an infinite OFFSET", with_text("-1e-1", "1e999"), "8: OFFSET of joint 'Spine': '1e999' is not a finite number"),
    ("an OFFSET too far", with_text("-1e-1", "-1e31"), "8: OFFSET of joint 'Spine': '-1e31' is beyond any length"),
    ("two OFFSETs", with_text("-1e-1", "1\nOFFSET 0 0 0"), "9: a second OFFSET in joint 'Spine'"),
    ("two CHANNELS", with_text("\t\tEnd", "CHANNELS 0\nEnd"), "10: a second CHANNELS in joint 'Spine'"),
    (
        "CHANNELS after a child",
        with_text("\t}\n}\n", "\tJOINT a {\nOFFSET 0 0 0\nJOINT b {\nOFFSET 0 0 0\n}\nCHANNELS 0\n}\n\t}\n}\n"),
        "19: CHANNELS of joint 'a' stands after a child; it must stand before",
    ),
    ("an unknown channel", with_text("3 Z", "3 W"), "9: joint 'Spine': unknown channel 'Wrotation'"),
    ("a repeated channel", with_text("3 Z", "3 X"), "9: joint 'Spine': channel Xrotation is repeated"),
    ("too few channels", with_text("3 Z", "6 Z"), "9: joint 'Spine' says 6 channels and names 3"),
    ("too many channels", with_text("3 Z", "2 Z"), "9: joint 'Spine' says 2 channels and names 3"),
    (
        "a negative channel count",
        with_text("3 Z", "-3 Z"),
        "9: CHANNELS of joint 'Spine': '-3' is not a count from 0 to 6",
    ),
    ("seven channels", with_text("3 Z", "7 Z"), "9: CHANNELS of joint 'Spine': '7' is not a count from 0 to 6"),
    (
        "no channel count",
        with_text("3 Zrotation Xrotation Yrotation", ""),
        "9: CHANNELS of joint 'Spine' has no count",
    ),
    (
        "channels of an End Site",
        with_text("5.0 0.0\n", "5.0 0.0\nCHANNELS 0\n"),
        "13: CHANNELS inside an End Site; an End Site holds only its OFFSET",
    ),
    (
        "a joint in an End Site",
        with_text("OFFSET 0.0 5.0 0.0", "JOINT a"),
        "12: JOINT inside an End Site; an End Site holds only its OFFSET",
    ),
    ("an empty End Site", with_text("\t\t\tOFFSET 0.0 5.0 0.0\n", ""), "12: End Site has no OFFSET"),
    (
        "a strange word in a joint",
        with_text("JOINT", "JOIN"),
        "6: expected OFFSET, CHANNELS, JOINT, End Site or '}' in joint 'Hips', found 'JOIN'",
    ),
    ("a strange word after", with_text("MOTION", "x"), "16: expected MOTION after the hierarchy, found 'x'"),
    (
        "no channel at all",
        with_text("6 Xposition Yposition Zposition Zrotation Xrotation Yrotation", "0").replace(
            b"3 Zrotation Xrotation Yrotation", b"0"
        ),
        "16: the hierarchy has no channels, so no motion can be in this file",
    ),
    ("no Frames:", with_text("Frames: 3\n", ""), "17: expected 'Frames:' in the MOTION part, found 'Frame'"),
    ("no count of frames", with_text("Frames: 3", "Frames:"), "17: Frames: has no count"),
    ("negative frames", with_text("Frames: 3", "Frames: -3"), "17: Frames: '-3' is not a count of frames"),
    ("frames in science", with_text("Frames: 3", "Frames: 1e9"), "17: Frames: '1e9' is not a count of frames"),
    ("half a frame", with_text("Frames: 3", "Frames: 2.5"), "17: Frames: '2.5' is not a count of frames"),
    (
        "a billion frames",
        with_text("Frames: 3", "Frames: 1000000000"),
        "17: Frames: says 1000000000, the file has 3 rows; --lenient uses the rows that are there",
    ),
    (
        "one frame too many",
        with_text("Frames: 3", "Frames: 2"),
        "17: Frames: says 2, the file has 3 rows; --lenient uses the rows that are there",
    ),
    (
        "one frame too few",
        TEXT[: TEXT.index("2 2 3")].encode(),
        "17: Frames: says 3, the file has 2 rows; --lenient uses the rows that are there",
    ),
    (
        "no frames",
        with_text("Frames: 3\nFrame Time: 0.04\n" + ROWS, "Frames: 0\nFrame Time: 1"),
        "17: the file has no frames",
    ),
    ("no frame time", with_text("Frame Time: 0.04\n", ""), "18: expected 'Frame Time:' in the MOTION part, found '1'"),
    ("an empty frame time", with_text("Time: 0.04", "Time:"), "18: Frame Time: has no number"),
    ("a frame time of 0", with_text("0.04", "0.0"), "18: Frame Time: 0.0 is not positive"),
    ("a negative frame time", with_text("0.04", "-0.04"), "18: Frame Time: -0.04 is not positive"),
    ("nan as frame time", with_text("0.04", "nan"), "18: Frame Time: 'nan' is not a number"),
    ("an infinite frame time", with_text("0.04", "inf"), "18: Frame Time: 'inf' is not a number"),
    ("a comma in the frame time", with_text("0.04", "0,04"), "18: Frame Time: '0,04' is not a number"),
]


@pytest.mark.parametrize(("data", "message"), [case[1:] for case in HEADERS], ids=[case[0] for case in HEADERS])
def test_a_wrong_header_is_refused_with_its_line(data, message):
    assert refusal(data) == f"walk.bvh:{message}"


@pytest.mark.parametrize(
    "word",
    [
        *("nan", "NaN", "inf", "-inf", "infinity", "0x10", "1-2", "1+2", "1.2.3", "1_000", "1D5", "1d5", "-", "+"),
        *(".", "-.", "e5", "1e", "1e+", "1e999", "abc", "1,5", "--1", "+-1", "1e5.0", "{", "½", "1/2", "#1"),
    ],
)
def test_a_word_that_is_no_finite_number_is_refused_with_its_line_and_text(word):
    assert refusal(with_text("-21", word)) == f"walk.bvh:20: frame 1: '{word}' is not a finite number"
    # Also among other long numbers and exponents, which are read another way.
    longer = with_text("-21", f"1e-3 {word} 0.12345678901234567890").replace(b" 11 1e", b" 1e").replace(b" 31", b"")
    assert refusal(longer) == f"walk.bvh:20: frame 1: '{word}' is not a finite number"


@pytest.mark.parametrize("word", ["1e31", "-1e160"])
def test_a_position_too_far_is_refused_and_an_angle_of_that_size_is_not(word):
    size = word.removeprefix("-").replace("e", "e+")
    expected = f"walk.bvh:20: frame 1 has a position of {size}, which is beyond any length"
    assert refusal(with_text("1.5 2 3", f"1.5 {word} 3")) == expected
    assert len(parse_clip(with_text("-21", "1e31"), label="walk.bvh").motion) == 3


@pytest.mark.parametrize("lenient", [False, True])
def test_a_row_of_another_length_is_refused(lenient):
    assert (
        refusal(with_text("11 -21 31 ", ""), lenient=lenient)
        == "walk.bvh:20: frame 1 has 6 values, the hierarchy has 9 channels"
    )
    assert (
        refusal(with_text("11 -21", "11 7 -21"), lenient=lenient)
        == "walk.bvh:20: frame 1 has 10 values, the hierarchy has 9 channels"
    )


def test_a_file_that_ends_inside_a_row_is_refused():
    cut = TEXT[: TEXT.index("22.125")].encode()
    assert refusal(cut) == "walk.bvh:21: frame 2 has 5 values, the hierarchy has 9 channels"


@pytest.mark.parametrize("lenient", [False, True])
def test_text_after_the_rows_is_refused(lenient):
    assert refusal(TEXT.encode() + b"the end\n", lenient=lenient).endswith(":22: frame 3: 'the' is not a finite number")
    assert refusal(TEXT.encode() + b"\xff\xfe", lenient=lenient).endswith(":22: frame 3: 'ÿþ' is not a finite number")


def test_control_characters_among_the_values_are_named():
    assert refusal(with_text("-21", "-2\x001")) == "walk.bvh:20: a NUL byte among the values: not a text file"
    assert refusal(with_text("-21", "-2\x1f1")).endswith("20: control character 0x1f among the values: not a text file")


@pytest.mark.parametrize("lenient", [False, True])
def test_a_ctrl_z_anywhere_but_at_the_end_is_refused(lenient):
    says = ": control character 0x1a among the values: not a text file"
    assert refusal(with_text("-21", "-2\x1a1"), lenient=lenient) == f"walk.bvh:20{says}"
    assert refusal(with_text("1.5 2", "\x1a\n1.5 2"), lenient=lenient) == f"walk.bvh:20{says}"
    assert refusal(with_text("0.04\n", "0.04\n\x1a\n"), lenient=lenient) == f"walk.bvh:19{says}"
    assert refusal(TEXT.encode() + b"\x1a\n1 2 3 4 5 6 7 8 9\n", lenient=lenient) == f"walk.bvh:22{says}"
    assert refusal(TEXT.encode() + b"\x1a\x1a 1", lenient=lenient) == f"walk.bvh:22{says}"
    assert refusal(TEXT.encode() + b"\x1b", lenient=lenient).startswith("walk.bvh:22: control character 0x1b")
    assert refusal(with_text("MOTION", "\x1a\nMOTION")).startswith("walk.bvh:16: expected MOTION after the hierarchy")


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_lines_are_counted_whatever_ends_them(ending):
    assert refusal(TEXT.replace("-21", "x").replace("\n", ending).encode()).startswith("walk.bvh:20: ")


def test_lines_are_counted_where_endings_are_mixed():
    lines = TEXT.replace("-21", "x").split("\n")
    mixed = "".join(line + ("\r\n", "\r", "\n")[i % 3] for i, line in enumerate(lines))
    assert refusal(mixed.encode()).startswith("walk.bvh:20: ")


JOINT = b"JOINT x\n{\nOFFSET 0 0 0\nCHANNELS 0\n"
HOSTILE = {
    "a million opening braces": (lambda: b"HIERARCHY\nROOT a\n" + b"{" * 10**6, "3: expected OFFSET, CHANNELS"),
    "a million closing braces": (lambda: b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n" + b"}" * 10**6, "5: a '}' too many"),
    "a million nested joints": (
        lambda: b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n" + JOINT * 10**6,
        "8001: more than 2000 joints",
    ),
    "a row without end": (lambda: with_text("-21", "1 " * (MANY // 2)), "20: frame 1 has 25000008 values"),
    "a number without end": (lambda: with_text("-21", "1" * MANY), "20: frame 1: '111"),
    "a name without end": (lambda: with_text("Spine\n\t{", "S" * MANY), "6: 'SSSS"),
    "an OFFSET without end": (
        lambda: with_text("10.5 ", "1 " * (MANY // 2)),
        "8: OFFSET of joint 'Spine' has more than 3",
    ),
    "a count without end": (lambda: with_text("Frames: 3", "Frames: " + "3" * MANY), "17: Frames: '333"),
    "one word": (lambda: b"a" * MANY, "1: 'aaa"),
    "blank lines in the header": (lambda: with_text("MOTION", "\n" * MANY + "x"), f"{MANY + 16}: expected MOTION"),
    "blank lines and no more": (lambda: b"HIERARCHY" + b"\n" * MANY, "1: expected ROOT"),
    "blank lines after the rows": (lambda: TEXT.encode() + b"\n" * MANY + b"x", f"{MANY + 22}: frame 3: 'x'"),
    "blanks in a row": (lambda: with_text("-21", " " * MANY + "x"), "20: frame 1: 'x'"),
    "more rows than declared": (
        lambda: TEXT.encode() + b"1 2 3 4 5 6 7 8 9\r" * (MANY // 18),
        "17: Frames: says 3, the file",
    ),
    "shorter rows than declared": (lambda: TEXT.encode() + b"1 2\n" * (MANY // 4), "22: frame 3 has 2 values"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_within_a_second(name):
    make, beginning = HOSTILE[name]
    message = refusal(make())
    assert message.startswith(f"walk.bvh:{beginning}")
    assert len(message) < 200


def test_a_path_that_cannot_be_opened_is_an_error_of_the_clip(tmp_path):
    with pytest.raises(BvhError, match="cannot be read: No such file or directory") as caught:
        read_clip(tmp_path / "none.bvh", label="none.bvh")
    assert str(caught.value).startswith("none.bvh: ")
