import numpy as np
import pytest
from mannequin import bvh_text

from motionedit.core.bvh import parse_clip
from motionedit.jobs.clip.facts import facts_of
from motionedit.jobs.preview.bodies import _RADII, body_of, upright


def made(**options):
    return body_of(facts_of(parse_clip(bvh_text(**options).encode(), label="x.bvh")), label="x")


@pytest.fixture(scope="module")
def body():
    return made()


def limb_to(body, name):
    point = body.names.index(name)
    return next(limb for limb in body.limbs if limb.end == point)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_upright_is_a_rotation_that_brings_up_to_y(axis, sign):
    up = sign * np.eye(3)[axis]
    turn = upright(up)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3))
    np.testing.assert_allclose(turn @ up, [0.0, 1.0, 0.0])


def test_a_file_with_z_up_stands_as_one_with_y_up(body):
    turned = made(z_up=True)
    np.testing.assert_allclose(turned.positions, body.positions, atol=1e-4)
    assert body.axes == ("x", "y", "z")
    assert turned.axes == ("x", "z", "-y")


def test_the_points_are_joints_then_end_sites_then_what_only_serves_the_drawing(body):
    assert body.names[:2] == ("Hips", "LeftUpLeg")
    assert body.names[22:] == (
        *(f"{name} (end site)" for name in ("LeftToeBase", "RightToeBase", "Head", "LeftHand", "Club")),
        "",
        "",
    )
    assert body.positions.shape == (12, 29, 3)


def test_end_sites_are_where_the_offsets_say_in_a_pose_without_turns(body):
    head, top = (body.positions[0, body.names.index(name)] for name in ("Head", "Head (end site)"))
    np.testing.assert_allclose(top - head, [0.0, 18.0, 0.0], atol=1e-9)


def test_sides_follow_the_anatomy(body):
    assert limb_to(body, "LeftLeg").side == "left"
    assert limb_to(body, "RightForeArm").side == "right"
    assert limb_to(body, "Spine1").side == "middle"


def test_the_way_from_a_root_on_the_ground_up_to_the_pelvis_is_no_limb():
    hips = bvh_text().partition("HIERARCHY\n")[2].partition("MOTION")[0].replace("ROOT Hips", "JOINT Hips", 1)
    channels = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"
    assert hips.count(channels) == 1
    offset, turns = hips.split("\n")[2].strip(), "CHANNELS 3 Zrotation Xrotation Yrotation"
    hips = hips.replace(offset, "OFFSET 0 90 0", 1).replace(channels, turns)
    rows = bvh_text().splitlines()[-12:]
    moved = ["0 0 0 0 0 0 " + " ".join(row.split()[3:]) for row in rows]
    head = f"HIERARCHY\nROOT Ground\n{{\nOFFSET 0 0 0\n{channels}\n{hips}}}\nMOTION\nFrames: 12\nFrame Time: 0.04\n"
    text = head + "\n".join(moved) + "\n"
    grounded = body_of(facts_of(parse_clip(text.encode(), label="x.bvh")), label="x")
    assert "Ground" not in {grounded.names[limb.start] for limb in grounded.limbs}


PARTS = {
    "thigh": ("LeftLeg", "RightLeg"),
    "shin": ("LeftFoot", "RightFoot"),
    "foot": ("LeftToeBase", "RightToeBase"),
    "spine": ("Spine", "Spine1"),
    "neck": ("Neck", "Head"),
    "upper arm": ("LeftForeArm", "RightForeArm"),
    "forearm": ("LeftHand", "RightHand"),
    "hand": ("LeftHand (end site)",),
    "prop": ("Club", "Club (end site)"),
}


@pytest.mark.parametrize("part", PARTS)
def test_each_link_is_as_thick_as_the_part_of_the_body_that_it_is(body, part):
    for name in PARTS[part]:
        assert limb_to(body, name).radii == tuple(body.size * radius for radius in _RADII[part]), name


