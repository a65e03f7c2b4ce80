"""What the page shows of an edit: goals in the scene, lanes under the time line, keys and hands that move them."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from motionedit.cli import main

ROOT = Path(__file__).resolve().parents[2]
FRAME = "Number(document.querySelector('#now b').textContent)"
NAMES = "[...document.querySelectorAll('#lanes .name')].map(e => e.textContent)"
CHOSEN = "[...document.querySelectorAll('#lanes .chosen .name')].map(e => e.textContent)"
GREEN = {False: (11, 122, 94), True: (69, 208, 165)}  # --goal, light and dark
RED = {False: (196, 32, 29), True: (255, 123, 114)}  # --miss


def pixels(canvas, color, area="0, 0, c.width, c.height"):
    """Return a script that counts the pixels of a colour in a canvas."""
    r, g, b = color
    return f"""(() => {{
      const c = document.querySelector({canvas!r});
      const data = c.getContext('2d').getImageData({area}).data;
      let count = 0;
      for (let i = 0; i < data.length; i += 4) {{
        count += Math.abs(data[i] - {r}) + Math.abs(data[i + 1] - {g}) + Math.abs(data[i + 2] - {b}) < 12;
      }}
      return count;
    }})()"""


def lane(number):
    return f"#lanes li:nth-child({number + 2}) canvas"


@pytest.fixture(scope="session")
def edited_page(folder):
    """Return a function from a clip of data/, a spec of configs/ and options to the address of the edit's page."""

    def make(name, clip, spec, *options):
        arguments = ["edit-prioritized", ROOT / "data" / clip, "-s", ROOT / "configs" / spec, *options]
        result = CliRunner().invoke(main, [*map(str, arguments), "-o", str(folder / f"{name}.bvh"), "--preview", "-q"])
        assert result.exit_code == 0, result.output
        return (folder / f"{name}.html").as_uri()

    return make


@pytest.fixture(scope="session")
def reach(edited_page):
    return edited_page("reach", "walk.bvh", "reach.yaml")


@pytest.fixture(scope="session")
def missed(edited_page, folder):
    far = ("--set", "constraints.kick.points.0.shift=[0, 90, 0]")
    return edited_page("missed", "kick.bvh", "karate.yaml", *far, "--report", folder / "missed.json")


@pytest.mark.parametrize("dark", [False, True])
def test_the_goal_is_drawn_at_its_frame_without_a_complaint_or_a_request(browser, reach, dark):
    browser.open(reach + "#frame=69&goal=hand", dark=dark)
    assert browser.evaluate(pixels("#scene", GREEN[dark])) > 40
    assert browser.errors == []
    assert [url for url in browser.requests if not url.startswith("data:")] == [reach]


def test_g_puts_goals_and_lanes_away_and_back(browser, reach):
    browser.open(reach + "#frame=69")
    height = browser.evaluate("document.getElementById('scene').clientHeight")
    browser.press("g")
    assert browser.evaluate(pixels("#scene", GREEN[False])) == 0
    assert browser.evaluate("document.getElementById('lanes').offsetHeight") == 0
    assert browser.evaluate("document.getElementById('scene').clientHeight") > height
    browser.press("g")
    assert browser.evaluate(pixels("#scene", GREEN[False])) > 40


def test_constraints_are_named_in_the_order_of_their_priorities(browser, reach):
    browser.open(reach + "#frame=0")
    assert browser.evaluate(NAMES) == ["feet", "feet-2", "feet-3", "feet-4", "hand", "balance"]
    order = browser.evaluate("[...document.querySelectorAll('#lanes .priority')].map(e => Number(e.textContent))")
    assert order == [10, 10, 10, 10, 4, 2]


