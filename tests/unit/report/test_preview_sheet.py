import re
import struct
from dataclasses import replace

import numpy as np
import pytest
from mannequin import bvh_text

from motionedit.core.bvh import parse_clip
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.preview.bodies import body_of

pytest.importorskip("matplotlib", reason="sheets need the extra motionedit[plot]")

from motionedit.report.sheet import _view, key_frames, sheet
from motionedit.report.sheet_shapes import pose_shapes


def made(*, label="swing", **options):
    return body_of(facts_of(parse_clip(bvh_text(**options).encode(), label="x.bvh")), label=label)


def size_of(png):
    assert png.startswith(b"\x89PNG")
    return struct.unpack(">II", png[16:24])


def test_a_sheet_is_as_wide_as_a_readme_and_the_same_every_time():
    body = made()
    first = sheet([body], "png")
    assert size_of(first)[0] == 1800
    assert sheet([made()], "png") == first


def test_an_svg_has_no_date_and_is_the_same_every_time():
    first = sheet([made()], "svg")
    assert sheet([made()], "svg") == first
    assert re.findall(rb"\d{4}-\d\d-\d\dT", first) == []


def test_two_clips_that_keep_together_share_a_row_and_others_do_not():
    body = made()
    near, far = (replace(body, positions=body.positions + np.array([x, 0.0, 0.0])) for x in (20.0, 400.0))
    one = size_of(sheet([body], "png"))[1]
    assert size_of(sheet([body, near], "png"))[1] < 1.5 * one
    assert size_of(sheet([body, far], "png"))[1] == pytest.approx(2 * one, abs=2)
    assert size_of(sheet([body, body, body], "png"))[1] == pytest.approx(3 * one, abs=3)


def test_a_name_in_any_letters_is_only_a_name():
    assert size_of(sheet([made(label="a_$x^ \u6b69\u304f")], "png"))[0] == 1800


def test_key_frames_hold_both_ends_and_are_denser_where_the_body_is_faster():
    body = made(frames=101)
    still = np.concatenate((np.repeat(body.positions[:1], 100, axis=0), body.positions))
    frames = key_frames(replace(body, positions=still), 11)
    assert (frames[0], frames[-1], len(frames)) == (0, 200, 11)
    assert np.sum(frames > 100) == 8


def test_a_rest_pose_in_front_is_no_key_frame():
    assert key_frames(replace(made(), first=2), 5)[0] == 2


def test_a_clip_of_one_frame_and_a_clip_at_rest_have_key_frames():
    assert key_frames(made(frames=1), 8).tolist() == [0]
    assert key_frames(made(frames=9, swing=0.0), 3).tolist() == [0, 4, 8]
    assert size_of(sheet([made(frames=1)], "png"))[0] == 1800


def test_a_walk_is_seen_from_its_right_side_and_goes_to_the_right():
    view = _view(made(step=30.0))
    np.testing.assert_allclose(view.right, [0.0, 0.0, 1.0], atol=1e-6)
    np.testing.assert_allclose(view.back, [-1.0, 0.0, 0.0], atol=1e-6)


def test_the_view_is_no_mirror():
    for body in (made(), made(step=30.0)):
        view = _view(body)
        np.testing.assert_allclose(np.cross(view.right, [0.0, 1.0, 0.0]), view.back, atol=1e-12)


def test_the_left_side_is_paler_than_the_right():
    body = made()
    flat = body.positions[0]
    light = {side: [] for side in ("left", "middle", "right")}
    for limb in body.limbs:
        alone = replace(body, limbs=(limb,), hulls=(), balls=())
        light[limb.side] += [sum(shape.fill) for shape in pose_shapes(alone, flat, "#2a78bd")]
    assert max(light["right"]) < min(light["middle"]) <= max(light["middle"]) < min(light["left"])


def test_what_is_nearer_is_drawn_later():
    body = made()
    near = next(i for i, limb in enumerate(body.limbs) if limb.end == body.names.index("LeftForeArm"))
    flat = body.positions[0].copy()
    flat[[body.limbs[near].start, body.limbs[near].end], 2] += 500.0
    last = pose_shapes(replace(body, hulls=(), balls=()), flat, "#2a78bd")[-1].outline
    np.testing.assert_allclose(last.mean(axis=0)[0], flat[body.limbs[near].end, 0], atol=2.0)


def test_a_limb_seen_from_its_end_is_a_disc():
    body = made()
    limb = body.limbs[0]
    flat = body.positions[0].copy()
    flat[limb.end, :2] = flat[limb.start, :2]
    (shape,) = pose_shapes(replace(body, limbs=(limb,), hulls=(), balls=()), flat, "#2a78bd")
    radii = np.linalg.norm(shape.outline - flat[limb.start, :2], axis=1)
    np.testing.assert_allclose(radii, max(limb.radii), rtol=1e-9)