def test_what_is_below_the_toes_joint_is_thin():
    end = "\tEnd Site\n\t\t\t\t\t{\n\t\t\t\t\t\tOFFSET 0.000000 0.000000 6.000000\n\t\t\t\t\t}\n"
    text = bvh_text()
    assert text.count(end) == 2
    joint = "JOINT ToeEnd\n{\nOFFSET 0 0 6\nCHANNELS 0\n" + end.replace("6.000000", "2.000000") + "}\n"
    body = body_of(facts_of(parse_clip(text.replace(end, joint, 1).encode(), label="x.bvh")), label="x")
    radii = {part: tuple(body.size * radius for radius in _RADII[part]) for part in ("foot", "toe")}
    links = {"LeftToeBase": "foot", "ToeEnd": "toe", "ToeEnd (end site)": "toe", "RightToeBase": "foot"}
    assert {name: limb_to(body, name).radii for name in links} == {name: radii[part] for name, part in links.items()}


def test_the_hulls_of_pelvis_and_chest_hold_hips_waist_and_shoulders(body):
    pelvis, chest = body.hulls
    names = [[body.names[point] for point in hull.points] for hull in body.hulls]
    assert names == [["LeftUpLeg", "RightUpLeg", "Hips"], ["LeftArm", "RightArm", "Spine"]]
    for hull in (pelvis, chest):
        # Wide enough to round a hip, and by far narrower than the body.
        assert all(0.05 * body.size < radius < 0.1 * body.size for radius in hull.radii)
    assert not {"LeftUpLeg", "RightUpLeg", "LeftArm", "RightArm"} & {body.names[limb.end] for limb in body.limbs}


def test_without_arms_there_is_a_pelvis_alone():
    lines = bvh_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.split()[-1:] == ["LeftShoulder"])
    stop = next(i for i, line in enumerate(lines) if line == "MOTION")
    hierarchy = [*lines[:start], *("}" * 3)]
    columns = 6 + 3 * sum(line.split()[:1] == ["JOINT"] for line in hierarchy)
    rows = [" ".join(line.split()[:columns]) for line in lines[stop + 3 :]]
    text = "\n".join([*hierarchy, *lines[stop : stop + 3], *rows]) + "\n"
    armless = body_of(facts_of(parse_clip(text.encode(), label="x.bvh")), label="x")
    assert [[armless.names[point] for point in hull.points] for hull in armless.hulls] == [
        ["LeftUpLeg", "RightUpLeg", "Hips"]
    ]


def test_a_thigh_is_thick_and_a_club_thin(body):
    thigh, club = limb_to(body, "LeftLeg"), limb_to(body, "Club (end site)")
    assert thigh.radii[0] > thigh.radii[1] > 4.0
    assert max(club.radii) < 1.0


def test_the_trail_is_that_of_the_club_head(body):
    assert [body.names[point] for point in body.trails] == ["Club (end site)"]


def test_the_nose_lies_before_the_head(body):
    head, nose = body.balls
    assert (head.part, nose.part) == ("head", "nose")
    ahead = body.positions[0, nose.point] - body.positions[0, head.point]
    np.testing.assert_allclose(ahead / np.linalg.norm(ahead), [0.0, 0.0, 1.0], atol=0.1)
    assert body.forward == pytest.approx((0.0, 0.0, 1.0), abs=1e-9)


def test_pelvis_and_chest_are_hulls_and_cover_the_collars(body):
    pelvis, chest = body.hulls
    assert {body.names[p] for p in pelvis.points} == {"Hips", "LeftUpLeg", "RightUpLeg"}
    assert {"LeftArm", "RightArm"} <= {body.names[p] for p in chest.points}
    assert body.names.index("LeftArm") not in {limb.end for limb in body.limbs}


def test_the_floor_is_up_0_unless_the_figure_never_comes_near_it(body):
    assert body.floor == 0.0
    assert made(hips_height=0.0).floor == pytest.approx(-96.0)


def test_a_skeleton_without_legs_is_thin_limbs_throughout():
    text = (
        "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT b\n{\nOFFSET 0 10 0\n"
        "CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 10 0\n}\n}\n}\n"
        "MOTION\nFrames: 2\nFrame Time: 0.1\n0 0 0 0 0 0\n0 0 0 0 9 0\n"
    )
    body = body_of(facts_of(parse_clip(text.encode(), label="x.bvh")), label="x")
    assert [(body.names[limb.start], body.names[limb.end]) for limb in body.limbs] == [
        ("a", "b"),
        ("b", "b (end site)"),
    ]
    assert all(limb.radii[0] <= 3.0 and limb.side == "middle" for limb in body.limbs)
    assert body.hulls == body.balls == ()
    assert body.trails == (2,)
