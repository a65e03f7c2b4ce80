from itertools import pairwise

import pytest

from motionedit.core.bvh import read_clip
from motionedit.core.kinematics import Effector, effector_positions, forward
from motionedit.jobs.preview import job as preview

PICTURE = "document.getElementById('scene').toDataURL()"
COLORS = """(() => {
  const c = document.getElementById('scene');
  const data = new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer);
  return new Set(data).size;
})()"""
FRAME = "Number(document.querySelector('#now b').textContent)"
PLAYING = "document.body.classList.contains('playing')"


def pressed(browser, button):
    return browser.evaluate(f"document.getElementById('{button}').getAttribute('aria-pressed')")


def where(browser):
    return browser.evaluate("[...document.querySelectorAll('#legend .where')].map(e => e.textContent)")


@pytest.mark.parametrize("dark", [False, True])
def test_the_page_draws_a_picture_without_a_complaint_or_a_request(browser, pair, dark):
    browser.open(pair + "#frame=10", dark=dark)
    assert browser.evaluate(COLORS) > 500
    assert browser.errors == []
    assert [url for url in browser.requests if not url.startswith("data:")] == [pair]


def test_it_follows_the_colour_scheme(browser, single):
    pictures = []
    for dark in (False, True):
        browser.open(single + "#frame=10", dark=dark)
        pictures.append(browser.evaluate(PICTURE))
    assert pictures[0] != pictures[1]


def test_it_is_drawn_in_device_pixels(browser, single):
    browser.open(single + "#frame=10", scale=2.0)
    assert (
        browser.evaluate("document.getElementById('scene').width / document.getElementById('scene').clientWidth") == 2
    )


@pytest.mark.parametrize("size", [(700, 900), (1900, 1000), (420, 800)])
def test_no_picture_is_stretched_from_an_old_size_to_a_new_one(browser, pair, size):
    browser.open(pair + "#frame=10")
    # Nothing but the change of size draws from here on.
    browser.evaluate("window.later = requestAnimationFrame; window.requestAnimationFrame = () => 0; null")
    browser.evaluate("new Promise(done => later(() => later(done)))")
    browser.send(
        "Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1.0, mobile=False
    )
    browser.wait(f"innerWidth === {size[0]}")
    browser.evaluate("new Promise(done => later(() => later(done)))")
    sizes = "['scene', 'ruler'].map(id => document.getElementById(id)).map(c => [c.width, c.height, c.{}, c.{}])"
    found = browser.evaluate(sizes.format("clientWidth", "clientHeight"))
    assert all(drawn == shown for *drawn, width, height in found for shown in [[width, height]]), found
    assert browser.errors == []


def test_it_plays_in_time_and_space_pauses_it(browser, single):
    browser.open(single)
    assert browser.evaluate(PLAYING)
    browser.wait(f"{FRAME} > 3")
    browser.press(" ", code="Space")
    assert not browser.evaluate(PLAYING)
    frame = browser.evaluate(FRAME)
    browser.frames()
    assert browser.evaluate(FRAME) == frame


def test_arrows_step_and_home_and_end_go_to_the_ends(browser, single):
    browser.open(single + "#frame=20")
    seen = []
    for key, shift in (
        ("ArrowRight", False), ("ArrowRight", True), ("ArrowLeft", False), ("End", False), ("Home", False),
    ):  # fmt: skip
        browser.press(key, shift=shift)
        seen.append(browser.evaluate(FRAME))
    assert seen == [21, 31, 30, 59, 0]


def test_presets_zoom_and_orbit_change_the_view_and_follow_says_so(browser, single):
    browser.open(single + "#frame=20")
    browser.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    pictures = [browser.evaluate(PICTURE)]
    for key in ("1", "2", "3", "4", "+", "-", "a", "w", "D"):
        browser.press(key, shift=key == "D")
        pictures.append(browser.evaluate(PICTURE))
        assert pressed(browser, "follow") == ("true" if key in "4+-awD" else "false")
    assert all(a != b for a, b in pairwise(pictures))
    browser.press("0")
    assert browser.evaluate(PICTURE) == pictures[0]


def test_question_mark_shows_the_keys_and_escape_puts_them_away(browser, single):
    browser.open(single + "#frame=20")
    browser.press("?", shift=True)
    assert browser.evaluate("document.getElementById('keys').open")
    browser.press("Escape")
    assert not browser.evaluate("document.getElementById('keys').open")


def test_letters_switch_loop_layout_trail_and_brackets_the_speed(browser, pair):
    browser.open(pair + "#frame=10")
    browser.press("l")
    browser.press("o")
    browser.press("t")
    browser.press("[")
    assert (pressed(browser, "loop"), pressed(browser, "layout")) == ("false", "true")
    assert browser.evaluate("document.getElementById('trail').value") == ""
    assert browser.evaluate("document.getElementById('speed').value") == "0.5"


