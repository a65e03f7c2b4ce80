"""Whatever legal file comes in: values as `float` reads them, bytes kept, edits that read back."""

import re
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from motionedit.core import rotations as rot
from motionedit.core.bvh import edited_bytes, new_bytes, parse_clip, resampled_bytes
from motionedit.core.bvh.format import format_fixed
from motionedit.core.bvh.parse import _parse_any, parse_block
from motionedit.core.bvh.scan import decimals, words_between

PAD = b"HIERARCHY ROOT x"
NUMBER = re.compile(rb"[-+.0-9eE]+")

digits = st.text("0123456789", max_size=20)
decimal_words = st.builds(
    lambda sign, whole, point, fraction: f"{sign}{whole}{point}{fraction if point else ''}",
    st.sampled_from(["", "-", "+"]),
    st.text("0123456789", min_size=1, max_size=20),
    st.sampled_from(["", "."]),
    digits,
)
words = st.one_of(
    st.floats(-1e6, 1e6).map(repr),
    st.floats(-400.0, 400.0).map(lambda x: f"{x:.6f}"),
    st.floats(-400.0, 400.0).map(lambda x: f"{x:.4f}"),
    st.integers(-999, 999).map(str),
    decimal_words,
    st.floats(allow_nan=False, allow_infinity=False).map(lambda x: f"{x:E}"),
    st.text("0123456789", min_size=1).map(lambda t: f".{t}"),
)
gaps = st.sampled_from([" ", "  ", "\t", " \t  "])
endings = st.sampled_from(["\n", "\r\n", "\r", " \n", "\n\n"])


@given(st.lists(words, min_size=1, max_size=60), gaps)
@settings(max_examples=300)
def test_every_word_is_read_as_float_reads_it(tokens, gap):
    data = PAD + b" " + gap.join(tokens).encode() + b"\n"
    starts, stops = words_between(data, len(PAD), len(data))
    out = np.empty(len(tokens))
    assert parse_block(data, starts, stops, out=out) == max(decimals(token.encode()) for token in tokens)
    exact = np.array([float(token) for token in tokens])
    np.testing.assert_array_equal(out, exact)
    np.testing.assert_array_equal(np.signbit(out), np.signbit(exact))
    # The slow rule, one word after the other, says the same.
    slow = np.empty(len(tokens))
    assert _parse_any(data, starts, stops, slow) == max(decimals(token.encode()) for token in tokens)
    np.testing.assert_array_equal(slow, exact)


@given(st.lists(st.text("0123456789.+-eExnaif_", min_size=1, max_size=6), min_size=1, max_size=8))
@settings(max_examples=300)
def test_a_block_is_refused_exactly_where_a_word_is_no_decimal_number(tokens):
    data = PAD + b" " + " ".join(tokens).encode() + b"\n"
    starts, stops = words_between(data, len(PAD), len(data))
    result = parse_block(data, starts, stops, out=np.empty(len(tokens)))
    form = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
    bad = [i for i, t in enumerate(tokens) if not form.fullmatch(t) or not np.isfinite(float(t))]
    assert (not isinstance(result, int)) == bool(bad)
    if bad:
        assert result.index == bad[0]


@given(st.lists(st.floats(-1e18, 1e18), min_size=1, max_size=30), st.integers(1, 17))
@settings(max_examples=300)
def test_numbers_are_formatted_to_their_decimals(values, places):
    text = format_fixed(np.array(values), decimals=places)
    for row, length, value in zip(text.chars, text.lengths, values, strict=True):
        word = row[len(row) - length :].tobytes().decode()
        assert re.fullmatch(rf"-?(0|[1-9]\d*)\.\d{{{places}}}", word)
        assert not re.fullmatch(r"-0\.0*", word)
        assert abs(float(word) - value) <= 0.5000001 * 10.0**-places + abs(value) * 2.0**-52


