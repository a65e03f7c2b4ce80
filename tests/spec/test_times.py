"""Times, intervals and durations: what is written, and the frames it means."""

import math
from fractions import Fraction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from motionedit.spec.faults import FaultyValueError
from motionedit.spec.times import Time, parse_duration, parse_event_name, parse_interval, parse_time

NO_TIME = "must be a time: a frame such as 94, or 3.76s, 71.2%, an event's name, or hit + 1.5s"
FRAMES = st.integers(1, 100_000)
RATES = st.sampled_from([24.0, 25.0, 30.0, 60.0, 100.0, 119.88, 120.0, 240.0])


def frame(text, *, frames=100, rate=25.0, **events):
    return parse_time(text).frame(frames=frames, frame_time=1.0 / rate, events=events)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (94, 94),
        (94.0, 94),
        ("94", 94),
        ("3.76s", 94),
        ("3.76 s", 94),
        ("0%", 0),
        ("100%", 99),
        ("50%", 50),  # 49.5, halves up
        ("1.5s", 38),  # 37.5
        ("hit", 40),
        ("hit + 1.5s", 78),  # 40 + 37.5
        ("hit + 10", 50),
        ("hit - 10", 30),
        ("hit-10", 30),
        ("hit  +  .2s", 45),
    ],
)
def test_each_form_of_a_time_means_its_frame(text, expected):
    assert frame(text, hit=40.0) == expected


@given(frames=FRAMES, data=st.data(), rate=RATES)
def test_a_frame_written_in_seconds_or_percent_is_that_frame(frames, data, rate):
    n = data.draw(st.integers(0, frames - 1))
    assert frame(n, frames=frames, rate=rate) == n
    assert frame(f"{n / rate!r}s", frames=frames, rate=rate) == n
    if frames > 1:
        assert frame(f"{100.0 * n / (frames - 1)!r}%", frames=frames, rate=rate) == n


def test_a_half_frame_that_binary_fractions_put_a_hair_too_low_is_rounded_up():
    assert 0.145 / (1.0 / 100.0) < 14.5
    assert frame("0.145s", rate=100.0) == 15


@given(frames=st.integers(2, 100_000))
def test_100_percent_is_the_last_frame(frames):
    assert frame("100%", frames=frames) == frames - 1


@given(n=st.integers(0, 10_000), numerator=st.integers(0, 999))
def test_seconds_round_to_the_nearest_frame_with_halves_up(n, numerator):
    seconds = Fraction(n * 1000 + numerator, 25_000)
    expected = math.floor(seconds * 25 + Fraction(1, 2))
    assert frame(f"{float(seconds)!r}s", frames=20_000) == expected


@given(event=st.floats(0.0, 1000.0), offset=st.integers(-500, 500))
def test_an_event_that_lies_between_frames_carries_its_fraction(event, offset):
    time = parse_time(f"hit {'-' if offset < 0 else '+'} {abs(offset)}")
    assert time.instant(frames=10, frame_time=0.04, events={"hit": event}) == event + offset


def answer(parse, text):
    """Return the refusal of a text, or its description."""
    try:
        return repr(parse(text))
    except FaultyValueError as error:
        return str(error)


@given(st.text(max_size=20))
def test_any_text_is_a_time_or_refused_on_one_line(text):
    assert answer(parse_time, text).isprintable()