def test_a_bar_is_drawn_over_its_interval_and_nowhere_else(browser, reach):
    browser.open(reach + "#frame=0")
    hand = lane(4)
    # The hand is active from frame 49 to 89 of 0 to 144.
    x = {frame: f"Math.round(8 + (c.width - 16) * {frame} / 144)" for frame in (49, 66, 72, 89)}
    inside = browser.evaluate(pixels(hand, GREEN[False], f"{x[66]}, 0, {x[72]} - {x[66]}, c.height"))
    before = browser.evaluate(pixels(hand, GREEN[False], f"0, 0, {x[49]} - 3, c.height"))
    after = browser.evaluate(pixels(hand, GREEN[False], f"{x[89]} + 3, 0, c.width, c.height"))
    assert (before, after) == (0, 0)
    assert inside > 100
    assert browser.evaluate(pixels(lane(0), GREEN[False], f"0, 0, {x[49]}, c.height")) > 100


def test_lanes_stand_under_the_time_line(browser, reach):
    browser.open(reach + "#frame=30")
    edges = browser.evaluate(
        f"['#ruler', {lane(0)!r}].map(s => document.querySelector(s).getBoundingClientRect())"
        ".map(r => [r.left, r.right])"
    )
    assert edges[0] == edges[1]


def record(folder):
    return json.loads((folder / "missed.json").read_text(encoding="utf-8"))["clips"][0]


def test_what_is_missed_is_red_and_tells_by_how_much(browser, missed, folder):
    browser.open(missed + "#frame=36")
    assert browser.evaluate("document.querySelector('#lanes .status').textContent") == "out of tolerance"
    assert "priorities 10, 5 above left no freedom" in browser.evaluate(
        "document.querySelector('#lanes .told').textContent"
    )
    assert browser.evaluate(pixels("#scene", RED[False])) > 100
    kick = next(each for each in record(folder)["constraints"] if each["name"] == "kick")
    off = kick["frames"]["error"][36 - kick["first_frame"]]
    assert off > 10.0
    assert browser.evaluate("document.querySelector('#lanes .off').textContent").startswith(f"{off:.1f},")
    # The curve is red where it is above the tolerance, and not where it is within.
    curve = "0, 0, {}, c.height - 13"
    middle = "Math.round(8 + (c.width - 16) * 26 / 83)"
    assert browser.evaluate(pixels(lane(2), RED[False])) > browser.evaluate(
        pixels(lane(2), RED[False], curve.format(middle))
    )
    assert browser.evaluate(pixels(lane(2), RED[False], curve.format(middle))) == 0
    browser.open(missed + "#frame=5")
    assert browser.evaluate("document.querySelector('#lanes .off')") is None


def test_n_and_p_go_from_goal_to_goal(browser, edited_page):
    browser.open(edited_page("stairs", "walk.bvh", "stairs.yaml") + "#frame=31&goal=right-foot")
    seen = []
    for key in ("n", "n", "p", "p", "p"):
        browser.press(key)
        seen.append(browser.evaluate(FRAME))
    assert seen == [34, 58, 34, 29, 6]


def test_arrows_and_clicks_choose_a_constraint_and_escape_lets_it_go(browser, reach):
    browser.open(reach + "#frame=69")
    seen = []
    for key in ("ArrowDown", "ArrowDown", "ArrowUp", "Escape", "ArrowUp"):
        browser.press(key)
        seen.append(browser.evaluate(CHOSEN))
    assert seen == [["feet"], ["feet-2"], ["feet"], [], ["balance"]]
    browser.evaluate("document.querySelectorAll('#lanes button')[4].click()")
    browser.frames()
    assert browser.evaluate(CHOSEN) == ["hand"]
    assert browser.evaluate(f"document.querySelector({lane(4)!r}).clientHeight") > 60
    browser.evaluate("document.querySelectorAll('#lanes button')[4].click()")
    assert browser.evaluate(CHOSEN) == []