@st.composite
def files(draw):
    """Return the bytes of a legal file with a small random tree, odd gaps, endings and numbers."""
    joints = draw(st.integers(1, 4))
    parents = [draw(st.integers(0, j - 1)) for j in range(1, joints)]
    axes = ["X", "Y", "Z"]
    names = [[f"{a}{kind}" for a in axes] for kind in ("position", "rotation")]
    channels = [draw(st.lists(st.sampled_from(names[0] + names[1]), unique=True)) for _ in range(joints)]
    if not any(channels):
        channels[0] = ["Zrotation", "Xrotation", "Yrotation"]
    ending = draw(st.sampled_from(["\n", "\r\n", "\r"]))

    def block(j):
        lines = [f"{'ROOT' if j == 0 else 'JOINT'} joint {j}:x", "{", f"OFFSET {j} 1.5 -2e-1"]
        lines.append(" ".join(["CHANNELS", str(len(channels[j])), *channels[j]]))
        for child, parent in enumerate(parents, start=1):
            if parent == j:
                lines += block(child)
        return [*lines, "}"]

    width = sum(map(len, channels))
    number = st.one_of(
        st.floats(-400.0, 400.0).map(lambda x: f"{x:.5f}"), st.integers(-720, 720).map(str), st.floats(-9, 9).map(repr)
    )
    rows = draw(st.lists(st.lists(number, min_size=width, max_size=width), min_size=1, max_size=6))
    head = ending.join(["HIERARCHY", *block(0), "MOTION", f"Frames: {len(rows)}", "Frame Time: .01", ""])
    body = "".join(draw(gaps).join(row) + draw(endings) for row in rows)
    return (head + body).encode()


@given(files(), st.data())
def test_files_keep_their_bytes_and_edits_read_back(data, draw):
    clip = parse_clip(data, label="x")
    motion = clip.motion
    frames, joints = motion.rotations.shape[:2]
    touched = np.array(draw.draw(st.lists(st.booleans(), min_size=frames * joints, max_size=frames * joints)))
    touched = touched.reshape(frames, joints)
    moved = touched[:, motion.skeleton.translated]
    shifted = replace(motion, translations=motion.translations + 0.125)
    written = edited_bytes(clip, shifted, touched=touched, moved=moved)
    assert NUMBER.sub(b"#", written) == NUMBER.sub(b"#", data)
    again = parse_clip(written, label="x")
    assert np.degrees(rot.angle_between(again.motion.rotations, motion.rotations)).max() < 2e-4
    for p, joint in enumerate(motion.skeleton.translated):
        free = list(motion.skeleton.position_axes[joint])
        step = again.motion.translations[:, p, free] - motion.translations[:, p, free]
        np.testing.assert_allclose(step - 0.125 * moved[:, p, None], 0.0, atol=1e-6)
    same = edited_bytes(clip, shifted, touched=np.zeros_like(touched))
    assert same == data


@given(files())
def test_fresh_and_resampled_files_read_back(data):
    clip = parse_clip(data, label="x")
    for written in (new_bytes(clip.motion), resampled_bytes(clip, clip.motion)):
        again = parse_clip(written, label="x").motion
        assert again.skeleton.channels == clip.motion.skeleton.channels
        assert np.degrees(rot.angle_between(again.rotations, clip.motion.rotations)).max() < 2e-4
        np.testing.assert_allclose(again.translations, clip.motion.translations, atol=1e-6)


@given(st.lists(st.integers(10**14, 10**17), min_size=1, max_size=40), st.integers(0, 16))
def test_words_with_the_most_digits_are_correctly_rounded(mantissas, places):
    tokens = [f"{m // 10**places}.{m % 10**places:0{places}d}" if places else str(m) for m in mantissas]
    data = PAD + b" " + " ".join(tokens).encode() + b"\n"
    starts, stops = words_between(data, len(PAD), len(data))
    out = np.empty(len(tokens))
    parse_block(data, starts, stops, out=out)
    np.testing.assert_array_equal(out, [float(token) for token in tokens])