def test_the_mouse_turns_moves_and_zooms(browser, single):
    browser.open(single + "#frame=20")
    pictures = [browser.evaluate(PICTURE)]
    for button in ("left", "right"):
        browser.mouse("mousePressed", 500, 300, button=button, clickCount=1)
        browser.mouse("mouseMoved", 560, 330, button=button, buttons=1 if button == "left" else 2)
        browser.mouse("mouseReleased", 560, 330, button=button, clickCount=1)
        browser.frames()
        pictures.append(browser.evaluate(PICTURE))
    browser.mouse("mouseWheel", 500, 300, deltaX=0, deltaY=240)
    browser.frames()
    pictures.append(browser.evaluate(PICTURE))
    assert len(set(pictures)) == 4


def test_after_a_click_space_plays_instead_of_pressing_the_button_again(browser, pair):
    browser.open(pair + "#frame=10")
    place = browser.evaluate(
        "(() => { const r = document.getElementById('layout').getBoundingClientRect();"
        " return [r.x + r.width / 2, r.y + r.height / 2]; })()"
    )
    for kind in ("mousePressed", "mouseReleased"):
        browser.mouse(kind, *place, button="left", clickCount=1)
    browser.press(" ", code="Space")
    assert pressed(browser, "layout") == "true"
    assert browser.evaluate(PLAYING)


def test_the_address_sets_the_state(browser, pair):
    browser.open(pair + "#frame=7&view=top&layout=side&trail=LeftHand&speed=0.25")
    assert browser.evaluate(FRAME) == 7
    assert pressed(browser, "layout") == "true"
    assert browser.evaluate("document.getElementById('trail').value") == "LeftHand"
    assert browser.evaluate("document.getElementById('speed').value") == "0.25"


@pytest.mark.parametrize(
    "fragment", ["#frame=abc&view=nowhere&trail=Nobody&speed=7", "#frame=1e9", "#%", "#view=constructor"]
)
def test_nonsense_in_the_address_does_no_harm(browser, single, fragment):
    browser.open(single + fragment)
    assert browser.errors == []
    assert browser.evaluate(COLORS) > 200


def test_clips_of_differing_rates_play_in_real_time(browser, pair):
    browser.open(pair + "#frame=4")
    first, second = where(browser)
    assert first.startswith("frame 4 ")
    assert second.startswith("frame 8 ")


def test_a_clip_that_has_ended_stands_at_its_last_frame(browser, page_of):
    browser.open(page_of("ended", {"frames": 10}, {"frames": 20}) + "#frame=15")
    assert where(browser)[0].startswith("frame 9 (end)")


def test_a_clip_is_solid_then_a_ghost_then_hidden(browser, pair):
    browser.open(pair + "#frame=10")
    pictures, names = [], []
    for _ in range(3):
        pictures.append(browser.evaluate(PICTURE))
        names.append(browser.evaluate("document.querySelector('#legend button').getAttribute('aria-label')"))
        browser.evaluate("document.querySelector('#legend button').click()")
        browser.frames()
    assert names == ["pair0: solid", "pair0: ghost", "pair0: hidden"]
    assert len(set(pictures)) == 3
    assert browser.evaluate(PICTURE) == pictures[0]


def test_the_readout_is_in_the_files_own_axes(browser, page_of, folder):
    browser.open(page_of("z-up", {"frames": 12, "z_up": True}) + "#frame=5")
    motion = read_clip(folder / "z-up0.bvh").motion
    site = motion.skeleton.end_sites[-1]
    x, y, z = effector_positions(forward(motion), Effector(site.joint, site.offset))[5]
    shown = where(browser)[0].replace("\u2212", "-")
    assert shown.startswith("frame 5 · Club (end site) ")
    assert [float(word) for word in shown.split(") ")[1].split(", ")] == pytest.approx([x, y, z], abs=0.06)


def test_every_control_has_a_name_and_shows_its_focus(browser, pair):
    browser.open(pair + "#frame=10")
    nameless = browser.evaluate(
        "[...document.querySelectorAll('button, input, select, canvas:not([aria-hidden])')]"
        ".filter(e => !(e.textContent.trim() || e.getAttribute('aria-label') || e.closest('label'))).length"
    )
    assert nameless == 0
    browser.press("Tab")
    assert browser.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"


def test_a_single_frame_is_a_picture(browser, page_of):
    browser.open(page_of("still", {"frames": 1}))
    assert browser.errors == []
    assert browser.evaluate(COLORS) > 500
    assert not browser.evaluate(PLAYING)


def test_a_narrow_screen_needs_no_scrolling_aside(browser, pair):
    browser.open(pair + "#frame=10", size=(360, 740))
    assert browser.evaluate("document.documentElement.scrollWidth") <= 360
    assert browser.evaluate("document.getElementById('scene').clientHeight") > 300


@pytest.mark.parametrize(
    "name", ["golf/cmu_63_01.bvh", "motions/cmu_12_01_walk.bvh", "strokes/smash_mrios/mrios_Remate_01.bvh"]
)
def test_real_clips_are_drawn(browser, folder, real_clips, name):
    target = folder / "real.html"
    preview.run([real_clips / name], target)
    browser.open(target.as_uri() + "#frame=60")
    assert browser.errors == []
    assert browser.evaluate(COLORS) > 500