def test_a_press_on_a_lane_goes_to_that_time(browser, reach):
    browser.open(reach + "#frame=0")
    box = f"document.querySelector({lane(1)!r}).getBoundingClientRect()"
    left, right, y = browser.evaluate(f"(r => [r.left, r.right, r.top + 5])({box})")
    browser.mouse("mousePressed", left + 8 + (right - left - 16) * 100 / 144, y, button="left", clickCount=1)
    browser.mouse("mouseReleased", left, y, button="left", clickCount=1)
    browser.frames()
    assert browser.evaluate(FRAME) == 100


def test_trails_are_those_of_the_effectors_in_both_clips(browser, reach):
    browser.open(reach + "#frame=69&goal=hand")
    told = browser.evaluate("[...document.querySelectorAll('#legend .where')].map(e => e.textContent)")
    assert [line.split(" · ")[1].split(" ")[0] for line in told] == ["LeftHand", "LeftHand"]
    assert told[1].endswith("58.0, 150.0, 322.0")
    assert told[0] != told[1]


def test_goals_are_drawn_in_both_views_side_by_side(browser, reach):
    browser.open(reach + "#frame=69&layout=side&goal=hand")
    for half in ("0, 0, c.width / 2, c.height", "c.width / 2, 0, c.width / 2, c.height"):
        assert browser.evaluate(pixels("#scene", GREEN[False], half)) > 40


def test_a_finger_turns_the_scene_and_two_zoom(browser, reach):
    browser.open(reach + "#frame=69")
    picture = "document.getElementById('scene').toDataURL()"
    pictures = [browser.evaluate(picture)]
    browser.send("Emulation.setTouchEmulationEnabled", enabled=True)
    for start, end in ((((500, 200),), ((560, 230),)), (((400, 200), (600, 200)), ((350, 200), (650, 200)))):
        for kind, points in (("touchStart", start), ("touchMove", end), ("touchEnd", ())):
            touches = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)]
            browser.send("Input.dispatchTouchEvent", type=kind, touchPoints=touches)
        browser.frames()
        pictures.append(browser.evaluate(picture))
    browser.send("Emulation.setTouchEmulationEnabled", enabled=False)
    assert len(set(pictures)) == 3


def test_a_goal_of_edit_pc_stands_in_the_scene_all_the_time(browser, golf, folder):
    spec = golf.spec(
        folder / "golf.yaml",
        goals=[{"name": "ball", "at": "hit", "effector": {"end_site": "Club"}, "shift": [0, 0, 10], "tolerance": 0.1}],
    )
    arguments = ["edit-pc", golf.swings[3], "-m", golf.model, "-s", spec, "-o", folder / "golf.bvh", "--preview", "-q"]
    assert CliRunner().invoke(main, list(map(str, arguments))).exit_code == 0
    address = (folder / "golf.html").as_uri()
    for frame in (10, 85):
        browser.open(f"{address}#frame={frame}")
        assert browser.evaluate(pixels("#scene", GREEN[False])) > 40
        assert browser.evaluate(NAMES) == ["ball"]
    assert browser.errors == []


def test_a_page_without_goals_has_no_room_and_no_button_for_them(browser, single):
    browser.open(single + "#frame=10")
    assert browser.evaluate("document.getElementById('lanes').offsetHeight") == 0
    assert browser.evaluate("document.getElementById('goals').hidden")
    browser.press("g")
    browser.press("n")
    browser.press("ArrowDown")
    assert browser.errors == []


def test_a_narrow_screen_needs_no_scrolling_aside_and_keeps_the_scene(browser, reach):
    browser.open(reach + "#frame=69", size=(360, 740))
    assert browser.evaluate("document.documentElement.scrollWidth") <= 360
    assert browser.evaluate("document.getElementById('scene').clientHeight") > 200


def test_every_control_of_the_lanes_has_a_name(browser, reach):
    browser.open(reach + "#frame=10")
    assert browser.evaluate(
        "[...document.querySelectorAll('#lanes button')].every(b => b.textContent.trim() && b.title)"
    )
    assert browser.evaluate("document.getElementById('keys').textContent").count("next goal") == 1
