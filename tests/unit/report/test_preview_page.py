import base64
import json
import re

import numpy as np
import pytest

from motionedit.report.preview.body import Body, Limb
from motionedit.report.preview.page import packed, page

LEG = 85.0


def made_body(*, label="swing", frames=145, points=38, way=0.0, seed=0):
    rng = np.random.default_rng(seed)
    positions = rng.uniform(-110.0, 110.0, (frames, points, 3)) + np.array([0.0, 100.0, 0.0])
    positions[..., 2] += np.linspace(0.0, way, frames)[:, None]
    return Body(
        label=label,
        names=tuple(f"Joint{p}" for p in range(points)),
        positions=positions,
        frame_time=0.04,
        first=0,
        limbs=tuple(Limb(p - 1, p, (3.0, 2.0), "left") for p in range(1, points)),
        hulls=(),
        balls=(),
        trails=(points - 1,),
        size=LEG,
        forward=(0.0, 0.0, 1.0),
        axes=("x", "y", "z"),
    )


def unpacked(centers, steps, step):
    centers = np.frombuffer(base64.b64decode(centers), "<f4").reshape(-1, 1, 3).astype(float)
    return centers + step * np.frombuffer(base64.b64decode(steps), "<i2").reshape(len(centers), -1, 3)


@pytest.mark.parametrize("way", [0.0, 1e4, 1e6])
def test_positions_come_back_to_a_tenth_of_a_millimetre_however_long_the_way(way):
    body = made_body(way=way)
    # A leg of 85 units is 0.85 m: one unit is a centimetre.
    np.testing.assert_allclose(unpacked(*packed(body.positions)), body.positions, rtol=0.0, atol=0.01)


def test_a_single_point_is_packed_as_well_as_many():
    positions = np.full((3, 1, 3), 7.25)
    np.testing.assert_array_equal(unpacked(*packed(positions)), positions)


def test_two_clips_of_145_frames_and_31_joints_stay_under_400_kb():
    bodies = [made_body(label="a"), made_body(label="b", seed=1)]
    assert len(page(bodies, title="a, b")) < 400_000


def test_the_same_bodies_give_the_same_bytes():
    assert page([made_body()], title="t") == page([made_body()], title="t")


def test_the_page_names_no_address_and_loads_nothing():
    text = page([made_body()], title="t").decode()
    assert re.findall(r"https?://|//cdn|@import|url\(", text) == []
    assert re.findall(r"""(?:src|href)=["']?([^"'> ]*)""", text) == ["data:,"]
    assert "default-src 'none'" in text


def test_a_clip_name_cannot_leave_the_data_nor_fill_a_mark_of_the_template():
    label = "</script><img src=x>{{script}}{{title}}"
    text = page([made_body(label=label)], title='<&">{{data}}').decode()
    assert text.count("</script>") == 3
    assert "<title>&lt;&amp;&quot;&gt;{{data}}</title>" in text
    data = re.search(r'<script id="clips" type="application/json">(.*?)</script>', text, re.DOTALL)
    assert json.loads(data.group(1))[0]["label"] == label