@given(st.text(max_size=20))
def test_any_text_is_a_duration_or_refused_on_one_line(text):
    assert answer(parse_duration, text).isprintable()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (-3, "must not be negative: frames count from 0; not -3"),
        ("-1s", "must not be negative: frames count from 0; not '-1s'"),
        ("-0.5%", "must not be negative: frames count from 0; not '-0.5%'"),
        ("100.1%", "must be from 0% to 100% of the clip, not '100.1%'"),
        (94.5, "must be a whole frame, or seconds such as 3.76s; not 94.5"),
        ("hit + 1.5", "must be a whole frame, or seconds such as 3.76s; not 'hit + 1.5'"),
        ("10:20", f"{NO_TIME}; not '10:20'"),
        ("0x10", f"{NO_TIME}; not '0x10'"),
        (True, f"{NO_TIME}; not true"),
        ([1], f"{NO_TIME}; not [1]"),
        ("hit + 5%", f"{NO_TIME}; not 'hit + 5%'"),
        ("1e999s", "must be a finite time"),
        (math.inf, f"{NO_TIME}; not inf"),
    ],
)
def test_what_is_no_time_is_refused(text, expected):
    with pytest.raises(FaultyValueError) as caught:
        parse_time(text)
    assert str(caught.value) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (100, "100 is outside the clip, whose frames are 0 to 99"),
        ("4s", "4s (frame 100) is outside the clip, whose frames are 0 to 99"),
        ("hit - 50", "hit - 50 (frame -10) is outside the clip, whose frames are 0 to 99"),
        ("hti", "no event 'hti'; did you mean 'hit'?"),
        ("top", "no event 'top'; the events are hit"),
        ("1e300s", "1e300s is outside the clip, whose frames are 0 to 99"),
    ],
)
def test_a_time_outside_a_clip_says_so(text, expected):
    with pytest.raises(ValueError, match=r"outside|no event") as caught:
        frame(text, hit=40.0)
    assert str(caught.value) == expected


def test_seconds_without_end_are_outside_the_clip():
    with pytest.raises(ValueError, match="outside the clip"):
        Time("x", seconds=1e308).frame(frames=10, frame_time=1e-3, events={})


@pytest.mark.parametrize(("value", "frames"), [(40, 40.0), ("0.8s", 20.0), (0, 0.0), ("40", 40.0), ("0.062s", 1.55)])
def test_a_duration_is_in_frames_or_seconds(value, frames):
    assert parse_duration(value).in_frames(0.04) == pytest.approx(frames)


@pytest.mark.parametrize("value", [-1, "-1s", "2%", 2.5, "soon", True, None, [1], "1e999s", "1 min"])
def test_what_is_no_duration_is_refused(value):
    with pytest.raises(FaultyValueError):
        parse_duration(value)


def test_an_interval_has_both_ends():
    interval = parse_interval(["hit - 10", "100%"])
    assert interval.frame_range(frames=100, frame_time=0.04, events={"hit": 40.0}) == (30, 99)


def test_an_interval_that_ends_before_it_begins_in_a_clip_is_refused():
    interval = parse_interval(["hit", 20])
    with pytest.raises(ValueError, match=r"^\[hit, 20\] ends at frame 20, before it begins at frame 40$"):
        interval.frame_range(frames=100, frame_time=0.04, events={"hit": 40.0})


@pytest.mark.parametrize(
    "value",
    [
        [20, 10],
        ["2s", "1s"],
        ["90%", "40%"],
        ["hit", "hit - 1"],
        ["hit + 1s", "hit"],
        [1],
        5,
        [1, 2, 3],
        "1, 2",
        [1, 0],
    ],
)
def test_what_is_no_interval_is_refused(value):
    with pytest.raises(FaultyValueError):
        parse_interval(value)


@pytest.mark.parametrize("value", [[20, 20], ["1s", 3], ["hit", 3], [0, "hit - 50"], [50, "1s"], ["a", "b - 9"]])
def test_an_interval_whose_order_only_a_clip_can_tell_is_accepted(value):
    assert parse_interval(value)


@given(st.lists(st.integers(0, 50), min_size=2, max_size=2))
def test_an_interval_of_frames_is_refused_exactly_where_it_runs_backwards(ends):
    if ends[0] <= ends[1]:
        assert parse_interval(ends).frame_range(frames=51, frame_time=0.04, events={}) == tuple(ends)
    else:
        with pytest.raises(FaultyValueError):
            parse_interval(ends)


@given(st.from_regex(r"[a-z_][a-z0-9_]{0,5}(-[a-z][a-z0-9]{0,3})?", fullmatch=True))
def test_a_legal_event_name_is_read_back_as_that_event(name):
    assume(name not in ("first", "mean", "event"))
    assert parse_event_name(name) == name
    assert parse_time(name) == Time(name, event=name)
    assert parse_time(f"{name} - 10").event == name


@pytest.mark.parametrize("name", ["first", "mean", "10", "hit-10", "a b", "", "hit+", "3.76s", None, 5, "-a"])
def test_a_name_that_reads_as_something_else_is_no_event(name):
    with pytest.raises(FaultyValueError):
        parse_event_name(name)
